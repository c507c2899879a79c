"""`rigsim compare`: triangulators side by side."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rigsim.cli.kit import lists, quantity
from rigsim.cli.kit.answer import print_document, quiet
from rigsim.cli.kit.options import Json, takes_rig
from rigsim.cli.kit.progress import shown
from rigsim.cli.kit.rigs import DEFAULT_PRESET, RigOptions
from rigsim.cli.kit.triangulators import TIMEOUT, InProcess, resolved, words
from rigsim.errors import InvalidRange, MeasurementFailed

if TYPE_CHECKING:
    from rigsim.study.compare.run import ComparisonResult

_NOISE = quantity.QuantityKind("noise", "px", quantity.NOISE.factors, above=0)


@takes_rig
def compare(
    options: RigOptions,
    methods: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="METHOD",
            help="optimal, dlt, midpoint, cv2 (these unless said), rectified, or package.module:function;"
            " ratios are to the first.",
        ),
    ] = None,
    exec_: Annotated[
        list[str] | None,
        typer.Option(
            "--exec",
            metavar="COMMAND",
            help="A program in any language, see docs/reference/exec.md. Repeatable.",
        ),
    ] = None,
    geometry: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help=f"{lists.GEOMETRIES}, or none beside a rig of yours. Repeatable, or commas.",
        ),
    ] = None,
    noise: Annotated[
        str, typer.Option(metavar="PX", help="Noise levels, standard deviation of every pixel coordinate.")
    ] = "0.1,0.25,0.5,1,2",
    points: Annotated[
        int, typer.Option(metavar="N", help="Points for each geometry and noise level.")
    ] = 20_000,
    seed: Annotated[int, typer.Option(help="Seed of points and noise.")] = 0,
    timeout: Annotated[
        str, typer.Option(metavar="TIME", help="For one call of a function or program of yours.")
    ] = "10s",
    in_process: InProcess = False,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for compare.html, compare.csv, compare.json, figure.png and figure.pdf."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False,
    as_json: Json = False,
) -> None:
    """Compare triangulators: distance to the bound, bias, lost points and speed, over geometry and noise.

    Every method gets the same noisy pixels. A rig given by options stands beside the geometries.
    """
    timeout_s = quantity.value(timeout, TIMEOUT)
    noises_px = quantity.values(noise, _NOISE)
    names = words(methods, "method")
    chosen = words(geometry, "geometry")
    from rigsim.interop.files import folder

    if out is not None:
        folder.check_output(out, force)
    from rigsim.study.compare.run import (
        DEFAULT_GEOMETRIES,
        DEFAULT_METHODS,
        ComparisonPlan,
        compare,
        comparison_provenance,
    )

    plan = ComparisonPlan(
        () if chosen == ("none",) else chosen or DEFAULT_GEOMETRIES,
        noises_px,
        points,
        seed,
        None if options == RigOptions() else options.single(DEFAULT_PRESET),
    )
    names, missing = _installed(names or DEFAULT_METHODS)
    with (
        quiet(as_json),
        resolved(names, tuple(exec_ or ()), timeout_s, in_process) as known,
        shown(len(plan.chosen()) * len(noises_px), "cells") as progress,
    ):
        done = 0

        def one_more() -> None:
            nonlocal done
            done += 1
            if progress is not None:
                progress(done)

        provenance = comparison_provenance(shlex.join(["rigsim", *sys.argv[1:]]))
        result = compare(plan, known, one_more, missing, provenance)
    _deliver(result, out, force, as_json)


def _deliver(result: ComparisonResult, out: Path | None, force: bool, as_json: bool) -> None:
    from rigsim.interop.documents.compare import compare_document
    from rigsim.interop.files import folder
    from rigsim.present.compare import words

    document = compare_document(result, words.headline(result), words.sentences(result)).model_dump()
    if out is not None:
        from rigsim.interop.files.tables import csv_bytes, json_bytes
        from rigsim.present.compare.page import comparison_files

        files = comparison_files(result)
        files["compare.csv"] = csv_bytes(result.rows)
        files["compare.json"] = json_bytes(document)
        folder.write_folder(out, files, force)
    if as_json:
        print_document(document)
    else:
        from rigsim.present.compare.console import print_comparison

        print_comparison(result, out)


def _installed(names: tuple[str, ...]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The names that can be had, and a sentence on OpenCV when it is missing.

    Raises:
        InvalidRange: none is left.
    """
    if "cv2" not in names:
        return names, ()
    from rigsim.pixels.opencv import load_cv2

    try:
        load_cv2()
    except MeasurementFailed as error:
        rest = tuple(name for name in names if name != "cv2")
        if not rest:
            raise InvalidRange(f"method cv2: {error}, or name another one") from None
        return rest, (f"cv2: {error}",)
    return names, ()
