"""How much one run may be asked for: all bounds on counts, so that memory and time are known beforehand."""

from __future__ import annotations

from dataclasses import dataclass

from rigsim.errors import InvalidRange


@dataclass(frozen=True, slots=True)
class Extent:
    """A count, and how much of it is meant."""

    name: str
    """Name in messages."""
    most: int
    """More is a slip of the pen."""
    least: int = 1
    """Fewer cannot be."""
    bytes_each: int = 0
    """Memory that one of them takes; 0 where they take time alone."""
    way_out: str = ""
    """What to do instead."""

    def check(self, count: int) -> None:
        """Refuse a count beyond the bounds, with the memory that it would take.

        Raises:
            InvalidRange: it is.
        """
        if count < self.least:
            raise InvalidRange(f"{self.name} {_written(count)}: must be >= {self.least:,}")
        if count > self.most:
            # as whole numbers: a float overflows where a count has 400 digits
            size = f", about {_written(count * self.bytes_each // 10**9)} GB" if self.bytes_each else ""
            way_out = f"; {self.way_out}" if self.way_out else ""
            raise InvalidRange(f"{self.name} {_written(count)}{size}: must be <= {self.most:,}{way_out}")


SWEEP_POINTS = Extent("points", 1_000_000, bytes_each=2000)
TRIALS = Extent("trials", 1_000_000)
TRIANGULATIONS = Extent(
    "points times trials", 10_000_000_000, way_out="each is triangulated: take fewer of either"
)
NOISES = Extent("number of noise levels", 1000, way_out="take fewer values of --noise")
JOBS = Extent(
    "jobs", 256, bytes_each=450_000_000, way_out="more processes than processors make nothing faster"
)
FRAMES = Extent("frames", 100_000, way_out="export several datasets, each with a --seed of its own")
BUILT_RIGS = Extent(
    "rigs", 1_000_000, least=2, bytes_each=400, way_out="a million give a yield to a tenth of a percent"
)
JUDGED_POINTS = Extent("points", 100_000, bytes_each=2000)
DISTANCES = Extent("number of rows", 10_000, way_out="give one row a distance, with its n")
PAIRS = Extent("number of pairs", 1_000_000, bytes_each=2000, way_out="split the table")
CAMERAS = Extent("number of cameras", 10_000, way_out="take fewer values of --lens or --resolution")


def _written(count: int) -> str:
    return str(count) if abs(count) < 10**15 else f"{float(max(min(count, 10**300), -(10**300))):.3g}"
