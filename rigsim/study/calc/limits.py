"""What to say beside a rig's limits: where nothing is shared, and which shift reaches a range."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.theory.limits import blind_zone_m, depth_range_for_disparities, overlap_at_depth, shifts_for_range


@dataclass(frozen=True, slots=True)
class ShiftFound:
    """A disparity shift for a range of depths."""

    shift_px: float
    """The whole number of px nearest to 0 that does; NaN where none does."""
    remarks: tuple[Remark, ...]
    """Why none does."""


def shift_for(
    rig: StereoRig, near_m: float, far_m: float | None, max_disparity_px: float, min_disparity_px: float
) -> ShiftFound:
    """The shift with which a search of these disparities reaches from `near_m` to `far_m`.

    Raises:
        InvalidRig: the rig is not rectified.
    """
    least, most = shifts_for_range(rig, near_m, far_m, max_disparity_px, min_disparity_px)
    # a whole number is met although arithmetic's last digits are not
    low, high = math.ceil(least - 1e-9), math.floor(most + 1e-9) if math.isfinite(most) else math.inf
    if low <= high:
        return ShiftFound(float(min(max(0, low), high)), ())
    wide = max_disparity_px - min_disparity_px
    nearest, farthest = depth_range_for_disparities(
        rig, max_disparity_px, min_disparity_px, shift_px=float(low)
    )
    text = (
        f"no shift reaches {near_m * 1e3:g} to {(far_m or math.inf) * 1e3:g} mm: that takes "
        f"{wide + low - high:g} px of search, there are {wide:g}; a shift of {low} px reaches "
        f"{nearest * 1e3:.4g} to {farthest * 1e3:.4g} mm"
    )
    return ShiftFound(math.nan, (Remark("no_shift", text),))


def limit_remarks(rig: StereoRig, depths_m: Sequence[float]) -> Iterator[Remark]:
    """Where the two images show nothing in common."""
    blind_m = blind_zone_m(rig)
    if math.isinf(blind_m):
        yield Remark(
            "nothing_shared",
            "the two cameras see no common point at any distance: turn them towards each other",
        )
        return
    for depth_m in depths_m:
        if not overlap_at_depth(rig, depth_m).fraction > 0:
            way = (
                f"the nearest common point lies at Z = {blind_m * 1e3:.4g} mm"
                if depth_m < blind_m
                else "their fields of view part before that; turn them towards each other"
            )
            yield Remark(
                "nothing_shared", f"at Z = {depth_m * 1e3:g} mm the cameras see nothing in common: {way}"
            )
