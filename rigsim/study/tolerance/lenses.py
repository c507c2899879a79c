"""The lenses of many rigs at once, each with a k1 of its own: positions (n rigs, m points), there and back.

A lens of another model than Brown-Conrady's has no k1 to differ by: all rigs have the same.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.lens.distortion import BrownConrady, brown_of
from rigsim.rig.lens.lens import Lens, ahead


class Slopes(NamedTuple):
    """Derivative of `distort`, entry by entry."""

    xx: Array
    """Seen x by ideal x."""
    yy: Array
    """Seen y by ideal y."""
    xy: Array
    """Seen x by ideal y."""
    yx: Array
    """Seen y by ideal x."""


def with_k1(lens: Lens | None, more: Array) -> tuple[Lens, Array]:
    """The lens, and the k1 (n, 1) of every rig, greater by `more`.

    Raises:
        InvalidRig: there is more, and the lens has no k1.
    """
    if lens is None or isinstance(lens, BrownConrady) or more.any():
        brown = brown_of(lens, "a change of k1")
        return brown, brown.k1 + more
    return lens, more


def distort(x: Array, y: Array, k1: Array, lens: Lens) -> tuple[Array, Array]:
    """Distorted positions; as `lens.distort`, with a k1 for every rig. NaN past the radius where it folds."""
    if not isinstance(lens, BrownConrady):
        return _other(lens, x, y)
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (lens.k2 + r2 * lens.k3))
    falls = 1 + r2 * (3 * k1 + r2 * (5 * lens.k2 + 7 * r2 * lens.k3)) <= 0
    radial[falls] = np.nan
    if lens.p1 == lens.p2 == 0.0:
        return x * radial, y * radial
    return (
        x * radial + 2 * lens.p1 * x * y + lens.p2 * (r2 + 2 * x * x),
        y * radial + lens.p1 * (r2 + 2 * y * y) + 2 * lens.p2 * x * y,
    )


def undistort(
    x: Array, y: Array, start: tuple[Array, Array], k1: Array, lens: Lens, steps: int
) -> tuple[Array, Array]:
    """Newton from `start`, which a small change of the lens has put off by little."""
    if not isinstance(lens, BrownConrady):
        rays = lens.ray(np.stack(np.broadcast_arrays(x, y), axis=-1))
        with np.errstate(all="ignore"):
            ideal = np.where(rays[..., 2:] > 0, rays[..., :2] / rays[..., 2:], np.nan)
        return ideal[..., 0], ideal[..., 1]
    ideal_x, ideal_y = start
    for _ in range(steps):
        with np.errstate(all="ignore"):
            ideal_x, ideal_y = _newton(x, y, ideal_x, ideal_y, k1, lens)
    return ideal_x, ideal_y


def _newton(
    x: Array, y: Array, ideal_x: Array, ideal_y: Array, k1: Array, lens: BrownConrady
) -> tuple[Array, Array]:
    off_x, off_y = distort(ideal_x, ideal_y, k1, lens)
    off_x, off_y = off_x - x, off_y - y
    xx, yy, xy = _brown_slopes(ideal_x, ideal_y, k1, lens)
    det = xx * yy - xy * xy
    return ideal_x - (yy * off_x - xy * off_y) / det, ideal_y - (xx * off_y - xy * off_x) / det


def slopes(x: Array, y: Array, k1: Array, lens: Lens) -> Slopes:
    """Derivative of `distort`; as `lens.jacobian`."""
    if not isinstance(lens, BrownConrady):
        J = lens.jacobian(ahead(np.stack(np.broadcast_arrays(x, y), axis=-1)))
        return Slopes(J[..., 0, 0], J[..., 1, 1], J[..., 0, 1], J[..., 1, 0])
    xx, yy, xy = _brown_slopes(x, y, k1, lens)
    return Slopes(xx, yy, xy, xy)


def _other(lens: Lens, x: Array, y: Array) -> tuple[Array, Array]:
    seen = lens.project(ahead(np.stack(np.broadcast_arrays(x, y), axis=-1)))
    return seen[..., 0], seen[..., 1]


def _brown_slopes(x: Array, y: Array, k1: Array, lens: BrownConrady) -> tuple[Array, Array, Array]:
    """The same of Brown-Conrady's, a symmetric matrix: its xx, yy and xy."""
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (lens.k2 + r2 * lens.k3))
    slope = 2 * (k1 + r2 * (2 * lens.k2 + 3 * r2 * lens.k3))
    return (
        radial + x * x * slope + 2 * lens.p1 * y + 6 * lens.p2 * x,
        radial + y * y * slope + 6 * lens.p1 * y + 2 * lens.p2 * x,
        x * y * slope + 2 * lens.p1 * x + 2 * lens.p2 * y,
    )
