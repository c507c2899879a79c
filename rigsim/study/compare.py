"""Triangulators side by side: how near the bound, how biased, how often they fail, how fast.

Every method gets the same noisy pixels. Errors are judged in pixels and in 1/Z, as
`rigsim.study.verify.checks` does and for its reasons: both stay Gaussian where depth does not.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from rigsim.errors import InvalidRange, TriangulatorError
from rigsim.rig.arrays import Array
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.study.verify.suite import own_geometry, stream
from rigsim.study.verify.synthetic import GEOMETRIES, Geometry, visible_points
from rigsim.theory.custom import Triangulator
from rigsim.theory.uncertainty import parallax_px, pixel_gain

GEOMETRY_NAMES = tuple(geometry.name for geometry in GEOMETRIES)
"""Geometries that may be asked for."""
DEFAULT_GEOMETRIES = ("rectified", "far", "verged", "forward", "unequal", "distorted")
"""What is compared unless something else is asked for."""
DEFAULT_NOISES_PX = (0.1, 0.25, 0.5, 1.0, 2.0)
"""Noise levels unless something else is asked for, px."""

COLUMNS = (
    "geometry",
    "noise_px",
    "triangulator",
    "n",
    "failed_share",
    "expected_failed_share",
    "pixel_error_over_bound",
    "pixel_error_over_bound_se",
    "depth_error_over_bound",
    "depth_bias_over_std",
    "depth_bias_over_std_se",
    "depth_median_abs_mm",
    "points_per_second",
)
"""Columns of the table; a row is one triangulator in one geometry at one noise level."""

_SPEED_POINTS = 20_000
_SPEED_RUNS = 5


@dataclass(frozen=True, slots=True)
class ComparisonPlan:
    """What is compared."""

    geometries: tuple[str, ...] = DEFAULT_GEOMETRIES
    """Names of geometries."""
    noises_px: tuple[float, ...] = DEFAULT_NOISES_PX
    """Standard deviations per coordinate, px."""
    n_points: int = 20_000
    """Rows for each geometry and noise level."""
    seed: int = 0
    """Seed of points and noise."""
    rig: StereoRig | None = None
    """A rig beside the geometries."""

    def __post_init__(self) -> None:
        for name in self.geometries:
            if name not in GEOMETRY_NAMES:
                raise InvalidRange(f"geometry {name!r}: choose among {', '.join(GEOMETRY_NAMES)}")
        if not self.geometries and self.rig is None:
            raise InvalidRange("a comparison needs at least one geometry or a --rig")
        if not self.noises_px:
            raise InvalidRange("a comparison needs at least one noise level")
        for noise_px in self.noises_px:
            if not (math.isfinite(noise_px) and noise_px > 0):
                raise InvalidRange(f"noise {noise_px:g} px: must be > 0 and finite")
        if not 100 <= self.n_points <= 1_000_000:
            raise InvalidRange(f"points {self.n_points}: must be between 100 and 1,000,000")
        if self.seed < 0:
            raise InvalidRange(f"seed {self.seed}: must be >= 0")

    def chosen(self) -> list[Geometry]:
        """The geometries, a rig of the user's own first."""
        own = [] if self.rig is None else [own_geometry(self.rig)]
        return own + [geometry for geometry in GEOMETRIES if geometry.name in self.geometries]


@dataclass(frozen=True, slots=True, eq=False)
class ComparisonResult:
    """What came of it."""

    rows: pd.DataFrame
    """Columns as in `COLUMNS`."""
    plan: ComparisonPlan
    """What was asked for."""
    left_out: tuple[str, ...]
    """Triangulators that do not fit a geometry or broke there, a sentence each."""


def compare(
    plan: ComparisonPlan,
    triangulators: Mapping[str, Triangulator],
    on_step: Callable[[], None] = lambda: None,
) -> ComparisonResult:
    """Run every triangulator, by the name it has in tables, in every geometry at every noise level.

    Args:
        plan: what to compare.
        triangulators: the methods.
        on_step: is called after each geometry and noise level.
    """
    rows: list[dict[str, object]] = []
    left_out: dict[str, None] = {}
    for geometry in plan.chosen():
        points_left = visible_points(geometry, plan.n_points, stream(plan.seed, f"{geometry.name} points"))
        fitting = _fitting(geometry, points_left, triangulators, left_out)
        speed = {label: _speed(geometry.rig, points_left, method) for label, method in fitting.items()}
        for noise_px in plan.noises_px:
            rng = stream(plan.seed, f"{geometry.name} {noise_px!r}")
            noisy = PixelNoise(noise_px).apply(*geometry.rig.project(points_left), rng)
            for label, method in fitting.items():
                try:
                    found_left = method(geometry.rig, *noisy)
                except TriangulatorError as error:
                    left_out[f"{geometry.name} at {noise_px:g} px: {error}"] = None
                    continue
                figures = _figures(geometry.rig, points_left, found_left, noise_px)
                head = {"geometry": geometry.name, "noise_px": noise_px, "triangulator": label}
                rows.append(head | figures | {"points_per_second": speed[label]})
            on_step()
    return ComparisonResult(pd.DataFrame(rows, columns=list(COLUMNS)), plan, tuple(left_out))


def _fitting(
    geometry: Geometry,
    points_left: Array,
    triangulators: Mapping[str, Triangulator],
    left_out: dict[str, None],
) -> dict[str, Triangulator]:
    """The triangulators that can do a geometry at all."""
    pixels = geometry.rig.project(points_left[:10])
    fitting = {}
    for label, method in triangulators.items():
        try:
            method(geometry.rig, *pixels)
        except TriangulatorError as error:
            left_out[f"{geometry.name}: {error}"] = None
        else:
            fitting[label] = method
    return fitting


def _speed(rig: StereoRig, points_left: Array, method: Triangulator) -> float:
    """Points a second: the median of a few runs over exact pixels; NaN when it breaks."""
    times = _SPEED_POINTS // len(points_left) + 1
    pixels = [np.tile(uv, (times, 1))[:_SPEED_POINTS] for uv in rig.project(points_left)]
    seconds = []
    for _ in range(_SPEED_RUNS):
        start = time.perf_counter()
        try:
            method(rig, *pixels)
        except TriangulatorError:
            return math.nan
        seconds.append(time.perf_counter() - start)
    return len(pixels[0]) / float(np.median(seconds))


def _figures(rig: StereoRig, points_left: Array, found_left: Array, noise_px: float) -> dict[str, object]:
    """The figures of one row, over the points that came back."""
    truth_px = np.hstack(rig.project(points_left))
    error_px = np.hstack(rig.project(found_left)) - truth_px
    back = np.asarray(np.isfinite(error_px).all(axis=1))
    n = int(back.sum())
    expected = _expected_failures(rig, points_left, noise_px)
    figures: dict[str, object] = dict.fromkeys(COLUMNS[3:-1], math.nan)
    figures |= {"n": len(points_left), "failed_share": 1 - n / len(back), "expected_failed_share": expected}
    if n < 2:
        return figures
    truth, found = points_left[back], found_left[back]
    squares = (error_px[back] ** 2).sum(axis=1) / (3 * noise_px**2)
    std_m = noise_px * np.linalg.norm(pixel_gain(rig, truth)[:, 2], axis=1)
    # 1/Z follows the disparity in a straight line
    inverse_depth = -(1 / found[:, 2] - 1 / truth[:, 2]) * truth[:, 2] ** 2 / std_m
    ratio = math.sqrt(float(squares.mean()))
    return figures | {
        "pixel_error_over_bound": ratio,
        "pixel_error_over_bound_se": float(squares.std()) / math.sqrt(n) / (2 * ratio),
        "depth_error_over_bound": math.sqrt(float((inverse_depth**2).mean())),
        "depth_bias_over_std": float(inverse_depth.mean()),
        "depth_bias_over_std_se": float(inverse_depth.std()) / math.sqrt(n),
        "depth_median_abs_mm": float(np.median(np.abs(found[:, 2] - truth[:, 2]))) * 1e3,
    }


def _expected_failures(rig: StereoRig, points_left: Array, noise_px: float) -> float:
    """Share of points whose parallax the noise turns negative."""
    from scipy.stats import norm

    return float(norm.sf(parallax_px(rig, points_left) / (math.sqrt(2) * noise_px)).mean())
