"""COLMAP's camera models: which numbers each has, and the lens that they mean.

COLMAP counts pixels from the corner of the first one: its principal point is half a pixel more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.interop.formats.tables.terms import opencv_lens, opencv_terms
from rigsim.interop.formats.values import clipped, number, pixels, real
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.eucm import Eucm
from rigsim.rig.lens.fov import FieldOfView
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens

_HALF = 0.5


@dataclass(frozen=True, slots=True)
class _Model:
    """A model: one focal length or two, the principal point, and the lens's numbers."""

    focals: int
    terms: int
    lens: Callable[..., Lens | None]


def _terms(*places: int) -> Callable[..., Lens | None]:
    """A lens of OpenCV's terms that stand at these places of its list."""

    def lens(*values: float) -> Lens | None:
        D = np.zeros(8)
        D[list(places)] = values
        return opencv_lens(D, "camera")

    return lens


def _fisheye(*values: float) -> Lens:
    return KannalaBrandt(*values)


_MODELS = {
    "SIMPLE_PINHOLE": _Model(1, 0, _terms()),
    "PINHOLE": _Model(2, 0, _terms()),
    "SIMPLE_RADIAL": _Model(1, 1, _terms(0)),
    "RADIAL": _Model(1, 2, _terms(0, 1)),
    "OPENCV": _Model(2, 4, _terms(0, 1, 2, 3)),
    "FULL_OPENCV": _Model(2, 8, _terms(*range(8))),
    "SIMPLE_FISHEYE": _Model(1, 0, _fisheye),
    "FISHEYE": _Model(2, 0, _fisheye),
    "SIMPLE_RADIAL_FISHEYE": _Model(1, 1, _fisheye),
    "RADIAL_FISHEYE": _Model(1, 2, _fisheye),
    "OPENCV_FISHEYE": _Model(2, 4, _fisheye),
    "FOV": _Model(2, 1, FieldOfView),
    "EUCM": _Model(2, 2, Eucm),
}
_OTHERS = (
    "SIMPLE_DIVISION",
    "DIVISION",
    "THIN_PRISM_FISHEYE",
    "RAD_TAN_THIN_PRISM_FISHEYE",
    "EQUIRECTANGULAR",
)
NAMES = (*_MODELS, *_OTHERS)
"""COLMAP's models, those that rigsim has no lens for included."""


def camera_of(words: Sequence[str], where: str) -> Intrinsics:
    """The camera in a line of cameras.txt.

    Raises:
        InvalidRig: the model is unknown, or it has other numbers.
    """
    name = words[1] if len(words) > 1 else "missing"
    if len(words) < 4 or name not in _MODELS:
        raise InvalidRig(f"{where}: camera model {clipped(name)}: must be one of {', '.join(_MODELS)}")
    model = _MODELS[name]
    count = model.focals + 2 + model.terms
    if len(words) != 4 + count:
        raise InvalidRig(f"{where}: {name} has {len(words) - 4} numbers, must have {count}")
    width, height = (pixels(word, f"{where}: size") for word in words[2:4])
    values = [number(word, f"{where}: parameter") for word in words[4:]]
    cx, cy, *terms = values[model.focals :]
    try:
        lens = model.lens(*terms)
    except InvalidRig as error:
        raise InvalidRig(f"{where}: {error}") from None
    return Intrinsics(width, height, values[0], values[model.focals - 1], cx - _HALF, cy - _HALF, lens)


def camera_line(index: int, camera: Intrinsics) -> str:
    """The line of cameras.txt of a camera, every digit kept.

    Raises:
        InvalidRig: no model has its lens.
    """
    model, terms = _written(camera.lens)
    params = (camera.fx, camera.fy, camera.cx + _HALF, camera.cy + _HALF, *terms)
    return f"{index} {model} {camera.width} {camera.height} {' '.join(real(value) for value in params)}"


def _written(lens: Lens | None) -> tuple[str, tuple[float, ...]]:
    """The model of a lens, and its numbers."""
    if isinstance(lens, KannalaBrandt):
        return "OPENCV_FISHEYE", (lens.k1, lens.k2, lens.k3, lens.k4)
    if isinstance(lens, FieldOfView):
        return "FOV", (lens.w,)
    if isinstance(lens, Eucm):
        return "EUCM", (lens.alpha, lens.beta)
    terms = opencv_terms(lens, "COLMAP, beside its OPENCV_FISHEYE, FOV and EUCM,")
    if any(terms[8:]):
        raise InvalidRig(
            "thin-prism and tilt terms must be 0: COLMAP's FULL_OPENCV camera has k1 to k6, p1, p2"
        )
    if any(terms[4:]):
        return "FULL_OPENCV", terms[:8]
    return ("OPENCV", terms[:4]) if any(terms) else ("PINHOLE", ())
