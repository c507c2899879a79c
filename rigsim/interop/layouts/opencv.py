"""OpenCV's stereo.yml for all frames, and a folder a kind of file."""

from __future__ import annotations

from rigsim.interop.formats.opencv_yaml import FILE_NAME, opencv_yaml
from rigsim.interop.layouts.layout import Layout, depths, png
from rigsim.study.scene.frames import DatasetFrame


def _frame(frame: DatasetFrame) -> dict[str, bytes]:
    left, right = png(frame.pictures.left), png(frame.pictures.right)
    return {f"left/{frame.index:06d}.png": left, f"right/{frame.index:06d}.png": right, **depths(frame)}


LAYOUT = Layout(
    "opencv",
    "stereo.yml; left, right, depth_left, depth_right, mask, points",
    _frame,
    opencv_yaml,
    lambda rig, poses: {FILE_NAME: opencv_yaml(rig)},
)
