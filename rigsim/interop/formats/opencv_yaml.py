"""A calibration as OpenCV's FileStorage reads it: ``stereo.yml``.

``K1, D1, K2, D2`` (left, right), ``R`` and ``T`` as `cv2.stereoCalibrate` returns them, mapping the left
camera's frame to the right one's, ``x_right = R x_left + T``; ``T`` in metres. A rectified rig also has
``R1, R2, P1, P2, Q`` as `cv2.stereoRectify` returns them. ``D`` has 5, 8, 12 or 14 terms; two fisheyes have
the four of `cv2.fisheye` and say so, two omnidirectional cameras those of `cv2.omnidir`, and ``xi1, xi2``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.interop.files.folder import write_file
from rigsim.interop.formats.tables.terms import opencv_terms
from rigsim.interop.formats.values import real, reals
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import brown_of
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.mei import Mei
from rigsim.rig.stereo import StereoRig

FILE_NAME = "stereo.yml"

_FISHEYE = "fisheye"

IN_METRES = "# rigsim stereo rig. T and the baseline in metres;"
"""How rigsim's own file says its unit."""

_HEAD = f"%YAML:1.0\n---\n{IN_METRES} x_right = R x_left + T; integer pixel = pixel centre.\n"


def opencv_yaml(rig: StereoRig) -> str:
    """The text of a stereo.yml of `rig`, every digit kept.

    Raises:
        InvalidRig: OpenCV has no such lens, or no function that takes the two together.
    """
    left, right = rig.left, rig.right
    kinds = [_kind(camera) for camera in (left, right)]
    if kinds[0] != kinds[1]:
        raise InvalidRig(f"left lens is {kinds[0]}, right one {kinds[1]}: OpenCV takes two of one kind")
    lines = [f"image_width: {left.width}", f"image_height: {left.height}"]
    if (right.width, right.height) != (left.width, left.height):
        lines += [f"image_width_right: {right.width}", f"image_height_right: {right.height}"]
    if kinds[0] == _FISHEYE:
        lines += [f"distortion_model: {_FISHEYE}"]
    lines += [
        f"xi{i}: {real(camera.lens.xi)}" for i, camera in _numbered(rig) if isinstance(camera.lens, Mei)
    ]
    matrices: dict[str, Array] = {
        "K1": left.K,
        "D1": np.array([_terms(left)]),
        "K2": right.K,
        "D2": np.array([_terms(right)]),
        "R": rig.right_from_left.R,
        "T": rig.right_from_left.t[:, None],
    }
    if rig.is_rectified:
        matrices |= rectified_matrices(rig)
    return _HEAD + "\n".join([*lines, *(_matrix_text(name, M) for name, M in matrices.items())]) + "\n"


def _kind(camera: Intrinsics) -> str:
    """What of OpenCV's modules the lens is of."""
    if isinstance(camera.lens, KannalaBrandt):
        return _FISHEYE
    return "omnidir" if isinstance(camera.lens, Mei) else "calib3d"


def _numbered(rig: StereoRig) -> tuple[tuple[int, Intrinsics], tuple[int, Intrinsics]]:
    return (1, rig.left), (2, rig.right)


def _terms(camera: Intrinsics) -> tuple[float, ...]:
    """``D`` of a camera, as short as OpenCV takes it."""
    lens = camera.lens
    if isinstance(lens, KannalaBrandt):
        return lens.k1, lens.k2, lens.k3, lens.k4
    if isinstance(lens, Mei):
        return lens.k1, lens.k2, lens.p1, lens.p2
    terms = opencv_terms(lens, "OpenCV, beside fisheyes and omnidirectional ones,")
    return terms[: next(count for count in (5, 8, 12, 14) if not any(terms[count:]))]


def write_opencv_yaml(path: Path, rig: StereoRig) -> None:
    """Write `rig` to the file `path`, whole or not at all.

    Raises:
        OutputError: it cannot be written.
        InvalidRig: as `opencv_yaml`.
    """
    write_file(path, opencv_yaml(rig).encode())


def coefficients(camera: Intrinsics) -> Array:
    """A camera's distortion in OpenCV's order, (5,): k1, k2, p1, p2, k3.

    Raises:
        InvalidRig: its lens is another model.
    """
    return np.array(brown_of(camera.lens, "the file").coefficients)


def rectified_matrices(rig: StereoRig) -> dict[str, Array]:
    """``R1, R2, P1, P2, Q`` of a rectified rig; ``Q`` maps (u, v, disparity, 1) to the left frame."""
    left, right, b = rig.left, rig.right, rig.baseline_m
    zero = np.zeros((3, 1))
    P1, P2 = np.hstack([left.K, zero]), np.hstack([right.K, zero])
    P2[0, 3] = -right.fx * b
    aspect = left.fx / left.fy  # 1 in cv2's own, whose pixels are square once rectified
    Q = np.array(
        [
            [1.0, 0.0, 0.0, -left.cx],
            [0.0, aspect, 0.0, -left.cy * aspect],
            [0.0, 0.0, 0.0, left.fx],
            [0.0, 0.0, 1 / b, rig.doffs_px / b],
        ]
    )
    return {"R1": np.eye(3), "R2": np.eye(3), "P1": P1, "P2": P2, "Q": Q}


def _matrix_text(name: str, M: Array) -> str:
    rows = ",\n      ".join(reals(row) for row in M)
    return (
        f"{name}: !!opencv-matrix\n   rows: {M.shape[0]}\n   cols: {M.shape[1]}\n   dt: d\n"
        f"   data: [ {rows} ]"
    )
