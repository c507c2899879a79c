"""One rig that was built a little off: what it reads of points, taken for the rig that is assumed.

Exact: the built rig projects, and the assumed one triangulates. Pixel noise comes on top as `Judge` says.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from types import MappingProxyType

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array, Mask
from rigsim.rig.perturbation import NAMES, Perturbation
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance.batch import PARAMETERS, RigBatch, read_rays
from rigsim.study.tolerance.built import built_depths
from rigsim.study.tolerance.inputs import QUANTITIES, UNITS, BuildRequirement
from rigsim.study.tolerance.judge import Judge, make_judge
from rigsim.study.tolerance.rows import row_errors_px
from rigsim.study.tolerance.sensitivities import on_plane, shared_points

MAY_BE_OFF: Mapping[str, tuple[str, float]] = MappingProxyType(
    {
        "yaw_deg": ("yaw_rad", math.radians(1)),
        "pitch_deg": ("pitch_rad", math.radians(1)),
        "roll_deg": ("roll_rad", math.radians(1)),
        "baseline_mm": ("baseline_m", 1e-3),
        "right_focal_px": ("right_focal_px", 1.0),
        "right_cx_px": ("right_cx_px", 1.0),
        "right_cy_px": ("right_cy_px", 1.0),
    }
)
"""Of `QUANTITIES`, those that a single rig can be given here: a parameter, and its change per unit."""
_POINTS = 60
_COLUMNS = 32


@dataclass(frozen=True, slots=True)
class BuiltAt:
    """The built rig at one distance, over the part of the image that both cameras see."""

    depth_m: float
    """The distance, m."""
    common_mm: float
    """Depth error that the whole image shares (its mean), mm; positive reads too far."""
    rms_mm: float
    """Root mean square depth error that the build makes, mm; infinite where a point has no depth."""
    largest_mm: float
    """The largest of it, mm, with its sign; infinite where a point has no depth."""
    whole_mm: float
    """Root mean square with pixel noise, mm."""
    noise_mm: float
    """What pixel noise alone does, root mean square, mm."""
    row_px: float
    """Root mean square row misalignment, px."""
    row_largest_px: float
    """The largest of it, px, with its sign: positive where the right row is lower."""


@dataclass(frozen=True, slots=True, eq=False)
class BuiltMap:
    """Depth error over the left image at one distance."""

    depth_m: float
    """The distance, m."""
    u_px: Array
    """Columns (n,), px."""
    v_px: Array
    """Rows (m,), px."""
    error_mm: Array
    """Depth error (m, n), mm; positive reads too far; NaN where only one camera sees."""
    row_px: Array
    """Row misalignment (m, n), px; NaN likewise."""


@dataclass(frozen=True, slots=True, eq=False)
class OneBuiltRig:
    """A rig that was built off, read as the one assumed."""

    rig: StereoRig
    """The rig as it was built."""
    at: tuple[BuiltAt, ...]
    """Near to far."""
    judged: BuiltAt
    """At the requirement's distance."""
    is_good: bool
    """Whether it meets the requirement with its pixel noise."""
    alone_mm: Mapping[str, float]
    """Mean depth error there of each quantity alone, mm, by the keys of `MAY_BE_OFF`."""
    map: BuiltMap
    """At the requirement's distance."""


@dataclass(frozen=True, slots=True, eq=False)
class Bench:
    """Points before the assumed rig, at which any built one can be read: made once, and read often."""

    rig: StereoRig
    """The rig that is assumed."""
    required: BuildRequirement
    """What a built one is held to."""
    judges: tuple[Judge, ...]
    """One a distance, near to far, each with the noise of its points."""
    points: Array
    """Points (m, 3) m: distance by distance, then those of the map."""
    cuts: tuple[slice, ...]
    """Which of them are of each distance, and last those of the map."""
    u_px: Array
    """Columns of the map, px."""
    v_px: Array
    """Rows of the map, px."""
    seen: Mask
    """Which places of the map, row by row, both cameras see."""

    def read(self, off: Mapping[str, float]) -> OneBuiltRig:
        """What a rig that is off makes of the points.

        Args:
            off: what the built one is off by, signed, by the keys of `MAY_BE_OFF`.

        Raises:
            InvalidRange: an unknown quantity, or one that is not finite.
            InvalidRig: no such rig can be built.
        """
        theta = _theta(off)
        least_mm = -1e3 * self.rig.baseline_m
        if not off.get("baseline_mm", 0.0) > least_mm:
            raise InvalidRange(
                f"built rig, baseline {off['baseline_mm']:g} mm: must be > {least_mm:g} mm, which leaves none"
            )
        depth, rows = _read(self.rig, theta[None], self.points)
        place = [float(judge.z[0]) for judge in self.judges].index(self.required.depth_m)
        cut = self.cuts[place]
        alone, _ = _read(self.rig, np.stack([_theta({key: off[key]}) for key in off]), self.points[cut])
        each = 1e3 * (alone - self.required.depth_m).mean(axis=1)
        at = tuple(
            _at(judge, depth[:, cut], rows[0, cut])
            for judge, cut in zip(self.judges, self.cuts[:-1], strict=True)
        )
        good = bool(self.judges[place].is_good(depth[:, cut])[0])
        if self.required.row_px is not None:
            good = good and max(item.row_px for item in at) <= self.required.row_px
        return OneBuiltRig(
            _built(self.rig, theta),
            at,
            at[place],
            good,
            dict(zip(off, each.tolist(), strict=True)),
            self._map(depth[0, self.cuts[-1]], rows[0, self.cuts[-1]]),
        )

    def _map(self, depth: Array, rows: Array) -> BuiltMap:
        error, row = np.full(len(self.seen), np.nan), np.full(len(self.seen), np.nan)
        error[self.seen], row[self.seen] = 1e3 * (depth - self.required.depth_m), rows
        shape = len(self.v_px), len(self.u_px)
        return BuiltMap(self.required.depth_m, self.u_px, self.v_px, error.reshape(shape), row.reshape(shape))


def bench(rig: StereoRig, required: BuildRequirement, depths_m: Sequence[float], noise_px: float) -> Bench:
    """A bench for `rig`.

    Args:
        rig: the rig that is assumed.
        required: what built ones are held to.
        depths_m: distances to look at, m; the requirement's comes with them.
        noise_px: standard deviation of one pixel coordinate, px.

    Raises:
        InvalidRange: a distance that not both cameras see.
    """
    planes = [shared_points(rig, depth_m, _POINTS) for depth_m in sorted({*depths_m, required.depth_m})]
    rows = max(2, round(_COLUMNS * rig.left.height / rig.left.width))
    u = (np.arange(_COLUMNS) + 0.5) / _COLUMNS * rig.left.width - 0.5
    v = (np.arange(rows) + 0.5) / rows * rig.left.height - 0.5
    uv = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    points = on_plane(rig, uv, np.full(len(uv), required.depth_m))
    seen = np.asarray(np.isfinite(points).all(axis=1))
    seen[seen] = rig.right.contains(rig.project(points[seen])[1])
    parts = [*planes, points[seen]]
    ends = np.cumsum([0, *map(len, parts)]).tolist()
    return Bench(
        rig,
        required,
        tuple(make_judge(rig, plane, required, noise_px) for plane in planes),
        np.concatenate(parts),
        tuple(slice(start, stop) for start, stop in pairwise(ends)),
        u,
        v,
        seen,
    )


def _theta(off: Mapping[str, float]) -> Array:
    """Changes (p,) of `PARAMETERS`."""
    theta = np.zeros(len(PARAMETERS))
    for key, value in off.items():
        if key not in MAY_BE_OFF:
            raise InvalidRange(f"built rig {key!r}: choose one of {', '.join(MAY_BE_OFF)}")
        if not math.isfinite(value):
            raise InvalidRange(f"built rig, {QUANTITIES[key]} {value} {UNITS[key]}: must be a finite number")
        name, per_unit = MAY_BE_OFF[key]
        theta[PARAMETERS.index(name)] = value * per_unit
    return theta


def _built(rig: StereoRig, theta: Array) -> StereoRig:
    value = dict(zip(PARAMETERS, theta.tolist(), strict=True))
    built = Perturbation(**{name: value[name] for name in NAMES}).apply(rig)
    return replace(built, right=replace(built.right, cy=built.right.cy + value["right_cy_px"]))


def _read(rig: StereoRig, thetas: Array, points: Array) -> tuple[Array, Array]:
    """Depths (n, m) m that the assumed rig reads, and rows (n, m) px of its rectified pair."""
    depth, pixels, rays = built_depths(rig, thetas, points)
    assumed = RigBatch(rig, np.zeros((1, len(PARAMETERS))))
    return depth, row_errors_px(assumed, rays or read_rays(rig, pixels))


def _at(judge: Judge, read: Array, rows: Array) -> BuiltAt:
    """One distance, of depths (1, m) m and rows (m,) px."""
    error_mm = 1e3 * (read[0] - judge.z)
    return BuiltAt(
        float(judge.z[0]),
        float(error_mm.mean()),
        _rms(error_mm),
        _largest(error_mm),
        1e3 * float(judge.rms_m(read)[0]),
        1e3 * judge.noise_m,
        _rms(rows),
        _largest(rows),
    )


def _rms(values: Array) -> float:
    return float(np.sqrt((values**2).mean())) if np.isfinite(values).all() else math.inf


def _largest(values: Array) -> float:
    return float(values[np.abs(values).argmax()]) if np.isfinite(values).all() else math.inf
