"""Million points a second, and how many times those of cv2.triangulatePoints, in one process."""

from __future__ import annotations

import time
from collections.abc import Callable
from statistics import median

import cv2
import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.theory.triangulation import triangulate

REPEATS = 7
LENS = Intrinsics.from_focal(1280, 960, 800.0)
RIGS = {"rectified": StereoRig.rectified(LENS, 0.12), "verged by 20 deg": StereoRig.verged(LENS, 0.12, 20.0)}
METHODS = {"rectified": ("rectified", "optimal"), "verged by 20 deg": ("optimal",)}
SLOW = ("midpoint", "dlt")


def run() -> None:
    """Print a table for each rig and number of points; noise of 0.25 px, medians of interleaved runs."""
    for kind, rig in RIGS.items():
        for count in (100_000, 1_000_000):
            uv_left, uv_right = observations(rig, count)
            P_left, P_right = projections(rig)
            jobs: dict[str, Callable[[], object]] = {
                "cv2.triangulatePoints": lambda a=uv_left.T, b=uv_right.T, p=P_left, q=P_right: (
                    cv2.triangulatePoints(p, q, a, b)
                )
            }
            methods = METHODS[kind] + (SLOW if count == 100_000 else ())
            for method in methods:
                jobs[f"rigsim {method}"] = lambda m=method, r=rig, a=uv_left, b=uv_right: triangulate(
                    r, a, b, m
                )
            seconds = interleaved(jobs)
            print(f"{kind}, {count:,} points{'':14}Mpoints/s   x cv2 {cv2.__version__}")
            for name, taken in seconds.items():
                print(
                    f"  {name:36}{count / taken / 1e6:9.2f}   {seconds['cv2.triangulatePoints'] / taken:7.1f}"
                )


def observations(rig: StereoRig, count: int) -> tuple[Array, Array]:
    """Pixels (count, 2) of both images: points 1 to 10 m away, with noise."""
    rng = np.random.default_rng(0)
    z = rng.uniform(1.0, 10.0, count)
    points = np.column_stack([rng.uniform(-0.6, 0.6, count) * z, rng.uniform(-0.5, 0.5, count) * z, z])
    return PixelNoise(0.25).apply(*rig.project(points), rng)


def projections(rig: StereoRig) -> tuple[Array, Array]:
    """Projection matrices (3, 4) as OpenCV wants them."""
    pose = rig.right_from_left
    return rig.left.K @ np.eye(3, 4), rig.right.K @ np.column_stack([pose.R, pose.t])


def interleaved(jobs: dict[str, Callable[[], object]]) -> dict[str, float]:
    """Median seconds of each job; run in turn, so that a busy machine is busy for all of them.

    Each turn of a job has one untimed run first: none pays for what the one before left in the caches.
    """
    taken: dict[str, list[float]] = {name: [] for name in jobs}
    for _ in range(REPEATS):
        for name, job in jobs.items():
            job()
            begin = time.perf_counter()
            job()
            taken[name].append(time.perf_counter() - begin)
    return {name: median(values) for name, values in taken.items()}
