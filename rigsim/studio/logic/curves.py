"""The curves of a rig over its working range."""

from __future__ import annotations

from dataclasses import dataclass

from rigsim.studio.logic.numbers import RigNumbers
from rigsim.study.calc.curve import DepthCurve, OverlapCurve, depth_curve, overlap_curve


@dataclass(frozen=True, slots=True, eq=False)
class RigCurves:
    """What the chart shows."""

    depth: DepthCurve | None
    """The depth error; None where there is no rig or no range."""
    overlap: OverlapCurve | None
    """The overlap."""
    required: tuple[float, float] | None
    """Distance, m, and the error allowed there, mm."""


def curves_of(found: RigNumbers, *, resting: bool = True) -> RigCurves:
    """The curves that belong to the numbers; what takes long is left out unless the hand is `resting`."""
    if found.shown is None or found.distances is None:
        return RigCurves(None, None, None)
    rig, ends = found.shown.rig, (found.distances.near_m, found.distances.far_m)
    required = None if found.kept is None else (found.kept.at_mm / 1e3, found.kept.limit_mm)
    exact = rig.left.lens is None and rig.right.lens is None
    depth = depth_curve(rig, found.shown.noise, *ends, bounds=resting or rig.is_rectified)
    return RigCurves(depth, overlap_curve(rig, *ends) if resting or exact else None, required)
