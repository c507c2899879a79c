"""`rigsim measure`: what the pixels of somebody's own pair say."""

from __future__ import annotations

import re
import shlex
import sys
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from rigsim.cli.kit import quantity
from rigsim.cli.kit.answer import print_document, quiet
from rigsim.cli.kit.options import Json, single_rig, takes_rig
from rigsim.cli.kit.rigs import RigOptions
from rigsim.errors import InvalidRange

_SQUARE = replace(quantity.BASELINE, name="square")


@takes_rig
def measure(
    options: RigOptions,
    left: Annotated[Path, typer.Argument(metavar="LEFT", help="Picture of the left camera.")],
    right: Annotated[Path, typer.Argument(metavar="RIGHT", help="Picture of the right camera.")],
    board: Annotated[
        str | None,
        typer.Option(metavar="ROWSxCOLS", help="Measure checker boards as well: inner corners, 6x9."),
    ] = None,
    square: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH", help="Known side of the boards' squares: 25mm. Tells if depths are right."
        ),
    ] = None,
    dense: Annotated[bool, typer.Option(help="Find a disparity for every pixel.")] = True,
    matcher: Annotated[
        str,
        typer.Option(
            help="Who finds it: sgbm; package.module:function(left, right, rig); or a command with {left}, "
            "{right} and {out} in it."
        ),
    ] = "sgbm",
    timeout: Annotated[float, typer.Option(metavar="S", help="Longest time for a matcher, s.")] = 120.0,
    disparity: Annotated[
        str | None, typer.Option(metavar="PX:PX", help="Disparities to search: 0:128, px.")
    ] = None,
    truth: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="True disparity of the left pixels: .pfm, .npy or .png."),
    ] = None,
    truth_scale: Annotated[
        float | None,
        typer.Option(metavar="LEVELS", help="Grey levels of a truth PNG that are one px.  [default: 256]"),
    ] = None,
    target: Annotated[
        str | None,
        typer.Option(metavar="U,V,WxH", help="Pixels of a flat target, to judge by itself: 400,300,200x100."),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Folder of pictures, points and tables.")] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False,
    as_json: Json = False,
) -> None:
    """Measure a pair of pictures: matches, depths, how accurate they are, and whether the rig fits.

    Give the rig with --rig: a rig.toml, a Middlebury calib.txt, or another calibration
    (docs/reference/export.md).
    """
    rows_cols = None if board is None else _board(board)
    if square is not None and board is None:
        raise InvalidRange(f"square {square}: is the side of a board's squares: give --board as well")
    side_m = None if square is None else quantity.value(square, _SQUARE) / 1e3
    pixels = None if target is None else _target(target)
    searched = None if disparity is None else quantity.span(disparity, quantity.DISPARITY)

    from rigsim.interop.files import folder

    if out is not None:
        folder.check_output(out, force)

    from rigsim.interop.files.measure import document, pair_files, read_truth, sources
    from rigsim.pixels.reading import read_image

    image_left, image_right = read_image(left), read_image(right)
    if options == RigOptions():
        raise InvalidRange(
            "--rig is missing: give a rig.toml or another calibration, or --baseline and --focal"
        )
    if options.rig is None and options.preset is None and options.resolution is None:
        options = replace(options, resolution=f"{image_left.shape[1]}x{image_left.shape[0]}")
    rig = single_rig(options, None)
    true = None if truth is None else read_truth(truth, truth_scale)

    from rigsim.study.measure.run import Wanted, measure_pair, versions

    paths = {"left": left, "right": right} | ({} if truth is None else {"truth": truth})
    with quiet(as_json):
        result = measure_pair(
            image_left,
            image_right,
            rig,
            Wanted(
                matcher=matcher if dense else None,
                board=rows_cols,
                square_m=side_m,
                target=pixels,
                disparity_range=searched or options.disparity_range(),
                timeout_s=timeout,
            ),
            truth=true,
            provenance={"command": shlex.join(["rigsim", *sys.argv[1:]]), **sources(paths), **versions()},
        )

    from rigsim.present.measure.console import pair_pictures, print_pair
    from rigsim.present.measure.words import sentence

    written = None
    if out is not None:
        from rigsim.interop.documents.base import Written
        from rigsim.interop.files.tables import json_bytes

        files = {**pair_pictures(result), **pair_files(result)}
        written = Written(folder=str(out), files=sorted([*files, "measure.json"]))
        files["measure.json"] = json_bytes(document(result, sentence, written))
        folder.write_folder(out, files, force)
    if as_json:
        print_document(document(result, sentence, written))
    else:
        print_pair(result, out)


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
