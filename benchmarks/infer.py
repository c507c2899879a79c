"""How often the interval of `rigsim infer` holds the disparity noise that the data were made with."""

from __future__ import annotations

import math
import time

import numpy as np

from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.study.infer.run import ErrorsByDistance, infer_disparity_noise
from rigsim.theory.triangulation import triangulate

REPETITIONS = 2000
RIG = StereoRig.rectified(Intrinsics.from_focal(1280, 720, 900.0), 0.12)
DEPTHS_M = np.array([0.8, 1.2, 2.0, 2.8, 3.5, 4.0])


def run() -> None:
    """Print the coverage by counts and by fit for several noises and sample sizes, and the time of one."""
    print("f 900 px, B 120 mm, Z 0.8 to 4 m at 6 distances; noisy pixels triangulated; 95 % intervals")
    print(f"{'sigma_d px':>10} {'n':>5} {'by n':>8} {'by fit':>8} {'called not stereo':>18} {'ms each':>8}")
    rng = np.random.default_rng(1)
    for sigma_px in (0.05, 0.2, 0.5):
        for count in (10, 60):
            print(_line(rng, sigma_px, count))


def _line(rng: np.random.Generator, sigma_px: float, count: int) -> str:
    noise = PixelNoise(sigma_px / math.sqrt(2))
    shape = (len(DEPTHS_M), REPETITIONS, count)
    points = np.zeros((math.prod(shape), 3))
    points[:, 2] = np.repeat(DEPTHS_M, REPETITIONS * count)
    depths = triangulate(RIG, *noise.apply(*RIG.project(points), rng))[:, 2]
    stds = depths.reshape(shape).std(axis=2, ddof=1)
    counts = np.full(len(DEPTHS_M), float(count))
    by_counts = by_fit = wrong = 0
    begin = time.perf_counter()
    for i in range(REPETITIONS):
        told = infer_disparity_noise(RIG, ErrorsByDistance(DEPTHS_M, stds[:, i], counts=counts))
        untold = infer_disparity_noise(RIG, ErrorsByDistance(DEPTHS_M, stds[:, i]))
        by_counts += told.low_px <= sigma_px <= told.high_px
        by_fit += untold.low_px <= sigma_px <= untold.high_px
        wrong += untold.verdict == "inconsistent"
    each_ms = (time.perf_counter() - begin) / REPETITIONS / 2 * 1e3
    shares = (by_counts / REPETITIONS, by_fit / REPETITIONS, wrong / REPETITIONS)
    return f"{sigma_px:10g} {count:5d} {shares[0]:8.1%} {shares[1]:8.1%} {shares[2]:18.1%} {each_ms:8.2f}"
