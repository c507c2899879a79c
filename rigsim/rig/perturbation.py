"""How the rig that was built differs from the one that is assumed."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

from rigsim.errors import InvalidRig
from rigsim.rig import given
from rigsim.rig.lens.distortion import brown_of
from rigsim.rig.lens.lens import Lens
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig


@dataclass(frozen=True, slots=True)
class Perturbation:
    """True rig minus assumed rig; `apply` turns the assumed rig into the true one.

    The rotations turn the right camera's body about its own axes (x right, y down, z forward), by the
    right-hand rule: positive yaw looks further right, positive pitch looks further up, positive
    roll turns the camera clockwise as it looks.

    Example:
        >>> import math, rigsim
        >>> rig = rigsim.preset("bin").rig
        >>> built = rigsim.Perturbation(yaw_rad=math.radians(1.0)).apply(rig)
        >>> round(built.vergence_deg, 6)  # the right camera looks further right: apart
        -1.0
    """

    yaw_rad: float = 0.0
    """Right camera about its y axis (down), rad."""
    pitch_rad: float = 0.0
    """Right camera about its x axis (right), rad."""
    roll_rad: float = 0.0
    """Right camera about its z axis (forward), rad."""
    baseline_m: float = 0.0
    """Right camera further away along the baseline, m."""
    axial_m: float = 0.0
    """Right camera forward along the left camera's z axis, m."""
    vertical_m: float = 0.0
    """Right camera down along the left camera's y axis, m."""
    right_focal_px: float = 0.0
    """Right fx and fy longer by this, px."""
    right_cx_px: float = 0.0
    """Right principal point u greater by this, px."""
    right_k1: float = 0.0
    """Right radial distortion k1 greater by this."""
    both_k1: float = 0.0
    """Both cameras' k1 greater by this."""

    def __post_init__(self) -> None:
        for item in fields(self):
            value = given.real(getattr(self, item.name), f"perturbation {item.name}", InvalidRig)
            if not math.isfinite(value):
                raise InvalidRig(f"perturbation {item.name} {value}: must be a finite number")

    def pose(self, rig: StereoRig) -> Pose:
        """`right_from_left` of the true rig, when `rig` is the assumed one."""
        left_from_right = rig.right_from_left.inverse
        along = left_from_right.t / rig.baseline_m
        center_left = left_from_right.t + along * self.baseline_m + (0.0, self.vertical_m, self.axial_m)
        turn = Pose.from_rotvec((self.pitch_rad, self.yaw_rad, self.roll_rad)).R
        return Pose(left_from_right.R @ turn, center_left).inverse

    def apply(self, rig: StereoRig) -> StereoRig:
        """The true rig, when `rig` is the assumed one."""
        return StereoRig(
            replace(rig.left, lens=with_k1(rig.left.lens, self.both_k1)),
            replace(
                rig.right,
                fx=rig.right.fx + self.right_focal_px,
                fy=rig.right.fy + self.right_focal_px,
                cx=rig.right.cx + self.right_cx_px,
                lens=with_k1(rig.right.lens, self.both_k1, self.right_k1),
            ),
            self.pose(rig),
        )


def with_k1(lens: Lens | None, *more: float) -> Lens | None:
    """`lens` with a k1 that is greater by `more`.

    Raises:
        InvalidRig: there is more, and the model has no k1.
    """
    if not any(more):
        return lens
    brown = brown_of(lens, "a change of k1")
    return replace(brown, k1=sum(more, brown.k1))


NAMES: tuple[str, ...] = tuple(item.name for item in fields(Perturbation))
"""The ten quantities, in the order of the fields."""
