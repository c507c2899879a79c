"""Calibration files of KITTI's stereo data (Geiger et al., "Vision meets robotics", 2013).

``calib_cam_to_cam.txt`` has one line a value: ``S_rect_02`` the rectified size, ``P_rect_02`` and
``P_rect_03`` the rectified projections (3 x 4, row by row) of the left and the right colour camera. There
the last column is ``K t``, ``t`` mapping the first camera's rectified frame to this one's, metres; only the
difference of the two counts. KITTI's own pairs are some millimetres off in y and z, which is kept.
"""

from __future__ import annotations

import re

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidRig
from rigsim.interop.formats import middlebury
from rigsim.interop.formats.format import Format
from rigsim.interop.formats.values import clipped, lens, number, pixels, real
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

_LINE = re.compile(r"\s*(\w+)\s*:\s*(.*?)\s*$")
_SIDES = ("02", "03")
_ROUNDED_PX = 1e-3


def calib_cam_to_cam(rig: StereoRig) -> str:
    """The text of a calib_cam_to_cam.txt of the rectified `rig`, every digit kept.

    Raises:
        InvalidRig: the rig is not rectified, or has doffs, which KITTI's formula for depth leaves out.
    """
    if not rig.is_rectified:
        raise InvalidRig(
            "KITTI's disparities need a rectified rig: parallel axes, equal lenses, no distortion"
        )
    if rig.doffs_px != 0:
        raise InvalidRig(f"doffs {rig.doffs_px:g} px: must be 0, KITTI's depth is fx b / disparity")
    lines = []
    for side, camera, x in zip(_SIDES, (rig.left, rig.right), (0.0, rig.baseline_m), strict=True):
        size = (camera.width, camera.height)
        P = np.hstack([camera.K, [[0.0 - camera.fx * x], [0.0], [0.0]]])
        rows: dict[str, npt.ArrayLike] = {
            "S": size,
            "K": camera.K,
            "D": np.zeros(5),
            "R": np.eye(3),
            "T": np.array([0.0 - x, 0.0, 0.0]),
            "S_rect": size,
            "R_rect": np.eye(3),
            "P_rect": P,
        }
        lines += [
            f"{key}_{side}: {' '.join(real(float(value)) for value in np.ravel(values))}"
            for key, values in rows.items()
        ]
    return "\n".join(lines) + "\n"


def parse_cam_to_cam(text: str) -> StereoRig:
    """The rectified rig in the text of a calib_cam_to_cam.txt.

    Raises:
        InvalidRig: a line is missing, or the two cameras are no rectified pair.
    """
    values = {match[1]: match[2] for line in text.splitlines() if (match := _LINE.match(line))}
    width, height = (pixels(float(side), "S_rect_02") for side in _numbers(values, "S_rect_02", 2))
    left, right = (_numbers(values, f"P_rect_{side}", 12).reshape(3, 4) for side in _SIDES)
    if (
        np.abs(left[:2, :2] - right[:2, :2]).max() > _ROUNDED_PX
        or abs(left[1, 2] - right[1, 2]) > _ROUNDED_PX
    ):
        raise InvalidRig(
            "P_rect_02 and P_rect_03: must share focal lengths and cy: the pair is not rectified"
        )
    if not left[0, 3] > right[0, 3]:
        raise InvalidRig(
            f"P_rect_02[0,3] {left[0, 3]:g} and P_rect_03[0,3] {right[0, 3]:g}: the left one must be larger"
            " by fx b; are the cameras swapped?"
        )

    def camera(P: Array, name: str) -> Intrinsics:
        return lens(width, height, P[:, :3], None, name)

    pose = Pose(np.eye(3), _place(right) - _place(left))
    return StereoRig(camera(left, "P_rect_02"), camera(right, "P_rect_03"), pose)


def _place(P: Array) -> Array:
    """``t`` (3,), m, of ``P = K [1 | t]``."""
    x, y, z = (float(value) for value in P[:, 3])
    return np.array([(x - P[0, 2] * z) / P[0, 0], (y - P[1, 2] * z) / P[1, 1], z])


def _numbers(values: dict[str, str], key: str, count: int) -> Array:
    if key not in values:
        raise InvalidRig(f"no line {key}: ...: KITTI's calib_cam_to_cam.txt has one")
    words = values[key].split()
    if len(words) != count:
        raise InvalidRig(f"{key}: {clipped(values[key])}: must be {count} numbers")
    return np.array([number(word, key) for word in words])


_KNOWN = re.compile(r"^\s*P_rect_0\d\s*:", re.MULTILINE)

FORMAT = Format(
    "kitti",
    "KITTI's stereo data, read only; data sets are written",
    (".txt",),
    "calib_cam_to_cam.txt",
    "training/calib_cam_to_cam/000000.txt",
    knows=lambda text: _KNOWN.search(text) is not None and not middlebury.knows(text),
    parse=parse_cam_to_cam,
)
