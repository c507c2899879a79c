"""The nearest lens of another model: least squares over the image's pixels."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.double_sphere import DoubleSphere
from rigsim.rig.lens.eucm import Eucm
from rigsim.rig.lens.fov import FieldOfView
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.mei import Mei
from rigsim.rig.lens.planar import PlanarLens
from rigsim.rig.lens.rational import Rational
from rigsim.rig.stereo import StereoRig

_FIT, _CHECK = (25, 19), (81, 61)
"""Columns and rows of the pixels that a lens is fitted to, and that it is judged by."""
_MOST_STEPS = 100
_A_LITTLE = 1e-6
_FAR_OFF_PX = 1e4
_NEARLY_90 = 1e-3  # z of a unit ray: no plane shows what is flatter


@dataclass(frozen=True, slots=True)
class Family:
    """A lens model with some of its coefficients free and the others 0."""

    lens: type[Lens] | None
    """The model; None is the pinhole."""
    free: tuple[str, ...] = ()
    """Its free coefficients."""
    start: Mapping[str, float] = field(default_factory=dict)
    """Where the search begins, 0 where nothing is said."""
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Least and largest values of what is bounded."""

    def has(self, camera: Intrinsics) -> bool:
        """Whether the camera's lens is of the family."""
        if camera.lens is None:
            return self.lens in (None, BrownConrady, Rational)
        if self.lens is None or not isinstance(camera.lens, self.lens):
            return False
        return not any(getattr(camera.lens, name) for name in camera.lens.names() if name not in self.free)

    def made(self, values: Array) -> Lens | None:
        """The lens with these values of `free`."""
        if self.lens is None:
            return None
        return self.lens(**{name: float(value) for name, value in zip(self.free, values, strict=True)})


FAMILIES: tuple[Family, ...] = (
    Family(None),
    Family(BrownConrady, ("k1", "k2", "p1", "p2")),
    Family(BrownConrady, ("k1", "k2", "p1", "p2", "k3")),
    Family(Rational, ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")),
    Family(KannalaBrandt, ("k1", "k2", "k3", "k4")),
    Family(Mei, ("xi", "k1", "k2", "p1", "p2"), {"xi": 1.0}, {"xi": (0.0, 10.0)}),
    Family(
        DoubleSphere, ("xi", "alpha"), {"xi": 0.1, "alpha": 0.5}, {"xi": (-0.99, 10.0), "alpha": (0.0, 0.99)}
    ),
    Family(Eucm, ("alpha", "beta"), {"alpha": 0.5, "beta": 1.0}, {"alpha": (0.0, 0.99), "beta": (1e-3, 1e3)}),
    Family(FieldOfView, ("w",), {"w": 0.9}, {"w": (1e-3, 3.1)}),
)
"""What is tried, the simpler ones first."""


@dataclass(frozen=True, slots=True)
class Fitted:
    """A camera that stands for another one."""

    camera: Intrinsics
    """The camera."""
    rms_px: float
    """How far it shows what the other one shows in a pixel from that pixel, over the image, px."""
    largest_px: float
    """The same, the largest, px."""


def nearest(camera: Intrinsics, family: Family) -> Fitted | None:
    """The camera of `family` that shows most nearly what `camera` does; itself where it is of the family.

    None where no such camera shows all that this one does.
    """
    if family.has(camera):
        return Fitted(camera, 0.0, 0.0)
    from scipy.optimize import least_squares

    uv, rays = _shown(camera, *_FIT)
    planar = family.lens is None or issubclass(family.lens, PlanarLens)
    if planar and (rays[:, 2] < _NEARLY_90).any():
        return None
    start = _start(camera, family)
    bounds = [(-np.inf, np.inf)] * 4 + [family.bounds.get(name, (-np.inf, np.inf)) for name in family.free]
    low, high = np.transpose(bounds)

    def residuals(values: Array) -> Array:
        found = _camera(camera, family, values)
        places = found.denormalize(rays[:, :2] / rays[:, 2:]) if planar else found.project(rays)
        off = np.nan_to_num(places - uv, nan=_FAR_OFF_PX, posinf=_FAR_OFF_PX, neginf=-_FAR_OFF_PX)
        return np.asarray(np.clip(off, -_FAR_OFF_PX, _FAR_OFF_PX).ravel())

    try:
        solved = least_squares(residuals, start, bounds=(low, high), x_scale="jac", max_nfev=_MOST_STEPS)
        best = _camera(camera, family, np.asarray(solved.x))
        uv, rays = _shown(camera, *_CHECK)
        off = np.linalg.norm(best.project(rays) - uv, axis=1)
    except (InvalidRig, ValueError, np.linalg.LinAlgError):
        return None
    if not np.isfinite(off).all():
        return None
    return Fitted(best, float(np.sqrt(np.mean(off**2))), float(off.max()))


def nearest_rig(
    rig: StereoRig, holds: Callable[[StereoRig], bool]
) -> tuple[StereoRig, tuple[Fitted, Fitted]] | None:
    """The rig with the nearest lenses such that `holds` says yes, and what they are off by; None if there is
    none. Both lenses are of one family, and the poses stay."""
    made = []
    for family in FAMILIES:
        if not holds(_example(rig, family)):
            continue
        left = nearest(rig.left, family)
        right = nearest(rig.right, family)
        if left is None or right is None:
            continue
        fitted = StereoRig(left.camera, right.camera, rig.right_from_left)
        if holds(fitted):
            made.append((max(left.rms_px, right.rms_px), fitted, (left, right)))
    if not made:
        return None
    _, fitted, both = min(made, key=lambda item: item[0])
    return fitted, both


def _example(rig: StereoRig, family: Family) -> StereoRig:
    """The rig with lenses of the family, of no coefficient 0: what a format must hold."""
    values = np.array([family.start.get(name, _A_LITTLE) for name in family.free])
    left, right = (replace(camera, lens=family.made(values)) for camera in (rig.left, rig.right))
    return StereoRig(left, right, rig.right_from_left)


def _shown(camera: Intrinsics, columns: int, rows: int) -> tuple[Array, Array]:
    """Pixels (N, 2) over the image and their unit rays (N, 3), where the lens shows something."""
    u = np.linspace(-0.5, camera.width - 0.5, columns)
    v = np.linspace(-0.5, camera.height - 0.5, rows)
    uv = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    rays = camera.ray(uv)
    seen = np.isfinite(rays).all(axis=1)
    if not seen.any():
        raise InvalidRig("the lens shows nothing in its image")
    return uv[seen], rays[seen]


def _start(camera: Intrinsics, family: Family) -> Array:
    """First guess: the principal point and the scale on the axis stay."""
    values = np.array([family.start.get(name, 0.0) for name in family.free])
    axis = np.array([0.0, 0.0, 1.0])
    wanted = camera.jacobian(axis)
    scale = Intrinsics(camera.width, camera.height, 1.0, 1.0, 0.0, 0.0, family.made(values)).jacobian(axis)
    return np.array([wanted[0, 0] / scale[0, 0], wanted[1, 1] / scale[1, 1], camera.cx, camera.cy, *values])


def _camera(camera: Intrinsics, family: Family, values: Array) -> Intrinsics:
    fx, fy, cx, cy = (float(value) for value in values[:4])
    return Intrinsics(camera.width, camera.height, fx, fy, cx, cy, family.made(values[4:]))
