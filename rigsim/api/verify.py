"""`rigsim.verify`: any triangulator against cases whose answer is known."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rigsim.api.kit.golden import GOLDEN
from rigsim.api.kit.plain import takes
from rigsim.api.kit.triangulators import TIMEOUT_S, Method, named, opened
from rigsim.api.result import Result
from rigsim.api.rigs import RigLike, read_rig
from rigsim.errors import InvalidRange
from rigsim.rig import given
from rigsim.rig.remark import Remark

if TYPE_CHECKING:
    from rigsim.interop.documents.base import Written
    from rigsim.present.kit.types import Figure, Table
    from rigsim.study.golden.compare import GoldenReport
    from rigsim.study.verify.result import CaseResult, VerifyResult
    from rigsim.study.verify.session import Gathered, Selection

Stage = Callable[[str, int, int], None]
"""Is told what is being done (``scenes``, ``cases``, ``golden scenes``), how much of it, and of how much."""


@dataclass(frozen=True, slots=True)
class VerifyOptions:
    """The arguments of `verify`, which says what they mean."""

    triangulators: Method | Sequence[Method] = ()
    _: KW_ONLY
    programs: str | Sequence[str] = ()
    suite: str = "quick"
    cases: str | Sequence[str] = ()
    scenes: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] | None = None
    rig: RigLike | None = None
    strict: bool = False
    seed: int = 0
    timeout_s: float = TIMEOUT_S
    in_process: bool = False
    golden: str | os.PathLike[str] | None = None
    update: bool = False
    golden_tolerance: float = 0.0
    progress: Stage | None = None
    command: str = ""
    again: Sequence[str] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Verified(Result):
    """What became of every triangulator."""

    result: VerifyResult
    """Every case of every triangulator."""
    strict: bool
    """Whether efficiency counts."""
    golden: GoldenReport | None
    """How the numbers compare with golden results; None when it was not asked."""
    again: Mapping[str, Sequence[str]]
    """The words that run one triangulator again."""
    remarks: tuple[Remark, ...] = ()
    """Nothing is odd about a verification so far; what was left out is in `result`."""

    @property
    def passed(self) -> bool:
        """Whether no case failed, and no golden number moved."""
        return self.result.passed(self.strict) and (self.golden is None or self.golden.passed)

    @property
    def table(self) -> Table:
        """One row a triangulator and case: status, efficiency, depth errors."""
        from rigsim.present.kit.types import table

        rows: list[dict[str, object]] = []
        for one in self.document()["triangulators"]:
            for case in one["cases"]:
                plain = {key: value for key, value in case.items() if not isinstance(value, list)}
                rows.append({"triangulator": one["triangulator"], **plain})
        return table(rows)

    @property
    def verdict(self) -> str:
        """``passed`` or ``failed``."""
        return "passed" if self.passed else "failed"

    @property
    def headline(self) -> str:
        """The answer in one sentence."""
        from rigsim.present.verify.page import headline

        return headline(self.result, self.strict)

    @property
    def figures(self) -> Mapping[str, Callable[[], Figure]]:
        """One for every case with an answer, ``TRIANGULATOR: CASE``; those that failed first."""
        results = [case for one in self.result.triangulators for case in one.results]
        drawn = [case for case in results if case.found_left is not None]
        drawn.sort(key=lambda case: case.status(self.strict) != "failed")
        return {f"{case.triangulator}: {case.case.name}": _drawer(case) for case in drawn}

    def files(self) -> dict[str, bytes]:
        """verify.html, verify.json and junit.xml."""
        from rigsim.interop.files.tables import json_bytes
        from rigsim.present.verify.page import verify_html

        return {
            "verify.html": verify_html(self.result, self.strict, self.again).encode(),
            "verify.json": json_bytes(self.document()),
            "junit.xml": self.junit(),
        }

    def junit(self) -> bytes:
        """The verification as JUnit XML."""
        from rigsim.interop.files.junit import junit_bytes
        from rigsim.present.verify import words

        return junit_bytes(self.result, words, self.strict)

    def document(self, written: Written | None = None) -> Mapping[str, Any]:
        """The verification; docs/reference/verify.md says what the keys mean."""
        from rigsim.interop.documents.verify import verify_document
        from rigsim.present.verify import words

        return verify_document(self.result, words, self.strict, self.golden)

    def print(self, folder: Path | None = None) -> None:
        """Print a line a group where all is well, else what failed and how to run it again."""
        from rigsim.present.verify.console import print_verify
        from rigsim.present.verify.golden import print_golden

        print_verify(self.result, self.strict, self.again, folder)
        if self.golden is not None:
            print_golden(self.golden)


@takes(VerifyOptions)
def verify(options: VerifyOptions) -> Verified:
    """Hold triangulators against cases whose answer is known.

    Tolerances follow from the noise, and a correct triangulator fails in one run of 10,000.

    Args:
        triangulators: optimal (unless said), rectified, dlt, midpoint, cv2, ``package.module:function``,
            which runs in a process of its own, or functions, which run in this one.
        programs: Programs in any language; see docs/reference/exec.md.
        suite: quick, for every commit; or full, before a release.
        cases: Only these cases or groups, as ``verged`` or ``far*``.
        scenes: Scenes to take surfaces and pictures from; all unless said, and none for an empty list.
        rig: A rig that is added to the cases and placed in every scene: a preset's name, a calibration's path
            or text, or a rig.
        strict: Whether errors larger than least squares would leave fail, too.
        seed: Seed of every random number.
        timeout_s: For one call of a function or program of somebody else's, s.
        in_process: Whether a ``package.module:function`` is called in this process as well: faster, but if
            it crashes or hangs, so does this.
        golden: A folder of golden results that the numbers are held against; what moved fails.
        update: Whether golden results are written, to `golden` or reports/golden.
        golden_tolerance: What every golden number may differ by in any case, relative.
        progress: Is called with what is being done, how much of it is done, and of how much.
        command: What the files and the document name as the command that made them.
        again: The words of a command that makes the same cases again, which are shown with what failed.

    Raises:
        InvalidRange: An unknown suite, a pattern that matches no case, or a contradiction.
        TriangulatorError: A triangulator cannot be loaded.
        OutputError: Golden results cannot be read or written.

    Example:
        >>> import rigsim
        >>> found = rigsim.verify("dlt", cases="rectified", scenes=[])
        >>> found.verdict
        'passed'
        >>> def swapped(rig, uv_left, uv_right):
        ...     return rigsim.triangulate(rig, uv_right, uv_left)
        >>> rigsim.verify(swapped, cases="rectified", scenes=[]).verdict
        'failed'
    """
    return _verified(options)


def _verified(options: VerifyOptions) -> Verified:
    from rigsim.study.verify.session import run

    selection = _selection(options)
    folder = _golden_folder(options, selection)
    methods, programs = named(options.triangulators), tuple(map(str, given.several(options.programs)))
    if not methods and not programs:
        methods = ("optimal",)
    with opened(methods, programs, options.timeout_s, options.in_process) as known:
        gathered = _gathered(selection, options.progress)
        total, done = len(gathered.cases) * len(known), 0

        def one_more(_: CaseResult) -> None:
            nonlocal done
            done += 1
            if options.progress is not None:
                options.progress("cases", done, total)

        result = run(gathered, known, selection, one_more, options.command)
    n_methods = len(known) - len(programs)
    flags = ["--triangulator"] * n_methods + ["--exec"] * len(programs)
    return Verified(
        result,
        options.strict,
        _golden(result, selection, folder, options),
        {label: _again(options, flag, label) for flag, label in zip(flags, known, strict=True)},
    )


def print_cases(options: VerifyOptions) -> None:
    """Print the cases that `verify` tests triangulators on; nothing is run."""
    from rigsim.present.verify.console import print_cases

    with opened(named(options.triangulators), (), options.timeout_s, options.in_process):
        print_cases(_gathered(_selection(options), options.progress).cases)


def _selection(options: VerifyOptions) -> Selection:
    from rigsim.study.verify.session import Selection

    scenes = None if options.scenes is None else given.several(options.scenes)
    patterns = tuple(str(pattern) for pattern in given.several(options.cases))
    if options.update and (patterns or scenes is not None):
        raise InvalidRange("update: golden results hold every case; leave out --cases and --scene")
    return Selection(
        options.suite,
        int(given.real(options.seed, "seed")),
        patterns,
        None if scenes is None else tuple(str(given.path(scene, "scene")) for scene in scenes),
        None if options.rig is None else read_rig(options.rig),
    )


def _gathered(selection: Selection, progress: Stage | None) -> Gathered:
    from rigsim.sim.scenes import library
    from rigsim.study.verify.session import gather

    if progress is None:
        return gather(selection)
    n_scenes = len(library.names() if selection.scenes is None else selection.scenes)
    return gather(selection, lambda done: progress("scenes", done, n_scenes))


def _golden_folder(options: VerifyOptions, selection: Selection) -> Path | None:
    """Where golden results are; None when nobody asks. A folder that is not there is told before the work."""
    if options.golden is None:
        return GOLDEN if options.update else None
    folder = given.path(options.golden, "golden")
    if not options.update:
        from rigsim.interop.files.golden import read_golden

        read_golden(folder, ())
    return folder


def _golden(
    result: VerifyResult, selection: Selection, folder: Path | None, options: VerifyOptions
) -> GoldenReport | None:
    """Compare with golden results, or write them; None when neither is asked for."""
    if folder is None:
        return None
    from rigsim.interop.files.golden import read_golden, write_golden
    from rigsim.sim.scenes import library
    from rigsim.study.golden.compare import GoldenComparison, GoldenReport, compare
    from rigsim.study.verify.session import golden_records

    partial = bool(selection.patterns) or selection.scenes is not None
    scenes = () if selection.patterns else library.names() if selection.scenes is None else selection.scenes
    if options.progress is not None:
        options.progress("golden scenes", 0, len(scenes))
    records = golden_records(result, scenes)
    comparison = GoldenComparison(())
    troubles: list[str] = []
    if folder.is_dir() or not options.update:
        golden, troubles = read_golden(folder, [record.name for record in records])
        comparison = compare(
            golden, records, partial, given.real(options.golden_tolerance, "golden_tolerance")
        )
    written = write_golden(folder, records) if options.update else []
    return GoldenReport(str(folder), comparison, tuple(troubles), tuple(path.name for path in written))


def _again(options: VerifyOptions, flag: str, label: str) -> list[str]:
    """The words that run one triangulator again; none where nobody said how the cases are made."""
    if not options.again:
        return []
    patterns = ",".join(str(pattern) for pattern in given.several(options.cases))
    return [*options.again, flag, label, *(["--cases", patterns] if patterns else [])]


def _drawer(case: CaseResult) -> Callable[[], Figure]:
    from rigsim.present.verify.figures import case_figure

    return lambda: case_figure(case)
