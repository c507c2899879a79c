"""What Kalibr and its kin call a lens: a camera model and a distortion model, each with its numbers.

``pinhole`` has fx, fy, cx, cy; ``omni`` xi, ``ds`` xi and alpha, ``eucm`` alpha and beta before them.
``radtan`` is k1, k2, p1, p2; ``equidistant`` k1 to k4 of the angle; ``fov`` w
(https://github.com/ethz-asl/kalibr/wiki/supported-models).
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from rigsim.errors import InvalidRig
from rigsim.interop.formats.values import numbers, opencv_distortion, shown
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.double_sphere import DoubleSphere
from rigsim.rig.lens.eucm import Eucm
from rigsim.rig.lens.fov import FieldOfView
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.mei import Mei
from rigsim.rig.lens.rational import Rational

_LENSES: Mapping[tuple[str, str], type[Lens] | None] = MappingProxyType(
    {
        ("pinhole", "radtan"): BrownConrady,
        ("pinhole", "equidistant"): KannalaBrandt,
        ("pinhole", "fov"): FieldOfView,
        ("pinhole", "none"): None,
        ("omni", "radtan"): Mei,
        ("omni", "none"): Mei,
        ("ds", "none"): DoubleSphere,
        ("eucm", "none"): Eucm,
    }
)
"""The lens of each camera model and distortion model; its coefficients are theirs, in their order."""

_FIRST = {"pinhole": (), "omni": ("xi",), "ds": ("xi", "alpha"), "eucm": ("alpha", "beta")}
"""What stands before fx, fy, cx, cy."""

_COUNTS = {"radtan": 4, "equidistant": 4, "fov": 1, "none": 0}

_ALIASES = {
    "radial-tangential": "radtan", "radial_tangential": "radtan", "brown": "radtan",
    "equi": "equidistant", "fisheye": "equidistant", "kannala_brandt": "equidistant", "atan": "fov",
    "": "none", "mei": "omni", "unified": "omni", "double_sphere": "ds", "double-sphere": "ds",
}  # fmt: skip
"""Other words for the same."""

_OPENCV_S = ("rational_polynomial", "rational", "plumb_bob", "radtan8", "opencv")
"""Words for OpenCV's lens of 4, 5, 8, 12 or 14 terms: not Kalibr's own, but in files of its form."""


def camera_of(
    size: tuple[int, int], models: tuple[object, object], values: tuple[object, object], of: str
) -> Intrinsics:
    """The camera of a camera model and a distortion model with their numbers; `of` says whose, as " of cam0".

    Args:
        size: width and height, px.
        models: the two words; the second may be None, or be a part of the first, as ``pinhole-radtan``.
        values: the numbers of the first and of the second; the latter may be None.
        of: whose they are, in messages.

    Raises:
        InvalidRig: no lens is of these models together, or numbers are missing or cannot be.
    """
    camera, distortion = _words(*models)
    if camera == "pinhole" and distortion in _OPENCV_S:
        D = numbers(values[1] or [], f"distortion_coeffs{of}")
        lens: Lens | None = opencv_distortion(D, f"distortion_coeffs{of}")
        return _intrinsics(size, numbers(values[0], f"intrinsics{of}", 4), lens, of)
    if distortion == "plumb_bob":
        distortion = "radtan"
    counted = _counted(camera, distortion)
    coefficients = numbers(values[1] or [], f"distortion_coeffs{of}")
    if distortion == "radtan" and camera in ("ds", "eucm") and not coefficients.any():
        distortion, coefficients = "none", coefficients[:0]  # programs that have a line for it and no use
    if not counted or (camera, distortion) not in _LENSES:
        known = ", ".join("-".join(pair) for pair in (*_LENSES, ("pinhole", "rational_polynomial")))
        raise InvalidRig(
            f"camera_model {shown(models[0])} with distortion_model {shown(models[1])}{of}: no lens of these;"
            f" read are {known}: calibrate with one of them"
        )
    if distortion == "none":
        coefficients = coefficients[:0]
    elif len(coefficients) != _COUNTS[distortion]:
        raise InvalidRig(
            f"distortion_coeffs{of}: holds {len(coefficients)} values, must be {_COUNTS[distortion]}, as of"
            f" {distortion}"
        )
    first = _FIRST[camera]
    intrinsics = numbers(values[0], f"intrinsics{of}", len(first) + 4)
    model = _LENSES[camera, distortion]
    terms = [float(term) for term in (*intrinsics[: len(first)], *coefficients)]
    try:
        lens = None if model is None else model(*terms)
    except InvalidRig as error:
        raise InvalidRig(f"camera{of}: {error}") from None
    return _intrinsics(size, intrinsics[len(first) :], lens, of)


def _intrinsics(size: tuple[int, int], ends: Array, lens: Lens | None, of: str) -> Intrinsics:
    fx, fy, cx, cy = (float(value) for value in ends)
    try:
        return Intrinsics(*size, fx, fy, cx, cy, lens)
    except InvalidRig as error:
        raise InvalidRig(f"camera{of}: {error}") from None


def words_of(camera: Intrinsics, who: str) -> tuple[str, str, tuple[float, ...], tuple[float, ...]]:
    """The two words and the two lists of numbers of a camera.

    Raises:
        InvalidRig: no two words are of its lens; the message says that `who` has none.
    """
    ends = (camera.fx, camera.fy, camera.cx, camera.cy)
    lens = _plain(camera.lens, who)
    if lens is None:  # every reader knows radtan
        return "pinhole", "radtan", ends, (0.0,) * 4
    camera_model, distortion = next(pair for pair, model in _LENSES.items() if model is type(lens))
    terms = tuple(float(getattr(lens, name)) for name in lens.names())
    count = len(_FIRST[camera_model])
    return camera_model, distortion, (*terms[:count], *ends), terms[count : count + _COUNTS[distortion]]


def _plain(lens: Lens | None, who: str) -> Lens | None:
    """The lens as one of `_LENSES`."""
    if isinstance(lens, Rational) and not any(getattr(lens, name) for name in lens.names()[5:]):
        lens = BrownConrady(*(getattr(lens, name) for name in lens.names()[:5]))
    if isinstance(lens, BrownConrady):
        if lens.k3:
            raise InvalidRig(f"k3 {lens.k3:g}: must be 0, {who}'s radtan lens has no k3")
        return None if lens.is_ideal else lens
    if lens is None or type(lens) in _LENSES.values():
        return lens
    raise InvalidRig(f"lens {lens.said}: {who} has no such model")


def _words(camera: object, distortion: object) -> tuple[str, str]:
    first, second = (str("" if word is None else word).strip().lower() for word in (camera, distortion))
    if not second and "-" in first and first not in _ALIASES:  # as Kalibr's command line takes them
        first, _, second = first.partition("-")
    return _ALIASES.get(first, first), _ALIASES.get(second, second)


def _counted(camera: str, distortion: str) -> bool:
    return camera in _FIRST and distortion in _COUNTS
