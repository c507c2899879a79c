"""What a triangulator answers when it is given something else than the truth; many rigs at once.

Where lines of sight no longer meet, triangulators of different kinds answer differently: hence several.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import TypeAlias

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady, are_brown, brown_of
from rigsim.rig.lens.polynomial import distort
from rigsim.rig.lens.undistortion import undistort_rows
from rigsim.rig.stereo import StereoRig
from rigsim.theory.matrices import inverse_symmetric

_STEPS = 6  # of Gauss-Newton, from a start that is nearly right


def undo(distorted: Array, bend: Array) -> Array:
    """Ideal normalised coordinates (N, 2) of distorted ones; `bend` (N, 5) as k1, k2, p1, p2, k3."""
    # rows of one lens stand together
    ends = np.flatnonzero((np.diff(bend, axis=0) != 0).any(axis=1)) + 1
    begins = np.concatenate([[0], ends]) if len(bend) else ends
    lenses = [_lens(*row) for row in bend[begins].tolist()]
    return undistort_rows(lenses, np.diff(begins, append=len(bend)).tolist(), distorted)


def bent(xy: Array, bend: Array) -> Array:
    """Distorted normalised coordinates (N, 2) of ideal ones, and `bend` as in `undo`."""
    return distort((bend[:, 0], bend[:, 1], bend[:, 2], bend[:, 3], bend[:, 4]), xy)


_lens = lru_cache(256)(BrownConrady)  # the same few lenses are asked for again and again

Undo: TypeAlias = Callable[[Array, Array], Array]
"""``(distorted (N, 2), bend (N, 5)) -> ideal (N, 2)``, normalised coordinates."""


@dataclass(frozen=True, slots=True, eq=False)
class Lenses:
    """The left or the right camera of every row."""

    f: Array
    """(fx, fy), (N, 2), px."""
    c: Array
    """(cx, cy), (N, 2), px."""
    size: Array
    """(width, height), (N, 2), px."""
    bend: Array
    """(k1, k2, p1, p2, k3), (N, 5)."""
    undo: Undo = undo
    """How distortion is undone."""

    def normalize(self, uv: Array) -> Array:
        """Ideal normalised coordinates (N, 2) of pixels (N, 2)."""
        return self.undo((uv - self.c) / self.f, self.bend)


@dataclass(frozen=True, slots=True, eq=False)
class Given:
    """What a triangulator is given: a rig and two pixels for every row."""

    left: Lenses
    """Left camera."""
    right: Lenses
    """Right camera."""
    R: Array
    """Rotation of right_from_left, (N, 3, 3)."""
    t: Array
    """Translation of right_from_left, (N, 3), m."""
    uv_left: Array
    """(N, 2) px."""
    uv_right: Array
    """(N, 2) px."""

    @property
    def centre_right(self) -> Array:
        """The right camera's place in the left one's frame, (N, 3), m."""
        return -turned_back(self.R, self.t)


def given(rigs: Sequence[StereoRig], counts: Sequence[int], uv_left: Array, uv_right: Array) -> Given:
    """Rows in order, `counts` of them for each of `rigs`."""

    def rows(values: Sequence[object]) -> Array:
        return np.repeat(np.array(values, dtype=np.float64), counts, axis=0)

    def lenses(cameras: Sequence[Intrinsics]) -> Lenses:
        return Lenses(
            rows([(camera.fx, camera.fy) for camera in cameras]),
            rows([(camera.cx, camera.cy) for camera in cameras]),
            rows([(camera.width, camera.height) for camera in cameras]),
            rows([brown_of(camera.lens, "what is reenacted").coefficients for camera in cameras]),
        )

    return Given(
        lenses([rig.left for rig in rigs]),
        lenses([rig.right for rig in rigs]),
        rows([rig.right_from_left.R for rig in rigs]),
        rows([rig.right_from_left.t for rig in rigs]),
        uv_left,
        uv_right,
    )


def reenacts(rig: StereoRig) -> bool:
    """Whether the lenses are of the one model whose mistakes are made again, or none."""
    return are_brown(rig.left.lens, rig.right.lens)


def turned(R: Array, vectors: Array) -> Array:
    """``R v``, row by row."""
    return np.asarray(np.einsum("nij,nj->ni", R, vectors))


def turned_back(R: Array, vectors: Array) -> Array:
    """``R^T v``, row by row."""
    return np.asarray(np.einsum("nji,nj->ni", R, vectors))


def rectifying(g: Given) -> Array:
    """Rotations (N, 3, 3) to the frame whose x axis is the baseline and whose z axis looks halfway."""
    forward = g.R[:, 2] + (0.0, 0.0, 1.0)
    x = unit(g.centre_right)
    y = unit(np.cross(forward, x))
    return np.stack([x, y, np.cross(x, y)], axis=1)


def unit(vectors: Array) -> Array:
    """Of length 1, row by row."""
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def solve_midpoint(g: Given, left: Array, right: Array) -> Array:
    """The middle of the shortest line between two rays."""
    ray_left, ray_right, centre = homogeneous(left), turned_back(g.R, homogeneous(right)), g.centre_right
    normal = np.cross(ray_left, ray_right)
    square = np.sum(normal**2, axis=1)
    along_left = np.sum(np.cross(centre, ray_right) * normal, axis=1) / square
    along_right = np.sum(np.cross(centre, ray_left) * normal, axis=1) / square
    return np.asarray(
        (along_left[:, None] * ray_left + centre + along_right[:, None] * ray_right) / 2,
    )


def solve_rectifying(g: Given, left: Array, right: Array) -> Array:
    """Both pictures turned until rows correspond, then B / d and the mean row."""
    turn, B = rectifying(g), np.linalg.norm(g.t, axis=1)
    a, b = turned(turn, homogeneous(left)), turned(turn, turned_back(g.R, homogeneous(right)))
    a, b = a / a[:, 2:], b / b[:, 2:]
    z = B / (a[:, 0] - b[:, 0])
    return turned_back(turn, np.column_stack([a[:, 0] * z, (a[:, 1] + b[:, 1]) / 2 * z, z]))


def solve_linear(g: Given, left: Array, right: Array) -> Array:
    """Homogeneous linear equations in normalised coordinates."""
    return _null_space(_equations(g, left, right))


def solve_linear_px(g: Given, left: Array, right: Array) -> Array:
    """Homogeneous linear equations in pixels."""
    weights = np.concatenate([g.left.f, g.right.f], axis=1)
    return _null_space(_equations(g, left, right) * weights[:, :, None])


def solve_least_squares(g: Given, left: Array, right: Array) -> Array:
    """Least squares in pixels of ideal lenses."""
    X = solve_linear(g, left, right)
    seen, f = np.concatenate([left, right], axis=1), np.concatenate([g.left.f, g.right.f], axis=1)
    for _ in range(_STEPS):
        X_right = turned(g.R, X) + g.t
        slopes, ideal = [], []
        for at, turn in ((X, np.broadcast_to(np.eye(3), g.R.shape)), (X_right, g.R)):
            xy = at[:, :2] / at[:, 2:]
            slopes.append((turn[:, :2] - xy[:, :, None] * turn[:, 2:]) / at[:, 2, None, None])
            ideal.append(xy)
        J = np.concatenate(slopes, axis=1) * f[:, :, None]
        residual = (seen - np.concatenate(ideal, axis=1)) * f
        transposed = J.transpose(0, 2, 1)
        X = X + turned(inverse_symmetric(transposed @ J) @ transposed, residual)
    return X


def homogeneous(xy: Array) -> Array:
    """(x, y, 1), (N, 3)."""
    return np.column_stack([xy, np.ones(len(xy))])


Solver: TypeAlias = Callable[[Given, Array, Array], Array]
"""``(given, left (N, 2), right (N, 2)) -> points (N, 3)``, ideal normalised coordinates; on whichever side of
the cameras."""

QUICK: Mapping[str, Solver] = MappingProxyType({"midpoint": solve_midpoint, "rectifying": solve_rectifying})
"""Triangulators in closed form."""
SOLVERS: Mapping[str, Solver] = MappingProxyType(
    {**QUICK, "linear": solve_linear, "linear px": solve_linear_px, "least squares": solve_least_squares}
)
"""All the triangulators."""


def behind(g: Given, points: Array) -> Mask:
    """Whether points (N, 3) are no answer: not finite, or behind a camera of the rig that was given."""
    right = turned(g.R, points) + g.t
    return np.asarray(~(np.isfinite(points).all(axis=1) & (points[:, 2] > 0) & (right[:, 2] > 0)))


def _equations(g: Given, left: Array, right: Array) -> Array:
    P_left = np.broadcast_to(np.eye(3, 4), (len(left), 3, 4))
    P_right = np.concatenate([g.R, g.t[:, :, None]], axis=2)
    return np.concatenate(
        [xy[:, :, None] * P[:, 2:] - P[:, :2] for xy, P in ((left, P_left), (right, P_right))], axis=1
    )


def _null_space(A: Array) -> Array:
    usable = np.isfinite(A).all(axis=(1, 2))
    X = np.full((len(A), 4), np.nan)
    X[usable] = np.linalg.svd(A[usable])[2][:, 3]
    return np.asarray(X[:, :3] / X[:, 3:])
