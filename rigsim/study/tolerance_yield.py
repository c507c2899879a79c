"""Thousands of rigs built within tolerance, each measured with the one that was assumed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.special import ndtri

from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array
from rigsim.rig.perturbation import NAMES
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance import (
    Causes,
    Requirement,
    Sensitivity,
    Tolerances,
    causes,
    first_order,
    scattered_points,
    sensitivities,
    shared_points,
)
from rigsim.study.tolerance_batch import RigBatch, read_rays
from rigsim.study.tolerance_compensator import Compensator
from rigsim.theory.triangulation import triangulate

PARTS_BEYOND = 0.02
"""First order and Monte Carlo part where their root mean squares differ by more than this."""
_BLOCK = 200_000
_RIGS_A_BLOCK = 500
_ROW_SAMPLES = 201


@dataclass(frozen=True, slots=True)
class Recalibration:
    """What the compensator has to work with."""

    features: int = 60
    """Points of unknown place, over the image and the depth range."""
    pictures: int = 100
    """Pictures over which each of them is averaged."""
    noise_px: float = 0.25
    """Standard deviation of one pixel coordinate in one picture."""
    length_std_mm: float = 0.1
    """Standard deviation of the known length."""

    def __post_init__(self) -> None:
        for name, value, least in (
            ("features", self.features, 8),
            ("pictures", self.pictures, 1),
            ("noise", self.noise_px, 0),
        ):
            if not (math.isfinite(value) and value >= least):
                raise InvalidRange(f"recalibration {name} {value:g}: must be >= {least}")
        if not (math.isfinite(self.length_std_mm) and self.length_std_mm > 0):
            raise InvalidRange(f"known length's std {self.length_std_mm:g} mm: must be > 0")


@dataclass(frozen=True, slots=True, eq=False)
class DepthErrors:
    """Built rigs at one depth; errors in mm."""

    depth_m: float
    """The depth."""
    first_order_mm: float
    """Root mean square over rigs and image, predicted."""
    rms_mm: float
    """The same, simulated; before recalibration."""
    first_over_simulated: float
    """Root mean squares of the very same rigs: prediction over simulation."""
    per_rig_mm: Array
    """Root mean square over the image of each rig; infinite where a point has no depth."""
    after_per_rig_mm: Array | None
    """The same after recalibration; None when there was none."""

    @property
    def parts(self) -> bool:
        """Whether the first order is not to be trusted here."""
        return not abs(self.first_over_simulated - 1) <= PARTS_BEYOND


@dataclass(frozen=True, slots=True, eq=False)
class ToleranceResult:
    """What must be held how tightly, and how many rigs are good."""

    rig: StereoRig
    """The assumed rig."""
    tolerances: Tolerances
    """What it may be off by."""
    required: Requirement
    """What it is judged by."""
    recalibration: Recalibration | None
    """What the compensator had; None for none."""
    sensitivities: tuple[Sensitivity, ...]
    """The worst first."""
    depths: tuple[DepthErrors, ...]
    """Near to far; the requirement's is among them."""
    n_rigs: int
    """Rigs built."""
    n_points: int
    """Points each was judged by, over all depths."""

    @property
    def judged(self) -> DepthErrors:
        """The depth of the requirement."""
        return next(item for item in self.depths if item.depth_m == self.required.depth_m)

    @property
    def yield_before(self) -> float:
        """Share of rigs that meet the requirement as built."""
        return _share(self.judged.per_rig_mm, self.required)

    @property
    def yield_after(self) -> float | None:
        """Share of rigs that meet it after recalibration."""
        after = self.judged.after_per_rig_mm
        return None if after is None else _share(after, self.required)


def run_tolerance(
    rig: StereoRig,
    tolerances: Tolerances,
    required: Requirement,
    range_m: tuple[float, float],
    *,
    recalibration: Recalibration | None = None,
    n_rigs: int = 10_000,
    n_points: int = 500,
    seed: int = 0,
) -> ToleranceResult:
    """Rank the tolerances, build `n_rigs` within them, and count those that meet the requirement.

    Args:
        rig: the assumed rig.
        tolerances: what a built one may be off by.
        required: depth error and distance.
        range_m: near and far end; the middle is half way.
        recalibration: what the compensator has; None leaves it out.
        n_rigs: rigs to build.
        n_points: points over all depths.
        seed: of the random numbers.

    Raises:
        InvalidRange: no tolerance, a range or count that cannot be, or a depth that not both cameras see.
    """
    near_m, far_m = range_m
    if not 0 < near_m < far_m < math.inf:
        raise InvalidRange(f"range {near_m * 1e3:g}:{far_m * 1e3:g} mm: must be 0 < near < far")
    if n_rigs < 2:
        raise InvalidRange(f"rigs {n_rigs}: must be >= 2")
    depths_m = sorted({near_m, (near_m + far_m) / 2, far_m, required.depth_m})
    if n_points < 4 * len(depths_m):
        raise InvalidRange(f"points {n_points}: must be >= {4 * len(depths_m)}, 4 a depth")
    off = causes(rig, tolerances)
    per_depth = math.ceil(n_points / len(depths_m))
    planes = {depth: shared_points(rig, depth, per_depth) for depth in depths_m}
    rng = np.random.default_rng(seed)
    built = draw(off, tolerances.distribution, n_rigs, rng)
    compensator = None
    if recalibration is not None and not off.after_calibration.all():
        compensator = make_compensator(rig, off, recalibration, (near_m, far_m))
    return ToleranceResult(
        rig,
        tolerances,
        required,
        recalibration,
        tuple(sensitivities(rig, off, planes, required)),
        _depth_errors(rig, off, planes, built, compensator, rng),
        n_rigs,
        sum(map(len, planes.values())),
    )


def draw(off: Causes, distribution: str, n_rigs: int, rng: np.random.Generator) -> Array:
    """Deviations (n, q) of built rigs in standard deviations: a Latin hypercube, every margin even."""
    places = rng.permuted(np.tile(np.arange(n_rigs), (len(off.keys), 1)), axis=1).T
    turn = (places + rng.random(places.shape)) / n_rigs
    if distribution == "uniform":
        return np.asarray(math.sqrt(3) * (2 * turn - 1))
    return np.asarray(ndtri(turn))


def make_compensator(
    rig: StereoRig, off: Causes, recalibration: Recalibration, range_m: tuple[float, float]
) -> Compensator:
    """The calibration of one rig: features over the range, a length across the middle of the image."""
    near_m, far_m = range_m
    before = ~off.after_calibration
    std = np.sqrt(((off.effect * off.std[:, None])[before] ** 2).sum(axis=0))
    middle_m = (near_m + far_m) / 2
    row = np.column_stack(
        [np.linspace(0, rig.left.width - 1, _ROW_SAMPLES), np.full(_ROW_SAMPLES, (rig.left.height - 1) / 2)]
    )
    across = np.column_stack([rig.left.normalize(row) * middle_m, np.full(_ROW_SAMPLES, middle_m)])
    across = across[rig.right.contains(rig.project(across)[1])]
    if len(across) < 4:
        raise InvalidRange(
            f"depth {middle_m * 1e3:g} mm: too little is in both images to lay a known length there;"
            " take a larger distance or leave the recalibration out"
        )
    return Compensator(
        rig,
        scattered_points(rig, near_m, far_m, recalibration.features),
        across[[len(across) // 4, 3 * len(across) // 4]],
        std,
        recalibration.noise_px / math.sqrt(recalibration.pictures),
        recalibration.length_std_mm / 1e3,
    )


def _depth_errors(
    rig: StereoRig,
    off: Causes,
    planes: Mapping[float, Array],
    built: Array,
    compensator: Compensator | None,
    rng: np.random.Generator,
) -> tuple[DepthErrors, ...]:
    points = np.concatenate(list(planes.values()))
    ends = np.cumsum([0, *map(len, planes.values())])
    cuts = [slice(int(start), int(stop)) for start, stop in pairwise(ends)]
    scaled = first_order(rig, off, points)
    # one row a depth, one column a rig: mean squares over the image, m^2
    before, after, linear = (np.empty((len(cuts), len(built))) for _ in range(3))
    distorts = rig.left.distortion is not None or rig.right.distortion is not None
    assumed = RigBatch(rig, np.zeros((1, len(NAMES))))
    size = min(max(1, _BLOCK // len(points)), _RIGS_A_BLOCK)
    for start in range(0, len(built), size):
        block = slice(start, start + size)
        deviations = built[block] * off.std
        thetas = deviations @ off.effect
        pixels = RigBatch(rig, thetas).project(points)
        read = read_rays(rig, pixels) if distorts or compensator is not None else None
        if distorts and read is not None:
            # `optimal` would iterate; one step differs in the second order of the epipolar error alone
            depth = assumed.triangulate(read)[2]
        else:
            flat = pixels.reshape(4, -1).T
            depth = triangulate(rig, flat[:, :2], flat[:, 2:])[:, 2].reshape(pixels.shape[1:])
        _mean_squares(depth - points[:, 2], cuts, before[:, block])
        _mean_squares(built[block] @ scaled.T, cuts, linear[:, block])
        if compensator is not None and read is not None:
            known = deviations * ~off.after_calibration @ off.effect
            batch = RigBatch(rig, compensator.solve(compensator.observe(known, rng)))
            depth = batch.triangulate(batch.rays(pixels, read))[2]
            _mean_squares(depth - points[:, 2], cuts, after[:, block])
    found = []
    for i, (depth_m, cut) in enumerate(zip(planes, cuts, strict=True)):
        mean_square = float(before[i].mean())
        found.append(
            DepthErrors(
                depth_m,
                1e3 * math.sqrt((scaled[cut] ** 2).sum(axis=1).mean()),
                1e3 * math.sqrt(mean_square),
                math.sqrt(float(linear[i].mean()) / mean_square) if mean_square > 0 else 1.0,
                1e3 * np.sqrt(before[i]),
                None if compensator is None else 1e3 * np.sqrt(after[i]),
            )
        )
    return tuple(found)


def _mean_squares(errors: Array, cuts: list[slice], out: Array) -> None:
    for i, cut in enumerate(cuts):
        out[i] = np.einsum("nm,nm->n", errors[:, cut], errors[:, cut]) / errors[:, cut].shape[1]
    # a point without a depth fails its rig
    out[np.isnan(out)] = math.inf


def _share(per_rig_mm: Array, required: Requirement) -> float:
    return float((per_rig_mm <= required.error_m * 1e3).mean())
