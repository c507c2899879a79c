"""`rigsim verify`: any triangulator on cases with known answers."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from rigsim.cli.kit import lists
from rigsim.cli.kit.answer import claim, command, deliver, quiet
from rigsim.cli.kit.golden import GOLDEN, GoldenTolerance, share
from rigsim.cli.kit.options import Json, takes, takes_rig
from rigsim.cli.kit.progress import stages
from rigsim.cli.kit.triangulators import TIMEOUT, InProcess
from rigsim.cli.kit.triangulators import words as split
from rigsim.errors import InvalidRange, OutputError
from rigsim.typed import quantity
from rigsim.typed.rigs import DEFAULT_PRESET, RigOptions

FAILED = 3
"""Exit code when a case failed."""

_NO_SCENE = "none"


@dataclass(frozen=True, slots=True)
class VerifyWords:
    """The options of `rigsim verify`, as typed."""

    triangulator: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help=f"{lists.TRIANGULATORS}, or package.module:function; repeatable, or commas."
            " optimal by default.",
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
    suite: Annotated[str, typer.Option(help="quick, for every commit; full, before a release.")] = "quick"
    cases: Annotated[
        list[str] | None,
        typer.Option(
            metavar="PATTERN",
            help="Only these cases or groups: verged, 'far*'. Repeatable, or commas; see --list.",
        ),
    ] = None
    scene: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Scenes to take surfaces and pictures from: names, MJCF files, or none; all by default.",
        ),
    ] = None
    strict: Annotated[
        bool, typer.Option("--strict", help="Also fail errors larger than those of least squares.")
    ] = False
    seed: Annotated[int, typer.Option(help="Seed of every random number.")] = 0
    timeout: Annotated[
        str, typer.Option(metavar="TIME", help="Time limit for one call of your function or program.")
    ] = "10s"
    in_process: InProcess = False
    out: Annotated[Path | None, typer.Option(help="Folder for verify.html, verify.json and junit.xml.")] = (
        None
    )
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False
    junit: Annotated[Path | None, typer.Option(metavar="FILE", help="Write JUnit XML here.")] = None
    as_json: Json = False
    golden: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Compare with golden results; a changed number fails."),
    ] = None
    update: Annotated[
        bool, typer.Option("--update", help=f"Write golden results, to {GOLDEN} or --golden.")
    ] = False
    golden_tolerance: GoldenTolerance = None
    list_cases: Annotated[bool, typer.Option("--list", help="List the cases and run nothing.")] = False


@takes_rig
@takes(VerifyWords)
def verify(options: RigOptions, words: VerifyWords) -> None:
    """Test triangulators on cases with known answers; exit code 3 when one fails.

    Tolerances follow from the noise, and a correct triangulator fails in one run of 10,000. A rig given by
    options is added to the cases and placed in every scene.
    """
    timeout_s = quantity.value(words.timeout, TIMEOUT)
    if words.list_cases and words.as_json:
        raise InvalidRange("list: prints no JSON; leave out --json")
    claim(words.out, words.force)
    if words.junit is not None and not words.junit.absolute().parent.is_dir():
        raise OutputError(f"junit {words.junit}: its folder does not exist; make it, or choose another one")
    said: dict[str, Any] = {
        "triangulators": split(words.triangulator, "triangulator"),
        "programs": tuple(words.exec_ or ()),
        "suite": words.suite,
        "cases": split(words.cases, "cases"),
        "scenes": _scenes(words.scene),
        "rig": None if options == RigOptions() else options.single(DEFAULT_PRESET),
        "seed": words.seed,
        "timeout_s": timeout_s,
        "in_process": words.in_process,
        "golden": words.golden,
        "update": words.update,
        "golden_tolerance": share(words.golden_tolerance),
    }

    from rigsim.api import verify as api

    with quiet(words.as_json), stages() as progress:
        if words.list_cases:
            api.print_cases(api.VerifyOptions(**said, progress=progress))
            return
        result = api.verify(
            **said,
            strict=words.strict,
            progress=progress,
            command=command(),
            again=_again(options, words),
        )
    if words.junit is not None:
        from rigsim.interop.files.folder import write_file

        write_file(words.junit, result.junit())
    deliver(result, words.out, words.force, words.as_json)
    if not result.passed:
        raise typer.Exit(FAILED)


def _scenes(given: list[str] | None) -> tuple[str, ...] | None:
    if given is None:
        return None
    scenes = split(given, "scene")
    if _NO_SCENE in scenes:
        if len(scenes) > 1:
            raise InvalidRange("scene none: given with others; remove one or the other")
        return ()
    return scenes


def _again(options: RigOptions, words: VerifyWords) -> list[str]:
    """The words that make the same cases again, those left at their defaults left out."""
    said = ["rigsim", "verify"]
    for name, text in options.typed():
        said += [f"--{name}", text] if text else [f"--{name}"]
    for text in words.scene or ():
        said += ["--scene", text]
    if words.suite != "quick":
        said += ["--suite", words.suite]
    if words.strict:
        said.append("--strict")
    if words.seed:
        said += ["--seed", str(words.seed)]
    if words.timeout != "10s":
        said += ["--timeout", words.timeout]
    if words.in_process:
        said.append("--in-process")
    return said
