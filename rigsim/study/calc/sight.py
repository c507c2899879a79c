"""Which camera sees a point, why another does not, and what is odd about a rig or a pair of pixels."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.noise import PixelNoise
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.theory.frusta import crossings, outline
from rigsim.theory.uncertainty import LEAST_DEPTH_SIGMAS, depth_in_sigmas

SeenBy: TypeAlias = Literal["both", "left", "right", "neither"]

WIDEST_DEG = 170.0
"""No flat image shows more; a pinhole's that would is a slip of the pen."""
SHORTEST_FOCAL_PX = 20.0
"""Focal lengths under this are in mm, when no image size is known to hold them against."""
ODD_SIGMAS = 3.0
"""A residual is remarked on from here: by chance once in 370 right pairs."""


@dataclass(frozen=True, slots=True)
class Sight:
    """Who sees a point, and why the others do not."""

    seen_by: SeenBy
    """The cameras that see it."""
    remarks: tuple[Remark, ...]
    """One for each camera that does not."""

    @property
    def by_both(self) -> bool:
        """Whether both cameras do."""
        return self.seen_by == "both"


def sight_of_point(rig: StereoRig, point_left: Array, *, sized: bool) -> Sight:
    """Who sees a point (3,) m of the left camera's frame; images have no edge unless `sized`."""
    in_right = rig.right_from_left.apply(point_left)
    left, right = _why_not(rig.left, point_left, sized), _why_not(rig.right, in_right, sized)
    if not left and right and sized and not point_left[:2].any():
        right += _where_on_axis(rig)
    return _sight(left, right, f"the point at Z = {point_left[2] * 1e3:g} mm")


def sight_of_pixels(rig: StereoRig, uv_left: Array, uv_right: Array, *, sized: bool) -> Sight:
    """Whose image holds its pixel (2,)."""
    if not sized:
        return Sight("both", ())
    reasons = [
        "" if camera.contains(uv) else f"{_at(uv)} lies outside the {_size(camera)} image"
        for camera, uv in ((rig.left, uv_left), (rig.right, uv_right))
    ]
    return _sight(reasons[0], reasons[1], "the point")


def rig_remarks(rig: StereoRig, *, sized: bool) -> Iterator[Remark]:
    """What is odd about a rig that was typed by hand."""
    if rig.baseline_m < 1e-3:
        yield Remark(
            "unit",
            f"baseline {rig.baseline_m * 1e3:g} mm: lengths without a unit are in mm; write m if metres "
            "are meant",
        )
    cameras = [("of the left camera", rig.left), ("of the right camera", rig.right)]
    if rig.left == rig.right:
        cameras = [("of both cameras", rig.left)]
    for of, camera in cameras:
        yield from _lens_remarks(of, camera, sized)


def noise_remarks(rig: StereoRig, point_left: Array, noise: PixelNoise) -> Iterator[Remark]:
    """Whether the depth of a point (3,) m is too noisy for moments."""
    sigmas = float(depth_in_sigmas(rig, point_left[None], noise)[0])
    if not sigmas < LEAST_DEPTH_SIGMAS:
        return
    says = f"Z is {sigmas:.2g} times its standard deviation, under {LEAST_DEPTH_SIGMAS:g}"
    if rig.is_rectified:
        disparity_px = rig.left.fx * rig.baseline_m / point_left[2]
        least_px = float(f"{LEAST_DEPTH_SIGMAS * noise.disparity_std_px:.3g}")
        says = (
            f"disparity {disparity_px:.3g} px is under {least_px:g} px, "
            f"{LEAST_DEPTH_SIGMAS:g} times its noise"
        )
    yield Remark(
        "too_noisy",
        f"{says}: trust the bounds, not std and bias; a longer baseline or focal length makes them sound",
    )


def residual_px(rig: StereoRig, point_left: Array, uv_left: Array, uv_right: Array) -> float:
    """How far the four pixel coordinates are, px in all, from the images of the point (3,) m found for them.

    Over the noise of one coordinate it is the square root of a chi squared with one degree of freedom;
    ``|v_left - v_right| / sqrt(2)`` when rectified.
    """
    seen = np.hstack(rig.project(point_left[None]))[0]
    return float(np.linalg.norm(np.concatenate([uv_left, uv_right]) - seen))


def residual_remarks(
    rig: StereoRig, residual: float, noise: PixelNoise, uv_left: Array, uv_right: Array
) -> Iterator[Remark]:
    """Whether the two rays miss each other by more than the noise explains."""
    if residual <= ODD_SIGMAS * noise.std_px or residual < 1e-6:
        return
    times = f", {residual / noise.std_px:.3g} times the noise" if noise.std_px else ""
    rows = f" (the rows differ by {abs(uv_left[1] - uv_right[1]):.4g} px)" if rig.is_rectified else ""
    yield Remark(
        "residual",
        f"the pixels have a reprojection error of {residual:.4g} px{times}{rows}: a wrong match, or a "
        "calibration error; the depth may be wrong by far more than its std",
    )


def _lens_remarks(of: str, camera: Intrinsics, sized: bool) -> Iterator[Remark]:
    if not sized:
        if camera.fx < SHORTEST_FOCAL_PX:
            yield Remark(
                "focal",
                f"focal length {camera.fx:g} px: mm meant? Write --focal {camera.fx:g}mm with "
                "--pixel-pitch or --sensor-width",
            )
        return
    if camera.lens is None and camera.hfov_deg > WIDEST_DEG:
        yield Remark(
            "focal",
            f"focal length {camera.fx:g} px makes an image of {camera.width} px {camera.hfov_deg:.1f} deg "
            f"wide, over {WIDEST_DEG:g}: mm meant? Write the unit, with --pixel-pitch or --sensor-width",
        )
    if not camera.contains(np.array([camera.cx, camera.cy])):
        yield Remark(
            "principal_point",
            f"principal point {camera.cx:g},{camera.cy:g} px {of} lies outside the {_size(camera)} image: "
            "what lies straight ahead is not seen",
        )


def _sight(left: str, right: str, what: str) -> Sight:
    seen_by: SeenBy = (
        "both" if not left + right else "left" if not left else "right" if not right else "neither"
    )
    remarks = tuple(
        Remark(f"not_seen_{name}", f"the {name} camera does not see {what}: {why}; no depth error is given")
        for name, why in (("left", left), ("right", right))
        if why
    )
    return Sight(seen_by, remarks)


def _why_not(camera: Intrinsics, point: Array, sized: bool) -> str:
    """Why the camera does not see a point (3,) m of its own frame; empty when it does."""
    if not point[2] > 0:
        return "it lies behind it"
    uv = camera.project(point)
    if np.isnan(uv).any():
        return "it lies beyond what the lens shows"
    if sized:
        return "" if camera.contains(uv) else f"it would lie at {_at(uv)}, outside the {_size(camera)} image"
    off_deg = math.degrees(math.atan2(math.hypot(point[0], point[1]), point[2]))
    return "" if off_deg <= WIDEST_DEG / 2 else f"it lies {off_deg:.4g} deg off the optical axis"


def _where_on_axis(rig: StereoRig) -> str:
    """From where to where the right camera sees the left optical axis."""
    ray = rig.right_from_left.R[:, 2]
    fan = outline(rig.right)
    depths = crossings(rig.right_from_left.t, ray[None], fan).ravel()
    depths = np.unique(depths[np.isfinite(depths)])
    ends = np.concatenate([[0.0], depths, [2 * depths[-1] + 1.0 if depths.size else 1.0]])
    for near, far in itertools.pairwise(ends):
        if far > near * (1 + 1e-9) and rig.right.contains(
            rig.right.project(rig.right_from_left.t + ray * (near + far) / 2)
        ):
            to = f" to {_mm(far)}" if far in depths else " on"
            return f"; it sees the left optical axis from Z = {_mm(near)}{to}"
    return "; it sees the left optical axis nowhere"


def _mm(length_m: float) -> str:
    return f"{float(f'{length_m * 1e3:.4g}'):g} mm"


def _at(uv: Array) -> str:
    return f"{uv[0]:.5g},{uv[1]:.5g} px"


def _size(camera: Intrinsics) -> str:
    return f"{camera.width}x{camera.height}"
