"""A design's pick, built and calibrated from scratch: is its yield what the design states?

Rig by rig, with nothing of what the design counts by: each rig is drawn from its class's tolerances, its
pictures' points are projected by the rig itself, SciPy's least squares calibrates it, `optimal` triangulates
noisy pixels, and the root mean square of the depth errors is held to what was asked for.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.optimize import least_squares

import rigsim
from benchmarks.tolerance import built, single_residuals
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance.recalibration.compensator import Compensator
from rigsim.study.tolerance.recalibration.session import Recalibration, make_compensator
from rigsim.study.tolerance.sensitivities import CLASSES, causes, shared_points
from rigsim.theory.triangulation import triangulate

RIGS = 200
POINTS, DRAWS = 40, 60
ASKED: dict[str, dict[str, Any]] = {
    "10 mm at 3 m, 60 deg": {"range_m": (0.5, 3), "depth_error_mm": 10, "fov_deg": 60},
    "1 % at 5 m, calibrated": {"range_m": (1, 5), "depth_error_pct": 1, "tolerance_class": "calibrated"},
    "bin picking, 1.5 mm at 1.2 m": {
        "range_m": (0.8, 1.2),
        "depth_error_mm": 1.5,
        "cover_mm": (800, 600),
        "pixel_pitch_um": 3.45,
        "lenses_mm": (6, 8, 12),
        "resolutions_px": [(1440, 1080), (2448, 2048)],
        "body_width_mm": 29,
    },
}


def run() -> None:
    """Print the yields stated and found."""
    print(
        "  asked for                      class, state                stated   from scratch  (limit 3 points)"
    )
    for name, asked in ASKED.items():
        found = rigsim.design(**asked, proof=False)
        assert found.tolerance is not None
        held = found.found.specification
        class_name, state, count = found.tolerance.told
        good = sum(
            _is_good(found.rig, class_name, state == "recalibrated", held, np.random.default_rng([7, i]))
            for i in range(RIGS)
        )
        share, se = good / RIGS, math.sqrt(max(good, 1) * max(RIGS - good, 1) / RIGS**3)
        enough = {True: "enough", False: "not enough", None: "not told"}[count.is_enough]
        print(
            f"  {name:31}{class_name + ', ' + state:26}{100 * count.share:7.1f}"
            f"{100 * share:9.1f} ± {100 * se:.1f}   {enough}"
        )


def _is_good(
    rig: StereoRig, class_name: str, recalibrated: bool, held: Any, rng: np.random.Generator
) -> bool:
    off = causes(rig, CLASSES[class_name].tolerances(rig))
    uniform = rng.uniform(-math.sqrt(3), math.sqrt(3), len(off.keys))
    drawn = np.where(off.even, uniform, rng.standard_normal(len(off.keys))) * off.std
    true = built(rig, drawn @ off.effect)
    taken = rig
    range_m = (held.near_m, held.far_m)
    if recalibrated:
        session = Recalibration(noise_px=held.noise_px)
        taken = built(rig, _calibrate(true, make_compensator(rig, off, session, range_m), rng))
    asked = max((r for r in held.requirements if r.kind == "depth_error"), key=lambda r: r.depth_m)
    points = np.repeat(shared_points(rig, asked.depth_m, POINTS), DRAWS, axis=0)
    left, right = true.project(points)
    left = left + held.noise_px * rng.standard_normal(left.shape)
    right = right + held.noise_px * rng.standard_normal(right.shape)
    error_m = triangulate(taken, left, right)[:, 2] - points[:, 2]
    return bool(math.sqrt(np.mean(error_m**2)) <= asked.limit)


def _calibrate(true: StereoRig, eyes: Compensator, rng: np.random.Generator) -> Array:
    points = np.concatenate([eyes.features_left, eyes.marks_left])
    pixels = np.hstack(true.project(points)).T
    pixels = pixels + eyes.noise_px * rng.standard_normal(pixels.shape)
    lengths_m = eyes.lengths_m + eyes.length_std_m * rng.standard_normal(len(eyes.lengths_m))

    def residuals(scaled: Array) -> Array:
        return single_residuals(eyes, pixels, lengths_m, scaled * eyes.std)

    return np.asarray(least_squares(residuals, np.zeros(12), x_scale=1.0).x * eyes.std)
