"""Numbers, matrices and rotations in other programs' calibration files: written in full, read with care."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.rational import Rational
from rigsim.rig.remark import Remark

if TYPE_CHECKING:
    from rigsim.interop.formats.format import Asked

_LARGEST = 1e12
_ROUNDED_ROTATION = 2e-3  # three decimals of a rotation's numbers
_EXACT_ROTATION = 1e-11
_SHOWN = 40
_FAR_OFF = 0.12  # of the diagonal: further from the middle no principal point tells a size
_SIZES = (
    (640, 480), (1280, 720), (1920, 1080), (1280, 800), (752, 480), (1280, 960), (1920, 1200),
    (1280, 1024), (640, 400), (640, 360), (320, 240), (848, 480), (800, 600), (1024, 768), (1600, 1200),
    (2448, 2048), (960, 540), (512, 512), (1024, 1024), (1440, 1080), (1936, 1216), (2048, 1536),
    (2048, 2048), (2208, 1242), (672, 376), (960, 600), (1624, 1240), (2592, 1944), (3280, 2464),
    (3840, 2160), (4032, 3024), (4056, 3040),
)  # fmt: skip
"""Sizes that cameras have, px, the commonest first."""
_BRIEF = reprlib.Repr()
_BRIEF.maxlevel, _BRIEF.maxlist, _BRIEF.maxdict, _BRIEF.maxstring = 3, 8, 4, 2 * _SHOWN


def real(value: float) -> str:
    """Every digit of a number, with a point: to YAML 1.1 ``1e-05`` is a word, ``1.0e-05`` a number."""
    text = repr(float(value))
    mantissa, e, exponent = text.partition("e")
    return text if not e or "." in mantissa else f"{mantissa}.0e{exponent}"


def reals(values: Iterable[float]) -> str:
    """Numbers between commas, as in a YAML or JSON list without its brackets."""
    return ", ".join(real(float(value)) for value in values)


def member(table: object, key: str, owner: str = "") -> object:
    """What a file's table holds under `key`; `owner` says in messages whose table it is.

    Raises:
        InvalidRig: it is no table, or there is no such key.
    """
    of = f" of {owner}" if owner else ""
    if not isinstance(table, Mapping):
        raise InvalidRig(f"{owner or 'content'} {shown(table)}: must be a table of names and values")
    if key not in table:
        found = ", ".join(str(name) for name in list(table)[:8]) or "nothing"
        raise InvalidRig(f"{key}{of} is missing (found {clipped(found)}): add it")
    value: object = table[key]
    return value


def number(value: object, name: str) -> float:
    """A finite number.

    Raises:
        InvalidRig: it is none, or beyond 1e12.
    """
    if isinstance(value, str):  # YAML takes 1e-05 for a word
        try:
            value = float(value)
        except ValueError:
            value = shown(value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InvalidRig(f"{name} {shown(value)}: must be a number")
    try:
        value = float(value)
    except OverflowError:  # a whole number of more than 308 digits
        value = math.inf
    if not abs(value) <= _LARGEST:
        raise InvalidRig(f"{name} {value:g}: must be finite and within +-{_LARGEST:g}")
    return value


def pixels(value: object, name: str) -> int:
    """A whole number of pixels, from 1 to a million.

    Raises:
        InvalidRig: it is none.
    """
    size = number(value, name)
    if not (size.is_integer() and 1 <= size <= 1e6):
        raise InvalidRig(f"{name} {size:g} px: must be a whole number from 1 to 1e+06")
    return int(size)


def numbers(value: object, name: str, count: int | None = None) -> Array:
    """A list of `count` finite numbers (or however many there are), (N,).

    Raises:
        InvalidRig: it is none.
    """
    if not isinstance(value, list | tuple):
        raise InvalidRig(f"{name} {shown(value)}: must be a list of {count or 'numbers'}")
    if count is not None and len(value) != count:
        raise InvalidRig(f"{name}: holds {len(value)} values, must be {count}")
    return np.array([number(item, name) for item in value], dtype=np.float64)


def matrix(value: object, name: str, rows: int, columns: int) -> Array:
    """A matrix (rows, columns) from a list of its rows, or of all its numbers, row by row.

    Raises:
        InvalidRig: it is none.
    """
    if isinstance(value, list) and value and all(isinstance(row, list) for row in value):
        if len(value) != rows:
            raise InvalidRig(f"{name}: has {len(value)} rows, must be {rows}")
        return np.array([numbers(row, name, columns) for row in value])
    return numbers(value, name, rows * columns).reshape(rows, columns)


def rotation(R: Array, name: str) -> Array:
    """The rotation (3, 3) that a file means by `R`: the nearest one, where its numbers were rounded.

    Raises:
        InvalidRig: it is further from any rotation than rounding to three decimals takes it.
    """
    deviation = float(np.abs(R @ R.T - np.eye(3)).max())
    if not (deviation <= _ROUNDED_ROTATION and np.linalg.det(R) > 0):
        raise InvalidRig(
            f"{name} is no rotation (|R R^T - 1| = {deviation:.2g}, must be <= {_ROUNDED_ROTATION:g}; det ="
            f" {np.linalg.det(R):.3g}, must be 1): rows must be orthonormal and right-handed"
        )
    if deviation <= _EXACT_ROTATION:
        return R
    U, _, Vt = np.linalg.svd(R)
    return np.asarray(U @ Vt)


def rotation_from_quaternion(quaternion: Array, name: str) -> Array:
    """The rotation (3, 3) of a unit quaternion w, x, y, z, (4,).

    Raises:
        InvalidRig: its length is not 1 to three decimals.
    """
    length = float(np.linalg.norm(quaternion))
    if not abs(length - 1) <= _ROUNDED_ROTATION:
        raise InvalidRig(f"{name}: a quaternion of length {length:.3g} is no rotation, must be 1")
    w, x, y, z = (float(part) / length for part in quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion_from_rotvec(rotvec_rad: Array) -> tuple[float, float, float, float]:
    """The unit quaternion (w, x, y, z) of a rotation vector (3,), rad; w >= 0."""
    half = float(np.linalg.norm(rotvec_rad)) / 2
    x, y, z = (float(part) * 0.5 * float(np.sinc(half / np.pi)) for part in rotvec_rad)
    return math.cos(half), x, y, z


def lens(width: int, height: int, K: Array, distortion: Lens | None, name: str) -> Intrinsics:
    """The camera of a camera matrix `K` (3, 3), px.

    Raises:
        InvalidRig: the matrix has skew, or a last row other than 0 0 1.
    """
    if not (K[0, 1] == K[1, 0] == 0 and (K[2] == (0, 0, 1)).all()):
        row = " ".join(f"{item:g}" for item in (K[0, 1], K[1, 0], *K[2]))
        raise InvalidRig(f"{name}: must be [fx 0 cx; 0 fy cy; 0 0 1], without skew (found {row})")
    return Intrinsics(
        width, height, float(K[0, 0]), float(K[1, 1]), float(K[0, 2]), float(K[1, 2]), distortion
    )


def opencv_distortion(D: Array, name: str) -> BrownConrady | Rational | None:
    """The lens of OpenCV's k1, k2, p1, p2[, k3[, k4 to k6[, s1 to s4[, tau_x, tau_y]]]]; None if ideal.

    Raises:
        InvalidRig: there are not 0, 4, 5, 8, 12 or 14 of them.
    """
    if len(D) not in (0, 4, 5, 8, 12, 14):
        raise InvalidRig(f"{name}: has {len(D)} numbers, must be 4 (k1, k2, p1, p2), 5 (and k3), 8, 12 or 14")
    terms = [float(value) for value in D]
    if not any(terms):
        return None
    return Rational(*terms) if any(terms[5:]) else BrownConrady(*terms[:5])


def size_or_guess(
    asked: Asked, principals: Iterable[tuple[float, float]], at_least: tuple[float, float] = (1, 1)
) -> tuple[int, int, Remark | None]:
    """Width and height, px, of the pictures of a file that does not say them, and what is to be said of it.

    It is the size that the person said. Where they said none, it is the commonest size of a camera whose
    middle lies nearest to the principal points, and the remark ``no_size`` says that it was assumed.

    Args:
        asked: what the person said.
        principals: (cx, cy) of each camera, px.
        at_least: a width and a height that the pictures are known to have, px, as the corner of a region.

    Raises:
        InvalidRig: nothing was said, and no usual size fits; or what was said is less than `at_least`.
    """
    if asked.size_px is not None:
        width, height = asked.size_px
        if width < at_least[0] or height < at_least[1]:
            raise InvalidRig(
                f"image size {width}x{height}: the file has regions up to {at_least[0]:g},{at_least[1]:g} px"
            )
        return width, height, None
    cx, cy = (float(value) for value in np.mean(list(principals), axis=0))

    def off(size: tuple[int, int]) -> float:
        return math.hypot(cx - (size[0] - 1) / 2, cy - (size[1] - 1) / 2)

    fitting = [size for size in _SIZES if size[0] >= at_least[0] and size[1] >= at_least[1]]
    nearest = min(fitting, key=off, default=None)
    if nearest is None or not off(nearest) <= _FAR_OFF * math.hypot(*nearest):
        raise InvalidRig("has no image size: give it as --rig-size 1280x720")
    width, height = nearest
    text = (
        f"the calibration has no image size: {width}x{height} assumed, the usual size whose middle lies"
        f" nearest to the principal points (mean {cx:.4g}, {cy:.4g}); give the true one as --rig-size WxH"
    )
    return width, height, Remark("no_size", text)


def shown(value: object) -> str:
    """A value as a message quotes it, whatever its size."""
    try:
        return clipped(value[: 2 * _SHOWN] if isinstance(value, str) else _BRIEF.repr(value))
    except ValueError:  # Python writes no whole number of more than 4300 digits
        return "a number of thousands of digits"


def clipped(text: str) -> str:
    """A text cut to what fits a message, on one line."""
    text = printable(" ".join(text[: 4 * _SHOWN].split()))
    return text if len(text) <= _SHOWN else text[: _SHOWN - 3] + "..."


def printable(text: str) -> str:
    """A text without the letters that would break a line or a terminal."""
    return "".join(letter if letter.isprintable() else "?" for letter in text)
