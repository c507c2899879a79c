"""What `rigsim calc ... --json` prints: flat, lengths in mm under names without a unit, as `unit` says."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal, TypeAlias

from pydantic import SkipValidation

from rigsim.interop.documents.base import Golden, Part, RemarkPart
from rigsim.interop.documents.text import clean
from rigsim.rig.motion import Motion
from rigsim.rig.remark import Remark

Values: TypeAlias = Mapping[str, Any]
"""A document's numbers by key; NaN and infinite ones become null in the text."""

SeenBy = Literal["both", "left", "right", "neither"]


class DepthRow(Part):
    """One rig at one distance."""

    rig: str
    """Its name: the preset's, or the file's as it was typed; ``rig`` where it has none."""
    z_mm: float
    """Depth, on the left camera's optical axis, mm."""
    depth_std_mm: float | None
    """Standard deviation of the depth for this noise, mm; null unless both cameras see the point."""
    depth_near_mm: float | None
    """Nearest depth when the disparity is off by its error, mm."""
    depth_far_mm: float | None
    """Farthest depth when the disparity is off by its error, mm; null as well without bound."""
    depth_bias_mm: float | None
    """Mean error of many noisy measurements, mm."""
    seen_by: SeenBy
    """Which cameras see the point."""
    baseline_mm: float
    """Distance between the cameras, mm."""
    focal_px: float
    """Focal length of the left camera, px."""
    disparity_px: float | None
    """``u_left - u_right``, px."""
    row_px: float | None
    """How far below its row in the left image the row in the right one lies, as they are seen, px: on the
    left optical axis, 0 when rectified; null unless both cameras see the point."""
    row_least_px: float | None
    """The least of it over the part of the image that both see at this depth, px; null where there is none,
    or no image size."""
    row_most_px: float | None
    """The greatest, px."""
    claimed_mm: float | None
    """The maker's claim, carried from its own distance to this one by the square of the distance, mm; null
    where none is published of a preset."""
    claimed_pct: float | None
    """The claim itself: percent of its own distance."""
    claimed_at_mm: float | None
    """Its own distance, mm."""
    claim_source: str
    """Page and address of the claim; may be empty."""


class CalcDepthDocument(Part):
    """The depth error at a distance; of several rigs or distances in `rows` alone, the rest null."""

    seen_by: SeenBy | None
    """Which cameras see the point; unless both do, no disparity and no error is told."""
    z: float | None
    """Depth, on the left camera's optical axis, mm."""
    focal_px: float | None
    """Focal length of the left camera, px."""
    disparity_px: float | None
    """``u_left - u_right``, px; null unless both cameras see the point."""
    row_px: float | None
    """How far below its row in the left image the row in the right one lies, as they are seen, px: on the
    left optical axis, 0 when rectified; null unless both cameras see the point."""
    row_least_px: float | None
    """The least of it over the part of the image that both see at this depth, px; null where there is none,
    or no image size."""
    row_most_px: float | None
    """The greatest, px."""
    world_per_pixel: float | None
    """Width of a pixel at this depth, mm."""
    depth_std: float | None
    """Standard deviation of the depth for this noise, mm; null unless both cameras see the point."""
    depth_near: float | None
    """Nearest depth when the disparity is off by its error, mm; null unless both cameras see the point."""
    depth_far: float | None
    """Farthest depth when the disparity is off by its error, mm; null as well without bound."""
    depth_bias: float | None
    """Mean error of many noisy measurements, mm; null unless both cameras see the point."""
    rows: list[DepthRow]
    """Every rig at every distance, in the order given."""
    says: str
    """Which rig is the more accurate at which distance, in a sentence; empty for one rig."""
    remarks: list[RemarkPart]
    """What is odd: who does not see the point and why, too much noise, an unlikely lens, a camera's mode."""
    golden: Golden | None
    """Null without --golden and --update."""
    unit: Literal["mm"]
    """Unit of the keys that name none."""


class CalcPointDocument(Part):
    """A point seen in both images, in the left camera's frame."""

    seen_by: SeenBy
    """Whose image holds its pixel; unless both do, no depth error is given."""
    x: float
    """Right of the left camera, mm."""
    y: float
    """Below the left camera, mm."""
    z: float
    """Depth, in front of the left camera, mm."""
    disparity_px: float
    """``u_left - u_right``, px."""
    residual_px: float
    """Reprojection error of the pixel pair, px in all: over sqrt(2) the rows'
    difference when rectified."""
    residual_sigma: float | None
    """The same over the noise of a pixel coordinate; null without noise."""
    world_per_pixel: float
    """Width of a pixel at this depth, mm."""
    depth_std: float | None
    """Standard deviation of the depth for this noise, mm; null unless both images hold their pixel."""
    depth_near: float | None
    """Nearest depth when the disparity is off by its error, mm; null unless both images hold their pixel."""
    depth_far: float | None
    """Farthest depth when the disparity is off by its error, mm; null as well without bound."""
    uv_origin: Literal["first pixel", "optical axis"]
    """Where pixels count from: the optical axis where neither image size nor principal point is known."""
    remarks: list[RemarkPart]
    """What is odd: pixels outside the image, rays that miss each other, too much noise, an unlikely lens."""
    golden: Golden | None
    """Null without --golden and --update."""
    unit: Literal["mm"]
    """Unit of the keys that name none."""


class MotionPart(Part):
    """What moves between the two pictures."""

    time_offset_ms: float
    """How much later the right picture is taken, ms."""
    speed_m_s: float
    """Speed along the baseline, from the left camera to the right one, m/s."""
    forward_speed_m_s: float
    """Speed straight ahead, m/s."""
    vertical_speed_m_s: float
    """Speed across the rows, down the pictures, m/s; negative is up."""
    turn_rate_deg_s: float
    """How fast the rig turns to the right, deg/s; negative is to the left."""
    pivot: Literal["middle of the baseline"]
    """What it turns about."""
    moving: Literal["rig", "object"]
    """What the speeds are of."""


class CalcMotionDocument(Part):
    """What a time offset between the cameras does at a distance, while something moves."""

    seen_by: SeenBy
    """Which cameras see the point on the left optical axis."""
    z: float
    """Depth of it when the left picture is taken, mm."""
    along_px: float | None
    """How far it moves along the rows of the right picture, px, positive to the right; null unless both
    cameras see it."""
    across_px: float | None
    """The same across the rows, px, positive down."""
    depth_error: float | None
    """Depth that is found, minus the true one, mm; null as well where none is found."""
    most_along_px: float | None
    """The largest shift along the rows at this depth, over the part of the image that both see, px;
    null where there is none, or no image size."""
    most_across_px: float | None
    """The same across the rows, px."""
    most_depth_error: float | None
    """The same of the depth, mm."""
    allowed_ms: float | None
    """Time offset with which the largest shift along the rows is a disparity's noise, ms; null for any."""
    allowed_rows_ms: float | None
    """Time offset with which the largest shift across the rows is half a pixel, ms; null for any."""
    depth_std: float | None
    """Standard deviation of the depth for this noise, mm, beside it."""
    says: str
    """The answer in a sentence."""
    motion: MotionPart
    remarks: list[RemarkPart]
    """What is odd: who does not see the point, rows that a matcher would miss, no depth."""
    golden: Golden | None
    """Null without --golden and --update."""
    unit: Literal["mm"]
    """Unit of the keys that name none."""


class LimitsAt(Part):
    """What both cameras see at one distance."""

    z: float
    """Z, along the left camera's optical axis, mm."""
    overlap_share: float
    """Share of the left image's pixels whose points at this Z the right camera sees too, 0 to 1."""
    overlap_width: float | None
    """Extent, along the left image's rows, of what both see at this Z, mm; 0 where that is nothing."""
    overlap_height: float | None
    """The same along its columns, mm."""
    dead_band_px: float | None
    """Left image columns in which the right camera sees nothing at this Z, px."""
    dead_band: float | None
    """Their width in the scene, mm."""
    dead_rows_px: float | None
    """Left image rows in which the right camera sees nothing at this Z, px."""
    row_px: float | None
    """How far below its row in the left image the row in the right one lies, as they are seen, px: on the
    left optical axis, 0 when rectified; null where a camera does not show it."""
    row_least_px: float | None
    """The least of it over the part of the image that both see at this depth, px; null where there is none,
    or no image size."""
    row_most_px: float | None
    """The greatest, px."""
    depth_step: float | None
    """Depth of one pixel of disparity at this Z, mm; null where nothing is shared."""
    unit: Literal["mm"]
    """Unit of the keys that name none."""


class CalcLimitsDocument(Part):
    """What a rig can see at all; every Z is along the left camera's optical axis."""

    focal_px: float
    """Focal length of the left camera, px."""
    hfov_deg: float
    """Horizontal field of view of the left camera where it is widest, distortion included, degrees."""
    overlap_fov_deg: float
    """Horizontal angle, in the left camera's frame, of what both cameras see far away, degrees."""
    overlap_vfov_deg: float
    """The same, vertical."""
    blind_zone: float | None
    """Z before which no point at all is seen by both, mm; null when they see no point in common."""
    search_min_px: float
    """Least disparity searched, px, shift left out."""
    search_max_px: SkipValidation[float]  # a published whole number stays one
    """Greatest disparity searched, px, shift left out."""
    shift_px: float | None
    """Disparity shift added to both: --shift, or the one that --reach finds; null where none will do."""
    min_depth: float | None
    """Depth of the largest disparity searched, mm; null for a rig that is not rectified, or where no shift
    will do."""
    max_depth: float | None
    """Depth of the smallest disparity searched, mm; null as well without bound."""
    z: float | None
    """The one distance --z, mm; null when several are given, as all below: see `at`."""
    overlap_share: float | None
    """As in `at`."""
    overlap_width: float | None
    """As in `at`, mm."""
    overlap_height: float | None
    """As in `at`, mm."""
    dead_band_px: float | None
    """As in `at`, px."""
    dead_band: float | None
    """As in `at`, mm."""
    dead_rows_px: float | None
    """As in `at`, px."""
    row_px: float | None
    """As in `at`, px."""
    row_least_px: float | None
    """As in `at`, px."""
    row_most_px: float | None
    """As in `at`, px."""
    depth_step: float | None
    """As in `at`, mm."""
    at: list[LimitsAt]
    """What both cameras see at each --z, in the order given."""
    remarks: list[RemarkPart]
    """What is odd: distances at which nothing is shared, no shift that reaches, an unlikely lens."""
    golden: Golden | None
    """Null without --golden and --update."""
    unit: Literal["mm"]
    """Unit of the keys that name none."""


def point_document(values: Values, uv_origin: str, remarks: Iterable[Remark]) -> dict[str, Any]:
    """What ``rigsim calc point --json`` prints.

    Args:
        values: the numbers.
        uv_origin: where pixels count from.
        remarks: what is odd.
    """
    rest: Values = {"uv_origin": uv_origin, "remarks": _told(remarks), "golden": None, "unit": "mm"}
    return CalcPointDocument(**values, **rest).model_dump()


def depth_document(
    values: Values, remarks: Iterable[Remark], rows: Sequence[Values], says: str = ""
) -> dict[str, Any]:
    """What ``rigsim calc depth --json`` prints.

    Args:
        values: the numbers of the one rig at the one distance; None each where there are several.
        remarks: what is odd.
        rows: every rig at every distance.
        says: which rig is the more accurate where.
    """
    rest: Values = {"says": says, "remarks": _told(remarks), "golden": None, "unit": "mm"}
    return CalcDepthDocument(**values, rows=[DepthRow(**row) for row in rows], **rest).model_dump()


def limits_document(values: Values, at: Sequence[Values], remarks: Iterable[Remark]) -> dict[str, Any]:
    """What ``rigsim calc limits --json`` prints.

    Args:
        values: the numbers of the rig.
        at: those of each distance; of one alone they are told beside the rig's as well, of several they would
            contradict each other there.
        remarks: what is odd.
    """
    flat = at[0] if len(at) == 1 else dict.fromkeys(at[0])
    return CalcLimitsDocument(
        **values,
        **flat,
        at=[LimitsAt(**one, unit="mm") for one in at],
        remarks=_told(remarks),
        golden=None,
        unit="mm",
    ).model_dump()


def motion_document(values: Values, motion: Motion, remarks: Iterable[Remark], says: str) -> dict[str, Any]:
    """What ``rigsim calc motion --json`` prints."""
    part: dict[str, Any] = {
        "time_offset_ms": clean(motion.time_offset_s * 1e3),
        "speed_m_s": motion.speed_m_s,
        "forward_speed_m_s": motion.forward_speed_m_s,
        "vertical_speed_m_s": motion.vertical_speed_m_s,
        "turn_rate_deg_s": clean(math.degrees(motion.turn_rate_rad_s)),
        "pivot": "middle of the baseline",
        "moving": motion.moving,
    }
    return CalcMotionDocument(
        **values, says=says, motion=MotionPart(**part), remarks=_told(remarks), golden=None, unit="mm"
    ).model_dump()


def _told(remarks: Iterable[Remark]) -> list[RemarkPart]:
    return [RemarkPart(code=remark.code, text=remark.text) for remark in remarks]
