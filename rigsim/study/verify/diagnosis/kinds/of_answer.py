"""Mistakes with what comes back: frames, axes, and which number means what."""

from __future__ import annotations

from collections.abc import Callable
from itertools import permutations, product

import numpy as np
from scipy.spatial.transform import Rotation

from rigsim.rig.arrays import Array
from rigsim.study.verify.diagnosis.mistake import After, Mistake
from rigsim.study.verify.diagnosis.reenact import Given, rectifying, turned, turned_back

_FRAME = "Points come back in {}, not in the left camera's: {}."


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
        "right-frame",
        _FRAME.format(
            "the right camera's frame", "map them with right_from_left's inverse, or swap the roles"
        ),
        after=lambda X, g: turned(g.R, X) + g.t,
    ),
    Mistake(
        "rig-frame",
        _FRAME.format("the rig's frame", "its origin is the middle of the baseline, its axes look halfway"),
        after=_middle,
    ),
    Mistake(
        "rig-frame",
        _FRAME.format("a frame whose origin is the middle of the baseline", "half of it is missing"),
        after=lambda X, g: X - g.centre_right / 2,
        cost=0.001,
    ),
    Mistake(
        "rig-frame",
        _FRAME.format("a frame half a baseline away", "half of it has the wrong sign"),
        after=lambda X, g: X + g.centre_right / 2,
        cost=0.002,
    ),
    Mistake(
        "rectified-frame",
        _FRAME.format("the rectified left camera's frame", "rotate them back by the transpose of R1"),
        after=lambda X, g: turned(opencv_rectified(g), X),
    ),
    Mistake(
        "rectified-frame",
        _FRAME.format("the rectified left camera's frame", "rotate them back by the transpose of R1"),
        after=lambda X, g: turned(rectifying(g), X),
        cost=0.001,
    ),
    Mistake(
        "rectified-frame",
        _FRAME.format("a rectified frame", "they were rotated back the wrong way"),
        after=lambda X, g: turned(opencv_rectified(g), turned(opencv_rectified(g), X)),
        cost=0.002,
    ),
    Mistake(
        "transformed-wrongly",
        "Points are mapped by right_from_left's inverse although they are in the left frame already.",
        after=lambda X, g: turned_back(g.R, X - g.t),
        cost=0.001,
    ),
    Mistake(
        "transformed-wrongly",
        "Points are rotated by R once too often.",
        after=lambda X, g: turned(g.R, X),
        cost=0.001,
    ),
    Mistake(
        "transformed-wrongly",
        "Points are rotated by the transpose of R once too often.",
        after=lambda X, g: turned_back(g.R, X),
        cost=0.001,
    ),
    Mistake(
        "transformed-wrongly",
        "Points are measured from the right camera's place, along the left camera's axes.",
        after=lambda X, g: X - g.centre_right,
        cost=0.001,
    ),
    Mistake(
        "transformed-wrongly",
        "t is added to points that are in the left frame already.",
        after=lambda X, g: X + g.t,
        cost=0.002,
    ),
)
"""Right points in another camera's frame."""

_AXES: dict[tuple[tuple[int, ...], tuple[int, ...]], tuple[str, str]] = {
    ((0, 1, 2), (1, -1, -1)): (
        "opengl-axes",
        "y and z have the opposite sign, as in OpenGL (y up, z backwards)",
    ),
    ((0, 1, 2), (1, -1, 1)): ("flipped-y", "y has the opposite sign: it points down here"),
    ((0, 1, 2), (-1, 1, 1)): ("flipped-x", "x has the opposite sign"),
    ((0, 1, 2), (1, 1, -1)): ("flipped-z", "z has the opposite sign: points lie behind the camera"),
    ((0, 1, 2), (-1, -1, -1)): ("negated-points", "all three coordinates have the opposite sign"),
    ((1, 0, 2), (1, 1, 1)): ("x-y-exchanged", "x and y are exchanged: row and column are mixed up"),
    ((2, 0, 1), (1, -1, -1)): ("ros-axes", "axes are forward, left, up (ROS REP 103)"),
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
            name, what = _AXES.get((order, signs), ("axes-permuted", "the axes are another convention's"))
            says = (
                f"({shown}) comes back for (x, y, z): {what}; OpenCV's axes are x right, y down, z forward."
            )
            cost = 0.0 if (order, signs) in _AXES else 0.003
            made.append(Mistake(name, says, after=_permuted(order, signs), cost=cost))
    return tuple(made)


def _with_depth(depth: Callable[[Array, Given], Array]) -> After:
    return lambda X, g: np.column_stack([X[:, :2], depth(X, g)])


def _length(X: Array) -> Array:
    return np.asarray(np.linalg.norm(X, axis=1))


def _disparity(g: Given) -> Array:
    return g.uv_left[:, 0] - g.uv_right[:, 0] + g.right.c[:, 0] - g.left.c[:, 0]


_RAY = "Depth and length of the ray are mixed up"
MEANINGS: tuple[Mistake, ...] = (
    Mistake(
        "ray-length-for-depth",
        f"{_RAY}: z is the distance to the point.",
        after=_with_depth(lambda X, g: _length(X)),
    ),
    Mistake(
        "ray-length-for-depth",
        f"{_RAY}: the point lies at the depth's distance along its ray.",
        after=lambda X, g: X * (X[:, 2] / _length(X))[:, None],
    ),
    Mistake(
        "ray-length-for-depth",
        f"{_RAY}: the ray, scaled to z = 1, is made as long as the point is far.",
        after=lambda X, g: X * (_length(X) / X[:, 2])[:, None],
    ),
    Mistake("inverse-depth", "1/z comes back for z.", after=_with_depth(lambda X, g: 1 / X[:, 2])),
    Mistake(
        "disparity-for-depth", "z is the disparity in pixels.", after=_with_depth(lambda X, g: _disparity(g))
    ),
    Mistake(
        "not-times-depth",
        "x and y are not multiplied by z: (x/z, y/z, z) comes back.",
        after=lambda X, g: np.column_stack([X[:, :2] / X[:, 2:], X[:, 2]]),
    ),
    Mistake(
        "not-times-depth",
        "(x/z, y/z, 1) comes back: the depth is lost.",
        after=lambda X, g: X / X[:, 2:],
        cost=0.001,
    ),
    Mistake(
        "not-times-depth",
        "Directions of length 1 come back: the depth is lost.",
        after=lambda X, g: X / _length(X)[:, None],
        cost=0.001,
    ),
    Mistake(
        "pixels-for-metres",
        "x and y are the left image's pixels: (u, v, z) comes back.",
        after=lambda X, g: np.column_stack([g.uv_left, X[:, 2]]),
    ),
    Mistake(
        "not-divided-by-focal",
        "x and y are not divided by the focal length.",
        after=lambda X, g: np.column_stack([X[:, :2] * g.left.f, X[:, 2]]),
    ),
    Mistake(
        "principal-point-missing",
        "x and y are made without the principal point; the depth is right.",
        after=lambda X, g: X + np.column_stack([g.left.c / g.left.f * X[:, 2:], 0 * X[:, 2]]),
    ),
    Mistake(
        "xy-from-right-pixel",
        "x and y are made of the right image's pixel and the left camera's depth.",
        after=lambda X, g: np.column_stack([g.right.normalize(g.uv_right) * X[:, 2:], X[:, 2]]),
    ),
    Mistake(
        "depth-from-right",
        "z is the depth in the right camera's frame.",
        after=_with_depth(lambda X, g: (turned(g.R, X) + g.t)[:, 2]),
    ),
    Mistake(
        "fx-for-fy",
        "y is divided by fx where fy is meant; x and the depth are right.",
        after=lambda X, g: np.column_stack([X[:, 0], X[:, 1] * g.left.f[:, 1] / g.left.f[:, 0], X[:, 2]]),
        cost=0.001,
    ),
    Mistake(
        "fy-for-fx",
        "x is divided by fy where fx is meant; y and the depth are right.",
        after=lambda X, g: np.column_stack([X[:, 0] * g.left.f[:, 0] / g.left.f[:, 1], X[:, 1:]]),
        cost=0.001,
    ),
    Mistake(
        "distortion-ignored",
        "x and y are made of the pixel as it was seen, distortion included; the depth is right.",
        after=lambda X, g: np.column_stack([(g.uv_left - g.left.c) / g.left.f * X[:, 2:], X[:, 2]]),
        cost=0.001,
    ),
    Mistake(
        "behind-in-front",
        "Points behind the cameras come back in front of them: a disparity's absolute value is taken.",
        after=lambda X, g: np.where(X[:, 2:] < 0, -X, X),
    ),
    Mistake(
        "behind-in-front",
        "The absolute value of z is taken: points behind the cameras come back in front.",
        after=lambda X, g: np.column_stack([X[:, :2], np.abs(X[:, 2])]),
        cost=0.001,
    ),
    Mistake(
        "nothing-found",
        "Nothing is ever found: every row is NaN or behind a camera.",
        after=lambda X, g: np.full_like(X, np.nan),
        cost=0.05,
    ),
)
"""Numbers that mean something else."""

ANSWER: tuple[Mistake, ...] = (*FRAMES, *_axes(), *MEANINGS)
"""All of this module."""
