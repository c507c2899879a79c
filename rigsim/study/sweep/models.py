"""Single mistakes that have an amount: what a sweep names when it flags.

A mistake is a parameter of the true rig that the triangulation takes for another value, or something done
to its answers. The amount is the truth minus what the triangulation takes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import are_brown
from rigsim.rig.perturbation import Perturbation, with_k1
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.theory.triangulation import triangulate

Answers: TypeAlias = Callable[[float], Array]
"""Points (N, 3) m that a triangulation answers when the mistake has this amount."""


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """One mistake that has an amount."""

    name: str
    """Stable short name, as ``yaw``."""
    unit: str
    """Unit of the amount as it is said."""
    scale: float
    """Said amount for an amount of 1."""
    step: float
    """Amount small enough for a derivative."""
    answers: Answers
    """What it leads to."""
    of_answers: bool = False
    """Whether it is something done to the pixels or the answers, not a parameter of the rig."""


def models(rig: StereoRig, points_left: Array) -> Iterator[Model]:
    """Every mistake with an amount, the likelier first, for points (N, 3) m and the rig that is assumed."""
    yield from _of_answers(rig, points_left)
    for name, unit, scale, step, change in (*_BOTH, *_RIGHT, *_LEFT, *_pose(rig)):
        if not _lacks_k1(rig, name):
            yield Model(name, unit, scale, step, _rig_answers(rig, points_left, change))


_Change: TypeAlias = Callable[[StereoRig, float], StereoRig]
_Entry: TypeAlias = tuple[str, str, float, float, _Change]


def _rig_answers(rig: StereoRig, points_left: Array, change: _Change) -> Answers:
    def answers(amount: float) -> Array:
        return triangulate(rig, *change(rig, amount).project(points_left), "optimal")

    return answers


def _of_answers(rig: StereoRig, points_left: Array) -> Iterator[Model]:
    uv_left, uv_right = rig.project(points_left)

    def scaled(*axes: float) -> Answers:
        return lambda amount: points_left * (1 + amount * np.array(axes))

    yield Model(
        "disparity-offset",
        "px",
        1.0,
        1e-3,
        lambda amount: triangulate(rig, uv_left, uv_right - (amount, 0.0), "optimal"),
        of_answers=True,
    )
    for name, axes in (
        ("scale", (1.0, 1.0, 1.0)),
        ("depth-scale", (0.0, 0.0, 1.0)),
        ("lateral-scale", (1.0, 1.0, 0.0)),
    ):
        yield Model(name, "%", 100.0, 1e-5, scaled(*axes), of_answers=True)


def _lens(side: str, change: Callable[[Intrinsics, float], Intrinsics]) -> _Change:
    def changed(rig: StereoRig, amount: float) -> StereoRig:
        left = rig.left if side == "right" else change(rig.left, amount)
        right = rig.right if side == "left" else change(rig.right, amount)
        return replace(rig, left=left, right=right)

    return changed


def _k1(lens: Intrinsics, amount: float) -> Intrinsics:
    return replace(lens, lens=with_k1(lens.lens, amount))


def _lacks_k1(rig: StereoRig, name: str) -> bool:
    """Whether a mistake's `name` is of a k1 that a lens of another model does not have."""
    side = name.removesuffix("-k1")
    lenses = {"left": (rig.left,), "right": (rig.right,), "both": (rig.left, rig.right)}.get(side, ())
    return side != name and not are_brown(*(lens.lens for lens in lenses))


_CHANGES: tuple[tuple[str, str, float, float, Callable[[Intrinsics, float], Intrinsics]], ...] = (
    ("focal", "%", 100.0, 1e-6, lambda lens, a: replace(lens, fx=lens.fx * (1 + a), fy=lens.fy * (1 + a))),
    ("cx", "px", 1.0, 1e-3, lambda lens, a: replace(lens, cx=lens.cx + a)),
    ("cy", "px", 1.0, 1e-3, lambda lens, a: replace(lens, cy=lens.cy + a)),
    ("k1", "", 1.0, 1e-6, _k1),
    ("fx", "%", 100.0, 1e-6, lambda lens, a: replace(lens, fx=lens.fx * (1 + a))),
    ("fy", "%", 100.0, 1e-6, lambda lens, a: replace(lens, fy=lens.fy * (1 + a))),
)


def _of(side: str) -> tuple[_Entry, ...]:
    return tuple(
        (f"{side}-{name}", unit, scale, step, _lens(side, change))
        for name, unit, scale, step, change in _CHANGES
    )


_BOTH, _RIGHT, _LEFT = _of("both"), _of("right"), _of("left")


def _perturbed(field: str) -> _Change:
    return lambda rig, amount: Perturbation(**{field: amount}).apply(rig)


def _longer(rig: StereoRig, amount: float) -> StereoRig:
    pose = rig.right_from_left
    return replace(rig, right_from_left=Pose(pose.R, pose.t * (1 + amount)))


def _pose(rig: StereoRig) -> tuple[_Entry, ...]:
    degrees, metre_step = math.degrees(1.0), 1e-5 * rig.baseline_m
    return (
        ("baseline", "%", 100.0, 1e-6, _longer),
        ("yaw", "deg", degrees, 1e-6, _perturbed("yaw_rad")),
        ("pitch", "deg", degrees, 1e-6, _perturbed("pitch_rad")),
        ("roll", "deg", degrees, 1e-6, _perturbed("roll_rad")),
        ("axial", "mm", 1e3, metre_step, _perturbed("axial_m")),
        ("vertical", "mm", 1e3, metre_step, _perturbed("vertical_m")),
    )
