"""Data sets on disk: each frame is written as it comes, in the places where a format's readers look.

==========  =========================================================================================
middlebury  ``000000/``: im0.png, im1.png, disp0.pfm, disp1.pfm, mask0nocc.png, calib.txt, points.ply
kitti       ``training/``: image_2, image_3, disp_occ_0, disp_noc_0, calib_cam_to_cam; mask, points
opencv      stereo.yml; left, right, depth_left, depth_right, mask, points
colmap      ``sparse/0``; images/left, images/right, depth_left, depth_right, mask, points
==========  =========================================================================================

Every one has a ``manifest.json``: seed, versions, and where each frame was taken.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rigsim.errors import InvalidImage, InvalidRange, InvalidRig
from rigsim.interop.files.folder import folder_in_progress
from rigsim.interop.files.ply import ply_bytes
from rigsim.interop.files.tables import json_bytes, npy_bytes
from rigsim.interop.formats.colmap import colmap_files
from rigsim.interop.formats.kitti import calib_cam_to_cam
from rigsim.interop.formats.middlebury import LARGEST_PNG_PX, calib_text, disparity_png
from rigsim.interop.formats.opencv_yaml import FILE_NAME as OPENCV_NAME
from rigsim.interop.formats.opencv_yaml import opencv_yaml
from rigsim.pixels.dense.pfm import pfm_bytes
from rigsim.rig.arrays import AnyImage
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.study.scene.frames import DatasetFrame

CLOUD_POINTS = 100_000
"""Most points in a frame's PLY."""

SEEN_BY_BOTH, SEEN_BY_LEFT, SEEN_BY_NONE = 255, 128, 0
"""What a mask's pixels say of the left picture's: Middlebury's levels."""

_BYTES_A_PIXEL = 24  # pictures, depths and mask, generously
_BYTES_A_POINT = 15


@dataclass(frozen=True, slots=True)
class _Layout:
    """What a format writes of each frame, and of all of them."""

    frame: Callable[[DatasetFrame], Mapping[str, bytes]]
    whole: Callable[[StereoRig, list[Pose]], Mapping[str, str]]
    check: Callable[[StereoRig], object]


def write_dataset(
    path: Path,
    format: str,
    rig: StereoRig,
    frames: Iterable[DatasetFrame],
    *,
    count: int,
    manifest: Mapping[str, object],
    force: bool = False,
) -> list[str]:
    """Write `frames` into the folder `path`, which appears when the last one is done; the files' names.

    Args:
        path: the folder.
        format: one of `DATASET_FORMATS`.
        rig: the rig of all frames.
        frames: made one by one, and let go.
        count: how many there will be, for the room they need.
        manifest: what else manifest.json says: JSON values.
        force: replace files that are there.

    Raises:
        InvalidRange: there is no such format.
        InvalidRig: the format cannot hold the rig.
        InvalidImage: it cannot hold a frame's disparities.
        OutputError: the folder cannot be written; nothing is left.
    """
    check_format(format, rig)
    layout = _LAYOUTS[format]
    pixels = rig.left.width * rig.left.height + rig.right.width * rig.right.height
    needed = count * (_BYTES_A_PIXEL * pixels // 2 + _BYTES_A_POINT * CLOUD_POINTS)
    poses: list[Pose] = []
    names: list[str] = []
    with folder_in_progress(path, force, needed_bytes=needed) as folder:
        for frame in frames:
            names += _write(folder, layout.frame(frame))
            poses.append(frame.left_from_world)
        names += _write(folder, {name: text.encode() for name, text in layout.whole(rig, poses).items()})
        document = {
            "format": format,
            "frames": [
                {"frame": i, "left_from_world": {"R": pose.R.tolist(), "t_m": pose.t.tolist()}}
                for i, pose in enumerate(poses)
            ],
            **manifest,
        }
        names += _write(folder, {"manifest.json": json_bytes(document)})
    return sorted(names)


def check_format(format: str, rig: StereoRig) -> None:
    """Whether a data set's format exists and can hold `rig`.

    Raises:
        InvalidRange: there is no such format.
        InvalidRig: it cannot hold the rig; the message names those that can.
    """
    if format not in _LAYOUTS:
        raise InvalidRange(f"format {format!r}: must be one of {', '.join(DATASET_FORMATS)}")
    try:
        _LAYOUTS[format].check(rig)
    except InvalidRig as error:
        able = ", ".join(name for name in DATASET_FORMATS if _holds(name, rig))
        raise InvalidRig(f"format {format}: {error}; formats that hold this rig: {able}") from None


def nearest_m(format: str, rig: StereoRig) -> float:
    """The depth, m, of the largest disparity that a data set of `rig` can hold; 0 where there is no bound."""
    return rig.left.fx * rig.baseline_m / LARGEST_PNG_PX if format == "kitti" else 0.0


def _holds(format: str, rig: StereoRig) -> bool:
    try:
        _LAYOUTS[format].check(rig)
    except InvalidRig:
        return False
    return True


def _write(folder: Path, files: Mapping[str, bytes]) -> list[str]:
    for name, content in files.items():
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)
    return list(files)


def _png(image: AnyImage) -> bytes:
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(image).save(file, format="PNG")
    return file.getvalue()


def _mask(frame: DatasetFrame) -> bytes:
    seen = np.where(np.isfinite(frame.depth_left), SEEN_BY_LEFT, SEEN_BY_NONE)
    return _png(np.where(frame.seen_by_both, SEEN_BY_BOTH, seen).astype(np.uint8))


def _points(frame: DatasetFrame) -> bytes:
    points, colors = frame.cloud(CLOUD_POINTS)
    return ply_bytes(points, colors=colors)


def _middlebury(frame: DatasetFrame) -> dict[str, bytes]:
    place = f"{frame.index:06d}"
    disparity = frame.disparity(0)
    known = disparity[np.isfinite(disparity)]
    span = (float(known.min()), float(known.max()))
    return {
        f"{place}/calib.txt": calib_text(frame.rig, span).encode(),
        f"{place}/im0.png": _png(frame.pictures.left),
        f"{place}/im1.png": _png(frame.pictures.right),
        f"{place}/disp0.pfm": pfm_bytes(disparity),
        f"{place}/disp1.pfm": pfm_bytes(frame.disparity(1)),
        f"{place}/mask0nocc.png": _mask(frame),
        f"{place}/points.ply": _points(frame),
    }


def _kitti(frame: DatasetFrame) -> dict[str, bytes]:
    name = f"{frame.index:06d}"
    disparity = frame.disparity(0)
    try:
        every, seen = disparity_png(disparity), np.where(frame.seen_by_both, disparity, np.nan)
        both = disparity_png(seen)
    except InvalidImage as error:
        raise InvalidImage(f"frame {frame.index}: {error}: choose --format middlebury") from None
    return {
        f"training/calib_cam_to_cam/{name}.txt": calib_cam_to_cam(frame.rig).encode(),
        f"training/image_2/{name}_10.png": _png(frame.pictures.left),
        f"training/image_3/{name}_10.png": _png(frame.pictures.right),
        f"training/disp_occ_0/{name}_10.png": every,
        f"training/disp_noc_0/{name}_10.png": both,
        f"training/mask/{name}_10.png": _mask(frame),
        f"training/points/{name}_10.ply": _points(frame),
    }


def _depths(frame: DatasetFrame) -> dict[str, bytes]:
    name = f"{frame.index:06d}"
    return {
        f"depth_left/{name}.npy": npy_bytes(frame.depth_left.astype(np.float32)),
        f"depth_right/{name}.npy": npy_bytes(frame.depth_right.astype(np.float32)),
        f"mask/{name}.png": _mask(frame),
        f"points/{name}.ply": _points(frame),
    }


def _opencv(frame: DatasetFrame) -> dict[str, bytes]:
    left, right = _png(frame.pictures.left), _png(frame.pictures.right)
    return {f"left/{frame.index:06d}.png": left, f"right/{frame.index:06d}.png": right, **_depths(frame)}


def _colmap(frame: DatasetFrame) -> dict[str, bytes]:
    left, right = (f"images/{name}" for name in _names(frame.index))
    return {left: _png(frame.pictures.left), right: _png(frame.pictures.right), **_depths(frame)}


def _names(index: int) -> tuple[str, str]:
    return f"left/{index:06d}.png", f"right/{index:06d}.png"


def _colmap_model(rig: StereoRig, poses: list[Pose]) -> dict[str, str]:
    files = colmap_files(rig, poses, [_names(i) for i in range(len(poses))])
    return {f"sparse/0/{name}": text for name, text in files.items()}


_LAYOUTS = {
    "middlebury": _Layout(_middlebury, lambda rig, poses: {}, calib_text),
    "kitti": _Layout(_kitti, lambda rig, poses: {}, calib_cam_to_cam),
    "opencv": _Layout(_opencv, lambda rig, poses: {OPENCV_NAME: opencv_yaml(rig)}, opencv_yaml),
    "colmap": _Layout(_colmap, _colmap_model, colmap_files),
}

DATASET_FORMATS = tuple(_LAYOUTS)
"""The formats of data sets."""
