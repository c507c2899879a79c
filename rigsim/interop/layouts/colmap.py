"""A COLMAP model of all frames, and a folder a kind of file."""

from __future__ import annotations

from rigsim.interop.formats.colmap import colmap_files
from rigsim.interop.layouts.layout import Layout, depths, png
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.study.scene.frames import DatasetFrame


def _frame(frame: DatasetFrame) -> dict[str, bytes]:
    left, right = (f"images/{name}" for name in _names(frame.index))
    return {left: png(frame.pictures.left), right: png(frame.pictures.right), **depths(frame)}


def _names(index: int) -> tuple[str, str]:
    return f"left/{index:06d}.png", f"right/{index:06d}.png"


def _model(rig: StereoRig, poses: list[Pose]) -> dict[str, str]:
    files = colmap_files(rig, poses, [_names(i) for i in range(len(poses))])
    return {f"sparse/0/{name}": text for name, text in files.items()}


LAYOUT = Layout(
    "colmap",
    "``sparse/0``; images/left, images/right, depth_left, depth_right, mask, points",
    _frame,
    colmap_files,
    _model,
)
