"""What a lens model is: one file of this room, and a line of the registry."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields
from typing import ClassVar

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig import given
from rigsim.rig.arrays import Array, Mask


@dataclass(frozen=True, slots=True)
class Lens(ABC):
    """Where a lens shows a ray, without units: pixels are these image coordinates times fx, fy plus cx, cy.

    A model is a frozen, slotted dataclass whose fields are its coefficients, each a float. All that projects,
    triangulates, predicts, draws, reads and writes asks these methods alone. Points are camera coordinates
    (x right, y down, z forward) of any length: only their direction counts, which may be more than 90 degrees
    off the axis.
    """

    model: ClassVar[str]
    """As rig.toml calls it."""
    title: ClassVar[str]
    """As tables and sentences call it."""

    def __post_init__(self) -> None:
        for name in self.names():
            value = given.real(getattr(self, name), f"distortion {name}", InvalidRig)
            if not np.isfinite(value):
                raise InvalidRig(f"distortion {name} {value}: must be a finite number")
            object.__setattr__(self, name, value)
        fault = self.fault()
        if fault:
            raise InvalidRig(f"distortion {fault}")

    def fault(self) -> str:
        """What is wrong with the coefficients, a phrase after "distortion"; empty where nothing is."""
        return ""

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """The coefficients' names, in their order."""
        return tuple(field.name for field in fields(cls))

    @property
    def said(self) -> str:
        """The model and its coefficients in words, as ``brown with k1 -0.1, k2 0, p1 0, p2 0, k3 0``."""
        return f"{self.model} with {', '.join(f'{name} {getattr(self, name):g}' for name in self.names())}"

    @property
    def is_ideal(self) -> bool:
        """Whether it distorts nothing, and a pinhole may stand for it; a model that cannot tell says no."""
        return False

    @abstractmethod
    def sees(self, points: Array) -> Mask:
        """Whether the lens shows points (..., 3); there `project` is one to one."""

    @abstractmethod
    def project(self, points: Array) -> Array:
        """Image coordinates (..., 2) of points (..., 3); NaN where the lens shows nothing."""

    @abstractmethod
    def ray(self, image: Array) -> Array:
        """Unit rays (..., 3) of image coordinates (..., 2), to rounding; NaN where the lens shows nothing."""

    @abstractmethod
    def jacobian(self, points: Array) -> Array:
        """Derivative (..., 2, 3) of `project` with respect to the point; NaN where that is."""

    @abstractmethod
    def slopes(self, points: Array) -> Array:
        """Derivative (..., 2, p) of `project` with respect to the p coefficients, in the order of `names`."""

    def bent(self, normalized: Array) -> Array:
        """Image coordinates (..., 2) of the rays ``(x, y, 1)``, those not shown included where it can be."""
        return self.project(ahead(normalized))


def ahead(normalized: Array) -> Array:
    """The points ``(x, y, 1)`` of x/z and y/z (..., 2)."""
    points = np.empty((*normalized.shape[:-1], 3))
    points[..., :2] = normalized
    points[..., 2] = 1.0
    return points


def unit(points: Array) -> Array:
    """Unit vectors (..., 3) along points (..., 3)."""
    x, y, z = points[..., 0], points[..., 1], points[..., 2]
    return np.asarray(points / np.sqrt(x * x + y * y + z * z)[..., None])
