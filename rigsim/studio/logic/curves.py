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


def curves_of(found: RigNumbers) -> RigCurves:
    """The curves that belong to the numbers."""
    if found.shown is None or found.distances is None:
        return RigCurves(None, None, None)
    rig, ends = found.shown.rig, (found.distances.near_m, found.distances.far_m)
    required = None if found.kept is None else (found.kept.at_mm / 1e3, found.kept.limit_mm)
    return RigCurves(depth_curve(rig, found.shown.noise, *ends), overlap_curve(rig, *ends), required)
