"""Many pairs of pixels to points: each with its uncertainty, and whether its two pixels belong together.

The test: the distance of a pair from each other's epipolar line over its standard deviation, squared, is a
chi squared with one degree of freedom where the rig, the noise and the match are right. One beyond `LIMIT`
standard deviations is inconsistent, by chance `FALSE_ALARM` of all. So is one whose rays part by more than as
many standard deviations of a disparity: a point at infinity does by chance once in 2000. Mistakes along the
epipolar line leave no trace.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import NormalDist
from typing import Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.noise import PixelNoise
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.statistics import robust_rms
from rigsim.theory.epipolar import pair_gap
from rigsim.theory.triangulation import triangulate
from rigsim.theory.uncertainty import LEAST_DEPTH_SIGMAS, predict_covariance

PairsVerdict: TypeAlias = Literal["agrees", "flagged", "untold"]

FALSE_ALARM = 1e-3
"""Share of right pairs that are called inconsistent."""
LIMIT = NormalDist().inv_cdf(1 - FALSE_ALARM / 2)
"""Standard deviations beyond which a pair is inconsistent."""
FEWEST = 110
"""Pairs from which on 5 % of wrong matches would be noticed 9 times of 10."""
BEHIND, INFINITY, LENS = "behind", "infinity", "lens"
"""Why a pair has no point: its rays part, are parallel within the noise, or the lens shows nothing there."""
_ROUNDING_PX = 1e-6
_ENOUGH_TO_SCATTER = 20


@dataclass(frozen=True, slots=True, eq=False)
class PairPoints:
    """Pairs (N,) of pixels, and the points that they are of."""

    rig: StereoRig
    """The rig that saw them."""
    noise: PixelNoise
    """The noise that they have."""
    uv: Array
    """Pixels (N, 4): u and v left, u and v right, px."""
    points: Array
    """Points (N, 3) m in the left camera's frame; NaN where there is none."""
    stds: Array
    """Standard deviations (N, 3) m of their coordinates, to first order."""
    off_px: Array
    """How far each pair is from the other's epipolar line (N,), px in all; the rows' difference over sqrt(2)
    when rectified."""
    consistent: Mask
    """Whether the noise explains that (N,)."""
    why: npt.NDArray[np.str_]
    """Why there is no point (N,); empty where there is one."""

    @property
    def n_inconsistent(self) -> int:
        """Pairs that are further off than the noise explains."""
        return int((~self.consistent).sum())

    @property
    def n_points(self) -> int:
        """Pairs that have a point."""
        return int((self.why == "").sum())

    @property
    def observed_noise_px(self) -> float:
        """Noise of a coordinate by the pairs' median distance, which a minority does not move, px."""
        return robust_rms(self.off_px[np.isfinite(self.off_px)])

    @property
    def verdict(self) -> PairsVerdict:
        """``flagged`` where chance makes so many inconsistent pairs once in 1000 sets or less; ``untold``
        where there are too few to tell."""
        count = len(self.uv)
        if _chance(self.n_inconsistent, count) < FALSE_ALARM:
            return "flagged"
        return "agrees" if count >= FEWEST else "untold"


def pair_points(rig: StereoRig, uv: Array, noise: PixelNoise) -> PairPoints:
    """Triangulate pairs (N, 4) px of (u_left, v_left, u_right, v_right) to the most likely points."""
    left, right = uv[:, :2], uv[:, 2:]
    points = triangulate(rig, left, right)
    gap = pair_gap(rig, left, right, noise.covariance_px2)
    known = np.isfinite(points).all(axis=1)
    stds = np.full((len(uv), 3), np.nan)
    covariance = predict_covariance(rig, points[known], noise)
    stds[known] = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    off_px = np.abs(gap.off_px)
    why = np.full(len(uv), "", dtype="<U8")
    parallel = np.abs(gap.disparity_px) <= LIMIT * noise.disparity_std_px + _ROUNDING_PX
    why[~known] = np.where(parallel, INFINITY, BEHIND)[~known]
    why[~known & ~np.isfinite(gap.disparity_px)] = LENS
    with np.errstate(invalid="ignore"):
        close = off_px <= LIMIT * gap.off_std_px + _ROUNDING_PX
    consistent = close & (why != BEHIND) & (why != LENS)
    return PairPoints(rig, noise, uv, points, stds, off_px, consistent, why)


def pair_remarks(found: PairPoints, *, sized: bool) -> Iterator[Remark]:
    """What is odd about the pairs; images have an edge where they are `sized`."""
    count = len(found.uv)
    yield from _missing(found)
    if sized:
        outside = ~(found.rig.left.contains(found.uv[:, :2]) & found.rig.right.contains(found.uv[:, 2:]))
        if outside.any():
            yield Remark(
                "outside",
                f"{_pairs(int(outside.sum()), count)} have a pixel outside its image: another image size, or "
                "columns exchanged?",
            )
    elif count > 1 and (found.uv >= 0).all():
        yield Remark(
            "uv_origin",
            "without an image size pixels count from the optical axis, yet none is negative: give "
            "--resolution, or --principal, where they count from the first pixel",
        )
    with np.errstate(invalid="ignore"):
        noisy = int((found.points[:, 2] < LEAST_DEPTH_SIGMAS * found.stds[:, 2]).sum())
    if noisy:
        yield Remark(
            "too_noisy",
            f"{_pairs(noisy, count)} have a Z under {LEAST_DEPTH_SIGMAS:g} times its own std: the std says "
            "little there",
        )
    if found.verdict == "flagged":
        yield Remark("inconsistent", _flagged(found))


def _missing(found: PairPoints) -> Iterator[Remark]:
    reasons = {
        BEHIND: "rays that meet nowhere in front of both cameras, by more than the noise explains: wrong "
        "matches, left and right swapped, or a calibration error",
        INFINITY: "rays that are parallel within the noise: too far away to have a depth",
        LENS: "a pixel where the lens shows nothing",
    }
    for code, says in reasons.items():
        number = int((found.why == code).sum())
        if number:
            yield Remark(code, f"{_pairs(number, len(found.uv))} have no point (NaN, {code}): {says}")


def _flagged(found: PairPoints) -> str:
    says = (
        f"{_pairs(found.n_inconsistent, len(found.uv))} are inconsistent, {100 * FALSE_ALARM:g} % would be "
        "by chance: wrong matches, a calibration that is off, or more noise than that"
    )
    observed_px = found.observed_noise_px
    if math.isfinite(observed_px) and len(found.uv) >= _ENOUGH_TO_SCATTER:
        says += f"; half of all pairs scatter as {observed_px:.3g} px of noise would make them"
    return says


def _pairs(number: int, count: int) -> str:
    share = 100 * number / count
    return f"{number} of {count} pairs ({share:.{4 if share > 99 else 2}g} %)"


def _chance(number: int, count: int) -> float:
    """Probability that so many or more of `count` right pairs are called inconsistent."""
    expected = count * FALSE_ALARM
    if number > expected + 10 * math.sqrt(expected) + 10:
        return 0.0
    log_p, log_q = math.log(FALSE_ALARM), math.log1p(-FALSE_ALARM)
    fewer = (
        math.lgamma(count + 1)
        - math.lgamma(k + 1)
        - math.lgamma(count - k + 1)
        + k * log_p
        + (count - k) * log_q
        for k in range(number)
    )
    return 1 - math.fsum(map(math.exp, fewer))
