"""What a layout of data sets is, one file of this room and a line of the registry; and what layouts share."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from rigsim.interop.files.ply import ply_bytes
from rigsim.interop.files.tables import npy_bytes
from rigsim.rig.arrays import AnyImage
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.study.scene.frames import DatasetFrame

CLOUD_POINTS = 100_000
"""Most points in a frame's PLY."""

SEEN_BY_BOTH, SEEN_BY_LEFT, SEEN_BY_NONE = 255, 128, 0
"""What a mask's pixels say of the left picture's: Middlebury's levels."""


def _nothing(rig: StereoRig, poses: list[Pose]) -> Mapping[str, str]:
    return {}


def _no_bound(rig: StereoRig) -> float:
    return 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Layout:
    """What is written of each frame, and of all of them, in the places where a format's readers look.

    The calibration lies where a `rigsim.interop.formats.format.Format` says: `in_folder` or `in_dataset`.
    """

    name: str
    """As ``rigsim export dataset --format`` takes it."""
    says: str
    """Its folders and files, a phrase for lists."""
    frame: Callable[[DatasetFrame], Mapping[str, bytes]]
    """The files of a frame, by path."""
    check: Callable[[StereoRig], object]
    """Raises `InvalidRig` where it cannot hold the rig."""
    whole: Callable[[StereoRig, list[Pose]], Mapping[str, str]] = _nothing
    """Texts of all frames together, by path; of the rig and each frame's left_from_world."""
    nearest_m: Callable[[StereoRig], float] = _no_bound
    """The depth, m, of the largest disparity that it can hold; 0 where there is no bound."""


def png(image: AnyImage) -> bytes:
    """An image as PNG."""
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(image).save(file, format="PNG")
    return file.getvalue()


def mask(frame: DatasetFrame) -> bytes:
    """Which pixels of the left picture both cameras see, one, or none."""
    seen = np.where(np.isfinite(frame.depth_left), SEEN_BY_LEFT, SEEN_BY_NONE)
    return png(np.where(frame.seen_by_both, SEEN_BY_BOTH, seen).astype(np.uint8))


def points(frame: DatasetFrame) -> bytes:
    """What the left camera sees, as PLY."""
    cloud, colors = frame.cloud(CLOUD_POINTS)
    return ply_bytes(cloud, colors=colors)


def depths(frame: DatasetFrame) -> dict[str, bytes]:
    """Both depths, the mask and the points, each in a folder of its own."""
    name = f"{frame.index:06d}"
    return {
        f"depth_left/{name}.npy": npy_bytes(frame.depth_left.astype(np.float32)),
        f"depth_right/{name}.npy": npy_bytes(frame.depth_right.astype(np.float32)),
        f"mask/{name}.png": mask(frame),
        f"points/{name}.ply": points(frame),
    }
