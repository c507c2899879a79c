"""A calibration as OpenCV's FileStorage reads it: ``stereo.yml``.

``K1, D1, K2, D2`` (left, right), ``R`` and ``T`` as `cv2.stereoCalibrate` returns them, mapping the left
camera's frame to the right one's, ``x_right = R x_left + T``; ``T`` in metres. A rectified rig also has
``R1, R2, P1, P2, Q`` as `cv2.stereoRectify` returns them.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from rigsim.interop.files.folder import write_file
from rigsim.interop.formats.values import reals
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import brown_of
from rigsim.rig.stereo import StereoRig

FILE_NAME = "stereo.yml"

IN_METRES = "# rigsim stereo rig. T and the baseline in metres;"
"""How rigsim's own file says its unit."""

_HEAD = f"%YAML:1.0\n---\n{IN_METRES} x_right = R x_left + T; integer pixel = pixel centre.\n"


def opencv_yaml(rig: StereoRig) -> str:
    """The text of a stereo.yml of `rig`, every digit kept."""
    left, right = rig.left, rig.right
    lines = [f"image_width: {left.width}", f"image_height: {left.height}"]
    if (right.width, right.height) != (left.width, left.height):
        lines += [f"image_width_right: {right.width}", f"image_height_right: {right.height}"]
    matrices: dict[str, Array] = {
        "K1": left.K,
        "D1": coefficients(left)[None],
        "K2": right.K,
        "D2": coefficients(right)[None],
        "R": rig.right_from_left.R,
        "T": rig.right_from_left.t[:, None],
    }
    if rig.is_rectified:
        matrices |= rectified_matrices(rig)
    return _HEAD + "\n".join([*lines, *(_matrix_text(name, M) for name, M in matrices.items())]) + "\n"


def write_opencv_yaml(path: Path, rig: StereoRig) -> None:
    """Write `rig` to the file `path`, whole or not at all.

    Raises:
        OutputError: it cannot be written.
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
