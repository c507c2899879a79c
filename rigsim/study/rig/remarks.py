"""What is odd about a rig that came out of a file: one rule a function, each with its threshold's reason.

The thresholds are held against calibrations that people published and against every preset; a rig that is
right must pass (`tests/rig/test_rig_remarks.py`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.study.rig.shape import relative_turn_deg, sides_exchanged
from rigsim.study.rig.sight import grid, never_meet
from rigsim.theory.frusta import last_rays

SHORTEST_BASELINE_M = 1e-3
LONGEST_BASELINE_M = 5.0
"""Baselines of stereo rigs that one can carry lie between these, 18 mm to 0.6 m among those published; metres
taken for millimetres, or squares of a board, do not."""
UPSIDE_DOWN_DEG = 135.0
"""Nearer to half a turn than to a quarter, which pairs of upright pictures have."""
OFF_CENTER = 0.10
"""Of the picture's side. Lenses sit within 6.5 % of its middle in published calibrations; the middle of half
a picture is 25 % off."""
OFF_CENTER_RECTIFIED = 0.20
"""Rectifying moves the principal point as far as the cameras were turned: 13 % and more is met."""
FOCALS_APART = 0.05
"""Two lenses of one kind are within 1.6 % of each other, and pixels are square within 0.7 %, in published
calibrations."""
SAME_SIZE = 0.06
"""By which the middle of a usual picture may differ from the principal point, of its side."""
FOLD_SHARE = 1e-3
"""Of a picture's pixels that no ray reaches; fewer is a corner."""
FOLD_DEG = 80.0
"""A lens that ends beyond this is a fisheye whose circle ends in the picture: nothing folds."""

WIDEST_DEG = 170.0
"""No flat picture is so wide: focal lengths in mm are taken for px."""

_USUAL_PX = (
    *((320, 240), (424, 240), (480, 270), (512, 512), (640, 360), (640, 400), (640, 480), (672, 376)),
    *((752, 480), (800, 600), (848, 480), (960, 540), (1024, 768), (1024, 1024), (1280, 720), (1280, 800)),
    *((1280, 960), (1280, 1024), (1600, 1200), (1920, 1080), (1920, 1200), (2048, 1536), (2208, 1242)),
    *((2448, 2048), (2592, 1944), (3264, 2448), (3840, 2160), (4000, 3000), (4032, 3024), (4056, 3040)),
)
_CELLS = (48, 36)


def remarks_of_rig(rig: StereoRig, changed: StereoRig | None = None) -> tuple[Remark, ...]:
    """All that is odd about a rig, whatever file it came from; empty where nothing is.

    Args:
        rig: the rig as its file says it.
        changed: the same with its pictures cut or scaled, as is asked for: what they show is then told of it.
    """
    return (
        *_of_baseline(rig),
        *_of_sides(rig),
        *_of_principal_points(rig),
        *_of_focal_lengths(rig),
        *_of_lenses(rig),
        *_of_folds(changed or rig),
        *_of_overlap(changed or rig),
    )


def _of_baseline(rig: StereoRig) -> Iterator[Remark]:
    baseline_mm = rig.baseline_m * 1e3
    if rig.baseline_m < SHORTEST_BASELINE_M:
        yield Remark(
            "unit",
            f"baseline {baseline_mm:.4g} mm, under 1 mm: were metres, or squares of a board, taken for "
            "millimetres? Say the file's unit with --rig-unit m, or --rig-unit 25mm for squares of 25 mm",
        )
    if rig.baseline_m > LONGEST_BASELINE_M:
        yield Remark(
            "unit",
            f"baseline {baseline_mm:.6g} mm, over {LONGEST_BASELINE_M:g} m: were millimetres, or squares of "
            "a board, taken for metres? Say the file's unit with --rig-unit mm, or --rig-unit 25mm for "
            "squares of 25 mm",
        )


def _of_sides(rig: StereoRig) -> Iterator[Remark]:
    if sides_exchanged(rig):
        yield Remark(
            "swapped",
            f"the right camera lies {rig.baseline_m * 1e3:.4g} mm to the left of the left one: the "
            "cameras are exchanged, the pose between them is inverted, or both hang upside down; --rig-swap "
            "exchanges them",
        )
    _, _, roll_deg = relative_turn_deg(rig)
    if abs(roll_deg) > UPSIDE_DOWN_DEG:
        yield Remark(
            "upside_down",
            f"the right camera is rolled by {roll_deg:.4g} deg against the left one: one of the two hangs "
            "upside down; turn its pictures by 180 deg and calibrate again",
        )


def _of_principal_points(rig: StereoRig) -> Iterator[Remark]:
    allowed = OFF_CENTER_RECTIFIED if rig.is_rectified else OFF_CENTER
    sides = [_Off.of(name, camera) for name, camera in (("left", rig.left), ("right", rig.right))]
    odd = [side for side in sides if side.most > allowed]
    if len(odd) == 2 and all(side.size_px is not None for side in sides):
        (width, height), camera = sides[0].size_px or (0, 0), rig.left
        yield Remark(
            "size",
            f"the principal point {camera.cx:.5g},{camera.cy:.5g} px is the middle of a picture of about "
            f"{width}x{height} px, not of {camera.width}x{camera.height}: was the rig calibrated in "
            f"that size? Then say --rig-size {width}x{height}, and --resize {camera.width}x{camera.height} or"
            " --crop",
        )
        return
    for side in odd:
        yield Remark("principal_point", side.says)


@dataclass(frozen=True, slots=True)
class _Off:
    """Where a principal point lies, as seen from the picture's middle."""

    name: str
    camera: Intrinsics
    right: float
    """To the right, of the width."""
    down: float
    """Down, of the height."""

    @classmethod
    def of(cls, name: str, camera: Intrinsics) -> _Off:
        right = (camera.cx + 0.5) / camera.width - 0.5
        return cls(name, camera, right, (camera.cy + 0.5) / camera.height - 0.5)

    @property
    def most(self) -> float:
        return max(abs(self.right), abs(self.down))

    @property
    def size_px(self) -> tuple[int, int] | None:
        """The usual picture size, other than its own, whose middle the principal point is; None for none."""
        twice = (2 * self.camera.cx + 1, 2 * self.camera.cy + 1)
        fits = {
            size: max(abs(asked / side - 1) for asked, side in zip(twice, size, strict=True))
            for size in (*_USUAL_PX, *((2 * width, 2 * height) for width, height in _USUAL_PX))
            if size != (self.camera.width, self.camera.height)
        }
        best = min(fits, key=fits.__getitem__)
        return best if fits[best] < SAME_SIZE else None

    @property
    def says(self) -> str:
        camera = self.camera
        where = f"{100 * abs(self.right):.0f} % of the width {'right' if self.right > 0 else 'left'}"
        if abs(self.down) > abs(self.right):
            where = f"{100 * abs(self.down):.0f} % of the height {'below' if self.down > 0 else 'above'}"
        of = "" if where.endswith(("below", "above")) else " of"
        return (
            f"principal point {camera.cx:.5g},{camera.cy:.5g} px of the {self.name} camera lies {where}{of} "
            f"the middle of its {camera.width}x{camera.height} picture: a crop, or a calibration of other "
            "pictures? Name their size with --rig-size, and what was cut out with --crop"
        )


def _of_focal_lengths(rig: StereoRig) -> Iterator[Remark]:
    left, right = rig.left.axial_focal_px, rig.right.axial_focal_px
    # of the same lens behind another grid, focal length and width grow together
    over = (right[0] / rig.right.width) / (left[0] / rig.left.width) - 1
    if abs(over) > FOCALS_APART:
        yield Remark(
            "focal_lengths",
            f"focal lengths {left[0]:.5g} px left and {right[0]:.5g} px right differ by "
            f"{100 * abs(over):.3g} %, over {100 * FOCALS_APART:g} %: were the two calibrated in "
            "different sizes, or badly?",
        )
    for name, (fx, fy) in (("left", left), ("right", right)):
        if abs(fy / fx - 1) > FOCALS_APART:
            yield Remark(
                "focal_lengths",
                f"fx {fx:.5g} px and fy {fy:.5g} px of the {name} camera differ by "
                f"{100 * abs(fy / fx - 1):.3g} %: pixels are square; was the picture stretched, or the "
                "board turned too little?",
            )


def _of_lenses(rig: StereoRig) -> Iterator[Remark]:
    sides = (("left", rig.left), ("right", rig.right))
    for name, camera in sides:
        fx, _ = camera.axial_focal_px
        flat_deg = 2 * math.degrees(math.atan(camera.width / 2 / fx))
        if not camera.is_wide and flat_deg > WIDEST_DEG:
            yield Remark(
                "focal_unit",
                f"focal length {fx:.4g} px of the {name} camera makes a flat picture of {camera.width} px "
                f"{flat_deg:.4g} deg wide, over {WIDEST_DEG:g}: is it in mm? In px it is the mm over a "
                "pixel's size; or is the lens a fisheye's, of another model?",
            )
    for (name, camera), (other, its) in (sides, sides[::-1]):
        if camera.lens is None and its.lens is not None:
            yield Remark(
                "one_lens",
                f"the {name} camera has no distortion and the {other} one has: are its coefficients missing?",
            )


def _of_folds(rig: StereoRig) -> Iterator[Remark]:
    for name, camera in (("left", rig.left), ("right", rig.right)):
        if camera.lens is None:
            continue
        share, angle_deg = unseen_share(camera)
        if share > FOLD_SHARE and angle_deg < FOLD_DEG:
            yield Remark(
                "fold",
                f"the distortion of the {name} camera folds inside its picture, {angle_deg:.3g} deg off the "
                f"axis: {100 * share:.2g} % of its pixels show nothing; calibrate with points out to the "
                "corners, or with fewer coefficients, or cut the border off with --crop",
            )


def unseen_share(camera: Intrinsics) -> tuple[float, float]:
    """Share of the pixels that no ray reaches, and the angle off the axis, deg, of the outermost that one
    reaches on the ways from the principal point to those; infinite where every pixel shows something."""
    uv = grid(camera, *_CELLS)
    lost = np.isnan(camera.ray(uv)[:, 2])
    if not lost.any():
        return 0.0, math.inf
    return float(lost.mean()), float(_off_axis_deg(last_rays(camera, uv[lost])).min())


def _off_axis_deg(rays: Array) -> Array:
    return np.degrees(np.arctan2(np.hypot(rays[:, 0], rays[:, 1]), rays[:, 2]))


def _of_overlap(rig: StereoRig) -> Iterator[Remark]:
    if never_meet(rig):
        yield Remark(
            "no_overlap",
            "the fields of view of the two cameras do not meet: no point is seen by both at any distance; is "
            "the pose between them inverted, or of another pair? --rig-cameras names two others",
        )
