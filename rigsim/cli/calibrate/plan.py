"""`rigsim calibrate plan`: how many pictures of which board, held where, and what they leave of the depth."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated

import typer

from rigsim import interrupts
from rigsim.cli.kit.answer import claim, command, deliver, print_document, quiet
from rigsim.cli.kit.options import DisparityNoise, Json, Noise, takes, takes_rig
from rigsim.cli.kit.progress import stages
from rigsim.errors import CalibrationUndetermined
from rigsim.typed.calibrate import plan_arguments
from rigsim.typed.rigs import DEFAULT_PRESET, RigOptions


@dataclass(frozen=True, slots=True)
class PlanWords:
    """The options of `rigsim calibrate plan`, as typed."""

    board: Annotated[
        str,
        typer.Option(
            metavar="COLSxROWS@SQUARE",
            help="The checker board: inner corners along it and down, and a square's side: 9x6@30mm.",
        ),
    ]
    poses: Annotated[
        str,
        typer.Option(
            metavar="N|FILE",
            help="How many pictures by each camera, whose poses are chosen; or a poses.json that says where"
            " the board is held.",
        ),
    ] = "20"
    board_range: Annotated[
        str,
        typer.Option(
            "--range",
            metavar="NEAR:FAR",
            help="How near and how far the board's middle can be held, from the left camera.",
        ),
    ] = "0.4:1.2m"
    tilt: Annotated[
        str, typer.Option(metavar="DEG", help="Most that the board is turned out of the picture's plane.")
    ] = "40deg"
    corner_noise: Annotated[
        str,
        typer.Option(
            metavar="PX",
            help="Standard deviation of one coordinate of a found corner, as real calibrations leave it:"
            " 0.13 px in OpenCV's sample pictures; `rigsim calibrate pictures` says what yours have.",
        ),
    ] = "0.1"
    noise: Noise = None
    disparity_noise: DisparityNoise = None
    model: Annotated[
        str | None,
        typer.Option(
            metavar="MODEL",
            help="Lens model that the calibration estimates: brown, rational, fisheye (kannala_brandt), ...;"
            " by default the rig's own, brown where it has none.",
        ),
    ] = None
    fix: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME,...",
            help="What it does not estimate: aspect, k3, right.p1, tangential, lens, pose, ... Repeatable.",
        ),
    ] = None
    warp: Annotated[bool, typer.Option("--warp", help="Let it estimate the board's warp as well.")] = False
    flatness: Annotated[
        str,
        typer.Option(
            metavar="LENGTH",
            help="Standard deviation of the board's warp, of the rise in the middle of its rows, and of its"
            " columns: 0.2mm.",
        ),
    ] = "0"
    depth_error: Annotated[
        str | None,
        typer.Option(
            metavar="ERROR[@DISTANCE]",
            help="Largest standard deviation of a depth on the axis, by calibration and pixel noise together:"
            " 10mm@3m, 1%; at the largest --at by default. Says how many pictures it takes.",
        ),
    ] = None
    at: Annotated[str, typer.Option(metavar="LENGTHS", help="Distances that the depth error is told at.")] = (
        "1,2,3,5m"
    )
    verify: Annotated[
        bool,
        typer.Option(
            "--verify/--no-verify",
            help="Make whole calibrations beside the prediction: 300 simulated, 20 of rendered pictures.",
        ),
    ] = False
    simulate: Annotated[
        int | None,
        typer.Option(
            min=0, metavar="N", help="How many are simulated instead; without --verify, only these."
        ),
    ] = None
    true_model: Annotated[
        str | None,
        typer.Option(
            metavar="MODEL|FILE",
            help="The true lens in those, where it is not --model: a model, which the rig's own lens is taken"
            " in, or a calibration's file.",
        ),
    ] = None
    true_warp: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH[,LENGTH]",
            help="True warp of the board in those, of its rows and its columns: 0.3mm.",
        ),
    ] = None
    seed: Annotated[int, typer.Option(min=0, help="Seed of every random number.")] = 0
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder for plan.html (the sheet for the bench), plan.json, poses.json, covariance.json,"
            " plan.png, poses.png and projection.png."
        ),
    ] = None
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False
    as_json: Json = False


@takes_rig
@takes(PlanWords)
def plan(options: RigOptions, words: PlanWords) -> None:
    """Plan a stereo calibration: how many pictures, where to hold the board, what that leaves of the depth.

    The depth error has two halves, which add as squares: what calibration leaves, and pixel noise. Both are
    told at each distance, with the number of pictures that meet --depth-error. Poses are chosen for the
    distance asked for, best first.
    """
    asked = plan_arguments({item.name: getattr(words, item.name) for item in fields(words)})
    claim(words.out, words.force)
    rig = options.single(DEFAULT_PRESET)

    from rigsim.api.calibrate.plan import plan_calibration

    try:
        with quiet(words.as_json), stages() as progress:
            found = plan_calibration(rig, **asked, command=command(), progress=progress)
    except CalibrationUndetermined as error:
        if words.as_json:
            from rigsim.interop.documents.calibrate.plan import undetermined_document

            print_document(undetermined_document(str(error), error.reason))
        raise
    deliver(found, words.out, words.force, words.as_json)
    if not found.complete:
        raise typer.Exit(interrupts.INTERRUPTED)
