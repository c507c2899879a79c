"""Data sets on disk: each frame is written as it comes, in the places where a format's readers look.

The places are a layout's of `rigsim.interop.layouts`. Every data set has a ``manifest.json``: seed, versions,
and where each frame was taken.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from rigsim.errors import InvalidRange, InvalidRig
from rigsim.interop.files.folder import folder_in_progress
from rigsim.interop.files.tables import json_bytes
from rigsim.interop.formats.registry import OURS_ALONE
from rigsim.interop.layouts.layout import CLOUD_POINTS
from rigsim.interop.layouts.registry import BY_NAME
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.study.scene.frames import DatasetFrame

DATASET_FORMATS = tuple(BY_NAME)
"""The formats of data sets."""

_BYTES_A_PIXEL = 24  # pictures, depths and mask, generously
_BYTES_A_POINT = 15


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
    layout = BY_NAME[format]
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
    if format not in BY_NAME:
        raise InvalidRange(f"format {format!r}: must be one of {', '.join(DATASET_FORMATS)}")
    try:
        BY_NAME[format].check(rig)
    except InvalidRig as error:
        able = ", ".join(name for name in DATASET_FORMATS if _holds(name, rig)) or OURS_ALONE
        raise InvalidRig(f"format {format}: {error}; formats that hold this rig: {able}") from None


def nearest_m(format: str, rig: StereoRig) -> float:
    """The depth, m, of the largest disparity that a data set of `rig` can hold; 0 where there is no bound."""
    return BY_NAME[format].nearest_m(rig)


def _holds(format: str, rig: StereoRig) -> bool:
    try:
        BY_NAME[format].check(rig)
    except InvalidRig:
        return False
    return True


def _write(folder: Path, files: Mapping[str, bytes]) -> list[str]:
    for name, content in files.items():
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)
    return list(files)
