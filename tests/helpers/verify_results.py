"""Verifications to say something about: real cases, and triangulators with known faults."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from rigsim.errors import TriangulatorError
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.study.saying import saying
from rigsim.study.verify.case import Case
from rigsim.study.verify.result import Diagnosis, TriangulatorResult, VerifyResult
from rigsim.study.verify.session import Gathered, Selection, gather, run
from rigsim.study.verify.suite import synthetic_cases
from rigsim.theory.triangulation import METHODS

Function = Callable[[StereoRig, Array, Array], Array]


def right(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return METHODS["optimal"](rig, uv_left, uv_right)


def swapped(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return METHODS["optimal"](rig, uv_right, uv_left)


def too_far(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    """One in a thousand too far: 1 m becomes 1.001 m."""
    return right(rig, uv_left, uv_right) * 1.001


def wasteful(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    """Adds noise of its own, 0.2 px where there is 0.25 px already; none to exact pixels."""
    noise = np.random.default_rng(5).normal(0, 0.2, uv_left.shape)
    return right(rig, uv_left + (noise if len(uv_left) > 500 else 0), uv_right)


def breaks_on_far(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    if rig.left.width == 1920:
        raise TriangulatorError("it broke <\x00&>")
    return right(rig, uv_left, uv_right)


@cache
def quick() -> Gathered:
    """The whole quick suite, scenes and their pictures included: made once a process."""
    return gather(Selection("quick"))


@cache
def telling() -> tuple[Case, ...]:
    """The quick suite's cases without noise, those of random rigs left out: what most mistakes show in."""
    cases = synthetic_cases("quick", 5)
    return tuple(case for case in cases if case.kind != "noisy" and not case.group.startswith("random"))


SMALL = Selection(patterns=("rectified", "verged", "far exact", "nowhere"), scenes=())
"""Eight cases in four groups."""


@cache
def result_of(*functions: Function) -> VerifyResult:
    return run(gather(SMALL), {one.__name__: one for one in functions}, SMALL, command="rigsim verify --x")


def one_of(function: Function) -> TriangulatorResult:
    return result_of(function).triangulators[0]


DIAGNOSES = (
    Diagnosis(saying("swapped-images"), 0.996, ("a", "b")),
    Diagnosis(saying("inverse-pose"), 0.7, ("b",)),
    Diagnosis(saying("degrees-for-radians: too large"), 0.5, ("c",)),
)
