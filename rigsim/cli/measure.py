"""`rigsim measure`: what the pixels of somebody's own pair say."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rigsim.cli.kit.answer import claim, command, deliver, quiet
from rigsim.cli.kit.options import Json, Rectify, takes, takes_rig
from rigsim.errors import InvalidRange
from rigsim.typed import quantity
from rigsim.typed.rigs import RigOptions, single_rig

if TYPE_CHECKING:
    from rigsim.rig.arrays import AnyImage
    from rigsim.rig.stereo import StereoRig

_SQUARE = replace(quantity.BASELINE, name="square")


@dataclass(frozen=True, slots=True)
class MeasureWords:
    """The arguments and options of `rigsim measure`, as typed."""

    left: Annotated[Path, typer.Argument(metavar="LEFT", help="Picture of the left camera.")]
    right: Annotated[Path, typer.Argument(metavar="RIGHT", help="Picture of the right camera.")]
    board: Annotated[
        str | None,
        typer.Option(metavar="ROWSxCOLS", help="Measure checker boards as well: inner corners, 6x9."),
    ] = None
    square: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH", help="Known side of the boards' squares: 25mm. Checks whether depths are right."
        ),
    ] = None
    dense: Annotated[bool, typer.Option(help="Find a disparity for every pixel.")] = True
    matcher: Annotated[
        str,
        typer.Option(
            help="The dense matcher: sgbm; package.module:function(left, right, rig); or a command with "
            "{left}, {right} and {out} in it."
        ),
    ] = "sgbm"
    timeout: Annotated[float, typer.Option(metavar="S", help="Time limit for a matcher, s.")] = 120.0
    disparity: Annotated[
        str | None, typer.Option(metavar="PX:PX", help="Disparities to search: 0:128, px.")
    ] = None
    rectify: Rectify = None
    truth: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="True disparity of the left pixels: .pfm, .npy or .png."),
    ] = None
    truth_scale: Annotated[
        float | None,
        typer.Option(metavar="LEVELS", help="Grey levels of a truth PNG that are one px.  [default: 256]"),
    ] = None
    target: Annotated[
        str | None,
        typer.Option(metavar="U,V,WxH", help="Pixels of a flat target, judged separately: 400,300,200x100."),
    ] = None
    out: Annotated[Path | None, typer.Option(help="Folder of pictures, points and tables.")] = None
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False
    as_json: Json = False


@takes_rig
@takes(MeasureWords)
def measure(options: RigOptions, words: MeasureWords) -> None:
    """Measure a pair of pictures: matches, depths, how accurate they are, and whether the rig fits.

    Give the rig with --rig: a rig.toml, a Middlebury calib.txt, or another calibration
    (docs/reference/export.md).
    """
    board = None if words.board is None else _board(words.board)
    if words.square is not None and board is None:
        raise InvalidRange(f"square {words.square}: is the side of a board's squares: give --board as well")
    square_mm = None if words.square is None else quantity.value(words.square, _SQUARE)
    target = None if words.target is None else _target(words.target)
    searched = None if words.disparity is None else quantity.span(words.disparity, quantity.DISPARITY)
    claim(words.out, words.force)

    from rigsim.api.measure import measure as run

    with quiet(words.as_json):
        result = run(
            words.left,
            words.right,
            lambda left: _rig(options, left),
            board=board,
            square_mm=square_mm,
            matcher=words.matcher if words.dense else None,
            timeout_s=words.timeout,
            disparities_px=searched or options.disparity_range(),
            rectify=words.rectify,
            truth=words.truth,
            truth_scale=words.truth_scale,
            target=target,
            command=command(),
        )
    deliver(result, words.out, words.force, words.as_json)


def _rig(options: RigOptions, left: AnyImage) -> StereoRig:
    """The rig asked for; its images are as large as the picture unless said."""
    if options == RigOptions():
        raise InvalidRange(
            "--rig is missing: give a rig.toml or another calibration, or --baseline and --focal"
        )
    if options.rig is None and options.preset is None and options.resolution is None:
        options = replace(options, resolution=f"{left.shape[1]}x{left.shape[0]}")
    return single_rig(options, None)


def _board(text: str) -> tuple[int, int]:
    sizes = re.fullmatch(r"\s*(\d{1,3})\s*[xX×]\s*(\d{1,3})\s*", text)
    if sizes is None:
        raise InvalidRange(f"board {text!r}: give rows and columns of inner corners: 6x9")
    return int(sizes[1]), int(sizes[2])


def _target(text: str) -> tuple[int, int, int, int]:
    sides = re.fullmatch(r"\s*(\d{1,6})\s*,\s*(\d{1,6})\s*,\s*(\d{1,6})\s*[xX×]\s*(\d{1,6})\s*", text)
    if sides is None:
        raise InvalidRange(f"target {text!r}: give its first column and row, and its size: 400,300,200x100")
    return int(sides[1]), int(sides[2]), int(sides[3]), int(sides[4])
