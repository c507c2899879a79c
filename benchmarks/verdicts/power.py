"""Power of a sweep's verdict: are 24 mistakes that people make flagged, and named for what they are?

A mistake is a triangulator that is wrong, or a true rig that is not the assumed one. Each has a rig on which
it has an effect, and words of which the verdict must hold one; both were written down before any result was
seen. Everything else is the default plan: 0.25 px of noise, 2000 points, 100 trials. Nothing is measured: the
row is made as in a sweep, without its pictures.
"""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from rigsim import Perturbation, Plan, Simulator, StereoRig, preset, triangulate
from rigsim.present.kit.agreement import fault, text
from rigsim.rig.arrays import Array
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.study.agreement.agreement import Agreement
from rigsim.study.scene.look import Look, all_rows

SEEDS = 20
SCENE = "boards"

RIG = preset("boards").rig
DOFFS = replace(RIG, right=replace(RIG.right, cx=RIG.right.cx + 6))
BENT = StereoRig(
    replace(RIG.left, lens=BrownConrady(k1=-0.05)),
    replace(RIG.right, lens=BrownConrady(k1=-0.05)),
    RIG.right_from_left,
)

Method: TypeAlias = Callable[[StereoRig, Array, Array], Array]


def answer(change: Callable[[Array, Array], Array]) -> Method:
    """A triangulator whose right points are changed; it knows the left pixels."""
    return lambda rig, uv_left, uv_right: change(triangulate(rig, uv_left, uv_right), uv_left)


def pixels(change: Callable[[Array, Array], tuple[Array, Array]]) -> Method:
    """A triangulator that changes its pixels."""
    return lambda rig, uv_left, uv_right: triangulate(rig, *change(uv_left, uv_right))


def believing(change: Callable[[StereoRig], StereoRig]) -> Method:
    """A triangulator that takes the rig for another."""
    return lambda rig, uv_left, uv_right: triangulate(change(rig), uv_left, uv_right)


def _longer(rig: StereoRig) -> StereoRig:
    left, right = (replace(lens, fx=1.002 * lens.fx, fy=1.002 * lens.fy) for lens in (rig.left, rig.right))
    return replace(rig, left=left, right=right)


def _straight(rig: StereoRig) -> StereoRig:
    return replace(rig, left=replace(rig.left, lens=None), right=replace(rig.right, lens=None))


def _noisy(uv_left: Array, uv_right: Array) -> tuple[Array, Array]:
    # three times the variance on top of it is twice the noise
    extra = np.random.default_rng().normal(0, 0.25 * 3**0.5, (2, *uv_left.shape))
    return uv_left + extra[0], uv_right + extra[1]


def _far_right(found: Array, uv_left: Array) -> Array:
    return np.where((uv_left[:, 0] > 0.8 * RIG.left.width)[:, None], 1.05 * found, found)


def _lost(found: Array, uv_left: Array) -> Array:
    return np.where(np.random.default_rng().random(len(found))[:, None] < 0.02, np.nan, found)


RIGHT: Method = triangulate
TRIANGULATORS: dict[str, tuple[Method, StereoRig, str]] = {
    "all coordinates 1 % too large": (answer(lambda X, uv: 1.01 * X), RIG, "all coordinates|baseline"),
    "disparity 0.02 px too large": (pixels(lambda a, b: (a, b - (0.02, 0))), RIG, "disparity offset"),
    "right fifth of the image 5 % too far": (answer(_far_right), RIG, r"points with u above 10\d\d px"),
    "X negated": (answer(lambda X, uv: X * (-1, 1, 1)), RIG, "x has the opposite sign"),
    "X = Y = 0": (answer(lambda X, uv: X * (0, 0, 1)), RIG, "X and Y come back as 0"),
    "answers in reverse order": (answer(lambda X, uv: X[::-1]), RIG, "order"),
    "left and right pixels swapped": (pixels(lambda a, b: (b, a)), RIG, "swapped|exchanged cameras"),
    "u and v swapped": (pixels(lambda a, b: (a[:, ::-1], b[:, ::-1])), RIG, "u and v are exchanged"),
    "focal length of both 0.2 % too long": (believing(_longer), RIG, "focal length of both"),
    "doffs ignored": (
        believing(lambda rig: replace(rig, right=replace(rig.right, cx=rig.left.cx))),
        DOFFS,
        "doffs",
    ),
    "distortion ignored": (believing(_straight), BENT, "distortion"),
    "half a pixel, both images": (pixels(lambda a, b: (a + 0.5, b + 0.5)), RIG, r"0\.50* px"),
    "pixels rounded to whole ones": (
        pixels(lambda a, b: (np.round(a), np.round(b))),
        RIG,
        "rounded to whole",
    ),
    "noise doubled": (pixels(_noisy), RIG, r"scatter (1\.9|2)\S* times as wide"),
    "right image's rows not used": (
        pixels(lambda a, b: (a, np.column_stack([b[:, 0], a[:, 1]]))),
        RIG,
        "one image's rows",
    ),
    "NaN for 2 % of the points": (answer(_lost), RIG, r"(1\.[5-9]|2\S*) % of the points come back as NaN"),
    "answers in float16": (answer(lambda X, uv: X.astype(np.float16)), RIG, "float16"),
    "ray length for depth": (
        answer(lambda X, uv: np.column_stack([X[:, :2], np.linalg.norm(X, axis=1)])),
        RIG,
        "length of the ray",
    ),
}
"""Triangulators that are wrong, the rig they are given, and what must be said."""

RIGS: dict[str, tuple[Perturbation, str]] = {
    "yaw 0.02 deg": (Perturbation(yaw_rad=np.radians(0.02)), "yaw"),
    "pitch 0.02 deg": (Perturbation(pitch_rad=np.radians(0.02)), "pitch"),
    "roll 0.02 deg": (Perturbation(roll_rad=np.radians(0.02)), "roll"),
    "baseline 0.5 %": (Perturbation(baseline_m=0.005 * RIG.baseline_m), "baseline"),
    "right principal point 0.1 px": (Perturbation(right_cx_px=0.1), "principal point of the right"),
    "right k1 0.001": (Perturbation(right_k1=0.001), "k1 of the right"),
}
"""True minus assumed rig, and what must be said."""


def verdict(
    simulator: Simulator, method: Method, rig: StereoRig, perturbation: Perturbation | None, seed: int
) -> Agreement:
    """The agreement of one row of a sweep."""
    plan = Plan(scene=SCENE, triangulators=(method,), seed=seed, measure="none", perturbation=perturbation)
    true_rig, _ = plan.true_and_assumed(rig)
    simulator.place(true_rig)
    truth = simulator.truth(plan.n_points, plan.stream("truth", simulator.scene.name, rig), plan.range_m)
    outcome = all_rows(simulator, rig, plan, Look({}, truth), {})
    agreement: Agreement = outcome.rows[0]["agreement"]
    return agreement


def run() -> None:
    """Print the share of seeds in which each mistake is flagged and named."""
    cases = [(name, method, rig, None, words) for name, (method, rig, words) in TRIANGULATORS.items()]
    cases += [(name, RIGHT, RIG, perturbation, words) for name, (perturbation, words) in RIGS.items()]
    started = time.perf_counter()
    print(f"{'mistake':40s} flagged  named   of {SEEDS} seeds")
    worst = SEEDS
    with Simulator(SCENE, renderer="rays") as simulator:
        correct = [verdict(simulator, RIGHT, RIG, None, seed).kind for seed in range(SEEDS)]
        for name, method, rig, perturbation, words in cases:
            told = [verdict(simulator, method, rig, perturbation, seed) for seed in range(SEEDS)]
            flagged = [one for one in told if one.kind == "flagged"]
            named = [one for one in flagged if one.fault is not None and re.search(words, fault(one.fault))]
            worst = min(worst, len(named))
            print(f"{name:40s} {len(flagged):7d} {len(named):6d}", flush=True)
            if len(named) < SEEDS:
                odd = next((text(one) for one in told if one not in named), "")
                print(f"    {odd[:160]}")
    print(f"correct, for comparison: {correct.count('flagged')} of {SEEDS} flagged")
    print(
        f"{len(cases)} mistakes, worst {worst} of {SEEDS}; {time.perf_counter() - started:.0f} s",
        file=sys.stderr,
    )
