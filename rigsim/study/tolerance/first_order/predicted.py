"""What to expect of built rigs to first order, in milliseconds: to choose among many, and to say what limits.

`rigsim.study.tolerance.count` builds them one by one; this is only as good as the first order.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.study.tolerance.batch import PARAMETERS
from rigsim.study.tolerance.built import draw
from rigsim.study.tolerance.judge import make_judge
from rigsim.study.tolerance.recalibration.session import Build, make_compensator
from rigsim.study.tolerance.rows import RowJudge, make_row_judge, row_slopes
from rigsim.study.tolerance.sensitivities import (
    BuildRequirement,
    Causes,
    causes,
    depth_slopes,
    shared_points,
)

NOISE = "noise"
"""What limits where nothing that is built does."""
_RIGS, _POINTS = 1000, 24


def quantity_of(parameter: str) -> str:
    """The key, in `QUANTITIES`, of one of `PARAMETERS`: they differ in their units."""
    for ending, instead in (("_rad", "_deg"), ("_m", "_mm")):
        if parameter.endswith(ending):
            return parameter.removesuffix(ending) + instead
    return parameter


@dataclass(frozen=True, slots=True)
class Expected:
    """Built rigs as expected to first order."""

    good: float
    """Share of them that meets the requirement with its pixel noise."""
    limited_by: str
    """The quantity without whose error the mean square depth error would fall most, or `NOISE`; where a
    bound on rows fails more rigs, that of the row misalignment."""
    remaining_std: float
    """That quantity's standard deviation as built, or as calibrated, in `PARAMETERS`' units; noise: px."""


def expect(build: Build, required: BuildRequirement, range_m: tuple[float, float], seed: int = 0) -> Expected:
    """Rigs of `build` at first order.

    Raises:
        InvalidRange: no tolerance, or a depth that not both cameras see.
    """
    off = causes(build.rig, build.tolerances)
    points = shared_points(build.rig, required.depth_m, _POINTS)
    judge = make_judge(build.rig, points, required, build.noise_px)
    slopes, rows = depth_slopes(build.rig, points, off), _rows(build, required, range_m, off)
    rng = np.random.default_rng(seed)
    drawn = draw(off, _RIGS, rng) * off.std
    late = off.after_calibration
    thetas = drawn * late @ off.effect
    information = None
    if build.recalibration is None or late.all():
        thetas = thetas + drawn * ~late @ off.effect
        early = np.diag(((off.effect * off.std[:, None])[~late] ** 2).sum(axis=0))
    else:
        information = make_compensator(build.rig, off, build.recalibration, range_m).information()
        early = _covariance(information)
        thetas = thetas + rng.multivariate_normal(np.zeros(len(PARAMETERS)), early, _RIGS, method="eigh")
    good = judge.is_good(points[:, 2] + thetas @ slopes.T)
    by_rows = False
    if rows is not None:
        keep = rows.judge.keeps(thetas @ rows.slopes.T)
        by_rows = bool(keep.mean() < good.mean())
        good &= keep
    by_quantity = _by_quantity(off, rows.slopes if rows is not None and by_rows else slopes, information)
    worst = max(by_quantity, key=lambda key: by_quantity[key])
    share = float(good.mean())
    if not by_rows and judge.noise_m**2 > by_quantity[worst]:
        return Expected(share, NOISE, build.noise_px)
    return Expected(share, worst, _std_of(worst, off, early))


class _RowErrors(NamedTuple):
    judge: RowJudge
    slopes: Array


def _rows(
    build: Build, required: BuildRequirement, range_m: tuple[float, float], off: Causes
) -> _RowErrors | None:
    """Who judges rows, and their slopes (m, 12) there; None where nobody asks."""
    if required.row_px is None:
        return None
    depths_m = (required.depth_m, *range_m)
    planes = tuple(shared_points(build.rig, depth_m, _POINTS) for depth_m in depths_m)
    judge = make_row_judge(required.row_px, planes)
    return _RowErrors(judge, row_slopes(build.rig, judge.points, off))


def _by_quantity(off: Causes, slopes: Array, information: Array | None) -> dict[str, float]:
    """What each quantity does to the mean square of what has these slopes (m, 12)."""
    if information is None:
        return _as_built(off, slopes)
    late = off.after_calibration
    of_late = slopes @ ((off.effect * off.std[:, None])[late]).T
    late_keys = (key for key, after in zip(off.keys, late, strict=True) if after)
    return _as_calibrated(information, slopes) | {
        key: float((of_late[:, i] ** 2).mean()) for i, key in enumerate(late_keys)
    }


def _as_built(off: Causes, slopes: Array) -> dict[str, float]:
    """Mean square, m^2 or px^2, that each quantity makes; what the left and the right camera err is one."""
    squares = ((slopes @ off.effect.T * off.std) ** 2).mean(axis=0)
    found: dict[str, float] = {}
    for key, square in zip(off.keys, squares, strict=True):
        name = key.replace("left_", "right_")
        found[name] = found.get(name, 0.0) + float(square)
    return found


def _as_calibrated(information: Array, slopes: Array) -> dict[str, float]:
    """By how much the mean square, m^2 or px^2, would fall, were one quantity known."""
    whole = _mean_square(information, slopes)
    found = {}
    for place, name in enumerate(PARAMETERS):
        if np.isfinite(information[place, place]):
            known = information.copy()
            known[place, :] = known[:, place] = 0.0
            known[place, place] = np.inf
            found[quantity_of(name)] = whole - _mean_square(known, slopes)
    return found


def _mean_square(information: Array, slopes: Array) -> float:
    return float(np.einsum("mi,ij,mj->m", slopes, _covariance(information), slopes).mean())


def _covariance(information: Array) -> Array:
    free = np.flatnonzero(np.isfinite(np.diag(information)))
    found = np.zeros_like(information)
    size = np.sqrt(np.diag(information)[free])
    scaled = information[np.ix_(free, free)] / np.outer(size, size)
    found[np.ix_(free, free)] = np.linalg.inv(scaled) / np.outer(size, size)
    return found


def _std_of(key: str, off: Causes, early: Array) -> float:
    """Of a quantity that may be a parameter's, or one of its own."""
    names = [quantity_of(name) for name in PARAMETERS]
    if key in names:
        return float(np.sqrt(early[names.index(key), names.index(key)]))
    return float(off.std[off.keys.index(key)])
