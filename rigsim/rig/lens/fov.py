"""The field-of-view model of Devernay and Faugeras ("Straight lines have to be straight", 2001)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.lens.angular import AngularLens


@dataclass(frozen=True, slots=True)
class FieldOfView(AngularLens):
    """Image radius ``atan(2 tan(t) tan(w / 2)) / w`` for a ray at an angle t off the axis; w in rad.

    0 is the ideal pinhole.

    Example:
        >>> import math, numpy as np, rigsim
        >>> lens = rigsim.FieldOfView(w=math.pi / 2)  # tan(w / 2) is 1
        >>> round(float(lens.project(np.array([0.5, 0, 1.0]))[0]), 6)  # atan(1) / (pi / 2)
        0.5
    """

    model: ClassVar[str] = "fov"
    title: ClassVar[str] = "field of view"

    w: float = 0.0

    def fault(self) -> str:
        """As `Lens.fault`."""
        if not 0 <= self.w < math.pi:
            return f"w {self.w:g} rad: must be >= 0 and below pi"
        return ""

    @property
    def is_ideal(self) -> bool:
        """As `Lens.is_ideal`."""
        return self.w == 0

    @property
    def end_rad(self) -> float:
        """As `AngularLens.end_rad`: the pinhole's 90 degrees, or all round."""
        return math.pi if self.w > 0 else math.pi / 2

    def radius(self, angle: Array) -> tuple[Array, Array]:
        """As `AngularLens.radius`."""
        sine, cosine = np.sin(angle), np.cos(angle)
        if self.w == 0:
            return sine / cosine, 1 / (cosine * cosine)
        a = 2 * math.tan(self.w / 2)
        # past 90 degrees the same arc goes on
        return (
            np.arctan2(a * sine, cosine) / self.w,
            a / (self.w * (cosine * cosine + a * a * sine * sine)),
        )

    def radius_slopes(self, angle: Array) -> Array:
        """As `AngularLens.radius_slopes`."""
        if self.w == 0:
            return np.zeros((*angle.shape, 1))
        sine, cosine = np.sin(angle), np.cos(angle)
        a = 2 * math.tan(self.w / 2)
        widened = (1 + a * a / 4) * sine * cosine / (cosine * cosine + a * a * sine * sine)
        return np.asarray((widened - self.radius(angle)[0]) / self.w)[..., None]

    def angle(self, radius: Array) -> Array:
        """As `AngularLens.angle`."""
        if self.w == 0:
            return np.arctan(radius)
        turned = radius * self.w
        return np.arctan2(np.sin(turned), 2 * math.tan(self.w / 2) * np.cos(turned))
