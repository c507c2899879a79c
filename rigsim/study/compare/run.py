"""Triangulators side by side: how near the bound, how biased, how often they fail, how fast.

Every method gets the same noisy pixels, so differences between methods are surer than each number alone.
"""

from __future__ import annotations

import math
import platform
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from rigsim.errors import InvalidRange, MeasurementFailed, RigsimError, TriangulatorError, TriangulatorTimeout
from rigsim.pixels.opencv import load_cv2
from rigsim.rig.arrays import Array
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.study.compare import columns as col
from rigsim.study.compare.row import Errors, errors, figures
from rigsim.study.scene.provenance import versions
from rigsim.study.verify.bound import bound
from rigsim.study.verify.geometries import GEOMETRIES, Geometry
from rigsim.study.verify.runner import PATIENCE
from rigsim.study.verify.suite import own_geometry, stream
from rigsim.study.verify.synthetic import visible_points
from rigsim.theory.custom import CheckedTriangulator, TriangulatorFunction

GEOMETRY_NAMES = tuple(geometry.name for geometry in GEOMETRIES)
"""Geometries that may be asked for."""
DEFAULT_METHODS = ("optimal", "dlt", "midpoint", "cv2")
"""What is compared unless something else is asked for."""
DEFAULT_GEOMETRIES = ("rectified", "far", "verged", "forward", "unequal", "distorted")
"""Where, unless something else is asked for."""
DEFAULT_NOISES_PX = (0.1, 0.25, 0.5, 1.0, 2.0)
"""Noise levels unless something else is asked for, px."""
SPEED_RUNS = 5
"""Times each method is timed in each geometry; the median counts."""

_MOST_POINTS = 1_000_000
_SPEED_POINTS = 20_000
_PROBE_POINTS = 500
_SPEED_S = 0.5  # about as long may one timed run take


@dataclass(frozen=True, slots=True)
class ComparisonPlan:
    """What is compared."""

    geometries: tuple[str, ...] = DEFAULT_GEOMETRIES
    """Names of geometries."""
    noises_px: tuple[float, ...] = DEFAULT_NOISES_PX
    """Standard deviations per coordinate, px."""
    n_points: int = 20_000
    """Points for each geometry and noise level."""
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
        for place, noise_px in enumerate(self.noises_px):
            if not (math.isfinite(noise_px) and noise_px > 0):
                raise InvalidRange(f"noise {noise_px:g} px: must be > 0 and finite")
            if noise_px in self.noises_px[:place]:
                raise InvalidRange(f"noise {noise_px:g} px: given twice; remove one")
        if not 100 <= self.n_points <= _MOST_POINTS:
            raise InvalidRange(f"points {self.n_points}: must be between 100 and {_MOST_POINTS:,}")
        if self.seed < 0:
            raise InvalidRange(f"seed {self.seed}: must be >= 0")

    def chosen(self) -> list[Geometry]:
        """The geometries in the order asked for, a rig of the user's own first."""
        own = [] if self.rig is None else [own_geometry(self.rig)]
        by_name = {geometry.name: geometry for geometry in GEOMETRIES}
        return own + [by_name[name] for name in self.geometries]


@dataclass(frozen=True, slots=True, eq=False)
class ComparisonResult:
    """What came of it."""

    rows: pd.DataFrame
    """Columns as in `rigsim.study.compare.columns`."""
    plan: ComparisonPlan
    """What was asked for."""
    triangulators: tuple[str, ...]
    """All that were asked, in order."""
    left_out: tuple[str, ...] = ()
    """What does not fit a geometry, broke there or is not installed, a sentence each."""
    provenance: Mapping[str, object] = field(default_factory=dict)
    """Command and versions."""


class _LeftOut:
    """Why methods were left out, and where, each reason once."""

    def __init__(self) -> None:
        self.places: dict[str, list[str]] = {}
        self.timeouts: dict[str, int] = {}

    def add(self, label: str, error: RigsimError, place: str) -> None:
        said = str(error)
        self.places.setdefault(said if label in said else f"{label}: {said}", []).append(place)
        if isinstance(error, TriangulatorTimeout):
            self.timeouts[label] = self.timeouts.get(label, 0) + 1

    def sentences(self) -> tuple[str, ...]:
        return tuple(f"{said} (in {', '.join(places)})" for said, places in self.places.items())


def compare(
    plan: ComparisonPlan,
    triangulators: Mapping[str, TriangulatorFunction],
    on_step: Callable[[], None] = lambda: None,
    left_out: tuple[str, ...] = (),
    provenance: Mapping[str, object] | None = None,
) -> ComparisonResult:
    """Run every triangulator, by the name it has in tables, in every geometry at every noise level.

    One that raises is told, and the others go on. One that does not come back three times is not asked again.

    Args:
        plan: what to compare.
        triangulators: the methods; the others' ratios are to the first one.
        on_step: is called after each geometry and noise level.
        left_out: sentences on what was left out before.
        provenance: command and versions.

    Raises:
        InvalidRange: no triangulator, or both cameras of the plan's rig see nothing in common.
        TriangulatorError: none of them returned anything anywhere.
    """
    if not triangulators:
        raise InvalidRange("a comparison needs at least one triangulator")
    rows: list[dict[str, object]] = []
    gone, first = _LeftOut(), next(iter(triangulators))
    checked: dict[str, TriangulatorFunction] = {
        label: CheckedTriangulator(function, label) for label, function in triangulators.items()
    }
    for geometry in plan.chosen():
        points_left = visible_points(geometry, plan.n_points, stream(plan.seed, f"{geometry.name} points"))
        asked = {label: one for label, one in checked.items() if gone.timeouts.get(label, 0) < PATIENCE}
        speed = _speeds(geometry, points_left, asked, triangulators, gone)
        first_speed = speed.get(first, math.nan)
        fitting = {label: asked[label] for label in speed}
        for noise_px in plan.noises_px:
            noisy = PixelNoise(noise_px).apply(
                *geometry.rig.project(points_left), stream(plan.seed, f"{geometry.name} {noise_px!r}")
            )
            found = _found(geometry, points_left, noise_px, noisy, fitting, gone)
            must = bound(geometry.rig, points_left, noise_px)
            for label, mine in found.items():
                rows.append(
                    {col.GEOMETRY: geometry.name, col.NOISE: noise_px, col.TRIANGULATOR: label}
                    | figures(mine, found.get(first), must, noise_px)
                    | {
                        col.POINTS_PER_SECOND: speed[label],
                        col.SPEED_OVER_FIRST: speed[label] / first_speed,
                    }
                )
            on_step()
    said = (*left_out, *gone.sentences())
    if not rows:
        raise TriangulatorError(f"nothing could be compared: {'; '.join(said)}", "nothing-found")
    return ComparisonResult(
        pd.DataFrame(rows, columns=list(col.COLUMNS)),
        plan,
        tuple(triangulators),
        said,
        provenance or {},
    )


def comparison_provenance(command: str) -> dict[str, object]:
    """Command, versions and processor: what speeds hold for."""
    try:
        opencv = str(load_cv2().__version__)
    except MeasurementFailed:
        opencv = None
    processor = platform.processor() or platform.machine()
    return {"command": command, **versions(), "opencv": opencv, "processor": processor}


def _found(
    geometry: Geometry,
    points_left: Array,
    noise_px: float,
    noisy: tuple[Array, Array],
    fitting: dict[str, TriangulatorFunction],
    gone: _LeftOut,
) -> dict[str, Errors]:
    """The errors of each method; one that does not come back is taken out of `fitting`."""
    found = {}
    for label in list(fitting):
        try:
            found_left = fitting[label](geometry.rig, *noisy)
        except RigsimError as error:
            gone.add(label, error, f"{geometry.name} at {noise_px:g} px")
            if isinstance(error, TriangulatorTimeout):
                del fitting[label]
        else:
            found[label] = errors(geometry.rig, points_left, found_left, noise_px)
    return found


def _speeds(
    geometry: Geometry,
    points_left: Array,
    asked: Mapping[str, TriangulatorFunction],
    own: Mapping[str, TriangulatorFunction],
    gone: _LeftOut,
) -> dict[str, float]:
    """Points a second of each method that can do a geometry: the median of a few runs over exact pixels.

    The methods take turns, so that what else the machine does meets them all. A function elsewhere is timed
    there, without the way to it.
    """
    times = _SPEED_POINTS // len(points_left) + 1
    pixels = [np.tile(uv, (times, 1))[:_SPEED_POINTS] for uv in geometry.rig.project(points_left)]

    def seconds(label: str, n: int) -> float:
        start = time.perf_counter()
        asked[label](geometry.rig, pixels[0][:n], pixels[1][:n])
        passed = time.perf_counter() - start
        inside = float(getattr(own[label], "seconds", math.nan))
        return inside if math.isfinite(inside) else passed

    many: dict[str, int] = {}
    for label in asked:
        try:
            rate = _PROBE_POINTS / max(seconds(label, _PROBE_POINTS), 1e-9)
        except RigsimError as error:
            gone.add(label, error, geometry.name)
        else:
            many[label] = min(max(int(rate * _SPEED_S), _PROBE_POINTS), _SPEED_POINTS)
    measured: dict[str, list[float]] = {label: [] for label in many}
    for _ in range(SPEED_RUNS):
        for label, n in many.items():
            try:
                measured[label].append(n / max(seconds(label, n), 1e-9))
            except RigsimError:
                measured[label].append(math.nan)
    return {label: float(np.median(rates)) for label, rates in measured.items()}
