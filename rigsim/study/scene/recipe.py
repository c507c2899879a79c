"""A rig that is being varied: what was asked for, before it is one."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.perturbation import Perturbation
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig


@dataclass(frozen=True, slots=True)
class Recipe:
    """The lenses of the base rig, changed, and where the cameras shall stand; axes change it."""

    base: StereoRig
    """The rig that is varied."""
    left: Intrinsics
    """Left lens."""
    right: Intrinsics
    """Right lens."""
    baseline_m: float | None = None
    """Distance between the cameras, m; None for the base's."""
    vergence_deg: float | None = None
    """Toe-in angle, deg; None for the base's pose."""
    right_moved: Perturbation | None = None
    """Turns and shifts of the right camera on top of all that; None for none."""

    def lenses(self, change: Callable[[Intrinsics], Intrinsics]) -> Recipe:
        """The same with both lenses changed."""
        return replace(self, left=change(self.left), right=change(self.right))

    def moved(self, **turns_and_shifts: float) -> Recipe:
        """The same with the right camera turned or shifted; the names are `Perturbation`'s fields."""
        return replace(self, right_moved=replace(self.right_moved or Perturbation(), **turns_and_shifts))

    def rig(self) -> StereoRig:
        """The rig.

        Raises:
            InvalidRig: there is no such rig.
        """
        rig = self._before_moving()
        if self.right_moved is None or self.right_moved == Perturbation():
            return rig  # bit for bit
        return StereoRig(rig.left, rig.right, self.right_moved.pose(rig))

    def _before_moving(self) -> StereoRig:
        length = self.base.baseline_m if self.baseline_m is None else self.baseline_m
        if self.vergence_deg is not None:
            return StereoRig.verged(self.left, length, self.vergence_deg, right=self.right)
        if self.baseline_m is None:
            return StereoRig(self.left, self.right, self.base.right_from_left)
        if self.base.is_rectified:
            return StereoRig.rectified(self.left, length, right=self.right)
        if not (math.isfinite(length) and length > 0):
            StereoRig.rectified(self.left, length)  # raises with the usual words
        pose = self.base.right_from_left
        return StereoRig(self.left, self.right, Pose(pose.R, pose.t * (length / self.base.baseline_m)))


def with_focal(lens: Intrinsics, focal_px: float) -> Intrinsics:
    """The lens at another focal length; pixels keep their shape, the principal point its place."""
    return replace(lens, fx=focal_px, fy=focal_px * lens.fy / lens.fx)
