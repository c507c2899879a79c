"""What changes after a calibration, which its covariance knows nothing of: heat, a knock, a touched focus.

Each is one small change of a size that people meet, not a standard deviation: whoever knows theirs scales the
numbers, which are first order.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.statistics import rms
from rigsim.study.tolerance.classes import CLASSES
from rigsim.study.tolerance.sensitivities import Tolerances, shared_points
from rigsim.theory.sensitivity import pixel_moves
from rigsim.theory.uncertainty import pixel_gain

FOCAL_PER_K = 30e-6
"""By which a lens's focal length grows a kelvin, of itself; an estimate, of the size of a glass lens in a
metal barrel. Lenses of plastic change by several times as much."""
REFOCUS_SHARE = 1e-3
"""By which a focus that is touched changes the focal length, of itself; an estimate."""
CAUSES = ("bar_warmer", "lenses_warmer", "knock", "refocus")
"""The bar that holds the cameras 1 K warmer; both lenses 1 K warmer; the right camera turned; the right
lens focused anew."""
_POINTS = 240


@dataclass(frozen=True, slots=True)
class Drift:
    """One change after the calibration, and what it does to depths that are found as if it had not been."""

    cause: str
    """One of `CAUSES`."""
    amount: float
    """How large it is, in `unit`."""
    unit: str
    """``K``, ``deg``, or ``%`` of the focal length."""
    source: str
    """Where the figure comes from: ``aluminium``, ``estimate``, or a class of the tolerance study."""
    z_m: tuple[float, ...]
    """Distances, m."""
    axis_m: tuple[float, ...]
    """Depth error on the left optical axis at each, m; positive is too far."""
    image_m: tuple[float, ...]
    """Its root mean square over the part of the image that both cameras see, m; NaN where they share none."""


def drift(rig: StereoRig, at_m: Sequence[float]) -> tuple[Drift, ...]:
    """What one change of each kind does at distances, m; in the order of `CAUSES`."""
    yaw = CLASSES["calibrated"].angle_deg
    changes = (
        ("bar_warmer", 1.0, "K", "aluminium", {"baseline_m": Tolerances().expansion_per_k * rig.baseline_m}),
        ("lenses_warmer", 1.0, "K", "estimate", {"both_focal_px": FOCAL_PER_K * rig.left.fx}),
        ("knock", yaw.value, "deg", "calibrated", {"yaw_rad": math.radians(yaw.value)}),
        (
            "refocus",
            100 * REFOCUS_SHARE,
            "%",
            "estimate",
            {"right_focal_px": REFOCUS_SHARE * rig.right.fx},
        ),
    )
    on_axis = np.array([[0.0, 0.0, z_m] for z_m in at_m])
    planes = [_plane(rig, z_m) for z_m in at_m]
    return tuple(
        Drift(
            cause,
            amount,
            unit,
            source,
            tuple(at_m),
            tuple(_errors(rig, on_axis, by).tolist()),
            tuple(rms(_errors(rig, points, by)) if len(points) else math.nan for points in planes),
        )
        for cause, amount, unit, source, by in changes
    )


def _errors(rig: StereoRig, points: Array, by: dict[str, float]) -> Array:
    """Depth errors (n,) m of points (n, 3) m when the true rig is off `by` so much."""
    gain, moves = pixel_gain(rig, points)[:, 2], pixel_moves(rig, points)
    return np.asarray(sum(np.einsum("ni,ni->n", gain, moves[name]) * size for name, size in by.items()))


def _plane(rig: StereoRig, z_m: float) -> Array:
    try:
        return shared_points(rig, z_m, _POINTS)
    except InvalidRange:
        return np.empty((0, 3))
