"""Ten thousand built rigs: seconds, memory, first order against simulation, recalibration against SciPy."""

from __future__ import annotations

import resource
import time
from dataclasses import replace

import numpy as np
from scipy.optimize import least_squares

from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.perturbation import NAMES, Perturbation
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance.recalibration.compensator import Compensator
from rigsim.study.tolerance.run import Build, Recalibration, draw, make_compensator, run_tolerance
from rigsim.study.tolerance.sensitivities import CLASSES, BuildRequirement, causes
from rigsim.theory.triangulation import triangulate

_LENS = Intrinsics.from_focal(1280, 720, 900.0)
_BENT = replace(_LENS, lens=BrownConrady(k1=-0.12, k2=0.03, p1=0.001, p2=-0.0015))
RIGS = {
    "rectified": StereoRig.rectified(_LENS, 0.12),
    "verged by 10 deg": StereoRig.verged(_LENS, 0.12, 10.0),
    "distorted": StereoRig.rectified(_BENT, 0.12),
}
RANGE_M = (1.0, 5.0)
REQUIRED = BuildRequirement(0.04, 3.0)
_REFERENCES = 10


def run() -> None:
    """Print the tables; memory is the process's highest so far."""
    print(
        "10,000 rigs x 501 points, calibrated      s   MB   with recalibration, s   MB   (limits 10 s, 1 GB)"
    )
    for kind, rig in RIGS.items():
        plain_s = timed(rig, None)
        plain_mb = peak_mb()
        full_s = timed(rig, Recalibration())
        print(f"  {kind:34}{plain_s:9.2f}{plain_mb:5.0f}{full_s:18.2f}{peak_mb():12.0f}")

    print("first order / simulated rms at 1, 3, 5 m, calibrated                      (limit 1 +- 0.02)")
    for kind, rig in RIGS.items():
        result = run_tolerance(Build(rig, CLASSES["calibrated"].tolerances(rig)), REQUIRED, RANGE_M)
        print(f"  {kind:34}" + " ".join(f"{d.first_order_mm / d.rms_mm:9.4f}" for d in result.depths))

    print("sum of squares after recalibration, largest relative difference to scipy  (limit 1e-6)")
    for kind, rig in RIGS.items():
        print(f"  {kind:34}{worst_reference(rig):10.1e}")


def timed(rig: StereoRig, recalibration: Recalibration | None) -> float:
    begin = time.perf_counter()
    tolerances = CLASSES["calibrated"].tolerances(rig)
    run_tolerance(Build(rig, tolerances, recalibration=recalibration), REQUIRED, RANGE_M)
    return time.perf_counter() - begin


def peak_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3


def worst_reference(rig: StereoRig) -> float:
    rng = np.random.default_rng(0)
    off = causes(rig, CLASSES["machined"].tolerances(rig))
    compensator = make_compensator(rig, off, Recalibration(), RANGE_M, informed=True)
    thetas = draw(off, _REFERENCES, rng) * off.std @ off.effect
    pixels, lengths_m = compensator.observe(thetas, rng)
    found = compensator.solve(pixels, lengths_m)
    ours = (compensator.residuals(pixels, lengths_m, found) ** 2).sum(axis=1)
    worst = 0.0
    for i in range(_REFERENCES):

        def residuals(scaled: Array, i: int = i) -> Array:
            return single_residuals(compensator, pixels[:, i], lengths_m[i], scaled * compensator.std)

        best = least_squares(residuals, np.zeros(12), jac="3-point", xtol=1e-15, ftol=1e-15, gtol=1e-15)
        worst = max(worst, abs(ours[i] / (2 * best.cost) - 1))
    return worst


def single_residuals(compensator: Compensator, pixels: Array, known_m: Array, theta: Array) -> Array:
    """The residuals of one rig, by its own pose, lenses and optimal triangulation."""
    rig = built(compensator.rig, theta)
    left = np.column_stack([rig.left.normalize(pixels[:2].T), np.ones(pixels.shape[1])])
    right = np.column_stack([rig.right.normalize(pixels[2:].T), np.ones(pixels.shape[1])])
    R, t = rig.right_from_left.R, rig.right_from_left.t
    lines_right, lines_left = np.cross(t, left @ R.T), np.cross(right, t) @ R
    slopes = np.hstack(
        [lines_left[:, :2] / (rig.left.fx, rig.left.fy), lines_right[:, :2] / (rig.right.fx, rig.right.fy)]
    )
    epipolar = (right * lines_right).sum(axis=1) / np.linalg.norm(slopes, axis=1)
    features = len(compensator.features_left)
    marks = triangulate(rig, pixels[:2, features:].T, pixels[2:, features:].T)
    found_m = np.linalg.norm(marks[1::2] - marks[::2], axis=1)
    length = known_m * (1 - known_m / found_m) / length_sigma_m(compensator)
    return np.concatenate([epipolar[:features] / compensator.noise_px, length, theta / compensator.std])


def built(rig: StereoRig, theta: Array) -> StereoRig:
    """The rig that is off by `theta` (12,)."""
    moved = Perturbation(**dict(zip(NAMES, map(float, theta), strict=False))).apply(rig)
    right_cy_px, both_focal_px = map(float, theta[len(NAMES) :])
    longer = both_focal_px / rig.left.fx
    left, right = (
        replace(lens, fx=lens.fx + longer * before.fx, fy=lens.fy + longer * before.fy)
        for lens, before in ((moved.left, rig.left), (moved.right, rig.right))
    )
    return StereoRig(left, replace(right, cy=right.cy + right_cy_px), moved.right_from_left)


def length_sigma_m(compensator: Compensator) -> Array:
    """Standard deviations of the known lengths as seen, by finite differences."""
    rig = compensator.rig
    pixels = np.hstack(rig.project(compensator.marks_left))
    variance = np.full(len(pixels) // 2, compensator.length_std_m**2)
    for place in np.ndindex(*pixels.shape):
        lengths = []
        for step in (1e-3, -1e-3):
            moved = pixels.copy()
            moved[place] += step
            found = triangulate(rig, moved[:, :2], moved[:, 2:])
            lengths.append(np.linalg.norm(found[1::2] - found[::2], axis=1))
        variance += ((lengths[0] - lengths[1]) / 2e-3 * compensator.noise_px) ** 2
    return np.asarray(np.sqrt(variance))
