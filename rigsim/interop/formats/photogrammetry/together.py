"""Pictures of two cameras with their poses: whether the cameras keep still against each other."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig.pose import Pose

_STILL = 0.03  # of the baseline: more than what poses from pictures are mostly off by


@dataclass(frozen=True, slots=True)
class Taken:
    """A picture of a reconstruction."""

    camera: str
    """Which camera took it."""
    name: str
    """Its name."""
    pose: Pose
    """Maps the world to the camera."""

    @property
    def frame(self) -> str:
        """What pictures that were taken together share: the number in the name, or all but the folder."""
        base = self.name.replace("\\", "/").rpartition("/")[2]
        digits = re.findall(r"\d+", base)
        return digits[-1].lstrip("0") if digits else base


def pose_together(images: Sequence[Taken], left: str, right: str, way_out: str) -> Pose:
    """Maps the left camera's frame to the right one's, as all their pictures that are called alike say.

    Raises:
        InvalidRig: none are, or the cameras move against each other; the message ends with `way_out`.
    """
    lefts, rights = ([image for image in images if image.camera == camera] for camera in (left, right))
    by_frame = {image.frame: image for image in rights}
    poses = [by_frame[one.frame].pose @ one.pose.inverse for one in lefts if one.frame in by_frame]
    if len(lefts) == len(rights) == 1:
        poses = [rights[0].pose @ lefts[0].pose.inverse]
    if not poses:
        raise InvalidRig(
            f"no image of camera {right} is called like one of camera {left}, so that none are known to be"
            f" taken together: {way_out}"
        )
    baseline = float(np.linalg.norm(poses[0].t))
    moved = max(float(np.linalg.norm(pose.t - poses[0].t)) for pose in poses)
    if not moved <= _STILL * baseline:
        raise InvalidRig(
            f"camera {right} moves against camera {left}, by {moved:.3g} of a baseline of {baseline:.3g}: no"
            f" rig; {way_out}"
        )
    return poses[0]
