"""`rigsim calc limits`: what a rig can see at all."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from rigsim.cli.calc.rows import for_people, row_facts
from rigsim.cli.kit import quantity
from rigsim.cli.kit.answer import print_remarks
from rigsim.cli.kit.facts import Fact, Form, print_facts, values
from rigsim.cli.kit.golden import GoldenWords
from rigsim.cli.kit.options import Csv, Json, Markdown, Principal, single_rig, takes, takes_rig
from rigsim.cli.kit.rigs import RigOptions
from rigsim.errors import InvalidRange

if TYPE_CHECKING:
    from rigsim.rig.remark import Remark
    from rigsim.rig.stereo import StereoRig

_SEARCH = (1.0, 128.0)


@dataclass(frozen=True, slots=True)
class LimitsWords:
    """The options of `rigsim calc limits`, as typed."""

    z: Annotated[
        str,
        typer.Option(
            "--z",
            metavar="LENGTHS",
            help="Distances Z along the left optical axis at which overlap and depth step are given: 1,3m.",
        ),
    ] = "1m"
    disparities: Annotated[
        str | None,
        typer.Option(
            metavar="MIN:MAX",
            help="Disparities a matcher searches, px; by default what is published of the preset, or 1:128.",
        ),
    ] = None
    shift: Annotated[
        str | None, typer.Option(metavar="PX", help="Disparity shift added to the search; 0 by default.")
    ] = None
    reach: Annotated[
        str | None,
        typer.Option(
            metavar="NEAR[:FAR]",
            help="Find the disparity shift with which the search reaches this near, and as far as FAR.",
        ),
    ] = None
    principal: Principal = None
    as_json: Json = False
    as_csv: Csv = False
    as_markdown: Markdown = False


@takes_rig
@takes(LimitsWords)
@takes(GoldenWords)
def limits(options: RigOptions, words: LimitsWords, golden: GoldenWords) -> None:
    """Say what a rig can see: depth range, overlap, blind zone, depth step.

    Every Z counts along the left camera's optical axis.
    """
    form = Form(words.as_json, words.as_csv, words.as_markdown)
    golden.check("calc limits")
    rig = single_rig(options, words.principal, size_for="calc limits")
    depths_mm = quantity.distances(words.z)
    shift, reach = words.shift, words.reach
    if shift is not None and reach is not None:
        raise InvalidRange("--shift and --reach both given: --reach finds the shift, give one")
    search = _search(options, words.disparities)
    shift_px = quantity.value(shift, quantity.DISPARITY) if shift is not None else 0.0
    reached = _reach(rig, search, reach) if reach is not None else _Reached(shift_px, "added to both", ())

    _tell(rig, depths_mm, search, reached, form, golden, options.mode_remarks(rig))


def _tell(
    rig: StereoRig,
    depths_mm: Sequence[float],
    search: _Search,
    reached: _Reached,
    form: Form,
    golden: GoldenWords,
    odd: Sequence[Remark],
) -> None:
    from rigsim.study.calc.limits import limit_remarks
    from rigsim.study.calc.sight import rig_remarks

    ahead = [*_rig_facts(rig), *_search_facts(rig, search, reached)]
    at = [_facts_at(rig, depth_mm) for depth_mm in depths_mm]
    remarks = [
        *odd,
        *rig_remarks(rig, sized=True),
        *reached.remarks,
        *limit_remarks(rig, [depth_mm / 1e3 for depth_mm in depths_mm]),
    ]

    def document() -> dict[str, Any]:
        from rigsim.interop.documents.calc import limits_document

        return limits_document(values(ahead), [values(facts) for facts in at], remarks)

    print_remarks(remarks)
    print_facts(
        [*ahead, *(fact for facts in at for fact in for_people(facts, rig))],
        title="Limits",
        form=form,
        document=document,
        rows=[[*ahead, *facts] for facts in at],
        golden=golden,
    )


class _Search(NamedTuple):
    low_px: float
    high_px: float
    says: str
    """Who says so, for people."""


class _Reached(NamedTuple):
    shift_px: float
    """Shift of the search, px; NaN where none reaches what was asked for."""
    says: str
    """What it is for, for people."""
    remarks: Sequence[Remark]


def _search(options: RigOptions, disparities: str | None) -> _Search:
    if disparities is not None:
        return _Search(*quantity.span(disparities, quantity.DISPARITY), "as asked")
    published = options.published_search()
    if published is None:
        return _Search(*_SEARCH, "assumed")
    (low_px, high_px), says = published
    return _Search(low_px, high_px, says)


def _reach(rig: StereoRig, search: _Search, reach: str) -> _Reached:
    """The least shift, in whole pixels, with which the search reaches the range asked for."""
    from rigsim.study.calc.limits import shift_for

    near_mm, far_mm = quantity.distances(reach)[0], None
    if ":" in reach:
        near_mm, far_mm = quantity.span(reach, quantity.DEPTH)
    found = shift_for(
        rig, near_mm / 1e3, None if far_mm is None else far_mm / 1e3, search.high_px, search.low_px
    )
    wanted = f"{near_mm:g} mm" + (f" to {far_mm:g} mm" if far_mm else "")
    return _Reached(found.shift_px, f"added to both, to reach {wanted}", found.remarks)


def _rig_facts(rig: StereoRig) -> list[Fact]:
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


def _search_facts(rig: StereoRig, search: _Search, reached: _Reached) -> list[Fact]:
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


def _facts_at(rig: StereoRig, depth_mm: float) -> list[Fact]:
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
