"""Mistakes with what comes back: frames, axes, and which number means what."""

from __future__ import annotations

from collections.abc import Callable
from itertools import permutations, product

import numpy as np
from scipy.spatial.transform import Rotation

from rigsim.rig.arrays import Array
from rigsim.study.saying import saying
from rigsim.study.verify.diagnosis.mistake import After, Mistake
from rigsim.study.verify.diagnosis.reenact import Given, rectifying, turned, turned_back


def _middle(points: Array, g: Given) -> Array:
    turn = Rotation.from_matrix(g.R)
    half = Rotation.from_rotvec(turn.as_rotvec() / 2).as_matrix()
    return turned(half, points - g.centre_right / 2)


def opencv_rectified(g: Given) -> Array:
    """R1 of OpenCV's stereoRectify (Bouguet): half the rotation, then the shortest turn of t to an axis."""
    half = Rotation.from_rotvec(-Rotation.from_matrix(g.R).as_rotvec() / 2)
    t = half.apply(g.t)
    sideways = np.abs(t[:, 0]) > np.abs(t[:, 1])
    axis = np.where(sideways[:, None], (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    along = np.sum(t * axis, axis=1)
    normal = np.cross(t, axis * np.where(along > 0, 1.0, -1.0)[:, None])
    length = np.linalg.norm(normal, axis=1)
    angle = np.arccos(np.clip(np.abs(along) / np.linalg.norm(t, axis=1), 0, 1))
    level = Rotation.from_rotvec(normal * (angle / np.maximum(length, 1e-300))[:, None])
    return np.asarray((level * half.inv()).as_matrix())


FRAMES: tuple[Mistake, ...] = (
    Mistake(
        saying("right-frame"),
        after=lambda X, g: turned(g.R, X) + g.t,
    ),
    Mistake(
        saying("rig-frame"),
        after=_middle,
    ),
    Mistake(
        saying("rig-frame: half missing"),
        after=lambda X, g: X - g.centre_right / 2,
        cost=0.001,
    ),
    Mistake(
        saying("rig-frame: half too much"),
        after=lambda X, g: X + g.centre_right / 2,
        cost=0.002,
    ),
    Mistake(
        saying("rectified-frame"),
        after=lambda X, g: turned(opencv_rectified(g), X),
    ),
    Mistake(
        saying("rectified-frame"),
        after=lambda X, g: turned(rectifying(g), X),
        cost=0.001,
    ),
    Mistake(
        saying("rectified-frame: wrong way"),
        after=lambda X, g: turned(opencv_rectified(g), turned(opencv_rectified(g), X)),
        cost=0.002,
    ),
    Mistake(
        saying("transformed-wrongly"),
        after=lambda X, g: turned_back(g.R, X - g.t),
        cost=0.001,
    ),
    Mistake(
        saying("transformed-wrongly: R"),
        after=lambda X, g: turned(g.R, X),
        cost=0.001,
    ),
    Mistake(
        saying("transformed-wrongly: transpose of R"),
        after=lambda X, g: turned_back(g.R, X),
        cost=0.001,
    ),
    Mistake(
        saying("transformed-wrongly: place"),
        after=lambda X, g: X - g.centre_right,
        cost=0.001,
    ),
    Mistake(
        saying("transformed-wrongly: t"),
        after=lambda X, g: X + g.t,
        cost=0.002,
    ),
)
"""Right points in another camera's frame."""

_AXES: dict[tuple[tuple[int, ...], tuple[int, ...]], str] = {
    ((0, 1, 2), (1, -1, -1)): "opengl-axes",
    ((0, 1, 2), (1, -1, 1)): "flipped-y",
    ((0, 1, 2), (-1, 1, 1)): "flipped-x",
    ((0, 1, 2), (1, 1, -1)): "flipped-z",
    ((0, 1, 2), (-1, -1, -1)): "negated-points",
    ((1, 0, 2), (1, 1, 1)): "x-y-exchanged",
    ((2, 0, 1), (1, -1, -1)): "ros-axes",
}


def _permuted(order: tuple[int, ...], signs: tuple[int, ...]) -> After:
    return lambda X, g: X[:, list(order)] * signs


def _axes() -> tuple[Mistake, ...]:
    made = []
    for order in permutations(range(3)):
        for signs in product((1, -1), repeat=3):
            if order == (0, 1, 2) and signs == (1, 1, 1):
                continue
            shown = ", ".join(
                f"{'-' if sign < 0 else ''}{'xyz'[i]}" for i, sign in zip(order, signs, strict=True)
            )
            said = saying(_AXES.get((order, signs), "axes-permuted"), axes=shown)
            cost = 0.0 if (order, signs) in _AXES else 0.003
            made.append(Mistake(said, after=_permuted(order, signs), cost=cost))
    return tuple(made)


def _with_depth(depth: Callable[[Array, Given], Array]) -> After:
    return lambda X, g: np.column_stack([X[:, :2], depth(X, g)])


def _length(X: Array) -> Array:
    return np.asarray(np.linalg.norm(X, axis=1))


def _disparity(g: Given) -> Array:
    return g.uv_left[:, 0] - g.uv_right[:, 0] + g.right.c[:, 0] - g.left.c[:, 0]


MEANINGS: tuple[Mistake, ...] = (
    Mistake(
        saying("ray-length-for-depth"),
        after=_with_depth(lambda X, g: _length(X)),
    ),
    Mistake(
        saying("ray-length-for-depth: along the ray"),
        after=lambda X, g: X * (X[:, 2] / _length(X))[:, None],
    ),
    Mistake(
        saying("ray-length-for-depth: scaled"),
        after=lambda X, g: X * (_length(X) / X[:, 2])[:, None],
    ),
    Mistake(saying("inverse-depth"), after=_with_depth(lambda X, g: 1 / X[:, 2])),
    Mistake(saying("disparity-for-depth"), after=_with_depth(lambda X, g: _disparity(g))),
    Mistake(
        saying("not-times-depth"),
        after=lambda X, g: np.column_stack([X[:, :2] / X[:, 2:], X[:, 2]]),
    ),
    Mistake(
        saying("not-times-depth: lost"),
        after=lambda X, g: X / X[:, 2:],
        cost=0.001,
    ),
    Mistake(
        saying("not-times-depth: length 1"),
        after=lambda X, g: X / _length(X)[:, None],
        cost=0.001,
    ),
    Mistake(
        saying("pixels-for-metres"),
        after=lambda X, g: np.column_stack([g.uv_left, X[:, 2]]),
    ),
    Mistake(
        saying("not-divided-by-focal"),
        after=lambda X, g: np.column_stack([X[:, :2] * g.left.f, X[:, 2]]),
    ),
    Mistake(
        saying("principal-point-missing: x and y"),
        after=lambda X, g: X + np.column_stack([g.left.c / g.left.f * X[:, 2:], 0 * X[:, 2]]),
    ),
    Mistake(
        saying("xy-from-right-pixel"),
        after=lambda X, g: np.column_stack([g.right.normalize(g.uv_right) * X[:, 2:], X[:, 2]]),
    ),
    Mistake(
        saying("depth-from-right"),
        after=_with_depth(lambda X, g: (turned(g.R, X) + g.t)[:, 2]),
    ),
    Mistake(
        saying("fx-for-fy: y alone"),
        after=lambda X, g: np.column_stack([X[:, 0], X[:, 1] * g.left.f[:, 1] / g.left.f[:, 0], X[:, 2]]),
        cost=0.001,
    ),
    Mistake(
        saying("fy-for-fx: x alone"),
        after=lambda X, g: np.column_stack([X[:, 0] * g.left.f[:, 0] / g.left.f[:, 1], X[:, 1:]]),
        cost=0.001,
    ),
    Mistake(
        saying("distortion-ignored: x and y"),
        after=lambda X, g: np.column_stack([(g.uv_left - g.left.c) / g.left.f * X[:, 2:], X[:, 2]]),
        cost=0.001,
    ),
    Mistake(
        saying("behind-in-front"),
        after=lambda X, g: np.where(X[:, 2:] < 0, -X, X),
    ),
    Mistake(
        saying("behind-in-front: z"),
        after=lambda X, g: np.column_stack([X[:, :2], np.abs(X[:, 2])]),
        cost=0.001,
    ),
    Mistake(
        saying("nothing-found: ever"),
        after=lambda X, g: np.full_like(X, np.nan),
        cost=0.05,
    ),
)
"""Numbers that mean something else."""

ANSWER: tuple[Mistake, ...] = (*FRAMES, *_axes(), *MEANINGS)
"""All of this module."""
