"""KITTI 2015: a folder a kind of file, disparities as PNG of 16 bits."""

from __future__ import annotations

import numpy as np

from rigsim.errors import InvalidImage
from rigsim.interop.formats.kitti.kitti import calib_cam_to_cam
from rigsim.interop.formats.middlebury import LARGEST_PNG_PX, disparity_png
from rigsim.interop.layouts.layout import Layout, mask, png, points
from rigsim.study.scene.frames import DatasetFrame


def _frame(frame: DatasetFrame) -> dict[str, bytes]:
    name = f"{frame.index:06d}"
    disparity = frame.disparity(0)
    try:
        every, seen = disparity_png(disparity), np.where(frame.seen_by_both, disparity, np.nan)
        both = disparity_png(seen)
    except InvalidImage as error:
        raise InvalidImage(f"frame {frame.index}: {error}: choose --format middlebury") from None
    return {
        f"training/calib_cam_to_cam/{name}.txt": calib_cam_to_cam(frame.rig).encode(),
        f"training/image_2/{name}_10.png": png(frame.pictures.left),
        f"training/image_3/{name}_10.png": png(frame.pictures.right),
        f"training/disp_occ_0/{name}_10.png": every,
        f"training/disp_noc_0/{name}_10.png": both,
        f"training/mask/{name}_10.png": mask(frame),
        f"training/points/{name}_10.ply": points(frame),
    }


LAYOUT = Layout(
    "kitti",
    "``training/``: image_2, image_3, disp_occ_0, disp_noc_0, calib_cam_to_cam; mask, points",
    _frame,
    calib_cam_to_cam,
    nearest_m=lambda rig: rig.left.fx * rig.baseline_m / LARGEST_PNG_PX,
)
