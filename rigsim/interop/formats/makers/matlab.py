"""A calibration as MATLAB's ``stereoParameters``, saved as a struct.

``s = toStruct(stereoParams); save('rig.mat', 's')`` saves it so.

MATLAB counts pixels from 1, so that its principal point is one pixel more; ``ImageSize`` is rows, columns.
Its older matrices multiply a row from the right: ``IntrinsicMatrix`` is transposed, and ``RotationOfCamera2``
and ``TranslationOfCamera2`` say ``x2 = x1 R + t``. ``K`` and ``PoseCamera2`` (2022b on) are as everybody's.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File, Format, Found
from rigsim.interop.formats.makers.mat5 import mat5_variables
from rigsim.interop.formats.tables.terms import opencv_lens
from rigsim.interop.formats.values import (
    clipped,
    lens,
    matrix,
    member,
    number,
    numbers,
    pixels,
    rotation,
    size_or_guess,
)
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig

_MAGIC = (b"MATLAB 5.0 MAT-file", b"MATLAB 7.3 MAT-file")
_METRES = {
    **dict.fromkeys(("m", "meter", "meters", "metre", "metres"), 1.0),
    **dict.fromkeys(("cm", "centimeter", "centimeters", "centimetres"), 1e-2),
    **dict.fromkeys(("mm", "millimeter", "millimeters", "millimetres"), 1e-3),
    **dict.fromkeys(("in", "inch", "inches"), 0.0254),
}
_SAVE = "s = toStruct(stereoParams); save('rig.mat', 's')"


def _groups(files: Sequence[File]) -> list[tuple[File, ...]]:
    return [(file,) for file in files if file.content.startswith(_MAGIC)]


def _open(group: tuple[File, ...], asked: Asked) -> Found:
    table = _parameters(_variables(group[0].content))
    sides = [_table(member(table, f"CameraParameters{i}"), f"CameraParameters{i}") for i in (1, 2)]
    cores = [_core(side, f"CameraParameters{i}") for i, side in enumerate(sides, start=1)]
    remarks: tuple[Remark, ...] = ()
    told = [_size(side, f"CameraParameters{i}") for i, side in enumerate(sides, start=1)]
    sizes = [size for size in told if size is not None]
    if len(sizes) < 2:
        width, height, remark = size_or_guess(asked, [(float(K[0, 2]), float(K[1, 2])) for K in cores])
        sizes, remarks = [(width, height)] * 2, (remark,) if remark else ()
    left, right = (
        _camera(side, K, size, f"CameraParameters{i}")
        for i, (side, K, size) in enumerate(zip(sides, cores, sizes, strict=True), start=1)
    )
    pose = _pose(table)
    scale = _METRES.get(str(sides[0].get("WorldUnits", "")).lower())
    if scale is not None:
        pose = Pose(pose.R, pose.t * scale)
    return Found(StereoRig(left, right, pose), unit=None if scale is None else "m", remarks=remarks)


def _variables(content: bytes) -> Mapping[str, object]:
    """The variables of a MAT-file of version 5."""
    if content.startswith(_MAGIC[1]):
        raise InvalidRig(f"is a MAT-file of version 7.3 (HDF5), which is not read: save(..., '-v7'): {_SAVE}")
    return mat5_variables(content)


def _parameters(variables: Mapping[str, object], depth: int = 3) -> Mapping[str, object]:
    """The table that has both cameras, however deep it lies."""
    layer: list[object] = [variables]
    for _ in range(depth):
        tables = [table for table in layer if isinstance(table, Mapping)]
        for table in tables:
            if {"CameraParameters1", "CameraParameters2"} <= set(table):
                return table
        layer = [value for table in tables for value in table.values()]
    names = ", ".join(name for name in variables if name.isidentifier()) or "none"
    raise InvalidRig(
        f"has no struct with CameraParameters1 and 2 (variables {clipped(names)}); an object is not read:"
        f" {_SAVE}"
    )


def _list(value: object) -> object:
    """An array as lists, a number as a list of one; anything else as it is."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    return [value] if isinstance(value, int | float) else value


def _row(value: object, name: str, count: int | None = None) -> Array:
    flat = _list(value.ravel() if isinstance(value, np.ndarray) else value)
    return numbers(flat, name, count)


def _table(value: object, name: str) -> Mapping[str, object]:
    if not isinstance(value, Mapping):
        raise InvalidRig(f"{name}: must be a struct; an object is not read: {_SAVE}")
    return value


def _core(table: Mapping[str, object], name: str) -> Array:
    """The camera matrix (3, 3) of one camera, pixels from 0."""
    if not {"K", "IntrinsicMatrix"} & set(table) and "FocalLength" in table:
        fx, fy = _row(table["FocalLength"], f"FocalLength of {name}", 2)
        cx, cy = _row(member(table, "PrincipalPoint", name), f"PrincipalPoint of {name}", 2)
        skew = number(table.get("Skew", 0.0), f"Skew of {name}")
        K = np.array([[fx, skew, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    else:
        key = "K" if "K" in table else "IntrinsicMatrix"
        K = matrix(_list(member(table, key, name)), f"{key} of {name}", 3, 3)
        if key == "IntrinsicMatrix":
            K = K.T
    K = K.copy()
    K[:2, 2] -= 1
    return K


def _size(table: Mapping[str, object], name: str) -> tuple[int, int] | None:
    """Width and height, px; None where the calibration was made without pictures."""
    value = table.get("ImageSize")
    if value is None or np.size(np.asarray(value, dtype=object)) == 0:
        return None
    rows, columns = _row(value, f"ImageSize of {name}", 2)
    return pixels(float(columns), f"columns of {name}"), pixels(float(rows), f"rows of {name}")


def _camera(table: Mapping[str, object], K: Array, size: tuple[int, int], name: str) -> Intrinsics:
    radial = _row(table.get("RadialDistortion", []), f"RadialDistortion of {name}")
    tangential = _row(table.get("TangentialDistortion", []), f"TangentialDistortion of {name}")
    if len(radial) > 3 or len(tangential) not in (0, 2):
        raise InvalidRig(
            f"{name}: has {len(radial)} radial and {len(tangential)} tangential terms, must be 2 or 3 and 2"
        )
    k = [*radial, *[0.0] * (3 - len(radial))]
    p = tangential if len(tangential) else [0.0, 0.0]
    bare = lens(*size, K, None, f"camera matrix of {name}")
    terms = opencv_lens(np.array([k[0], k[1], p[0], p[1], k[2]]), name)
    return Intrinsics(*size, bare.fx, bare.fy, bare.cx, bare.cy, terms)


def _pose(table: Mapping[str, object]) -> Pose:
    """Maps the first camera's frame to the second one's, the file's own unit."""
    if "RotationOfCamera2" in table:
        R = matrix(_list(table["RotationOfCamera2"]), "RotationOfCamera2", 3, 3).T
        t = _row(member(table, "TranslationOfCamera2"), "TranslationOfCamera2", 3)
        return Pose(rotation(R, "RotationOfCamera2"), t)
    pose = member(table, "PoseCamera2")
    if isinstance(pose, Mapping) and "A" not in pose:
        R = matrix(_list(member(pose, "R", "PoseCamera2")), "R of PoseCamera2", 3, 3)
        return Pose(
            rotation(R, "R of PoseCamera2"),
            _row(member(pose, "Translation", "PoseCamera2"), "Translation", 3),
        )
    A = matrix(_list(pose["A"] if isinstance(pose, Mapping) else pose), "PoseCamera2", 4, 4)
    if A[3].tolist() != [0, 0, 0, 1]:
        raise InvalidRig("PoseCamera2: its last row must be 0, 0, 0, 1 (that of a rigidtform3d's A)")
    return Pose(rotation(A[:3, :3], "PoseCamera2"), A[:3, 3])


FORMAT = Format(
    "matlab",
    "MATLAB's stereoParameters, saved as a struct",
    (".mat",),
    "rig.mat",
    groups=_groups,
    open=_open,
)
