"""`rigsim compare`: triangulators side by side."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import typer

from rigsim.cli.kit import lists
from rigsim.cli.kit.answer import claim, command, deliver, quiet
from rigsim.cli.kit.options import Json, takes, takes_rig
from rigsim.cli.kit.progress import stages
from rigsim.cli.kit.triangulators import TIMEOUT, InProcess
from rigsim.cli.kit.triangulators import words as split
from rigsim.typed import quantity
from rigsim.typed.rigs import DEFAULT_PRESET, RigOptions

_NOISE = replace(quantity.NOISE, at_least=None, above=0)
_DISPARITY_NOISE = replace(quantity.DISPARITY_NOISE, at_least=None, above=0)


@dataclass(frozen=True, slots=True)
class CompareWords:
    """The options of `rigsim compare`, as typed."""

    methods: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="METHOD",
            help="optimal, dlt, midpoint, cv2 (these by default), rectified, or package.module:function;"
            " ratios are to the first.",
        ),
    ] = None
    exec_: Annotated[
        list[str] | None,
        typer.Option(
            "--exec",
            metavar="COMMAND",
            help="A program in any language, see docs/reference/exec.md. Repeatable.",
        ),
    ] = None
    geometry: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help=f"{lists.GEOMETRIES}, or none beside a rig of yours. Repeatable, or commas.",
        ),
    ] = None
    noise: Annotated[
        str | None,
        typer.Option(
            metavar="PX",
            help="Noise levels, standard deviation of every pixel coordinate.  [default: 0.1,0.25,0.5,1,2]",
        ),
    ] = None
    disparity_noise: Annotated[
        str | None,
        typer.Option(
            metavar="PX",
            help="Noise levels, standard deviation of a disparity, instead of --noise: sqrt(2) times as"
            " much.",
        ),
    ] = None
    points: Annotated[int, typer.Option(metavar="N", help="Points for each geometry and noise level.")] = (
        20_000
    )
    seed: Annotated[int, typer.Option(help="Seed of points and noise.")] = 0
    timeout: Annotated[
        str, typer.Option(metavar="TIME", help="Time limit for one call of your function or program.")
    ] = "10s"
    in_process: InProcess = False
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for compare.html, compare.csv, compare.json, figure.png and figure.pdf."),
    ] = None
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False
    as_json: Json = False


@takes_rig
@takes(CompareWords)
def compare(options: RigOptions, words: CompareWords) -> None:
    """Compare triangulators: distance to the bound, bias, lost points and speed, over geometry and noise.

    Every method gets the same noisy pixels. A rig given by options stands beside the geometries.
    """
    timeout_s = quantity.value(words.timeout, TIMEOUT)
    noises_px = None if words.noise is None else quantity.values(words.noise, _NOISE)
    of_disparity = words.disparity_noise
    disparity_noises_px = None if of_disparity is None else quantity.values(of_disparity, _DISPARITY_NOISE)
    methods = split(words.methods, "method")
    geometries = split(words.geometry, "geometry")
    claim(words.out, words.force)
    rig = None if options == RigOptions() else options.single(DEFAULT_PRESET)

    from rigsim.api.compare import compare as run

    with quiet(words.as_json), stages() as progress:
        result = run(
            methods,
            programs=tuple(words.exec_ or ()),
            rig=rig,
            geometries=() if geometries == ("none",) else geometries or None,
            noises_px=noises_px,
            disparity_noises_px=disparity_noises_px,
            points=words.points,
            seed=words.seed,
            timeout_s=timeout_s,
            in_process=words.in_process,
            progress=lambda done, total: progress("cells", done, total),
            command=command(),
        )
    deliver(result, words.out, words.force, words.as_json)
