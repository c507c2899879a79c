"""How far a built rig may be off: tolerances, and what each does to the depth, to first order."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance.batch import PARAMETERS
from rigsim.study.tolerance.classes import CLASSES, ToleranceClass
from rigsim.study.tolerance.first_order.needed import (
    HeldTo,
    needed_alone,
    needed_at_equal_shares,
    needed_for_rows,
)
from rigsim.study.tolerance.inputs import (
    DISTRIBUTIONS,
    QUANTITIES,
    UNITS,
    BuildRequirement,
    Causes,
    Tolerances,
    causes,
    with_values,
)
from rigsim.study.tolerance.judge import make_judge
from rigsim.study.tolerance.rows import first_order_rows, rms_px
from rigsim.theory.sensitivity import pixel_moves
from rigsim.theory.uncertainty import pixel_gain

__all__ = [
    "CLASSES",
    "DISTRIBUTIONS",
    "QUANTITIES",
    "UNITS",
    "BuildRequirement",
    "Causes",
    "Sensitivity",
    "ToleranceClass",
    "Tolerances",
    "causes",
    "depth_slopes",
    "first_order",
    "in_view",
    "scattered_points",
    "sensitivities",
    "shared_points",
    "with_values",
]

FLAT_DEG = 60.0
"""Off the axis of a lens that looks past 90 degrees: there a place is twice as far as its depth."""
_CANDIDATES = 64
# Roberts' R2 sequence: even cover of a square, the same for every run
_R2 = (0.7548776662466927, 0.5698402909980532)


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """One quantity alone, off by its standard deviation; first order. Depth errors in mm."""

    key: str
    """One of `QUANTITIES`."""
    tolerance: float
    """As given: standard deviation or bound, in the unit that the key ends with."""
    depth_rms_mm: tuple[float, ...]
    """Root mean square over the image at each depth."""
    common_mm: float
    """What the whole image shares at the judged depth; the sign is the depth error's when positive. Of a
    calibration, whose parameters are off together: its standard deviation."""
    differing_mm: float
    """Standard deviation over the image of the rest."""
    share: float
    """Share of the variance at the judged depth."""
    row_px: float
    """Root mean square row misalignment over the image at the judged depth, px."""
    row_largest_px: float
    """The largest of that over the depths, px."""
    needed_alone: float
    """Tolerance with which 95 of 100 rigs are good, noise included, when nothing else is off; infinite
    without effect, 0 where noise alone is too much."""
    needed_equal_share: float
    """The same when every quantity that matters takes an equal share of the variance, all of them at once."""
    needed_for_rows: float = math.inf
    """What the bound on rows alone would ask for; infinite without one or without effect."""

    @property
    def is_held_by_rows(self) -> bool:
        """Whether the bound on rows is what `needed_alone` keeps, and not the depth error."""
        return 0 < self.needed_alone == self.needed_for_rows < math.inf


def sensitivities(
    rig: StereoRig,
    off: Causes,
    planes: Mapping[float, Array],
    required: BuildRequirement,
    noise_px: float = 0.0,
) -> list[Sensitivity]:
    """The effect of each quantity, the worst first.

    `planes` maps depths, m, to points (m, 3); the requirement's depth is one of them. `noise_px` on every
    pixel coordinate takes its part of what is required.
    """
    per_plane = {depth: first_order(rig, off, points) for depth, points in planes.items()}
    rms = {depth: np.sqrt(off.summed((errors**2).mean(axis=0))) for depth, errors in per_plane.items()}
    judged, judged_rms = per_plane[required.depth_m], rms[required.depth_m]
    shares = judged_rms**2 / (judged_rms**2).sum()
    rows = {depth: first_order_rows(rig, off, points) for depth, points in planes.items()}
    row_rms = {depth: np.sqrt(off.summed(rms_px(errors.T) ** 2)) for depth, errors in rows.items()}
    largest = np.max(list(row_rms.values()), axis=0)
    judge = make_judge(rig, planes[required.depth_m], required, noise_px)
    held = HeldTo(judged, off.even_numbers, judge, tuple(rows.values()), off.groups)
    alone, together, for_rows = (
        factors(held) * off.amounts for factors in (needed_alone, needed_at_equal_shares, needed_for_rows)
    )
    found = [
        Sensitivity(
            key=key,
            tolerance=float(off.amounts[i]),
            depth_rms_mm=tuple(float(values[i]) * 1e3 for values in rms.values()),
            common_mm=_common(judged[:, group]) * 1e3,
            differing_mm=math.sqrt(float(judged[:, group].var(axis=0).sum())) * 1e3,
            share=float(shares[i]),
            row_px=float(row_rms[required.depth_m][i]),
            row_largest_px=float(largest[i]),
            needed_alone=float(alone[i]),
            needed_equal_share=float(together[i]),
            needed_for_rows=float(for_rows[i]),
        )
        for i, (key, group) in enumerate(zip(off.names, off.groups, strict=True))
    ]
    return sorted(found, key=lambda item: -item.share)


def _common(errors: Array) -> float:
    """What the image shares of errors (m, r) of r independent numbers: with its sign where it is one."""
    means = errors.mean(axis=0)
    return float(means[0]) if len(means) == 1 else math.sqrt(float((means**2).sum()))


def first_order(rig: StereoRig, off: Causes, points: Array) -> Array:
    """Depth error (m, q) m of each independent number of what is off, by one standard deviation."""
    found = np.asarray(depth_slopes(rig, points, off) @ off.effect.T * off.std)
    if off.joint is None:
        return found
    gain, moves = pixel_gain(rig, points)[:, 2], off.joint.pixel_moves(rig, points)
    return np.hstack([found, np.einsum("mi,mir->mr", gain, moves)])


def depth_slopes(rig: StereoRig, points: Array, off: Causes) -> Array:
    """Depth error (m, p) m of `points` (m, 3) m per unit of each of `PARAMETERS`, of those that are off."""
    gain, moves = pixel_gain(rig, points)[:, 2], pixel_moves(rig, points)
    slopes = np.stack([np.einsum("ni,ni->n", gain, moves[name]) for name in PARAMETERS], axis=1)
    slopes[:, ~off.effect.any(axis=0)] = 0.0  # a lens without k1 has no effect of it, not even one of 0
    return slopes


def shared_points(rig: StereoRig, depth_m: float, count: int) -> Array:
    """Up to `count` points (m, 3) m at one depth, evenly over the part of the left image that both see.

    Raises:
        InvalidRange: both cameras see nothing there.
    """
    points = in_view(rig, np.full(_CANDIDATES * count, depth_m))[:count]
    if not len(points):
        raise InvalidRange(
            f"depth {depth_m * 1e3:g} mm: no point there is in both images; take a larger distance"
        )
    return points


def scattered_points(rig: StereoRig, near_m: float, far_m: float, count: int) -> Array:
    """Up to `count` points (m, 3) m that both see, evenly over image and inverse depth."""
    turn = (0.5 + np.arange(_CANDIDATES * count) * (math.sqrt(5) - 1) / 2) % 1
    return in_view(rig, 1 / (1 / far_m + turn * (1 / near_m - 1 / far_m)))[:count]


def on_plane(rig: StereoRig, uv: Array, z: Array) -> Array:
    """Points (m, 3) m at depths `z` (m,) of left pixels (m, 2); NaN where the lens shows none.

    Of a lens that looks past 90 degrees, those up to `FLAT_DEG` off the axis: beside the camera a depth says
    little of a point, and a plane at it is far away.
    """
    xy = rig.left.normalize(uv)
    if rig.left.is_wide:
        xy = np.where((np.hypot(*xy.T) <= math.tan(math.radians(FLAT_DEG)))[:, None], xy, np.nan)
    return np.column_stack([xy * z[:, None], z])


def in_view(rig: StereoRig, z: Array) -> Array:
    """Those of points (m, 3) m at depths `z`, even over the left image, that the right camera sees too."""
    turn = (0.5 + np.arange(1, len(z) + 1)[:, None] * _R2) % 1
    uv = turn * (rig.left.width, rig.left.height) - 0.5
    points = on_plane(rig, np.asarray(uv), z)
    points = points[np.isfinite(points).all(axis=1)]
    return np.asarray(points[rig.right.contains(rig.project(points)[1])])
