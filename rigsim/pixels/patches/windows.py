"""Square windows of the left image, and the normal equations of the patches that are fitted there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.pixels.patches.spline import REACH, Indices
from rigsim.rig.arrays import Array

RIDGE = 1e-10
"""Share of its trace that is added to the diagonal of a matrix which may be singular."""


def window_offsets(radius: int) -> tuple[Indices, Indices]:
    """Column and row offsets of a square window's pixels, each ((2 radius + 1)^2,)."""
    y, x = np.mgrid[-radius : radius + 1, -radius : radius + 1]
    return x.ravel().astype(np.intp), y.ravel().astype(np.intp)


@dataclass(frozen=True, slots=True, eq=False)
class Windows:
    """N windows of P pixels of the left image, and the normal equations of their fits."""

    padded: Array
    """The left image, mirrored by `REACH` beyond the ends of its rows."""
    uv_left: Indices
    """Middle pixels, (N, 2)."""
    rows: Indices
    """Row of each pixel, (N, P)."""
    columns: Indices
    """Column of each pixel, (N, P)."""
    x_px: Indices
    """Column offsets from the middle, (P,)."""
    y_px: Indices
    """Row offsets, (P,)."""
    radius: int
    """Half the side, px, without the middle."""
    template: Array
    """Grey levels, (N, P)."""
    gradient: Array
    """Their gradient along the row, (N, P), grey/px."""
    J: Array
    """Derivative of the grey levels by shift, stretch, shear, gain and offset, (N, 5, P)."""
    normal: Array
    """``J J^T``, (N, 5, 5)."""
    inverse: Array
    """Its inverse."""
    gradient_energy: Array
    """Mean squared gradient, (N,), grey^2/px^2."""
    grey_energy: Array
    """Variance of the grey levels, (N,), grey^2."""

    @classmethod
    def cut(cls, padded: Array, left_gradient: Array, uv_left: Indices, radius: int) -> Windows:
        """Cut them about whole pixels `uv_left` (N, 2) of an image `padded` by `REACH` along its rows."""
        x_px, y_px = window_offsets(radius)
        rows = uv_left[:, 1:] + y_px
        columns = uv_left[:, :1] + x_px
        x, y = x_px / radius, y_px / radius  # the affine parameters are px at the window's edge
        template, gradient = padded[rows, columns + REACH], left_gradient[rows, columns]
        centred = template - template.mean(axis=1, keepdims=True)
        J = np.stack([gradient, gradient * x, gradient * y, centred, np.ones_like(centred)], axis=1)
        normal = J @ J.transpose(0, 2, 1)
        # a flat patch gives a huge variance, not an exception
        normal += RIDGE * (1 + np.trace(normal, axis1=1, axis2=2)[:, None, None]) * np.eye(5)
        inverse = np.linalg.inv(normal)
        energies = np.mean(gradient**2, axis=1), np.mean(centred**2, axis=1)
        return cls(
            padded,
            uv_left,
            rows,
            columns,
            x_px,
            y_px,
            radius,
            template,
            gradient,
            J,
            normal,
            inverse,
            *energies,
        )

    @property
    def x(self) -> Array:
        """Column offsets, radii."""
        return np.asarray(self.x_px / self.radius)

    @property
    def y(self) -> Array:
        """Row offsets, radii."""
        return np.asarray(self.y_px / self.radius)
