"""The smallest image with which a camera of one field of view and shape would just do, by the formulas."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rigsim.study.design.solve import Candidate, Specification
from rigsim.theory.inverse import GATES, LOWER, disparity_std_px

_SLACK = 1e-9  # of a pixel's rounding: a size that just does is not one too small


@dataclass(frozen=True, slots=True)
class LeastSize:
    """An image that leaves one baseline, and nothing for the build."""

    width_px: int
    """Image width, px."""
    height_px: int
    """Image height, px."""
    baseline_m: float
    """That baseline, m: the longest that the other requirements allow."""


def least_size(pick: Candidate, specification: Specification) -> LeastSize | None:
    """The smallest image, in the pick's field of view and shape, that meets all requirements by formula.

    With k times the pixels across the same view the focal length is k times as many pixels: what the noise
    asks of the baseline goes with 1 / k, as does what the matcher's search allows; what overlap, coverage and
    mounting allow stays. So k is the baseline that the noise asks for over the longest that those allow, with
    the noise per pixel as it is.

    Returns:
        The size; None where nothing limits the baseline, or pixels keep their pitch: fewer of them are then a
        part of the picture, not the same view.
    """
    camera, sigma_d = pick.camera, disparity_std_px(specification.noise_px)
    if camera.pitch_um is not None and not camera.sensor:
        return None
    asked = [one for one in specification.asked_of(camera) if one.kind not in GATES]
    of_noise = [one for one in asked if one.kind in LOWER and one.kind != "min_baseline"]
    fixed = [one for one in asked if one.kind not in LOWER and one.kind != "max_disparity"]
    longest_m = min((one.baseline_m(camera, sigma_d) for one in fixed), default=math.inf)
    if not math.isfinite(longest_m):
        return None
    k = max(one.baseline_m(camera, sigma_d) for one in of_noise) / longest_m
    return LeastSize(
        math.ceil(k * camera.width_px - _SLACK), math.ceil(k * camera.height_px - _SLACK), longest_m
    )
