"""Patches against the matching bound, cv2's Lucas-Kanade, and the truth of rendered scenes."""

from __future__ import annotations

import time
from statistics import median

import cv2
import numpy as np

from rigsim.errors import MeasurementFailed
from rigsim.pixels.patches.patches import match_patches
from rigsim.pixels.patches.refine import fit_patches
from rigsim.pixels.patches.spline import RowSpline
from rigsim.pixels.patches.trust import predicted_std
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.presets import preset
from rigsim.rig.stereo import StereoRig

RADIUS = 7
PHASES = np.arange(10) / 10
SCENES = ("boards", "branch", "artifact", "corridor", "bin")


def run() -> None:
    """Print the five tables."""
    _claims()
    _bound()
    _bias()
    _scenes()
    _speed()


def texture_pair(
    size: tuple[int, int], disparity: float, highest: float, seed: int, slant: float = 0.0
) -> tuple[Array, Array, Array]:
    """Left image, right image and the left one's derivative along the row, by formula.

    Random plane waves up to `highest` cycles/px of 40 grey rms; the disparity grows by `slant` a px.
    """
    width, height = size
    rng = np.random.default_rng(seed)
    waves = 400
    frequency = 2 * np.pi * np.sqrt(rng.uniform(0.01**2, highest**2, waves))
    angle, phase = rng.uniform(0, np.pi, waves), rng.uniform(0, 2 * np.pi, waves)
    fx, fy = frequency * np.cos(angle), frequency * np.sin(angle)
    amplitude = 40 * np.sqrt(2 / waves)
    v = np.arange(height)[:, None] * fy + phase

    def wave(u: Array) -> tuple[Array, Array]:
        across = u[:, None] * fx
        cosine, sine = np.cos(v) @ np.cos(across).T, np.sin(v) @ np.sin(across).T
        slope = (fx * np.cos(v)) @ np.sin(across).T + (fx * np.sin(v)) @ np.cos(across).T
        return 128 + amplitude * (cosine - sine), -amplitude * slope

    u = np.arange(width, dtype=np.float64)
    left, derivative = wave(u)
    return left, wave((u + disparity) / (1 - slant))[0], derivative


def _claims() -> None:
    rig = StereoRig.rectified(Intrinsics.from_focal(320, 240, 300.0), 0.1)
    print(
        "claimed over actual RMS error of matches, plane waves, five phases of a pixel   (0.8 to 1.25)\n"
        "  highest   contrast  noise  trusted    rms      largest mean   claimed   within 3\n"
        "  cyc/px    grey      grey   share      px       of a phase     / actual  std"
    )
    for highest in (0.05, 0.15, 0.25, 0.35, 0.42, 0.48):
        for contrast, noise in ((50.0, 0.5), (50.0, 5.0), (20.0, 2.0), (10.0, 2.0), (5.0, 2.0), (2.5, 2.0)):
            errors, claims, shares = [], [], []
            for k, phase in enumerate(np.arange(5) / 5):
                rng = np.random.default_rng(k)
                pair = texture_pair((320, 240), 12 + phase, highest, k)[:2]
                left, right = (
                    128 + (image - 128) * contrast / 40 + noise * rng.standard_normal(image.shape)
                    for image in pair
                )
                try:
                    found = match_patches(left, right, rig, disparity_range=(0.0, 40.0))
                except MeasurementFailed:
                    continue
                valid = found.observations.valid
                errors.append(found.disparity[valid] - 12 - phase)
                claims.append(found.disparity_std_px[valid])
                shares.append(valid.mean())
            print(f"  {highest:6.2f} {contrast:9.1f} {noise:8.1f}", end="")
            if not errors:
                print("    refused")
                continue
            error, claim = np.concatenate(errors), np.concatenate(claims)
            rms = float(np.sqrt(np.mean(error**2)))
            print(
                f" {np.mean(shares):8.2f} {rms:10.4f} {max(abs(e.mean()) for e in errors):12.4f} "
                f"{np.sqrt(np.mean(claim**2)) / rms:12.2f} {np.mean(np.abs(error) < 3 * claim):9.3f}",
                flush=True,
            )


def _bound() -> None:
    print(
        "rms disparity error as a multiple of a bound, 15 px windows, plane waves, ten phases of a pixel\n"
        "  highest  noise    rms      shift bound   5-parameter bound   cv2 PyrLK   rms / predicted std\n"
        "  cyc/px   grey     px       (limit 1.2)                       / shift bound"
    )
    rng = np.random.default_rng(1)
    u, v = np.meshgrid(np.arange(60, 460, 16), np.arange(20, 280, 16))
    uv = np.stack([u.ravel(), v.ravel()], axis=1)
    y, x = (a.ravel() for a in np.mgrid[-RADIUS : RADIUS + 1, -RADIUS : RADIUS + 1])
    for highest in (0.15, 0.25, 0.35):
        for noise in (0.5, 2.0, 5.0):
            rows = []
            for k, phase in enumerate(PHASES):
                left0, right0, slope = texture_pair((500, 300), 20 + phase, highest, k)
                left, right = (image + noise * rng.standard_normal(image.shape) for image in (left0, right0))
                gradient = RowSpline.through(left).derivative()
                start = np.full(len(uv), 20.0)
                fits = fit_patches(left, gradient, RowSpline.through(right), uv, start, radius=RADIUS)
                error = fits.disparity - 20 - phase
                shift_bound = _shift_bound(slope, uv, x, y, noise)
                full_bound = _full_bound(left0, slope, fits.uv_left, uv, x, y, noise)
                flow = _lucas_kanade(left, right, uv) - 20 - phase
                std, _ = predicted_std(fits, noise**2)
                rows.append([error, error / shift_bound, error / full_bound, flow / shift_bound, error / std])
            rms = np.sqrt(np.mean(np.square(rows), axis=(0, 2)))
            print(f"  {highest:5.2f} {noise:7.1f} {rms[0]:10.4f} {rms[1]:11.3f} {rms[2]:18.3f}", end="")
            print(f"{rms[3]:16.2f} {rms[4]:18.3f}")


def _bias() -> None:
    print("largest mean error over the phase of a pixel, no noise, px (limit 0.01)")
    u, v = np.meshgrid(np.arange(60, 460, 16), np.arange(20, 280, 16))
    uv = np.stack([u.ravel(), v.ravel()], axis=1)
    for highest in (0.15, 0.25, 0.35):
        means, flows = [], []
        for phase in PHASES:
            left, right, _ = texture_pair((500, 300), 20 + phase, highest, 3)
            gradient = RowSpline.through(left).derivative()
            start = np.full(len(uv), 20.0)
            fits = fit_patches(left, gradient, RowSpline.through(right), uv, start, radius=RADIUS)
            means.append(float(np.mean(fits.disparity - 20 - phase)))
            flows.append(float(np.mean(_lucas_kanade(left, right, uv) - 20 - phase)))
        largest, largest_flow = np.abs(means).max(), np.abs(flows).max()
        print(f"  up to {highest:.2f} cycles/px {largest:8.5f}   cv2 PyrLK {largest_flow:8.5f}")


def _scenes() -> None:
    from rigsim.sim.simulator import Simulator

    print(
        "rendered scenes at their presets' rigs, 2000 points, supersample 2, 8 bit, points both cameras see\n"
        "  scene      noise   trusted   within 3 std      rms / predicted     median error\n"
        "             grey                limit 90 %         clipped at 6"
    )
    for name in SCENES:
        rig = preset(name).rig
        with Simulator(name) as simulator:
            simulator.place(rig)
            frame = simulator.render(supersample=2)
            truth = simulator.true_disparity(frame)
        for noise in (0.0, 2.0):
            rng = np.random.default_rng(0)
            left, right = (
                np.clip(
                    np.rint(255 * view.light.mean(axis=2) + noise * rng.standard_normal(truth.shape)), 0, 255
                )
                for view in (frame.left, frame.right)
            )
            matches = match_patches(left.astype(np.uint8), right.astype(np.uint8), rig)
            valid = matches.observations.valid
            at = matches.observations.uv_left[valid].astype(int)
            error = matches.disparity[valid] - truth[at[:, 1], at[:, 0]]
            seen = np.isfinite(error)
            scaled = np.abs(error / matches.disparity_std_px[valid])[seen]
            clipped = float(np.sqrt(np.mean(np.minimum(scaled, 6) ** 2)))
            print(
                f"  {name:10} {noise:5.1f} {int(seen.sum()):9} {100 * np.mean(scaled < 3):12.1f} % "
                f"{clipped:20.2f} {np.median(np.abs(error[seen])):24.4f} px"
            )


def _speed() -> None:
    left, right, _ = texture_pair((1280, 960), 40.3, 0.2, 1, slant=0.05)
    rig = StereoRig.rectified(Intrinsics.from_focal(1280, 960, 1000.0), 0.1)
    for what, disparities in (("whole rows", None), ("disparities 0 to 128", (0.0, 128.0))):
        times = []
        for _ in range(5):
            begin = time.perf_counter()
            matches = match_patches(left, right, rig, disparity_range=disparities)
            times.append(time.perf_counter() - begin)
        print(
            f"{matches.n_valid} of 2000 points matched on 1280 x 960 px, searching {what}: "
            f"{median(times):.2f} s (limit about 1)"
        )


def _shift_bound(slope: Array, uv: np.ndarray, x: np.ndarray, y: np.ndarray, noise: float) -> Array:
    """Robinson & Milanfar's bound when nothing but the shift is unknown."""
    g = slope[uv[:, 1, None] + y, uv[:, 0, None] + x]
    return np.asarray(np.sqrt(2) * noise / np.sqrt(np.sum(g**2, axis=1)))


def _full_bound(
    image: Array, slope: Array, at: Array, uv: np.ndarray, x: np.ndarray, y: np.ndarray, noise: float
) -> Array:
    """The same when stretch, shear, gain and offset are unknown too, at the pixels reported."""
    g, t = (a[uv[:, 1, None] + y, uv[:, 0, None] + x] for a in (slope, image))
    J = np.stack([g, g * x, g * y, t - t.mean(axis=1, keepdims=True), np.ones_like(t)], axis=1)
    inverse = np.linalg.inv(J @ J.transpose(0, 2, 1))[:, :3, :3]
    where = np.concatenate([np.ones((len(uv), 1)), at - uv], axis=1)
    return np.asarray(np.sqrt(2) * noise * np.sqrt(np.einsum("ni,nij,nj->n", where, inverse, where)))


def _lucas_kanade(left: Array, right: Array, uv: np.ndarray) -> Array:
    """Disparity by cv2's pyramidal Lucas-Kanade, started where it ends."""
    eight_bit = [np.clip(np.rint(image), 0, 255).astype(np.uint8) for image in (left, right)]
    points = uv.astype(np.float32)[:, None]
    start = points - np.array([20, 0], np.float32)
    found, _, _ = cv2.calcOpticalFlowPyrLK(
        *eight_bit,
        points,
        start,
        winSize=(2 * RADIUS + 1, 2 * RADIUS + 1),
        maxLevel=0,
        criteria=(cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 50, 1e-4),
        flags=cv2.OPTFLOW_USE_INITIAL_FLOW,
    )
    return np.asarray(uv[:, 0] - found[:, 0, 0].astype(np.float64))
