"""Built rigs, many at once: how they are drawn, what they measure, and how far off that is."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.special import ndtri

from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance import Causes, first_order
from rigsim.study.tolerance_batch import PARAMETERS, Rays, RigBatch, read_rays, read_rays_near
from rigsim.study.tolerance_compensator import Compensator
from rigsim.theory.triangulation import triangulate

PARTS_BEYOND = 0.02
"""First order and Monte Carlo part where their root mean squares differ by more than this."""
_BLOCK = 200_000
_RIGS_A_BLOCK = 500


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


def draw(off: Causes, n_rigs: int, rng: np.random.Generator) -> Array:
    """Deviations (n, q) of built rigs in standard deviations: a Latin hypercube, every margin even."""
    places = rng.permuted(np.tile(np.arange(n_rigs), (len(off.keys), 1)), axis=1).T
    return deviates(off, (places + rng.random(places.shape)) / n_rigs)


def deviates(off: Causes, turns: Array) -> Array:
    """The deviations (n, q) in standard deviations that have the probabilities `turns` (n, q) below them."""
    return np.where(off.even, math.sqrt(3) * (2 * turns - 1), ndtri(turns))


def built_depths(rig: StereoRig, thetas: Array, points: Array) -> tuple[Array, Array, Rays | None]:
    """Depths (n, m) m that `rig` is taken for reads of `points` (m, 3), when rigs are off by `thetas`.

    Also their pixels (4, n, m) and, for a rig whose lenses distort, the rays that `rig` makes of them.
    """
    pixels = RigBatch(rig, thetas).project(points)
    if rig.left.distortion is not None or rig.right.distortion is not None:
        read = read_rays_near(rig, pixels, points)
        # `optimal` would iterate; one step differs in the second order of the epipolar error alone
        return RigBatch(rig, np.zeros((1, len(PARAMETERS)))).triangulate(read)[2], pixels, read
    flat = pixels.reshape(4, -1).T
    return triangulate(rig, flat[:, :2], flat[:, 2:])[:, 2].reshape(pixels.shape[1:]), pixels, None


def rigs_a_block(points: int) -> int:
    """How many rigs to build at once, so that memory stays small."""
    return min(max(1, _BLOCK // points), _RIGS_A_BLOCK)


def depth_errors(
    rig: StereoRig,
    off: Causes,
    planes: Mapping[float, Array],
    built: Array,
    compensator: Compensator | None,
    rng: np.random.Generator,
) -> tuple[DepthErrors, ...]:
    """What rigs off by `built` (n, q) standard deviations make of points at each depth of `planes`.

    With a `compensator` each is recalibrated as well.
    """
    points = np.concatenate(list(planes.values()))
    ends = np.cumsum([0, *map(len, planes.values())])
    cuts = [slice(int(start), int(stop)) for start, stop in pairwise(ends)]
    scaled = first_order(rig, off, points)
    # one row a depth, one column a rig: mean squares over the image, m^2
    before, after, linear = (np.empty((len(cuts), len(built))) for _ in range(3))
    size = rigs_a_block(len(points))
    for start in range(0, len(built), size):
        block = slice(start, start + size)
        deviations = built[block] * off.std
        depth, pixels, read = built_depths(rig, deviations @ off.effect, points)
        _mean_squares(depth - points[:, 2], cuts, before[:, block])
        _mean_squares(built[block] @ scaled.T, cuts, linear[:, block])
        if compensator is not None:
            known = deviations * ~off.after_calibration @ off.effect
            batch = RigBatch(rig, compensator.solve(*compensator.observe(known, rng)))
            depth = batch.triangulate(batch.rays(pixels, read or read_rays(rig, pixels)))[2]
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
