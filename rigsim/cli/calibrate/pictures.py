"""`rigsim calibrate pictures`: a rig from one's own pictures of a board, and how good it is."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated

import typer

from rigsim import interrupts
from rigsim.cli.kit.answer import claim, command, deliver, quiet
from rigsim.cli.kit.options import DisparityNoise, Json, Noise, takes
from rigsim.cli.kit.progress import stages
from rigsim.typed.pictures import pictures_arguments


@dataclass(frozen=True, slots=True)
class PicturesWords:
    """The arguments and options of `rigsim calibrate pictures`, as typed."""

    board: Annotated[
        str,
        typer.Option(
            metavar="COLSxROWS@SQUARE",
            help="The checker board: inner corners along it and down, and a square's side: 9x6@25mm.",
        ),
    ]
    pictures: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="LEFT... RIGHT...",
            help="Pictures of both cameras: files, folders or patterns, paired by the sides and the digits in"
            " their names.",
        ),
    ] = None
    model: Annotated[
        str,
        typer.Option(
            metavar="MODEL",
            help="Lens model: pinhole, brown, rational (8 terms) or fisheye (Kannala-Brandt).",
        ),
    ] = "brown"
    fix: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME,...", help="What is not estimated: aspect, k3, tangential, principal. Repeatable."
        ),
    ] = None
    warp: Annotated[bool, typer.Option("--warp", help="Estimate the board's warp as well.")] = False
    at: Annotated[str, typer.Option(metavar="LENGTHS", help="Distances that the depth error is told at.")] = (
        "1,2,3,5m"
    )
    noise: Noise = None
    disparity_noise: DisparityNoise = None
    corners: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE",
            help="Corners found elsewhere, in the place of pictures: a corners.vnl, or a CSV table; twice"
            " for one of each camera (docs/reference/calibrate_pictures.md).",
        ),
    ] = None
    size: Annotated[
        str | None, typer.Option(metavar="WxH", help="Size of the pictures that --corners are of: 640x480.")
    ] = None
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder for rig.toml, covariance.json, calibration.json, corners.csv, coverage.png and"
            " residuals.png."
        ),
    ] = None
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False
    as_json: Json = False


@takes(PicturesWords)
def pictures(words: PicturesWords) -> None:
    """Calibrate a rig from your own pictures of a checker board, and say how good it is.

    OpenCV calibrates; then each pair is predicted by the others, bad ones are named with the reason and left
    out, and the covariance says what the calibration leaves of the depth.
    """
    asked = pictures_arguments({item.name: getattr(words, item.name) for item in fields(words)})
    claim(words.out, words.force)

    from rigsim.api.calibrate.pictures import calibrate_pictures

    with quiet(words.as_json), stages() as progress:
        found = calibrate_pictures(**asked, command=command(), progress=progress)
    deliver(found, words.out, words.force, words.as_json)
    if found.result.interrupted:
        raise typer.Exit(interrupts.INTERRUPTED)
