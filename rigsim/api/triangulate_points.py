"""`rigsim.triangulate_points`: a table of matched pixels to points, each with its uncertainty."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rigsim.api.kit.golden import print_comparison
from rigsim.api.result import Result
from rigsim.api.rigs import RigLike, read_rig
from rigsim.rig import given
from rigsim.rig.noise import PixelNoise, as_noise, coordinate_noise_px
from rigsim.rig.quantity import NOISE_PX
from rigsim.rig.remark import Remark

if TYPE_CHECKING:
    from rigsim.interop.documents.base import Written
    from rigsim.interop.files.pixels import PairTable
    from rigsim.present.kit.types import Figure, Table
    from rigsim.study.calc.points import PairPoints
    from rigsim.study.golden.compare import GoldenReport


@dataclass(frozen=True, slots=True, eq=False)
class TriangulatedPairs(Result):
    """Pairs of pixels, their points, and how sure they are."""

    found: PairPoints
    """Points, standard deviations and distances from the epipolar lines as arrays, in m and px."""
    pairs: PairTable
    """What was given."""
    remarks: tuple[Remark, ...] = ()
    """What is odd about the pairs."""
    uv_origin: str = "first pixel"
    """Where pixels count from."""
    golden: GoldenReport | None = None
    """What came of a comparison with golden results."""

    @property
    def table(self) -> Table:
        """One row a pair: the columns given, and x_mm, y_mm, z_mm, their std_..., off_px, consistent, why."""
        from rigsim.interop.files.pixels import points_table

        return points_table(self.pairs, self.found)

    @property
    def verdict(self) -> str:
        """``flagged``: more pairs are inconsistent than by chance; ``untold``: too few; or ``agrees``."""
        return self.found.verdict

    @property
    def headline(self) -> str:
        """The answer in two sentences."""
        from rigsim.present.kit.points import pairs_sentence

        return pairs_sentence(self.found)

    @property
    def figures(self) -> Mapping[str, Callable[[], Figure]]:
        """``points``: the rig and the points from above."""
        from rigsim.present.kit.topdown import topdown_figure

        known = self.found.points[self.found.why == ""]
        return {"points": lambda: topdown_figure(self.found.rig, known, noise=self.found.noise, rays=False)}

    @property
    def csv(self) -> str:
        """`table` as CSV, at full precision; NaN is an empty cell."""
        from rigsim.interop.files.pixels import points_csv

        return points_csv(self.pairs, self.found)

    def files(self) -> dict[str, bytes]:
        """points.csv and points.json."""
        return {"points.csv": self.csv.encode(), "points.json": f"{self.to_json()}\n".encode()}

    def document(self, written: Written | None = None) -> Mapping[str, Any]:
        """All pairs and the summary; docs/reference/calc.md says what the keys mean."""
        from rigsim.interop.documents.points import points_document

        return points_document(self.found, self.headline, self.uv_origin, self.remarks, self.golden)

    def print(self, folder: Path | None = None) -> None:
        """Print the summary and the first pairs."""
        from rigsim.present.kit.points import print_points

        print_points(self.found, file=folder)
        print_comparison(self.golden)


def triangulate_points(
    rig: RigLike,
    pairs: object,
    *,
    noise_px: float | PixelNoise | None = None,
    disparity_noise_px: float | None = None,
) -> TriangulatedPairs:
    """Triangulate a table of matched pixels, with the uncertainty of each point, and check that they match.

    A pair is consistent when it is no further from each other's epipolar lines than the noise explains: right
    pairs are called inconsistent once in 1000. Pairs that no point in front of both cameras has are NaN, with
    the reason in the column ``why``.

    Args:
        rig: The rig that saw them: a preset's name, a calibration's path or text, or a rig.
        pairs: The pixels as they were seen, lens distortion included: a CSV file's path; a table, pandas or
            columns by name, with u_left, v_left, u_right and v_right; or numbers (N, 4) in that order.
        noise_px: Standard deviation of one pixel coordinate, px; 0.25 by default.
        disparity_noise_px: Standard deviation of a disparity, px, instead: sqrt(2) times as much.

    Raises:
        InvalidRange: The pairs cannot be read: the message names line and column.
        InvalidNoise: The noise is none.
        InvalidRig, OutputError: As `read_rig`; or the CSV cannot be read.

    Example:
        >>> import rigsim
        >>> found = rigsim.triangulate_points("oak-d", [[700, 400, 650, 400], [700, 400, 650, 403]])
        >>> found.table[["z_mm", "std_z_mm", "off_px", "consistent"]].round(2).values.tolist()
        [[1323.75, 9.36, 0.0, True], [1323.75, 9.36, 2.12, False]]
    """
    from rigsim.interop.files.pixels import pairs_from, read_pairs
    from rigsim.study.calc.points import pair_points, pair_remarks

    said = coordinate_noise_px(noise_px, disparity_noise_px)
    noise, read = as_noise(NOISE_PX if said is None else said), read_rig(rig)
    is_path = isinstance(pairs, str | os.PathLike)
    table = read_pairs(given.path(pairs, "pairs")) if is_path else pairs_from(pairs)
    found = pair_points(read, table.uv, noise)
    return TriangulatedPairs(found, table, tuple(pair_remarks(found, sized=True)))
