"""Calibration files of KITTI's stereo data (Geiger et al., "Vision meets robotics", 2013).

``calib_cam_to_cam.txt`` of the raw data has one line a value: ``S_rect_02`` the rectified size, ``P_rect_00``
to ``P_rect_03`` the rectified projections (3 x 4, row by row) of the grey pair 0, 1 and the colour pair 2, 3.
``calib.txt`` of the odometry data and the object data's files have ``P0`` to ``P3`` and no size. In each the
last column is ``K t``, ``t`` mapping the first camera's rectified frame to this one's, metres; only the
difference of the two counts. KITTI's own pairs are some millimetres off in y and z, which is kept.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File, Format, Found, alone
from rigsim.interop.formats.kit.cameras import two_of
from rigsim.interop.formats.kit.poses import offset
from rigsim.interop.formats.values import clipped, lens, number, pixels, real, size_or_guess
from rigsim.rig.arrays import Array
from rigsim.rig.pose import Pose
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig

_LINE = re.compile(r"\s*(\w+)\s*:\s*(.*?)\s*$")
_RAW = re.compile(r"^\s*P_rect_0\d\s*:", re.MULTILINE)
_SHORT = re.compile(r"^[ \t]*P[0-3][ \t]*:(?:[ \t]+\S+){12}[ \t]*$", re.MULTILINE)
_CAMERA = re.compile(r"P(?:_rect_0)?(\d)")
_SIDES = ("02", "03")
_ROUNDED_PX = 1e-3
_SIZES = {
    721.5377: (1242, 375),
    718.856: (1241, 376),
    718.3351: (1238, 374),
    707.0912: (1226, 370),
    707.0493: (1224, 370),
}
"""Rectified size, px, of KITTI's recordings, by the focal length, px, of each day's calibration."""


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


def parse_kitti(text: str, asked: Asked | None = None) -> Found:
    """The rectified rig in the text of one of KITTI's files: cameras 2 and 3, or of odometry's 0 and 1.

    Raises:
        InvalidRig: a line is missing, or the two cameras are no rectified pair.
    """
    asked = asked or Asked()
    values = {match[1]: match[2] for line in text.splitlines() if (match := _LINE.match(line))}
    lines = {found[1]: key for key in sorted(values) if (found := _CAMERA.fullmatch(key))}
    first, second, remarks = _cameras(list(lines), values, asked)
    keys = (lines[first], lines[second])
    left, right = (_numbers(values, key, 12).reshape(3, 4) for key in keys)
    if (
        np.abs(left[:2, :2] - right[:2, :2]).max() > _ROUNDED_PX
        or abs(left[1, 2] - right[1, 2]) > _ROUNDED_PX
    ):
        raise InvalidRig(
            f"{keys[0]} and {keys[1]}: must share focal lengths and cy: the pair is not rectified"
        )
    pose = Pose(np.eye(3), offset(right, keys[1]) - offset(left, keys[0]))
    sizes, guessed = _sizes(values, (first, second), (left, right), asked)
    cameras = [
        lens(*size, P[:, :3], None, key) for size, P, key in zip(sizes, (left, right), keys, strict=True)
    ]
    return Found(StereoRig(cameras[0], cameras[1], pose), "m", (*remarks, *guessed))


def _cameras(
    names: list[str], values: Mapping[str, str], asked: Asked
) -> tuple[str, str, tuple[Remark, ...]]:
    """Which two cameras, and what is to be said of it."""
    if asked.cameras is not None:
        i, j, _ = two_of([f"P{name}" for name in names], asked)
        return names[i], names[j], ()
    colour, grey = {"2", "3"} <= set(names), {"0", "1"} <= set(names)
    odometry = "P0" in values and "R0_rect" not in values and "Tr_velo_to_cam" not in values
    if not (colour or grey):
        raise InvalidRig(f"has camera {', '.join(names) or 'none'}: must have 2 and 3 (colour) or 0 and 1")
    if not (colour and grey):
        return ("2", "3", ()) if colour else ("0", "1", ())
    taken, other = ("grey pair 0,1", "2,3") if odometry else ("colour pair 2,3", "0,1")
    text = f"has KITTI's four cameras: the {taken} is taken; --rig-cameras {other} takes the other one"
    return *(("0", "1") if odometry else ("2", "3")), (Remark("cameras", text),)


def _sizes(
    values: Mapping[str, str], names: tuple[str, str], projections: tuple[Array, Array], asked: Asked
) -> tuple[list[tuple[int, int]], tuple[Remark, ...]]:
    """Each camera's width and height, px, and what is to be said where the file has none."""
    keys = [f"S_rect_0{name}" for name in names]
    has = [key for key in keys if key in values]
    if has or _RAW.search("\n".join(f"{key}:" for key in values)):
        sizes = []
        for key in keys:
            width, height = _numbers(values, key if key in values or not has else has[0], 2)
            sizes.append((pixels(float(width), key), pixels(float(height), key)))
        return sizes, ()
    fx = float(projections[0][0, 0])
    own = next((size for focal, size in _SIZES.items() if abs(focal - fx) < _ROUNDED_PX), None)
    if asked.size_px is None and own is not None:
        text = (
            f"the calibration has no image size: {own[0]}x{own[1]} assumed, as KITTI's pictures of this focal"
            " length; give another as --rig-size WxH"
        )
        return [own, own], (Remark("no_size", text),)
    width_px, height_px, remark = size_or_guess(
        asked, [(float(P[0, 2]), float(P[1, 2])) for P in projections]
    )
    return [(width_px, height_px)] * 2, () if remark is None else (remark,)


def _numbers(values: Mapping[str, str], key: str, count: int) -> Array:
    if key not in values:
        raise InvalidRig(f"no line {key}: ...: KITTI's calib_cam_to_cam.txt has one")
    words = values[key].split()
    if len(words) != count:
        raise InvalidRig(f"{key}: {clipped(values[key])}: must be {count} numbers")
    return np.array([number(word, key) for word in words])


def knows(text: str) -> bool:
    """Whether a text is one of KITTI's calibrations."""
    return _RAW.search(text) is not None or _SHORT.search(text) is not None


def _open(files: tuple[File, ...], asked: Asked) -> Found:
    return parse_kitti(files[0].text, asked)


FORMAT = Format(
    "kitti",
    "KITTI's stereo data (raw, odometry, object), read only; data sets are written",
    (".txt",),
    "calib_cam_to_cam.txt",
    "training/calib_cam_to_cam/000000.txt",
    groups=alone(knows),
    open=_open,
)
