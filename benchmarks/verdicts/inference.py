"""`infer`: how often its 95 % intervals hold the offset, scale and noise that the data were made with.

The data are made from the law alone, without rigsim: disparities ``f B/Z + offset + noise``, depths
``(1 + scale) f B / disparity``, their mean and standard deviation at each distance. With scatter, every
distance has a noise of its own (10 % of it) and an offset of its own (.03 px).
"""

from __future__ import annotations

import time
from typing import NamedTuple

import numpy as np

from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig
from rigsim.study.infer.run import ErrorsByDistance, infer_disparity_noise

REPETITIONS = 200
COUNT = 60
"""Depths measured at each distance."""


class Case(NamedTuple):
    """One rig, its distances and what is wrong with it."""

    name: str
    fb: float
    depths: tuple[float, ...]
    offset_px: float
    scale: float
    sigma_px: float


CASES = (
    Case("no bias", 60.0, (1, 1.5, 2, 3, 4, 6, 8, 10), 0.0, 0.0, 0.1),
    Case("offset .7 px, D435", 21.2, (0.4, 0.6, 0.9, 1.3, 1.8, 2.5, 3.2, 4), -0.7, 0.0, 0.08),
    Case("far half too near", 80.3, (2, 4, 6, 9, 13, 18, 25), 3.2, 0.0, 0.1),
    Case("far half too far", 60.0, (1, 1.5, 2, 3, 4, 6, 8, 10), -2.0, 0.0, 0.1),
    Case("scale 50 %", 60.0, (1, 1.5, 2, 3, 4, 6, 8, 10), 0.0, 0.5, 0.1),
    Case("scale -20 %, offset 1 px", 60.0, (1, 2, 3, 5, 7, 10), 1.0, -0.2, 0.2),
    Case("five distances", 60.0, (1, 2, 4, 6, 9), -1.0, 0.02, 0.15),
)


def run() -> None:
    """Print the coverage of offset, scale and noise, with and without scatter of the distances."""
    print(f"95 % intervals, n {COUNT}, {REPETITIONS} repetitions: a true 95 % scatters by 1.5 points here")
    print("1.96 se: within 1.96 of the standard errors told; false: called not stereo noise")
    print(f"{'':24} {'':>7} {'worst':>5} | {'with n':^20} | {'1.96 se':^13} | {'without n':^20} |")
    print(f"{'case':24} {'scatter':>7} {'bias':>5} |", end="")
    print(" offset  scale  noise | offset  scale | offset  scale  noise | false")
    rng = np.random.default_rng(9)
    for scatter in (False, True):
        every = np.array([_line(rng, case, COUNT, scatter) for case in CASES])
        shares = "  ".join(f"{share:.1%}" for share in every.mean(axis=0))
        print(f"all cases: offset, scale, noise {shares}; single ones {every.min():.1%} to {every.max():.1%}")
    _time()


def _line(rng: np.random.Generator, case: Case, count: int, scatter: bool) -> list[float]:
    inside = np.zeros(9)
    z = np.array(case.depths, dtype=float)
    rig = StereoRig.rectified(Intrinsics.from_focal(1280, 720, case.fb / 0.1), 0.1)
    truth = (case.offset_px, case.scale, case.sigma_px)
    for _ in range(REPETITIONS):
        mean, std = _measured(rng, case, z, count, scatter)
        found = infer_disparity_noise(rig, ErrorsByDistance(z, std, mean - z, np.full(len(z), float(count))))
        bare = infer_disparity_noise(rig, ErrorsByDistance(z, std, mean - z))
        assert found.bias is not None
        assert bare.bias is not None
        inside[:3] += _held(truth, found)
        inside[3] += (
            abs(found.bias.disparity_offset_px - truth[0]) <= 1.96 * found.bias.disparity_offset_se_px
        )
        inside[4] += abs(found.bias.scale - truth[1]) <= 1.96 * found.bias.scale_se
        inside[5:8] += _held(truth, bare)
        inside[8] += found.verdict == "inconsistent"
    worst = np.abs((1 + case.scale) * case.fb / (case.fb / z + case.offset_px) / z - 1).max()
    share = inside / REPETITIONS
    shown = [f"{value:6.1%}" for value in share]
    print(
        f"{case.name:24} {'yes' if scatter else 'no':>7} {worst:5.0%} | "
        + " ".join(shown[:3])
        + f" | {' '.join(shown[3:5])} | {' '.join(shown[5:8])} | {share[8]:5.1%}",
        flush=True,
    )
    return [float(value) for value in share[:3]]


def _held(truth: tuple[float, float, float], found: object) -> list[bool]:
    from rigsim.study.infer.run import Inference

    assert isinstance(found, Inference)
    assert found.bias is not None
    intervals = (found.bias.offset_interval_px, found.bias.scale_interval, (found.low_px, found.high_px))
    return [low <= value <= high for value, (low, high) in zip(truth, intervals, strict=True)]


def _measured(
    rng: np.random.Generator, case: Case, z: np.ndarray, count: int, scatter: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Mean and standard deviation of `count` depths at each of `z`."""
    own = case.sigma_px * np.exp(0.1 * scatter * rng.standard_normal(len(z)))
    moved = case.offset_px + 0.03 * scatter * rng.standard_normal(len(z))
    disparities = case.fb / z + moved + own * rng.standard_normal((count, len(z)))
    depths = (1 + case.scale) * case.fb / disparities
    return depths.mean(axis=0), depths.std(axis=0, ddof=1)


def _time() -> None:
    case = CASES[3]
    z = np.array(case.depths, dtype=float)
    rig = StereoRig.rectified(Intrinsics.from_focal(1280, 720, case.fb / 0.1), 0.1)
    mean, std = _measured(np.random.default_rng(1), case, z, 200, True)
    begin = time.perf_counter()
    for _ in range(20):
        infer_disparity_noise(rig, ErrorsByDistance(z, std, mean - z, np.full(len(z), 200.0)))
    print(f"one inference takes {(time.perf_counter() - begin) / 20 * 1e3:.1f} ms")
