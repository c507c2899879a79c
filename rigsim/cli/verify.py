"""`rigsim verify`: any triangulator on cases with known answers."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rigsim.cli.kit import lists, quantity
from rigsim.cli.kit.answer import print_document, quiet
from rigsim.cli.kit.options import Json, takes_rig
from rigsim.cli.kit.progress import shown
from rigsim.cli.kit.rigs import DEFAULT_PRESET, RigOptions
from rigsim.cli.kit.triangulators import TIMEOUT, resolved, words
from rigsim.errors import InvalidRange, OutputError

if TYPE_CHECKING:
    from rigsim.study.verify.golden import GoldenReport
    from rigsim.study.verify.result import CaseResult, VerifyResult
    from rigsim.study.verify.session import Gathered, Selection

FAILED = 3
"""Exit code when a case failed."""

GOLDEN = Path("reports/golden")
"""Where golden results are written unless something else is said."""

_NO_SCENE = "none"


@takes_rig
def verify(
    options: RigOptions,
    triangulator: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help=f"{lists.TRIANGULATORS}, or package.module:function; repeatable, or commas."
            " optimal unless said.",
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
    suite: Annotated[str, typer.Option(help="quick, for every commit; full, before a release.")] = "quick",
    cases: Annotated[
        list[str] | None,
        typer.Option(
            metavar="PATTERN",
            help="Only these cases or groups: verged, 'far*'. Repeatable, or commas; see --list.",
        ),
    ] = None,
    scene: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Scenes to take surfaces and pictures from: names, MJCF files, or none; all unless said.",
        ),
    ] = None,
    strict: Annotated[
        bool, typer.Option("--strict", help="Errors larger than least squares would leave fail, too.")
    ] = False,
    seed: Annotated[int, typer.Option(help="Seed of every random number.")] = 0,
    timeout: Annotated[
        str, typer.Option(metavar="TIME", help="For one call of a function or program of yours.")
    ] = "10s",
    out: Annotated[
        Path | None, typer.Option(help="Folder for verify.html, verify.json and junit.xml.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False,
    junit: Annotated[Path | None, typer.Option(metavar="FILE", help="Write JUnit XML here.")] = None,
    as_json: Json = False,
    golden: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Hold the numbers against golden results; what moved fails."),
    ] = None,
    update: Annotated[
        bool, typer.Option("--update", help=f"Write golden results, to {GOLDEN} or --golden.")
    ] = False,
    list_cases: Annotated[
        bool, typer.Option("--list", help="Say which cases there are, and run nothing.")
    ] = False,
) -> None:
    """Test triangulators on cases with known answers; exit code 3 when one fails.

    Tolerances follow from the noise, and a correct triangulator fails in one run of 10,000. A rig given by
    options is added to the cases and placed in every scene.
    """
    timeout_s = quantity.value(timeout, TIMEOUT)
    if list_cases and as_json:
        raise InvalidRange("list: prints no JSON; leave out --json")
    from rigsim.interop.files import folder

    if out is not None:
        folder.check_output(out, force)
    if junit is not None and not junit.absolute().parent.is_dir():
        raise OutputError(f"junit {junit}: its folder does not exist; make it, or choose another one")
    if update and (cases or scene):
        raise InvalidRange("update: golden results hold every case; leave out --cases and --scene")
    if golden is not None and not update:
        from rigsim.interop.files.golden import read_golden

        read_golden(golden, ())  # a folder that is not there is told before the work
    from rigsim.study.verify.session import Selection, run

    selection = Selection(
        suite,
        seed,
        words(cases, "cases"),
        _scenes(scene),
        None if options == RigOptions() else options.single(DEFAULT_PRESET),
    )
    names = words(triangulator, "triangulator")
    commands = tuple(exec_ or ())
    if not names and not commands:
        names = ("optimal",)
    with quiet(as_json), resolved(names, commands, timeout_s) as known:
        gathered = _gathered(selection)
        if list_cases:
            from rigsim.present.verify.console import print_cases

            print_cases(gathered.cases)
            return
        with shown(len(gathered.cases) * len(known), "cases") as progress:
            done = 0

            def one_more(_: CaseResult) -> None:
                nonlocal done
                done += 1
                if progress is not None:
                    progress(done)

            result = run(gathered, known, selection, one_more, shlex.join(["rigsim", *sys.argv[1:]]))
    chosen = ["--cases", ",".join(selection.patterns)] if selection.patterns else []
    again = {
        label: [*_again(options, scene, suite, strict, seed, timeout), flag, label, *chosen]
        for flag, labels in (("--triangulator", names), ("--exec", commands))
        for label in labels
    }
    with quiet(as_json):
        report = _golden(result, selection, golden, update)
    _deliver(result, strict, again, out, force, junit, as_json, report)
    if not result.passed(strict) or (report is not None and not report.passed):
        raise typer.Exit(FAILED)


def _golden(
    result: VerifyResult, selection: Selection, folder: Path | None, update: bool
) -> GoldenReport | None:
    """Compare with golden results, or write them; None when neither is asked for."""
    if folder is None and not update:
        return None
    from rigsim.interop.files.golden import read_golden, write_golden
    from rigsim.sim.scenes import library
    from rigsim.study.verify.golden import GoldenComparison, GoldenReport, compare
    from rigsim.study.verify.session import golden_records

    folder = folder or GOLDEN
    partial = bool(selection.patterns) or selection.scenes is not None
    scenes = () if selection.patterns else library.names() if selection.scenes is None else selection.scenes
    with shown(len(scenes), "golden scenes"):
        records = golden_records(result, scenes)
    comparison = GoldenComparison(())
    troubles: list[str] = []
    if folder.is_dir() or not update:
        golden, troubles = read_golden(folder, [record.name for record in records])
        comparison = compare(golden, records, partial)
    written = write_golden(folder, records) if update else []
    return GoldenReport(str(folder), comparison, tuple(troubles), tuple(path.name for path in written))


def _deliver(
    result: VerifyResult,
    strict: bool,
    again: Mapping[str, list[str]],
    out: Path | None,
    force: bool,
    junit: Path | None,
    as_json: bool,
    golden: GoldenReport | None,
) -> None:
    from rigsim.interop.documents.verify import verify_document
    from rigsim.interop.files import folder
    from rigsim.interop.files.junit import junit_bytes
    from rigsim.interop.files.tables import json_bytes
    from rigsim.present.verify import words as said

    document = verify_document(result, strict, golden)
    if junit is not None:
        folder.write_file(junit, junit_bytes(result, said, strict))
    if out is not None:
        from rigsim.present.verify.page import verify_html

        files = {
            "verify.html": verify_html(result, strict, again).encode(),
            "verify.json": json_bytes(document),
            "junit.xml": junit_bytes(result, said, strict),
        }
        folder.write_folder(out, files, force)
    if as_json:
        print_document(document)
    else:
        from rigsim.present.verify.console import print_verify

        print_verify(result, strict, again, out)
        if golden is not None:
            from rigsim.present.verify.golden import print_golden

            print_golden(golden)


def _gathered(selection: Selection) -> Gathered:
    from rigsim.sim.scenes import library
    from rigsim.study.verify.session import gather

    n_scenes = len(library.names() if selection.scenes is None else selection.scenes)
    with shown(n_scenes, "scenes") as progress:
        return gather(selection, progress) if progress is not None else gather(selection)


def _scenes(given: list[str] | None) -> tuple[str, ...] | None:
    if given is None:
        return None
    scenes = words(given, "scene")
    if _NO_SCENE in scenes:
        if len(scenes) > 1:
            raise InvalidRange("scene none: given with others; remove one or the other")
        return ()
    return scenes


def _again(
    options: RigOptions, scene: list[str] | None, suite: str, strict: bool, seed: int, timeout: str
) -> list[str]:
    """The words that make the same cases again, those left at their defaults left out."""
    said = ["rigsim", "verify"]
    for name, text in options.typed():
        said += [f"--{name}", text]
    for text in scene or ():
        said += ["--scene", text]
    if suite != "quick":
        said += ["--suite", suite]
    if strict:
        said.append("--strict")
    if seed:
        said += ["--seed", str(seed)]
    if timeout != "10s":
        said += ["--timeout", timeout]
    return said
