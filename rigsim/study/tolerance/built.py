"""Built rigs, many at once: how they are drawn, what they measure, and how far off that is."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import ndtri

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.stereo import StereoRig
from rigsim.statistics import rms
from rigsim.study.tolerance.batch import PARAMETERS, Rays, RigBatch, read_rays, read_rays_near
from rigsim.study.tolerance.joint.cause import JointDraw
from rigsim.study.tolerance.joint.project import project_joint
from rigsim.study.tolerance.judge import Judge
from rigsim.study.tolerance.recalibration.compensator import Compensator
from rigsim.study.tolerance.rows import first_order_rows, rms_px, row_errors_px
from rigsim.study.tolerance.sensitivities import Causes, first_order
from rigsim.theory.triangulation import triangulate

if TYPE_CHECKING:
    pass


PARTS_BEYOND = 0.02
"""First order and Monte Carlo part where their root mean squares differ by more than this."""
_BLOCK = 200_000
_RIGS_A_BLOCK = 500


@dataclass(frozen=True, slots=True, eq=False)
class Rigs:
    """Rigs at one depth, each over its part of the image."""

    build_mm: Array
    """Root mean square error (n,) mm that the build alone makes; infinite where a point has no depth."""
    whole_mm: Array
    """The same with pixel noise."""
    good: Mask
    """Which (n,) meet the bound with pixel noise."""
    good_alone: Mask
    """Which (n,) meet it by their build alone."""
    row_px: Array
    """Root mean square row misalignment (n,) px of the pair that the calibration rectifies; infinite where
    a point has no row."""

    @property
    def row_rms_px(self) -> float:
        """The same over rigs and image, px."""
        return rms(self.row_px)

    def that(self, keep: Mask) -> Rigs:
        """The same rigs, of which those alone are good that `keep` (n,) something else as well."""
        return replace(self, good=self.good & keep, good_alone=self.good_alone & keep)


@dataclass(frozen=True, slots=True, eq=False)
class DepthErrors:
    """Built rigs at one depth; errors in mm."""

    depth_m: float
    """The depth."""
    noise_mm: float
    """Root mean square that pixel noise alone makes."""
    first_order_mm: float
    """Root mean square over rigs and image that the build makes, predicted."""
    rms_mm: float
    """The same, simulated; before recalibration."""
    first_over_simulated: float
    """Root mean squares of the very same rigs: prediction over simulation."""
    built: Rigs
    """As built."""
    recalibrated: Rigs | None
    """After a recalibration that knows nothing beforehand; None when there was none."""
    informed: Rigs | None
    """After one that knows the tolerances beforehand; None when there was none."""
    first_order_row_px: float
    """Root mean square row misalignment over rigs and image, as built, predicted, px."""
    row_as_seen_px: float
    """The same simulated, in the images as they are seen, without rectifying them, px."""

    @property
    def parts(self) -> bool:
        """Whether the first order is not to be trusted here."""
        return not abs(self.first_over_simulated - 1) <= PARTS_BEYOND


def draw(off: Causes, n_rigs: int, rng: np.random.Generator) -> Array:
    """Deviations (n, q) of built rigs in standard deviations: a Latin hypercube, every margin even.

    One column for each independent number of `off`.
    """
    places = rng.permuted(np.tile(np.arange(n_rigs), (len(off.even_numbers), 1)), axis=1).T
    return deviates(off, (places + rng.random(places.shape)) / n_rigs)


def deviates(off: Causes, turns: Array) -> Array:
    """The deviations (n, q) in standard deviations that have the probabilities `turns` (n, q) below them."""
    return np.where(off.even_numbers, math.sqrt(3) * (2 * turns - 1), ndtri(turns))


def built_depths(
    rig: StereoRig, thetas: Array, points: Array, together: JointDraw | None = None
) -> tuple[Array, Array, Rays | None]:
    """Depths (n, m) m that `rig` is taken for reads of `points` (m, 3), when rigs are off by `thetas`, and by
    what is off `together`.

    Also their pixels (4, n, m) and, for a rig whose lenses distort, the rays that `rig` makes of them.
    """
    batch = RigBatch(rig, thetas)
    pixels = batch.project(points) if together is None else project_joint(batch, together, points)
    if rig.left.lens is not None or rig.right.lens is not None:
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
    judges: Sequence[Judge],
    built: Array,
    compensators: Sequence[Compensator],
    rng: np.random.Generator,
) -> tuple[DepthErrors, ...]:
    """What rigs off by `built` (n, q) standard deviations make of points at each depth of `planes`.

    Each depth has its judge. Every rig is recalibrated by each of up to two `compensators` as well, the first
    of which knows nothing beforehand, and the second the tolerances; both see the same pictures.
    """
    points = np.concatenate(list(planes.values()))
    cuts = _cuts(planes)
    scaled, scaled_rows = first_order(rig, off, points), first_order_rows(rig, off, points)
    linear, as_seen = np.empty((len(cuts), len(built))), np.empty((len(cuts), len(built)))
    assumed = RigBatch(rig, np.zeros((1, len(PARAMETERS))))
    seen: list[list[list[Rigs]]] = [[[] for _ in cuts] for _ in range(1 + len(compensators))]
    size = rigs_a_block(len(points))
    for start in range(0, len(built), size):
        block = slice(start, start + size)
        drawn = built[block]
        depth, pixels, read = built_depths(rig, off.thetas(drawn), points, off.together(drawn))
        rays = read or read_rays(rig, pixels)
        found = [(depth, row_errors_px(assumed, rays))]
        errors = drawn @ scaled.T
        for i, cut in enumerate(cuts):
            linear[i, block] = np.einsum("nm,nm->n", errors[:, cut], errors[:, cut]) / len(points[cut])
            as_seen[i, block] = rms_px(pixels[3, :, cut] - pixels[1, :, cut])
        if compensators:
            known = drawn * off.std * ~off.after_calibration @ off.effect
            observed = compensators[0].observe(known, rng)
        for compensator in compensators:
            batch = RigBatch(rig, compensator.solve(*observed))
            found.append(_own_reading(batch, batch.rays(pixels, rays)))
        for per_depth, (depths, rows) in zip(seen, found, strict=True):
            for rigs, cut, judge in zip(per_depth, cuts, judges, strict=True):
                rigs.append(_judged(depths[:, cut], rows[:, cut], judge))
    whole = [_that_keep_rows([_joined(rigs) for rigs in per_depth], judges[0]) for per_depth in seen]
    result = []
    for i, (depth_m, cut) in enumerate(zip(planes, cuts, strict=True)):
        states = [per_depth[i] for per_depth in whole]
        mean_square = float((states[0].build_mm ** 2).mean()) * 1e-6
        result.append(
            DepthErrors(
                depth_m,
                1e3 * judges[i].noise_m,
                1e3 * math.sqrt((scaled[cut] ** 2).sum(axis=1).mean()),
                1e3 * math.sqrt(mean_square),
                math.sqrt(float(linear[i].mean()) / mean_square) if mean_square > 0 else 1.0,
                states[0],
                states[1] if len(states) > 1 else None,
                states[2] if len(states) > 2 else None,
                math.sqrt((scaled_rows[cut] ** 2).sum(axis=1).mean()),
                rms(as_seen[i]),
            )
        )
    return tuple(result)


def _cuts(planes: Mapping[float, Array]) -> list[slice]:
    """Which of all points lie at each depth."""
    ends = np.cumsum([0, *map(len, planes.values())])
    return [slice(int(start), int(stop)) for start, stop in pairwise(ends)]


def _own_reading(batch: RigBatch, rays: Rays) -> tuple[Array, Array]:
    """Depths (n, m) m and rows (n, m) px that rigs read with their own calibrations."""
    return batch.triangulate(rays)[2], row_errors_px(batch, rays)


def _judged(depths: Array, rows: Array, judge: Judge) -> Rigs:
    alone = judge.without_noise
    return Rigs(
        1e3 * alone.rms_m(depths),
        1e3 * judge.rms_m(depths),
        judge.is_good(depths),
        alone.is_good(depths),
        rms_px(rows),
    )


def _that_keep_rows(per_depth: Sequence[Rigs], judge: Judge) -> list[Rigs]:
    """The same rigs at each depth; where rows are bound, those alone are good that keep them at every one."""
    limit_px = judge.required.row_px
    if limit_px is None:
        return list(per_depth)
    keep = np.max([rigs.row_px for rigs in per_depth], axis=0) <= limit_px
    return [rigs.that(keep) for rigs in per_depth]


def _joined(parts: Sequence[Rigs]) -> Rigs:
    return Rigs(
        *(np.concatenate([getattr(part, item.name) for part in parts]) for item in fields(Rigs) if item.init)
    )


def percentile_mm(per_rig_mm: Array, percent: float) -> float:
    """A percentile over rigs; infinite where that many lose a point."""
    return float(np.percentile(per_rig_mm, percent, method="higher"))
