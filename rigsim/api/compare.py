"""`rigsim.compare`: triangulators side by side."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rigsim.api.kit.plain import takes
from rigsim.api.kit.triangulators import TIMEOUT_S, Method, named, opened
from rigsim.api.result import Result
from rigsim.api.rigs import RigLike, Several, read_rig
from rigsim.errors import InvalidRange, MeasurementFailed
from rigsim.rig import given
from rigsim.rig.noise import coordinate_noises_px
from rigsim.rig.remark import Remark

if TYPE_CHECKING:
    from rigsim.interop.documents.base import Written
    from rigsim.present.kit.types import Figure, Table
    from rigsim.study.compare.run import ComparisonResult


@dataclass(frozen=True, slots=True)
class CompareOptions:
    """The arguments of `compare`, which says what they mean."""

    methods: Method | Sequence[Method] = ()
    _: KW_ONLY
    programs: str | Sequence[str] = ()
    rig: RigLike | None = None
    geometries: str | Sequence[str] | None = None
    noises_px: Several | None = None
    disparity_noises_px: Several | None = None
    points: int = 20_000
    seed: int = 0
    timeout_s: float = TIMEOUT_S
    in_process: bool = False
    progress: Callable[[int, int], None] | None = None
    command: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Compared(Result):
    """Triangulators side by side."""

    result: ComparisonResult
    """The comparison."""
    remarks: tuple[Remark, ...] = ()
    """Nothing is odd about a comparison so far; what was left out is in `result`."""

    @property
    def table(self) -> Table:
        """One row a triangulator, geometry and noise level; the columns of compare.csv."""
        return self.result.rows

    @property
    def verdict(self) -> Mapping[str, bool]:
        """Whether each triangulator stays within noise of the bound wherever it ran."""
        rows: Any = self.document()["rows"]
        return {
            label: all(row["within_noise_of_bound"] for row in rows if row["triangulator"] == label)
            for label in dict.fromkeys(row["triangulator"] for row in rows)
        }

    @property
    def headline(self) -> str:
        """The answer in one sentence."""
        return str(self.document()["headline"])

    @property
    def figures(self) -> Mapping[str, Callable[[], Figure]]:
        """``compare``: distance to the bound against noise, for each geometry."""
        from rigsim.present.compare.figure import comparison_figure

        return {"compare": lambda: comparison_figure(self.result)}

    def files(self) -> dict[str, bytes]:
        """compare.html, compare.csv, compare.json, figure.png and figure.pdf."""
        from rigsim.interop.files.tables import csv_bytes, json_bytes
        from rigsim.present.compare.page import comparison_files

        return {
            **comparison_files(self.result),
            "compare.csv": csv_bytes(self.result.rows),
            "compare.json": json_bytes(self.document()),
        }

    def document(self, written: Written | None = None) -> Mapping[str, Any]:
        """The comparison; docs/reference/compare.md says what the keys mean."""
        from rigsim.interop.documents.compare import compare_document
        from rigsim.present.compare import words

        said = words.headline(self.result), words.sentences(self.result)
        return compare_document(self.result, *said).model_dump()

    def print(self, folder: Path | None = None) -> None:
        """Print the comparison at one noise level, and what it says."""
        from rigsim.present.compare.console import print_comparison

        print_comparison(self.result, folder)


@takes(CompareOptions)
def compare(options: CompareOptions) -> Compared:
    """Compare triangulators: distance to the bound, bias, lost points and speed, over geometry and noise.

    Every method gets the same noisy pixels; ratios are to the first.

    Args:
        methods: optimal, dlt, midpoint, cv2 (these unless said), rectified, ``package.module:function``,
            which runs in a process of its own, or functions, which run in this one.
        programs: Programs in any language, after the methods; see docs/reference/exec.md.
        rig: A rig beside the geometries: a preset's name, a calibration's path or text, or a rig.
        geometries: Their names; six of them unless said, and none for an empty list.
        noises_px: Standard deviations of the noise of one pixel coordinate, px; 0.1, 0.25, 0.5, 1 and 2
            unless said.
        disparity_noises_px: Standard deviations of a disparity, px, instead: sqrt(2) times as much.
        points: Points for each geometry and noise level.
        seed: Seed of points and noise.
        timeout_s: For one call of a function or program of somebody else's, s.
        in_process: Whether a ``package.module:function`` is called in this process as well: faster, but if
            it crashes or hangs, so does this.
        progress: Is called with how many geometries and noise levels are done, and of how many.
        command: What the files and the document name as the command that made them.

    Raises:
        InvalidRange: A value is out of bounds, missing or given twice.
        TriangulatorError: A method cannot be loaded, or none returned anything.

    Example:
        >>> import rigsim
        >>> found = rigsim.compare(["dlt", "midpoint"], geometries="rectified", noises_px=0.5, points=500)
        >>> found.table["triangulator"].tolist()
        ['dlt', 'midpoint']
        >>> round(float(found.table["pixel_error_over_first"].iloc[0]), 6)
        1.0
    """
    from rigsim.study.compare.run import (
        DEFAULT_METHODS,
        DEFAULT_NOISES_PX,
        ComparisonPlan,
        comparison_provenance,
    )
    from rigsim.study.compare.run import compare as run

    noises_px = coordinate_noises_px(options.noises_px, options.disparity_noises_px)
    plan = ComparisonPlan(
        _geometries(options.geometries),
        DEFAULT_NOISES_PX if noises_px is None else given.reals(noises_px, "noises_px"),
        int(given.real(options.points, "points")),
        int(given.real(options.seed, "seed")),
        None if options.rig is None else read_rig(options.rig),
    )
    methods, missing = _installed(named(options.methods, "method") or DEFAULT_METHODS)
    total, done = len(plan.chosen()) * len(plan.noises_px), 0

    def one_more() -> None:
        nonlocal done
        done += 1
        if options.progress is not None:
            options.progress(done, total)

    programs = tuple(str(program) for program in given.several(options.programs))
    with opened(methods, programs, options.timeout_s, options.in_process) as known:
        return Compared(run(plan, known, one_more, missing, comparison_provenance(options.command)))


def _geometries(geometries: str | Sequence[str] | None) -> tuple[str, ...]:
    from rigsim.study.compare.run import DEFAULT_GEOMETRIES

    if geometries is None:
        return DEFAULT_GEOMETRIES
    return tuple(str(name) for name in given.several(geometries))


def _installed(methods: tuple[Method, ...]) -> tuple[tuple[Method, ...], tuple[str, ...]]:
    """The methods that can be had, and a sentence on OpenCV when it is missing.

    Raises:
        InvalidRange: none is left.
    """
    if "cv2" not in methods:
        return methods, ()
    from rigsim.pixels.opencv import load_cv2

    try:
        load_cv2()
    except MeasurementFailed as error:
        rest = tuple(method for method in methods if method != "cv2")
        if not rest:
            raise InvalidRange(f"method cv2: {error}, or name another one") from None
        return rest, (f"cv2: {error}",)
    return methods, ()
