"""One point seen in both images."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from rigsim.api.calc.about import about
from rigsim.api.calc.fact import Assumed, Fact, values, whose
from rigsim.errors import RigsimError
from rigsim.rig.arrays import Array
from rigsim.rig.noise import PixelNoise
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig


@dataclass(frozen=True, slots=True, eq=False)
class PointAnswer:
    """A point with its uncertainty, as facts."""

    facts: tuple[Fact, ...]
    """Every number."""
    remarks: tuple[Remark, ...]
    """What is odd."""
    point_left: Array
    """The point (3,), m, in the left camera's frame."""
    uv_origin: str
    """Where pixels count from: ``first pixel`` or ``optical axis``."""

    def document(self) -> dict[str, Any]:
        """What ``rigsim calc point --json`` prints."""
        from rigsim.interop.documents.calc import point_document

        return point_document(values(self.facts), self.uv_origin, self.remarks)


def calc_point(
    rig: StereoRig,
    uv_left: tuple[float, float],
    uv_right: tuple[float, float],
    assumed: Assumed,
) -> PointAnswer:
    """Triangulate one point seen in both images, with its uncertainty.

    Args:
        rig: the rig.
        uv_left: the point in the left image, px.
        uv_right: the point in the right image, px.
        assumed: noise, and what is known of the images.

    Raises:
        RigsimError: the two rays meet nowhere in front of the rig.
    """
    from rigsim.study.calc import sight
    from rigsim.theory.triangulation import triangulate

    noise, sized = assumed.noise, assumed.sized
    found = triangulate(rig, [uv_left], [uv_right])[0]
    if not found[2] > 0:
        raise RigsimError(_why_no_depth(rig, uv_left[0] - uv_right[0]))
    uv = np.array(uv_left), np.array(uv_right)
    seen = sight.sight_of_pixels(rig, *uv, sized=sized)
    residual = sight.residual_px(rig, found, *uv)
    depth = about(rig, found, noise, assumed.disparity_error_px, seen.by_both)
    remarks = (
        *assumed.odd,
        *sight.rig_remarks(rig, sized=sized),
        *seen.remarks,
        *sight.residual_remarks(rig, residual, noise, *uv),
        *depth.remarks,
    )
    frame_x, frame_y = ("'s axis, where u = 0", "'s axis, where v = 0") if assumed.from_axis else ("", "")
    x, y, z = (float(value) * 1e3 for value in found)
    error_x, error_y, error_z = depth.errors_mm
    facts = (
        Fact("seen_by", "seen by", seen.seen_by, "", whose(sized, "whose image holds its pixel")),
        Fact("x", "X", x, "mm", f"right of the left camera{frame_x}", error_x),
        Fact("y", "Y", y, "mm", f"below the left camera{frame_y}", error_y),
        Fact("z", "Z", z, "mm", "depth, in front of the left camera", error_z),
        Fact("disparity_px", "disparity", uv_left[0] - uv_right[0], "px", "u left - u right"),
        *_residual_facts(residual, noise),
        *depth.facts,
    )
    return PointAnswer(facts, remarks, found, "optical axis" if assumed.from_axis else "first pixel")


def _residual_facts(residual: float, noise: PixelNoise) -> list[Fact]:
    # under a billionth of a pixel there is nothing but rounding
    residual = residual if residual > 1e-9 else 0.0
    sigmas = residual / noise.std_px if noise.std_px else math.nan if residual else 0.0
    return [
        Fact("residual_px", "residual", residual, "px", "reprojection error of the pixel pair"),
        Fact("residual_sigma", "residual / noise", sigmas, "", "over 3 is unusual for a matching pair"),
    ]


def _why_no_depth(rig: StereoRig, disparity_px: float) -> str:
    """What to say of two pixels whose rays meet nowhere in front of the rig."""
    offset = f" (+ {rig.doffs_px:g} px doffs)" if rig.doffs_px else ""
    says = f"disparity {disparity_px:g} px{offset}: "
    if not rig.is_rectified:
        return (
            says
            + "the rays do not meet in front of both cameras; left and right swapped, or a calibration error"
        )
    if disparity_px + rig.doffs_px == 0:
        return says + "must be > 0; the point is at infinity, or a calibration error hides its parallax"
    return says + "must be > 0; left and right swapped, or a calibration error (principal points, rotation)"
