"""The lens of a camera that OpenCV calibrated: its usual one, its fisheye, or its omnidirectional one."""

from __future__ import annotations

from rigsim.errors import InvalidRig
from rigsim.interop.formats.opencv.names import Facts
from rigsim.interop.formats.values import number, numbers, opencv_distortion
from rigsim.rig.lens.lens import Lens

_TERMS = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")


def lens_of(facts: Facts, side: str) -> Lens | None:
    """The lens of one camera; None for a pinhole.

    Four numbers are k1, k2, p1, p2 as `cv2.calibrateCamera` returns them, unless the file says fisheye
    (`cv2.fisheye`: k1 to k4) or has ``xi`` (`cv2.omnidir`).

    Raises:
        InvalidRig: they are too few or too many, or none.
    """
    from rigsim.interop.formats.opencv.rig import flat

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
        raise InvalidRig("xi: no omni")
    if facts.fisheye:
        raise InvalidRig("fisheye: no")
    return opencv_distortion(D, key)
