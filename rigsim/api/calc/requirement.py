"""A depth error that is asked for, held against the one predicted."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from rigsim.api.kit.asked import DepthError
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig

KeptVerdict: TypeAlias = Literal["met", "not_met", "not_seen"]
"""Whether what is asked for is kept; `not_seen` where a camera does not see that distance."""


@dataclass(frozen=True, slots=True)
class Kept:
    """A requirement, and what the rig makes of it."""

    verdict: KeptVerdict
    """Whether it is kept."""
    at_mm: float
    """The distance, mm."""
    limit_mm: float
    """Largest error allowed there, mm."""
    error_mm: float
    """Predicted error: root mean square, or what 95 of 100 stay under, mm; NaN where nothing is seen."""
    p95: bool
    """Whether 95 of 100 errors are meant."""


def keeps(rig: StereoRig, noise: PixelNoise, asked: DepthError, otherwise_m: float) -> Kept:
    """Hold the predicted error on the left optical axis against the one asked for.

    Args:
        rig: the rig.
        noise: noise of every pixel coordinate.
        asked: the error; its own distance goes first.
        otherwise_m: the distance where it has none, m.
    """
    from rigsim.study.calc.sight import sight_of_point
    from rigsim.theory.inverse_error import noise_error
    from rigsim.theory.uncertainty import predict_depth_std

    at_m = otherwise_m if asked.at_m is None or math.isnan(asked.at_m) else asked.at_m
    point = np.array([0.0, 0.0, at_m])
    limit_m, error_m = asked.error_m(at_m), math.nan
    if sight_of_point(rig, point, sized=True).by_both:
        error_m = noise_error(float(predict_depth_std(rig, point[None], noise)[0]) / at_m, asked.p95) * at_m
    verdict: KeptVerdict = "not_seen" if math.isnan(error_m) else "met" if error_m <= limit_m else "not_met"
    return Kept(verdict, at_m * 1e3, limit_m * 1e3, error_m * 1e3, asked.p95)
