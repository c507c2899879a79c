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
    """Where a lens shows a ray, in coordinates without units: ideal ``(x/z, y/z)`` to distorted ones.

    A model is a frozen, slotted dataclass whose fields are its coefficients, each a float. All that projects,
    triangulates, predicts, draws, reads and writes asks these methods alone.
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

    @property
    def fold_radius2(self) -> float:
        """Squared ideal radius at which the image turns back, or ends; infinite if it never does."""
        return float(np.inf)

    def shows(self, normalized: Array) -> Mask:
        """Whether the lens shows ideal coordinates (..., 2); there `distort` is one to one."""
        x, y = normalized[..., 0], normalized[..., 1]
        return np.asarray(x * x + y * y < self.fold_radius2)

    @abstractmethod
    def distort(self, normalized: Array) -> Array:
        """Map ideal (..., 2) to distorted (..., 2) coordinates."""

    @abstractmethod
    def undistort(self, distorted: Array) -> Array:
        """Invert `distort` (..., 2) to rounding; NaN where the lens shows no ideal point."""

    @abstractmethod
    def jacobian(self, normalized: Array) -> Array:
        """Derivative (..., 2, 2) of `distort` with respect to the ideal coordinates."""
