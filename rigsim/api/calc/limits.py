"""What a rig can see at all: depth range, overlap, blind zone, depth step."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

from rigsim.api.calc.fact import Fact
from rigsim.api.calc.rows import row_facts

if TYPE_CHECKING:
    from rigsim.rig.remark import Remark
    from rigsim.rig.stereo import StereoRig


class Search(NamedTuple):
    """Disparities that a matcher searches."""

    low_px: float
    high_px: float
    says: str
    """Who says so, for people."""


class Reached(NamedTuple):
    """A shift of the search."""

    shift_px: float
    """Shift of the search, px; NaN where none reaches what was asked for."""
    says: str
    """What it is for, for people."""
    remarks: Sequence[Remark]


def rig_facts(rig: StereoRig) -> list[Fact]:
    """What is known of the rig at any distance."""
    from rigsim.theory import limits as theory

    across, down = theory.overlap_fov_deg(rig)
    hfov_deg, _ = theory.field_of_view_deg(rig.left)
    blind_mm = theory.blind_zone_m(rig) * 1e3
    nearer = "nearer than this Z no point is seen by both"
    if not math.isfinite(blind_mm):
        nearer = "no point at any Z is seen by both"
    return [
        Fact("focal_px", "focal length", rig.left.fx, "px", "of the left camera"),
        Fact("hfov_deg", "field of view", hfov_deg, "deg", "horizontal, of the left camera"),
        Fact("overlap_fov_deg", "overlap", across, "deg", "horizontal, seen by both cameras far away"),
        Fact("overlap_vfov_deg", "overlap, vertical", down, "deg", "the same, vertical"),
        Fact("blind_zone", "blind zone", blind_mm, "mm", nearer),
    ]


def search_facts(rig: StereoRig, search: Search, reached: Reached) -> list[Fact]:
    """The depths of the disparities searched."""
    from rigsim.theory.limits import depth_range_for_disparities

    nearest = farthest = math.nan
    shift_px = reached.shift_px
    says = "" if rig.is_rectified else ": needs a rectified rig"
    if rig.is_rectified and math.isfinite(shift_px):
        nearest, farthest = depth_range_for_disparities(rig, search.high_px, search.low_px, shift_px=shift_px)
    return [
        Fact("search_min_px", "search from", search.low_px, "px", f"least disparity, {search.says}"),
        Fact("search_max_px", "search to", search.high_px, "px", f"greatest disparity, {search.says}"),
        Fact("shift_px", "shift", shift_px, "px", reached.says),
        Fact("min_depth", "min depth", nearest * 1e3, "mm", f"of the greatest disparity{says}"),
        Fact("max_depth", "max depth", farthest * 1e3, "mm", f"of the least disparity{says}"),
    ]


def facts_at(rig: StereoRig, depth_mm: float) -> list[Fact]:
    """What is known at one distance."""
    from rigsim.theory import limits as theory

    depth_m = depth_mm / 1e3
    overlap = theory.overlap_at_depth(rig, depth_m)
    dead_px, dead_rows = rig.left.width - float(overlap.columns_px), rig.left.height - float(overlap.rows_px)
    band_mm = dead_px * float(theory.world_per_pixel_m(rig, depth_m)) * 1e3
    shared = float(overlap.fraction) > 0
    step_mm = float(theory.depth_step_m(rig, depth_m)) * 1e3 if shared else math.nan
    return [
        Fact("z", "Z", depth_mm, "mm", "along the left camera's optical axis"),
        Fact("overlap_share", "overlap share", float(overlap.fraction), "", "of the left image, at this Z"),
        Fact("overlap_width", "overlap width", float(overlap.width_m) * 1e3, "mm", "seen by both at this Z"),
        Fact(
            "overlap_height", "overlap height", float(overlap.height_m) * 1e3, "mm", "seen by both at this Z"
        ),
        Fact("dead_band_px", "dead band", dead_px, "px", "left columns the right camera does not see"),
        Fact("dead_band", "dead band width", band_mm, "mm", "the same in the scene"),
        Fact("dead_rows_px", "dead rows", dead_rows, "px", "left rows the right camera does not see"),
        *row_facts(rig, depth_m, sized=True),
        Fact("depth_step", "depth step", step_mm, "mm", "of one pixel of disparity at this Z"),
    ]
