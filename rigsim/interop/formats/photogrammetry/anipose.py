"""Cameras around a subject as anipose, Pose2Sim and FreeMoCap write them: a TOML table a camera.

``rotation`` (a rotation vector) and ``translation`` map the world to the camera, in the unit of the board or
of the scene, which no file says. ``size`` is width and height; ``distortions`` are in OpenCV's order, or k1
to k4 of the angle where ``fisheye`` is true. Other tables, as ``metadata``, are no cameras.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from rigsim.errors import InvalidRig
from rigsim.interop.formats import rig_toml
from rigsim.interop.formats.format import Asked, File, Format, Found, alone
from rigsim.interop.formats.kit.cameras import two_of
from rigsim.interop.formats.tables.terms import opencv_lens
from rigsim.interop.formats.toml_text import toml_table
from rigsim.interop.formats.values import lens, matrix, member, numbers, pixels, shown, size_or_guess
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.pose import Pose
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig

_KEYS = ("matrix", "distortions", "rotation", "translation")
_KNOWN = tuple(re.compile(rf"^[ \t]*{key}[ \t]*=[ \t]*\[", re.MULTILINE) for key in _KEYS)
_HEAD = re.compile(r"^[ \t]*\[[^\[\]\n]+\]", re.MULTILINE)
_DIGITS = re.compile(r"\d+")


def parse_anipose(text: str, asked: Asked | None = None) -> Found:
    """The rig in the text: its first two cameras, or those asked for by name, by table or by number.

    Raises:
        InvalidRig: no TOML, a camera is missing, or values cannot be.
    """
    asked = asked or Asked()
    table = toml_table(text)
    cameras = {key: own for key, own in table.items() if isinstance(own, Mapping) and "matrix" in own}
    first, second, remarks = _two(cameras, asked)
    keys = [list(cameras)[i] for i in (first, second)]
    size, more = _size([cameras[key] for key in keys], keys, asked)
    left, right = (_camera(cameras[key], key, size) for key in keys)
    poses = [_pose(cameras[key], key) for key in keys]
    return Found(StereoRig(left, right, poses[1] @ poses[0].inverse), None, (*remarks, *more))


def _two(cameras: Mapping[str, Mapping[str, object]], asked: Asked) -> tuple[int, int, tuple[Remark, ...]]:
    """The cameras' places: by what they are called, or else by their tables, or the one number in those."""
    keys = list(cameras)
    names = [str(own.get("name", key)) for key, own in cameras.items()]
    digits = [_DIGITS.findall(key) for key in keys]
    counted = [found[0] if len(found) == 1 else key for key, found in zip(keys, digits, strict=True)]
    try:
        return two_of(names if all(names) and len(set(names)) == len(names) else keys, asked)
    except InvalidRig as error:
        for others in (keys, counted):
            try:
                return two_of(others, asked)
            except InvalidRig:
                continue
        raise error from None


def _size(
    cameras: Sequence[Mapping[str, object]], keys: Sequence[str], asked: Asked
) -> tuple[tuple[int, int] | None, tuple[Remark, ...]]:
    """The size of pictures of cameras that do not say theirs; None where they do."""
    if all("size" in own for own in cameras):
        return None, ()
    ends = [_matrix(own, key) for own, key in zip(cameras, keys, strict=True)]
    width, height, remark = size_or_guess(asked, [(float(K[0, 2]), float(K[1, 2])) for K in ends])
    return (width, height), () if remark is None else (remark,)


def _matrix(table: Mapping[str, object], key: str) -> Array:
    return matrix(member(table, "matrix", key), f"matrix of {key}", 3, 3)


def _camera(table: Mapping[str, object], key: str, size: tuple[int, int] | None) -> Intrinsics:
    if "size" in table:
        width, height = (
            pixels(float(side), f"size of {key}") for side in numbers(table["size"], f"size of {key}", 2)
        )
    else:
        assert size is not None
        width, height = size
    try:
        return lens(width, height, _matrix(table, key), _lens(table, key), f"matrix of {key}")
    except InvalidRig as error:
        raise InvalidRig(str(error) if key in str(error) else f"{key}: {error}") from None


def _lens(table: Mapping[str, object], key: str) -> Lens | None:
    name = f"distortions of {key}"
    fisheye = table.get("fisheye", False)
    if not isinstance(fisheye, bool):
        raise InvalidRig(f"fisheye of {key} {shown(fisheye)}: must be true or false")
    value = member(table, "distortions", key)
    if fisheye:
        return KannalaBrandt(*(float(term) for term in numbers(value, name, 4)))
    return opencv_lens(numbers(value, name), name)


def _pose(table: Mapping[str, object], key: str) -> Pose:
    """The camera's frame from the world's."""
    turn, t = (numbers(member(table, word, key), f"{word} of {key}", 3) for word in _KEYS[2:])
    return Pose.from_rotvec(turn, t)


def knows(text: str) -> bool:
    """Whether a text has such tables of cameras, and is no rig.toml's."""
    return (
        _HEAD.search(text) is not None
        and all(pattern.search(text) is not None for pattern in _KNOWN)
        and not rig_toml.knows(text)
    )


def _open(files: tuple[File, ...], asked: Asked) -> Found:
    return parse_anipose(files[0].text, asked)


FORMAT = Format(
    "anipose",
    "the cameras of anipose, Pose2Sim and FreeMoCap",
    (".toml",),
    "calibration.toml",
    groups=alone(knows),
    open=_open,
)
