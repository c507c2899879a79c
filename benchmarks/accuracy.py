"""How close theory, simulation and independent solutions come; the limits stand beside the figures."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
from scipy.optimize import least_squares

from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.noise import PixelNoise
from rigsim.rig.perturbation import NAMES, Perturbation
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.theory.sensitivity import depth_sensitivity
from rigsim.theory.triangulation import triangulate
from rigsim.theory.uncertainty import (
    parallax_px,
    predict_covariance,
    predict_depth_bias,
    predict_depth_rmse,
    predict_depth_std,
)

_PLAIN = Intrinsics.from_focal(1280, 960, 800.0)
_ODD = Intrinsics(1600, 1200, 1000.0, 1100.0, 810.0, 590.0)
_LENS = BrownConrady(k1=-0.12, k2=0.03, p1=0.001, p2=-0.0015)
_TILTED = Pose.from_rotvec((0.02, -0.05, 0.03), (-0.12, 0.01, 0.02))
RIGS = {
    "rectified": StereoRig.rectified(_PLAIN, 0.12, right=replace(_PLAIN, cx=600.0)),
    "verged by 20 deg": StereoRig.verged(_PLAIN, 0.12, 20.0),
    "forward": StereoRig(_PLAIN, _PLAIN, Pose.from_rotvec((0.01, 0.02, 0.03), (0.02, 0.01, -0.3))),
    "rolled": StereoRig(_PLAIN, _PLAIN, Pose.from_rotvec((0.0, -0.02, 0.3), (-0.12, 0.0, 0.0))),
    "unequal cameras": StereoRig(_PLAIN, _ODD, _TILTED),
    "distorted": StereoRig(replace(_PLAIN, lens=_LENS), replace(_ODD, lens=_LENS), _TILTED),
}


def run() -> None:
    """Print the four tables."""
    print("optimal against least squares (scipy), sigma 0.5 px      largest, m    NaN   (limits 1e-9, 0)")
    for kind, rig in RIGS.items():
        difference, lost = ml_agreement(rig)
        print(f"  {kind:52}{difference:12.1e}{lost:7d}")

    print("sqrt(NEES/3), sigma_d/d <= 0.03                          (limit 1 +- 0.005)")
    for kind, rig in RIGS.items():
        print(f"  {kind:52}{efficiency(rig):12.4f}")

    print("predicted / simulated depth std per depth bin, sigma_d/d <= 0.05   (limit 1 +- 0.01)")
    print(f"  {'':20}{'first order':^40}second order")
    for kind, rig in RIGS.items():
        first, second = depth_bins(rig)
        print(
            f"  {kind:20}"
            + " ".join(f"{x:.4f}" for x in first)
            + "     "
            + " ".join(f"{x:.4f}" for x in second)
        )

    print("ten sensitivities against finite differences            largest relative (limit 1e-4)")
    for kind, rig in RIGS.items():
        print(f"  {kind:52}{worst_sensitivity(rig):12.1e}")


def in_view(rig: StereoRig, count: int, near_m: float, far_m: float, seed: int = 0) -> Array:
    """Points (count, 3) m that both images show, evenly spread over depth."""
    rng = np.random.default_rng(seed)
    found = np.empty((0, 3))
    while len(found) < count:
        uv = rng.uniform((0, 0), (rig.left.width - 1, rig.left.height - 1), (2 * count, 2))
        z = rng.uniform(near_m, far_m, (2 * count, 1))
        points = np.hstack([rig.left.normalize(uv) * z, z])
        points = points[rig.right.contains(rig.project(points)[1])]
        found = np.concatenate([found, points])
    return found[:count]


def ml_agreement(rig: StereoRig) -> tuple[float, int]:
    """Largest distance, m, from least squares on 300 points with 8 sigma_d of parallax; count of NaN."""
    points = in_view(rig, 2000, 1.0, 6.0)
    points = points[parallax_px(rig, points) > 8 * 0.5 * math.sqrt(2)][:300]
    uv_left, uv_right = PixelNoise(0.5).apply(*rig.project(points), np.random.default_rng(1))
    found = triangulate(rig, uv_left, uv_right)
    largest = 0.0
    for X, start, pixels in zip(found, points, np.hstack([uv_left, uv_right]), strict=True):
        solution = least_squares(
            lambda P, pixels=pixels: np.hstack(rig.project(P[None]))[0] - pixels,
            start,
            jac=lambda P: rig.jacobian(P[None])[0],
            method="lm",
            xtol=1e-15,
            ftol=1e-15,
            gtol=1e-15,
        )
        # the search stops when the cost no longer falls; two more steps use up the digits left
        P = solution.x
        for _ in range(10):
            J, residual = rig.jacobian(P[None])[0], pixels - np.hstack(rig.project(P[None]))[0]
            P = P + np.linalg.lstsq(J, residual)[0]
        largest = max(largest, float(np.abs(P - X).max()))
    return largest, int(np.isnan(found).any(axis=1).sum())


def efficiency(rig: StereoRig) -> float:
    """Square root of the normalised estimation error squared per coordinate; 1 is the Cramer-Rao bound."""
    noise = PixelNoise(0.1)
    points = in_view(rig, 200_000, 1.0, 5.0)
    points = points[parallax_px(rig, points) > noise.disparity_std_px / 0.03]
    error = triangulate(rig, *noise.apply(*rig.project(points), np.random.default_rng(2))) - points
    weighted = np.linalg.solve(predict_covariance(rig, points, noise), error[..., None])[..., 0]
    return math.sqrt(np.einsum("ni,ni->n", error, weighted).mean() / 3)


def depth_bins(rig: StereoRig) -> tuple[list[float], list[float]]:
    """Predicted over simulated depth std in five bins of depth, to first and to second order."""
    noise, trials = PixelNoise(0.25), 300
    edges = np.linspace(1.0, 5.0, 6)
    points = in_view(rig, 10_000, edges[0], edges[-1])
    std = predict_depth_std(rig, points, noise)
    points, std = points[std / points[:, 2] <= 0.05], std[std / points[:, 2] <= 0.05]
    rmse, _ = predict_depth_rmse(rig, points, noise)
    second = np.sqrt(rmse**2 - predict_depth_bias(rig, points, noise) ** 2)
    rng = np.random.default_rng(3)
    uv_left, uv_right = rig.project(points)
    depths = np.stack([triangulate(rig, *noise.apply(uv_left, uv_right, rng))[:, 2] for _ in range(trials)])
    variance = depths.var(axis=0, ddof=1)
    ratios: tuple[list[float], list[float]] = ([], [])
    for near, far in pairwise(edges):
        inside = (points[:, 2] >= near) & (points[:, 2] < far)
        if inside.sum() < 50:
            continue
        for predicted, row in zip((std, second), ratios, strict=True):
            row.append(math.sqrt((predicted[inside] ** 2).mean() / variance[inside].mean()))
    return ratios


def worst_sensitivity(rig: StereoRig) -> float:
    """Largest difference from finite differences through the triangulation, relative to the largest value."""
    points = in_view(rig, 500, 1.0, 5.0)
    predicted = depth_sensitivity(rig, points)
    worst = 0.0
    for name in NAMES:
        step = 1e-3 if name.endswith("_px") else 1e-6
        above, below = (
            triangulate(rig, *Perturbation(**{name: s}).apply(rig).project(points))[:, 2]
            for s in (step, -step)
        )
        measured = (above - below) / (2 * step)
        scale = max(float(np.abs(measured).max()), 1e-6)
        worst = max(worst, float(np.abs(predicted[name] - measured).max()) / scale)
    return worst
