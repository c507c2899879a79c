"""Middlebury's stereo data: calibration and disparity files (https://vision.middlebury.edu/stereo/data/).

``calib.txt`` names the two camera matrices, ``doffs = cx1 - cx0`` px, the baseline in mm and the image's
size; depth is ``baseline f / (disparity + doffs)``, as in rigsim.

The principal points are taken as they are, integer index = pixel centre: the files come from a
calibration with OpenCV, which counts that way. Were it otherwise, depth would be the same (only
``doffs`` enters it), and X and Y would move by half a pixel's width, ``Z / 2f``.
"""

from __future__ import annotations

import io
import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rigsim import foreign
from rigsim.errors import InvalidImage, InvalidRig
from rigsim.interop.formats.format import Asked, File, Format, Found, alone, names_sides, swapped
from rigsim.interop.formats.values import clipped
from rigsim.pixels.dense.pfm import parse_pfm
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig

_DOFFS_TOLERANCE_PX = 2e-3  # the files print three decimals
_PNG_SCALE = 256.0
LARGEST_PNG_PX = 65535 / _PNG_SCALE
"""Largest disparity in a 16 bit PNG of KITTI's, px."""
FILE_NAME = "calib.txt"

_LINE = re.compile(r"\s*([A-Za-z]\w*)\s*=\s*(.+?)\s*$")


@dataclass(frozen=True, slots=True)
class MiddleburyCalibration:
    """What a calib.txt says."""

    rig: StereoRig
    """The rectified rig."""
    disparity_range: tuple[float, float] | None
    """Least and largest disparity, px: ``vmin`` and ``vmax``, or 0 and ``ndisp``; None when not given."""


def read_calib(path: str | Path) -> MiddleburyCalibration:
    """Read a calib.txt.

    Raises:
        OutputError: the file cannot be read.
        InvalidRig: a line is missing or contradicts another one.
    """
    content = foreign.read_bytes(path, "a calibration file", foreign.TEXT_BYTES)
    return parse_calib(content.decode("utf-8", errors="replace"), str(path))


def parse_calib(text: str, name: str = "calib.txt") -> MiddleburyCalibration:
    """The calibration that the `text` of a calib.txt describes; `name` stands in messages, if any.

    Raises:
        InvalidRig: a line is missing or contradicts another one.
    """
    name = f"{name}: " if name else ""
    values = {match[1]: match[2] for line in text.splitlines() if (match := _LINE.match(line))}
    left, right = _matrix(values, "cam0", name), _matrix(values, "cam1", name)
    baseline_mm, doffs = _number(values, "baseline", name), _number(values, "doffs", name)
    width, height = _pixels(values, "width", name), _pixels(values, "height", name)
    if not np.array_equal(left[:2, :2], right[:2, :2]) or left[1, 2] != right[1, 2]:
        raise InvalidRig(f"{name}cam0 and cam1 must share focal lengths and cy: the pair is not rectified")
    if abs(right[0, 2] - left[0, 2] - doffs) > _DOFFS_TOLERANCE_PX:
        raise InvalidRig(
            f"{name}doffs {doffs:g} px: must be cx1 - cx0 = {right[0, 2] - left[0, 2]:g}; are the cameras"
            " swapped?"
        )

    def lens(K: Array) -> Intrinsics:
        return Intrinsics(width, height, float(K[0, 0]), float(K[1, 1]), float(K[0, 2]), float(K[1, 2]))

    rig = StereoRig.rectified(lens(left), baseline_m=baseline_mm / 1e3, right=lens(right))
    disparity_range = None
    if "vmin" in values and "vmax" in values:
        disparity_range = (_number(values, "vmin", name), _number(values, "vmax", name))
    elif "ndisp" in values:
        disparity_range = (0.0, _number(values, "ndisp", name))
    return MiddleburyCalibration(rig, disparity_range)


def calib_text(rig: StereoRig, disparity_range: tuple[float, float] | None = None) -> str:
    """The text of a calib.txt of the rectified `rig`, every digit kept.

    Args:
        rig: a rectified rig, both pictures of one size.
        disparity_range: least and largest disparity, px, written as ``vmin``, ``vmax`` and ``ndisp``; without
            it ``ndisp`` is half the width: of what is nearer, the pictures share less than half.

    Raises:
        InvalidRig: the rig is not rectified, or its pictures differ in size.
    """
    left, right = rig.left, rig.right
    if not rig.is_rectified:
        raise InvalidRig("calib.txt needs a rectified rig: parallel axes, equal lenses, no distortion")
    if (left.width, left.height) != (right.width, right.height):
        raise InvalidRig(
            f"images of {left.width}x{left.height} and {right.width}x{right.height} px: calib.txt has one"
        )
    least, largest = disparity_range or (0.0, left.width / 2)
    lines = [
        f"cam0={_matrix_text(left)}",
        f"cam1={_matrix_text(right)}",
        f"doffs={rig.doffs_px!r}",
        f"baseline={rig.baseline_m * 1e3!r}",
        f"width={left.width}",
        f"height={left.height}",
        f"ndisp={max(1, math.ceil(largest))}",
    ]
    if disparity_range is not None:
        lines += ["isint=0", f"vmin={math.floor(least)}", f"vmax={math.ceil(largest)}"]
    return "\n".join(lines) + "\n"


def _matrix_text(camera: Intrinsics) -> str:
    return f"[{camera.fx!r} 0 {camera.cx!r}; 0 {camera.fy!r} {camera.cy!r}; 0 0 1]"


def read_disparity(path: str | Path, *, png_scale: float = _PNG_SCALE) -> Array:
    """A disparity map (H, W), px, NaN unknown, from a .pfm, .npy or .png file; its content says which.

    PNG files hold whole numbers, `png_scale` a pixel, 0 unknown: 256 in 16 bit is KITTI's; Middlebury's
    of 2001 to 2006 have 8 bit and a scale of 1 to 8.

    Raises:
        OutputError: the file cannot be read.
        InvalidImage: it holds no disparity map.
    """
    content = foreign.read_bytes(path, "a disparity map (PFM, NPY or PNG)")
    if content.startswith(b"\x93NUMPY"):
        disparity = _npy(content, path)
    elif content.startswith(b"\x89PNG"):
        disparity = _png(content, path, png_scale)
    elif content[:2] in (b"Pf", b"PF"):
        disparity = parse_pfm(content, str(path))
    else:
        raise InvalidImage(f"{path}: no disparity map: must be a PFM, NPY or PNG file")
    if disparity.ndim != 2:
        raise InvalidImage(f"{path}: shape {disparity.shape}: a disparity map has one channel")
    if not np.isfinite(disparity).any():
        raise InvalidImage(f"{path}: no disparity is known")
    return disparity


def disparity_png(disparity: Array, *, png_scale: float = _PNG_SCALE) -> bytes:
    """A 16 bit PNG of a disparity map (H, W), px: `png_scale` a pixel, 0 where unknown (KITTI's).

    Raises:
        InvalidImage: a disparity is negative or too large to be held.
    """
    from PIL import Image

    known = np.isfinite(disparity)
    levels = np.round(np.where(known, disparity, 0.0) * png_scale)
    if levels.min() < 0 or levels.max() > 65535:
        raise InvalidImage(
            f"disparities {np.nanmin(disparity):g} to {np.nanmax(disparity):g} px: a PNG holds 0 to "
            f"{65535 / png_scale:g} px; write PFM instead"
        )
    levels[known & (levels == 0)] = 1  # 0 means unknown
    file = io.BytesIO()
    Image.fromarray(levels.astype(np.uint16)).save(file, format="PNG")
    return file.getvalue()


def _npy(content: bytes, path: str | Path) -> Array:
    values = foreign.parse_npy(content, path).astype(np.float64)
    values[np.isinf(values)] = np.nan
    return np.asarray(values)


def _png(content: bytes, path: str | Path, png_scale: float) -> Array:
    from PIL import Image

    foreign.check_pixels(content, path)
    try:
        values = np.asarray(Image.open(io.BytesIO(content)), dtype=np.float64)
    except (OSError, SyntaxError, ValueError):
        raise InvalidImage(f"{path}: a PNG file that cannot be read") from None
    return np.where(values == 0, np.nan, values / png_scale)


def _matrix(values: dict[str, str], key: str, name: str) -> Array:
    text = _given(values, key, name)
    try:
        rows = [[float(number) for number in row.split()] for row in text.strip("[]").split(";")]
        K = np.array(rows)
    except ValueError:
        K = np.empty(0)
    shape_fits = K.shape == (3, 3)
    if not (shape_fits and np.isfinite(K).all() and K[0, 1] == K[1, 0] == 0 and (K[2] == (0, 0, 1)).all()):
        raise InvalidRig(f"{name}{key}={clipped(text)}: must be [f 0 cx; 0 f cy; 0 0 1]")
    return K


def _number(values: dict[str, str], key: str, name: str) -> float:
    text = _given(values, key, name)
    try:
        return float(text)
    except ValueError:
        raise InvalidRig(f"{name}{key}={clipped(text)}: must be a number") from None


def _pixels(values: dict[str, str], key: str, name: str) -> int:
    value = _number(values, key, name)
    if not (value.is_integer() and value >= 1):
        raise InvalidRig(f"{name}{key}={value:g}: must be a whole number of px >= 1")
    return int(value)


def _given(values: dict[str, str], key: str, name: str) -> str:
    if key not in values:
        raise InvalidRig(f"{name}no line {key}=...: a Middlebury calib.txt has one")
    return values[key]


_KNOWN = re.compile(r"^\s*cam0\s*=", re.MULTILINE)


def knows(text: str) -> bool:
    """Whether a text is a calib.txt's."""
    return _KNOWN.search(text) is not None


def _open(files: tuple[File, ...], asked: Asked) -> Found:
    rig = parse_calib(files[0].text, "").rig
    return Found(swapped(rig) if names_sides(asked) else rig)


FORMAT = Format(
    "middlebury",
    "Middlebury's stereo data sets, 2014 and later",
    (".txt",),
    FILE_NAME,
    "000000/calib.txt",
    groups=alone(knows),
    open=_open,
    write=lambda rig: {FILE_NAME: calib_text(rig)},
)
