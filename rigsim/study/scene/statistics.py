"""Error statistics that are gathered block by block, so that memory does not grow with the trials."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array, Ids, Mask

CI_SIGMAS = 1.959964
"""Half width of a 95 % confidence interval, in standard errors."""

NEAREST_TO_INFINITY = 1.0
"""A trial whose 1/Z is below this many of its standard deviations is at infinity, for all it tells."""

_BINS = 20_000
_LOG_LOW, _LOG_HIGH = math.log(1e-10), math.log(1e5)
_SCALE = _BINS / (_LOG_HIGH - _LOG_LOW)


class ErrorStatistics:
    """Sums over trials for each point, and a histogram of |depth error| for each group of points.

    The histogram has 20,000 logarithmic bins between 1e-10 and 1e5 m, 0.17 % wide: quantiles read
    from it are that precise.
    """

    def __init__(self, n_points: int, groups: Ids, n_groups: int, *, shared: bool = False) -> None:
        """`groups` (N,) puts each point into one of `n_groups`; negative leaves it out of the histogram.

        `shared` says that the points of one trial err together.
        """
        self.shared = shared
        self.count = np.zeros(n_points)
        self.n_finite = np.zeros(n_points)
        self.n_trials = 0
        self.sum_e = np.zeros(n_points)
        self.sum_e2 = np.zeros(n_points)
        self.sum_e4 = np.zeros(n_points)
        self.sum_d2 = np.zeros(n_points)
        self.sum_view = np.zeros((3, n_points))
        self.sum_depth_w2 = np.zeros(n_points)
        self.sum_nees = np.zeros(n_points)
        self.histogram = np.zeros((n_groups, _BINS), dtype=np.int64)
        # points left out fall into a group past the end
        self._offset = np.where(groups < 0, n_groups, groups).astype(np.int64) * _BINS

    def add(self, error_left: Array, error_view: Array, whitening: Array, depth_sigmas: Array) -> None:
        """Take in a block of trials.

        A trial whose ``1/Z`` lies within one standard deviation of infinity counts, but not in the sums
        of metric errors: these would have no expectation.

        Args:
            error_left: triangulated minus true points, (T, N, 3), m; NaN where it failed.
            error_view: the same as ``(1/Z, X/Z, Y/Z)``, (T, N, 3); see `rigsim.study.agreement.views`.
            whitening: (6, N): the lower triangle of W with ``W^T W`` = inverse predicted covariance of
                `error_view`, rows 00 10 11 20 21 22.
            depth_sigmas: ``Z / sigma_Z`` (N,).
        """
        good = np.isfinite(error_left[..., 2])
        whole = bool(good.all())
        self.n_trials += len(good)
        self.count += good.sum(axis=0)
        q0, q1, q2 = (_without(error_view[..., i], good, whole) for i in range(3))
        self.sum_view += np.stack([q.sum(axis=0) for q in (q0, q1, q2)])
        w00, w10, w11, w20, w21, w22 = whitening
        w0 = w00 * q0
        depth_w2 = np.einsum("tn,tn->n", w0, w0)
        self.sum_depth_w2 += depth_w2
        self.sum_nees += depth_w2
        w = w10 * q0 + w11 * q1
        self.sum_nees += np.einsum("tn,tn->n", w, w)
        w = w20 * q0 + w21 * q1 + w22 * q2
        self.sum_nees += np.einsum("tn,tn->n", w, w)
        self._add_metric(error_left, good, good & ~(w0 <= NEAREST_TO_INFINITY - depth_sigmas))

    def _add_metric(self, error_left: Array, good: Mask, finite: Mask) -> None:
        whole = bool(finite.all())
        self.n_finite += finite.sum(axis=0)
        x, y, z = (_without(error_left[..., i], finite, whole) for i in range(3))
        z2 = z * z
        self.sum_e += z.sum(axis=0)
        self.sum_e2 += z2.sum(axis=0)
        self.sum_e4 += np.einsum("tn,tn->n", z2, z2)
        self.sum_d2 += z2.sum(axis=0) + np.einsum("tn,tn->n", x, x) + np.einsum("tn,tn->n", y, y)
        # quantiles take the trials at infinity as they come
        self._add_to_histogram(z2 if whole else _without(error_left[..., 2], good, False) ** 2, good)

    def _add_to_histogram(self, squared: Array, good: Mask) -> None:
        with np.errstate(divide="ignore"):
            place = np.log(squared)
        place *= 0.5 * _SCALE
        place -= _LOG_LOW * _SCALE
        np.clip(place, 0, _BINS - 1, out=place)
        index = place.astype(np.int64)
        index += self._offset
        chosen = index.ravel() if good.all() else index[good]
        n = self.histogram.size
        self.histogram += np.bincount(chosen, minlength=n + _BINS)[:n].reshape(self.histogram.shape)

    @property
    def depth_rmse_m(self) -> Array:
        """RMS depth error of each point over its trials, (N,), m; NaN where none succeeded."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(np.sqrt(self.sum_e2 / self.n_finite))


def _without(values: Array, kept: Mask, whole: bool) -> Array:
    """Contiguous values with 0 where they are not kept."""
    return np.ascontiguousarray(values) if whole else np.where(kept, values, 0.0)


@dataclass(frozen=True, slots=True)
class ErrorSummary:
    """Errors of some points over all trials."""

    n: int
    """Triangulations that succeeded and are not at infinity."""
    bias_m: float
    """Mean depth error, m."""
    rmse_m: float
    """RMS depth error, m."""
    mean_square_se_m2: float
    """Standard error of the mean squared depth error, m^2."""
    ci_low_m: float
    """Lower end of the 95 % confidence interval of the RMS, m."""
    ci_high_m: float
    """Upper end, m."""
    relative_rmse: float
    """RMS of depth error over the point's own depth."""
    point_rmse_m: float
    """RMS distance between triangulated and true point, m."""
    nees: float
    """Mean normalised squared error of (1/Z, X/Z, Y/Z); 3 when the predicted covariance is right."""
    abs_p50_m: float
    """Median absolute depth error, m."""
    abs_p95_m: float
    """95th percentile of the absolute depth error, m."""


def summarize(stats: ErrorStatistics, depth_m: Array, kept: Mask, groups: slice) -> ErrorSummary | None:
    """Pool the points in `kept` (N,), whose histogram groups are `groups`; None when nothing succeeded."""
    n = int(stats.n_finite[kept].sum())
    if n == 0:
        return None
    mean_square = float(stats.sum_e2[kept].sum() / n)
    se = _mean_square_se(stats, kept, n)
    histogram = stats.histogram[groups].sum(axis=0)
    return ErrorSummary(
        n=n,
        bias_m=float(stats.sum_e[kept].sum() / n),
        rmse_m=math.sqrt(mean_square),
        mean_square_se_m2=se,
        ci_low_m=math.sqrt(max(mean_square - CI_SIGMAS * se, 0.0)),
        ci_high_m=math.sqrt(mean_square + CI_SIGMAS * se),
        relative_rmse=math.sqrt(float((stats.sum_e2[kept] / depth_m[kept] ** 2).sum() / n)),
        point_rmse_m=math.sqrt(float(stats.sum_d2[kept].sum() / n)),
        nees=float(stats.sum_nees[kept].sum() / stats.count[kept].sum()),
        abs_p50_m=_quantile(histogram, 0.50),
        abs_p95_m=_quantile(histogram, 0.95),
    )


def _mean_square_se(stats: ErrorStatistics, kept: Mask, n: int) -> float:
    """Standard error of the pooled mean of e^2 for these very points: only the noise is random."""
    count = stats.n_finite[kept]
    repeated = count >= 2
    e2, e4 = stats.sum_e2[kept], stats.sum_e4[kept]
    # a point seen once says nothing of its own spread: take E[e^4], which is not less than the variance
    variance = e4.copy()
    c = count[repeated]
    variance[repeated] = (e4[repeated] - e2[repeated] ** 2 / c) * c / (c - 1)
    if stats.shared:
        # no less than whatever the points have in common can make of it
        return float(np.sqrt(np.maximum(variance, 0.0)).sum()) / n
    return math.sqrt(max(float(variance.sum()), 0.0)) / n


def _quantile(histogram: Array, q: float) -> float:
    """Quantile of |e| from its logarithmic histogram, interpolated within the bin."""
    cumulative = np.cumsum(histogram)
    target = q * cumulative[-1]
    i = int(np.searchsorted(cumulative, target))
    before = float(cumulative[i - 1]) if i else 0.0
    inside = (target - before) / float(histogram[i])
    return math.exp(_LOG_LOW + (i + inside) / _SCALE)
