"""The mistakes that a diagnosis knows by name; here those with images and cameras."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.study.saying import saying
from rigsim.study.verify.diagnosis.kinds.of_answer import ANSWER
from rigsim.study.verify.diagnosis.kinds.of_distortion import DISTORTION
from rigsim.study.verify.diagnosis.kinds.of_lens import PIXELS
from rigsim.study.verify.diagnosis.kinds.of_numbers import NUMBERS
from rigsim.study.verify.diagnosis.kinds.of_pose import POSE, invert
from rigsim.study.verify.diagnosis.kinds.of_rectification import RECTIFICATION
from rigsim.study.verify.diagnosis.mistake import Mistake
from rigsim.study.verify.diagnosis.reenact import Given, Solver, homogeneous


def _swap_images(g: Given) -> Given:
    return replace(g, uv_left=g.uv_right, uv_right=g.uv_left)


def _swap_lenses(g: Given) -> Given:
    return replace(g, left=g.right, right=g.left)


CAMERAS: tuple[Mistake, ...] = (
    Mistake(
        saying("swapped-images"),
        _swap_images,
    ),
    Mistake(saying("swapped-cameras: both lenses"), lambda g: _swap_images(_swap_lenses(g))),
    Mistake(saying("swapped-cameras: lenses and pose"), lambda g: _swap_lenses(invert(g))),
    Mistake(saying("swapped-cameras: pose"), lambda g: _swap_images(invert(g))),
    Mistake(
        saying("swapped-intrinsics"),
        _swap_lenses,
    ),
    Mistake(
        saying("left-intrinsics-for-both: K alone"),
        lambda g: replace(g, right=replace(g.left, bend=g.right.bend)),
        cost=0.0015,
    ),
    Mistake(
        saying("left-intrinsics-for-both"),
        lambda g: replace(g, right=g.left),
        cost=0.0015,
    ),
    Mistake(
        saying("right-intrinsics-for-both: K alone"),
        lambda g: replace(g, left=replace(g.right, bend=g.left.bend)),
        cost=0.0015,
    ),
    Mistake(
        saying("right-intrinsics-for-both"),
        lambda g: replace(g, left=g.right),
        cost=0.0015,
    ),
    Mistake(
        saying("swapped-intrinsics: K alone"),
        lambda g: replace(
            g, left=replace(g.right, bend=g.left.bend), right=replace(g.left, bend=g.right.bend)
        ),
        cost=0.002,
    ),
)
"""Which camera is which."""


def _parallel(length: Callable[[Given], Array], doffs: bool, undistorted: bool, mean_row: bool) -> Solver:
    """Z = f B / d whatever the rig."""

    def solve(g: Given, left: Array, right: Array) -> Array:
        one, other = (
            (left, right)
            if undistorted
            else ((g.uv_left - g.left.c) / g.left.f, (g.uv_right - g.right.c) / g.right.f)
        )
        fx = g.left.f[:, 0]
        u_left = one[:, 0] * fx + g.left.c[:, 0]
        u_right = other[:, 0] * g.right.f[:, 0] + g.right.c[:, 0]
        offset = g.right.c[:, 0] - g.left.c[:, 0] if doffs else 0.0
        z = fx * length(g) / (u_left - u_right + offset)
        y = (one[:, 1] + other[:, 1]) / 2 if mean_row else one[:, 1]
        return homogeneous(np.column_stack([one[:, 0], y])) * z[:, None]

    return solve


def _length(g: Given) -> Array:
    return np.asarray(np.linalg.norm(g.t, axis=1))


def _length_x(g: Given) -> Array:
    return -g.t[:, 0]


def _length_abs_x(g: Given) -> Array:
    return np.abs(g.t[:, 0])


PARALLEL: tuple[Mistake, ...] = tuple(
    Mistake(
        saying("treated-as-rectified" if doffs else "treated-as-rectified: no doffs"),
        solver=_parallel(length, doffs, undistorted, mean_row),
        cost=0.003,
    )
    for length in (_length, _length_x, _length_abs_x)
    for doffs in (True, False)
    for undistorted in (True, False)
    for mean_row in (True, False)
)
"""The formula of rectified rigs where it does not hold."""

LIBRARY: tuple[Mistake, ...] = (
    *CAMERAS,
    *POSE,
    *PIXELS,
    *NUMBERS,
    *DISTORTION,
    *ANSWER,
    *PARALLEL,
    *RECTIFICATION,
)
"""All mistakes that need no fit, the likelier first."""
