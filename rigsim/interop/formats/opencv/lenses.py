"""The lens of a camera that OpenCV calibrated: its usual one, its fisheye, or its omnidirectional one."""

from __future__ import annotations

from rigsim.errors import InvalidRig
from rigsim.interop.formats.opencv.names import Facts
from rigsim.interop.formats.values import number, numbers, opencv_distortion
from rigsim.rig.arrays import Array
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.mei import Mei

_TERMS = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")


def lens_of(facts: Facts, side: str) -> Lens | None:
    """The lens of one camera; None for a pinhole.

    Four numbers are k1, k2, p1, p2 as `cv2.calibrateCamera` returns them, unless the file says fisheye
    (`cv2.fisheye`: k1 to k4) or has ``xi`` (`cv2.omnidir`).

    Raises:
        InvalidRig: they are too few or too many, or none.
    """
    if facts.has("D", side):
        key = facts.key("D", side)
        D = numbers(flat(facts.value("D", side)), key)
    else:
        key = f"distortion of the {side} camera"
        given = {term: number(facts.value(term, side), term) for term in _TERMS if facts.has(term, side)}
        order: tuple[str, ...] = _TERMS if any(term in given for term in _TERMS[5:]) else _TERMS[:5]
        if facts.fisheye:
            order = ("k1", "k2", "k3", "k4")
        D = numbers([given.get(term, 0.0) for term in order], key)
    if facts.has("xi", side):
        (xi,) = numbers(flat(facts.value("xi", side)), facts.key("xi", side), 1)
        _check_count(D, key, (0, 4), "an omnidirectional lens: k1, k2, p1, p2")
        return Mei(float(xi), *(float(term) for term in D))
    if facts.fisheye:
        _check_count(D, key, (0, 4), "a fisheye lens: k1, k2, k3, k4")
        return KannalaBrandt(*(float(term) for term in D))
    return opencv_distortion(D, key)


def flat(value: object) -> object:
    """The numbers of a row or a column, or of a number alone."""
    if isinstance(value, list):
        return [item for row in value for item in (row if isinstance(row, list) else [row])]
    return [value] if isinstance(value, int | float) else value


def _check_count(D: Array, key: str, counts: tuple[int, ...], of: str) -> None:
    if len(D) not in counts:
        raise InvalidRig(f"{key}: has {len(D)} numbers, must have {counts[-1]}, as of {of}")
