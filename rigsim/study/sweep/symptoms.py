"""A triangulator that a sweep asks again, and what its answers show at sight."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.study.agreement.fault import Fault
from rigsim.study.agreement.views import views
from rigsim.study.saying import Saying, saying
from rigsim.study.scene.plan import Triangulator
from rigsim.theory.triangulation import triangulate
from rigsim.theory.uncertainty import predict_covariance

TRIALS = 30
"""How often a triangulator is asked with noise, or one that answers differently each time."""

_MOST_POINTS = 400
_SEED = 20_240_229
_LEAST_NOISE_PX = 1e-3  # exact pixels have no scatter to weigh errors by
_LOST = 1e-3
_AT_INFINITY = 1e-6  # of the true 1/Z
_LIFT_PX, _FAR_M, _MOST = 10.0, 1e6, 0.9
_SPREAD = 0.05
_ONE_IMAGE = 1.3  # sqrt(2) with equal lenses
_IMPURE = 0.03


@dataclass(frozen=True, slots=True, eq=False)
class AskedPoints:
    """Some points, and how errors of their views are weighed."""

    rig: StereoRig
    """The rig that is assumed."""
    points_left: Array
    """True points, (N, 3), m."""
    whitening: Array
    """(N, 3, 3): makes errors of the views of one trial white."""
    method: Triangulator
    """What is asked."""

    def __getitem__(self, rows: Mask) -> AskedPoints:
        """Some of the points."""
        return AskedPoints(self.rig, self.points_left[rows], self.whitening[rows], self.method)

    def answer(self, rig: StereoRig) -> Array:
        """What the triangulator makes of the pixels that `rig` sees, without noise."""
        return triangulate(self.rig, *rig.project(self.points_left), self.method)

    def size(self, found_left: Array) -> Array:
        """Size (N,) of the errors in standard deviations of one trial; NaN where nothing was found."""
        error = views(found_left) - views(self.points_left)
        return np.asarray(np.linalg.norm(np.einsum("nij,nj->ni", self.whitening, error), axis=1))


def ask(rig: StereoRig, points_left: Array, noise: PixelNoise, method: Triangulator) -> AskedPoints:
    """At most `_MOST_POINTS` of the points (N, 3) m, in the order they have."""
    uv = np.hstack(rig.project(points_left))
    points = points_left[np.isfinite(uv).all(axis=1)]
    points = (
        points[np.unique(np.linspace(0, len(points) - 1, _MOST_POINTS).astype(int))]
        if len(points)
        else points
    )
    weighed = noise if noise.std_px > _LEAST_NOISE_PX else PixelNoise(_LEAST_NOISE_PX)
    x, y, z = points.T
    to_views = np.zeros((len(points), 3, 3))
    to_views[:, 0, 2] = -1 / z**2
    to_views[:, 1, 0] = to_views[:, 2, 1] = 1 / z
    to_views[:, 1, 2], to_views[:, 2, 2] = -x / z**2, -y / z**2
    covariance = to_views @ predict_covariance(rig, points, weighed) @ to_views.transpose(0, 2, 1)
    known = np.isfinite(covariance).all(axis=(1, 2))
    whitening = np.linalg.inv(np.linalg.cholesky(covariance[known]))
    return AskedPoints(rig, points[known], whitening, method)


def flat(found: Array) -> Fault | None:
    """Coordinates that are zero or the same in every row."""
    known = found[np.isfinite(found).all(axis=1)]
    same = [axis for i, axis in enumerate("XYZ") if np.ptp(known[:, i]) <= 1e-12 * np.abs(known).max()]
    if not same:
        return None
    zero = not known[:, ["XYZ".index(axis) for axis in same]].any()
    return Fault("constant-coordinates", saying("constant-coordinates", axes=tuple(same), zero=zero))


def without_disparity(asked: AskedPoints, found: Array) -> Fault | None:
    """Of answers at infinity: whether the depth follows the rows instead of the columns."""
    inverse = views(found)[:, 0] / views(asked.points_left)[:, 0]
    if not np.nanmedian(np.where(np.isfinite(inverse), np.abs(inverse), 0.0)) < _AT_INFINITY:
        return None
    uv_left, uv_right = asked.rig.project(asked.points_left)

    def is_answered(*move_px: float) -> bool:
        moved = triangulate(asked.rig, uv_left, uv_right + move_px, asked.method)
        near = np.isfinite(moved).all(axis=1) & (np.abs(moved[:, 2]) < _FAR_M)
        return float(near.mean()) >= _MOST

    if is_answered(0.0, -_LIFT_PX):
        return Fault("row-column-exchanged", saying("depth-by-rows"))
    # where the disparity is taken with the other sign, it is right again once it is turned over
    if is_answered(2 * float(np.abs(uv_left - uv_right).max()), 0.0):
        return None
    return Fault("no-disparity", saying("no-disparity"))


def where(asked: AskedPoints, off: Mask) -> Saying | None:
    """In which part of the image or of the depth the wrong rows lie; None when in none."""
    uv_left, _ = asked.rig.project(asked.points_left)
    lens = asked.rig.left
    candidates: tuple[tuple[str, Array, float, float], ...] = (
        ("u", uv_left[:, 0], -0.5, lens.width - 0.5),
        ("v", uv_left[:, 1], -0.5, lens.height - 0.5),
        ("Z", asked.points_left[:, 2], 0.0, math.inf),
    )
    told: list[tuple[float, str, Saying]] = []
    for name, values, least, most in candidates:
        low, high = float(values[off].min()), float(values[off].max())
        outside = values[~off]
        impure = float(((outside >= low) & (outside <= high)).mean())
        if impure > _IMPURE:
            continue
        ends_low, ends_high = not (outside < low).any(), not (outside > high).any()
        low, high = max(low, least), min(high, most)
        span = "below" if ends_low else "above" if ends_high else "between"
        told.append((impure, name, saying(f"points: {span}", of=name, low=low, high=high)))
    return min(told, key=lambda one: one[:2])[2] if told else None


def scatter(asked: AskedPoints, noise: PixelNoise) -> Fault | None:
    """Whether the errors under noise are as wide as the noise makes them, and whether points are lost."""
    if not noise.std_px:
        return None
    rng = np.random.default_rng(_SEED)
    uv_left, uv_right = (
        np.broadcast_to(uv, (TRIALS, *uv.shape)) for uv in asked.rig.project(asked.points_left)
    )
    noisy_left, noisy_right = noise.apply(uv_left, uv_right, rng)
    found = triangulate(asked.rig, noisy_left.reshape(-1, 2), noisy_right.reshape(-1, 2), asked.method)
    lost = float((~np.isfinite(found).all(axis=1)).mean())
    if lost > _LOST:
        return Fault("lost-points", saying("lost-points: with noise", share=lost))
    seen = views(found).reshape(TRIALS, -1, 3)
    error = seen - np.nanmean(seen, axis=0)
    covariance = np.linalg.inv(asked.whitening.transpose(0, 2, 1) @ asked.whitening)
    std = np.sqrt(np.einsum("nii->ni", covariance) * (1 - 1 / TRIALS))
    depth, column, row = (float(np.nanmedian(np.abs(error[..., i]) / std[:, i])) / 0.6745 for i in range(3))
    widest = max(depth, column, row)
    narrowest = min(depth, column, row)
    times = math.sqrt((depth**2 + column**2 + row**2) / 3)
    if max(widest - 1, 1 - narrowest) <= _SPREAD:
        return None
    if abs(depth - 1) <= _SPREAD and abs(column - 1) <= _SPREAD:
        if row < 1:
            return Fault("too-little-scatter", saying("scatter-of-Y", times=row), row)
        form = "scatter-of-Y: one image" if row > _ONE_IMAGE else "scatter-of-Y: a part"
        return Fault("rows-wasted", saying(form, times=row), row)
    name = "too-little-scatter" if times < 1 else "too-much-scatter"
    as_px = times * noise.std_px
    return Fault(name, saying(name, times=times, noise_px=noise.std_px, as_px=as_px), times)
