"""A calibration as ROS keeps it: one ``camera_info`` YAML a camera, ``left.yaml`` and ``right.yaml``.

``R`` turns each camera until rows (or columns) correspond, ``P`` projects after that; the baseline stands in
the right one's ``P[0,3] = -fx b`` (px m), or of a pair one above the other in ``P[1,3] = -fy b``, and nowhere
else, so that a rig that cannot be rectified cannot be held
(sensor_msgs/CameraInfo; wiki.ros.org/image_pipeline/CameraInfo).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rigsim.errors import InvalidRig
from rigsim.interop.formats.values import (
    lens,
    matrix,
    member,
    numbers,
    opencv_distortion,
    pixels,
    rotation,
    shown,
)
from rigsim.interop.formats.yaml_text import yaml_table
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.fov import FieldOfView
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.rational import Rational
from rigsim.rig.remark import Remark

_POLYNOMIALS = ("plumb_bob", "rational_polynomial", "radtan", "brown_conrady", "thin_prism", "tilted")
_FISHEYES = ("equidistant", "fisheye", "kannala_brandt", "kannala_brandt4")
_COUNTS = {"plumb_bob": (0, 4, 5), "radtan": (0, 4, 5), "brown_conrady": (0, 4, 5)}
"""How many terms each of the polynomials may have, where fewer than OpenCV's."""
MODELS = "plumb_bob, rational_polynomial, equidistant, fov or none"
"""Distortion models, as messages name them."""

_KEYS = {
    "camera_matrix": "K",
    "distortion_coefficients": "D",
    "rectification_matrix": "R",
    "projection_matrix": "P",
    "image_width": "width",
    "image_height": "height",
}
"""What a calibration file says, and what the message of a running camera calls it."""


@dataclass(frozen=True, slots=True)
class CameraInfo:
    """One camera's file."""

    camera: Intrinsics
    """The camera as it is, before it is turned."""
    R: Array
    """What turns it, (3, 3)."""
    P: Array
    """What projects after that, (3, 4); its last column px m."""
    name: str
    """What the file calls the camera; empty where it does not."""
    remarks: tuple[Remark, ...]
    """What is odd."""


def camera_info(text: str) -> CameraInfo:
    """What the text of a camera_info says.

    Raises:
        InvalidRig: no YAML, a value is missing or cannot be, or the distortion model is none of `MODELS`.
    """
    table = _table(text)
    width = pixels(_value(table, "image_width"), "image_width")
    height = pixels(_value(table, "image_height"), "image_height")
    D = numbers(_value(table, "distortion_coefficients"), "distortion_coefficients")
    distortion, remarks = _lens(table, D)
    K = matrix(_value(table, "camera_matrix"), "camera_matrix", 3, 3)
    key = "rectification_matrix"
    return CameraInfo(
        lens(width, height, K, distortion, "camera_matrix"),
        rotation(matrix(_value(table, key), key, 3, 3), key),
        matrix(_value(table, "projection_matrix"), "projection_matrix", 3, 4),
        str(table.get("camera_name") or ""),
        remarks,
    )


def model_of(lens: Lens | None) -> tuple[str, tuple[float, ...]]:
    """The distortion model of a lens, and its terms.

    Raises:
        InvalidRig: camera_info has no such model, or not all of its terms.
    """
    if lens is None:
        return "plumb_bob", (0.0,) * 5
    terms = tuple(float(getattr(lens, name)) for name in lens.names())
    if isinstance(lens, BrownConrady):
        return "plumb_bob", terms
    if isinstance(lens, Rational):
        if any(terms[8:]):
            raise InvalidRig(f"lens {lens.said}: rational_polynomial has k1 to k6, p1, p2 alone")
        return "rational_polynomial", terms[:8]
    if isinstance(lens, KannalaBrandt):
        return "equidistant", terms
    raise InvalidRig(
        f"lens {lens.said}: camera_info has plumb_bob, rational_polynomial and equidistant alone"
    )


def _table(text: str) -> Mapping[str, object]:
    """The file's table; of the messages that a running camera prints, the first."""
    start = text.lstrip()
    begin = start[3:] if start.startswith("---") else text
    return yaml_table(begin.split("\n---", 1)[0])


def _value(table: Mapping[str, object], key: str) -> object:
    """What a file has under `key`, or under a message's short name of it."""
    short = _KEYS[key]
    own = next((name for name in (key, short, short.lower()) if name in table), key)
    found = member(table, own)
    return member(found, "data", own) if isinstance(found, Mapping) else found


def _lens(table: Mapping[str, object], D: Array) -> tuple[Lens | None, tuple[Remark, ...]]:
    """The lens by its model's name, or where the file names none by the number of its terms."""
    named = table.get("distortion_model") or table.get("camera_model")
    if named is None or named == "" or named == "pinhole":
        return _unnamed(D)
    model = str(named).strip().lower()
    key = "distortion_coefficients"
    if model in _FISHEYES:
        _check_count(D, (4,), f"{model}: k1, k2, k3, k4")
        return KannalaBrandt(*(float(term) for term in D)), ()
    if model in ("fov", "atan"):
        _check_count(D, (1,), f"{model}: w")
        return FieldOfView(float(D[0])), ()
    if model in ("none", "ideal"):
        return None, ()
    if model not in _POLYNOMIALS:
        raise InvalidRig(f"distortion_model {shown(named)}: must be {MODELS}")
    if model in _COUNTS and not (D[5:] == 0).all():
        _check_count(D, _COUNTS[model], f"{model}: k1, k2, p1, p2, k3")
    return opencv_distortion(D, key), ()


def _unnamed(D: Array) -> tuple[Lens | None, tuple[Remark, ...]]:
    found = opencv_distortion(D, "distortion_coefficients")
    if found is None:
        return None, ()
    model = "rational_polynomial" if len(D) > 5 else "plumb_bob"
    text = (
        f"no distortion_model is named: {model} assumed, by its {len(D)} terms; write distortion_model:"
        f" {model}, or equidistant of a fisheye, into the file"
    )
    return found, (Remark("lens_model", text),)


def _check_count(D: Array, counts: tuple[int, ...], of: str) -> None:
    if len(D) not in counts:
        allowed = " or ".join(str(count) for count in counts)
        raise InvalidRig(f"distortion_coefficients: has {len(D)} numbers, must be {allowed}, as of {of}")
