"""How near and how far a point can lie when its four pixel coordinates are off by a little.

The seen pixels z of a point may be off by up to r px in all: every point X with ``|project(X) - z| <= r`` is
possible, and the bounds are the least and the greatest Z among them. To first order that is Z -+ r |g|, g
being dZ by the pixel coordinates of least squares: with r the noise of one coordinate, one standard
deviation of the depth. It is the profile likelihood's interval where chi squared is 1.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.theory.matrices import inverse_symmetric

_STEPS = 40
_STILL = 1e-13
_HALVINGS = 40
_CUTS = 48
_GAINS = 16
_BEYOND = 1e6
"""Inverse depth, in those of the point, past which the nearest depth is 0."""


def extreme_depths(rig: StereoRig, points_left: Array, radius_px: npt.ArrayLike) -> tuple[Array, Array]:
    """Least and greatest depth (N,) m whose images lie within `radius_px` of those of points (N, 3).

    0 and infinity where there is no bound; NaN where a camera does not see the point.
    """
    radius = np.broadcast_to(np.asarray(radius_px, dtype=np.float64), len(points_left))
    z = points_left[:, 2]
    seen = np.all(np.isfinite(np.hstack(rig.project(points_left))), axis=1)
    near, far = (np.where(seen, z, np.nan) for _ in range(2))
    with np.errstate(all="ignore"):
        moves = seen & (radius > 0)
        for ends, sign in ((near, 1.0), (far, -1.0)):
            q = _extreme(rig, points_left[moves], radius[moves], sign)
            ends[moves] = np.where(q > 0, 1 / q, np.inf)
    return near, far


def _extreme(rig: StereoRig, points: Array, radius: Array, sign: float) -> Array:
    """Greatest (`sign` 1) or least (-1) inverse depth (N,) within the radius: infinite or 0 without bound.

    Unknowns (x/z, y/z, 1/z), in which images are almost linear: each step goes to the extreme of the
    linearised problem, an ellipsoid.
    """
    start = np.column_stack([points[:, :2] / points[:, 2:], 1 / points[:, 2]])
    unbounded = np.inf if sign > 0 else 0.0
    found, state, active = np.full(len(points), np.nan), start.copy(), np.arange(len(points))
    for _ in range(_STEPS):
        if not active.size:
            break
        now = state[active]
        residual = _images(rig, now) - _images(rig, start[active])
        moved = now + _step(rig, now, residual, radius[active], sign)
        moved = _held(rig, now, moved, sign)
        state[active] = moved
        q = moved[:, 2]
        gone = (q <= 0) if sign < 0 else (q > _BEYOND * start[active, 2])
        still = np.abs(moved - now).max(axis=1) <= _STILL * np.abs(moved).max(axis=1)
        found[active] = np.where(gone, unbounded, np.where(still, q, np.nan))
        active = active[~(gone | still)]
    # with an error of hundreds of pixels the bound may lie where a camera ceases to see: halve the interval
    for place in np.flatnonzero(np.isnan(found)):
        found[place] = _bisected(rig, start[place : place + 1], float(radius[place]), sign)
    return found


def _bisected(rig: StereoRig, start: Array, radius: float, sign: float) -> float:
    """What `_extreme` finds for one point (1, 3), by halving its depth's or inverse depth's interval."""
    inside, outside = float(start[0, 2]), float(start[0, 2]) * _BEYOND if sign > 0 else 0.0
    xy, off = _least_off(rig, start, start[:, :2], outside)
    if off <= radius:
        return np.inf if sign > 0 else 0.0
    xy = start[:, :2]
    for _ in range(_CUTS):
        q = 2 / (1 / inside + 1 / outside) if sign > 0 else (inside + outside) / 2
        moved, off = _least_off(rig, start, xy, q)
        if off <= radius:
            inside, xy = q, moved
        else:
            outside = q
    return inside


def _least_off(rig: StereoRig, start: Array, xy: Array, q: float) -> tuple[Array, float]:
    """x/z, y/z (1, 2) at inverse depth `q` whose images are nearest to those of `start`, and how near, px.

    Gauss-Newton, each step held back until it is a gain.
    """
    images = _images(rig, start)
    now = np.column_stack([xy, [q]])
    residual = _images(rig, now) - images
    off = float(np.linalg.norm(residual))
    for _ in range(_GAINS):
        J = _jacobian(rig, now)[0, :, :2]
        if not (np.isfinite(J).all() and np.isfinite(off)):
            return xy, np.inf
        step = np.linalg.lstsq(J, residual[0], rcond=None)[0]
        trials = [now - np.append(step / 2**halving, 0.0) for halving in range(_GAINS)]
        offs = np.linalg.norm(_images(rig, np.concatenate(trials)) - images, axis=1)
        best = int(np.nanargmin(np.append(offs, off)))
        if best == len(trials) or offs[best] > off * (1 - 1e-12):
            break
        now, off = trials[best], float(offs[best])
        residual = _images(rig, now) - images
    return now[:, :2], off


def _step(rig: StereoRig, now: Array, residual: Array, radius: Array, sign: float) -> Array:
    J = _jacobian(rig, now)
    transposed = J.transpose(0, 2, 1)
    inverse = inverse_symmetric(transposed @ J)
    to_best = -(inverse @ (transposed @ residual[:, :, None]))[:, :, 0]
    left_over = ((residual + (J @ to_best[:, :, None])[:, :, 0]) ** 2).sum(axis=1)
    room = np.sqrt(np.maximum(radius**2 - left_over, 0.0) / inverse[:, 2, 2])
    return np.asarray(to_best + sign * room[:, None] * inverse[:, :, 2])


def _held(rig: StereoRig, now: Array, moved: Array, sign: float) -> Array:
    """`moved`, or as much of the way from `now` as both lenses still show; the far end counts at infinity."""
    for _ in range(_HALVINGS):
        ends = moved.copy()
        if sign < 0:
            ends[:, 2] = np.maximum(ends[:, 2], 0.0)
        lost = ~np.all(np.isfinite(_images(rig, ends)), axis=1)
        if not lost.any():
            break
        moved = np.where(lost[:, None], (now + moved) / 2, moved)
    return moved


def _rays(rig: StereoRig, unknowns: Array) -> tuple[Array, Array]:
    """The points over their depth, in either camera: (N, 3) each."""
    left = np.column_stack([unknowns[:, :2], np.ones(len(unknowns))])
    return left, left @ rig.right_from_left.R.T + unknowns[:, 2:] * rig.right_from_left.t


def _images(rig: StereoRig, unknowns: Array) -> Array:
    left, right = _rays(rig, unknowns)
    return np.hstack([rig.left.project(left), rig.right.project(right)])


def _jacobian(rig: StereoRig, unknowns: Array) -> Array:
    left, right = _rays(rig, unknowns)
    J = np.zeros((len(unknowns), 4, 3))
    J[:, :2, :2] = rig.left.jacobian(left)[..., :2]
    by_point = np.column_stack([rig.right_from_left.R[:, :2], rig.right_from_left.t])
    J[:, 2:] = rig.right.jacobian(right) @ by_point
    return J
