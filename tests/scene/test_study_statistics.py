"""Block-wise statistics say what numpy says of all errors at once."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rigsim.study.scene.statistics import ErrorStatistics, summarize

N, T = 40, 300
VIEW = [2, 0, 1]


def gather(errors: np.ndarray, groups: np.ndarray, covariance: np.ndarray, block: int) -> ErrorStatistics:
    stats = ErrorStatistics(errors.shape[1], groups.astype(np.int32), int(groups.max()) + 1)
    W = np.linalg.inv(np.linalg.cholesky(covariance))
    whitening = np.stack([np.full(errors.shape[1], W[i, j]) for i in range(3) for j in range(i + 1)])
    near = np.full(errors.shape[1], np.inf)  # no trial is at infinity
    for start in range(0, len(errors), block):
        # the view errors are any three numbers: here the metric ones in another order
        part = errors[start : start + block]
        stats.add(part, part[..., VIEW], whitening, near)
    return stats


@pytest.fixture
def errors() -> np.ndarray:
    return np.random.default_rng(0).standard_normal((T, N, 3)) * (0.01, 0.02, 0.05) + (0, 0, 0.003)


COVARIANCE = np.array([[1e-4, 2e-5, 5e-5], [2e-5, 4e-4, 1e-5], [5e-5, 1e-5, 25e-4]])


@pytest.mark.parametrize("block", [1, 7, T])
def test_moments_and_quantiles(errors: np.ndarray, block: int):
    stats = gather(errors, np.zeros(N), COVARIANCE, block)
    depth = np.linspace(1, 4, N)
    got = summarize(stats, depth, np.ones(N, dtype=bool), slice(0, 1))
    assert got is not None
    z = errors[..., 2]
    assert got.n == N * T
    assert got.bias_m == pytest.approx(z.mean(), rel=1e-9)
    assert got.rmse_m == pytest.approx(math.sqrt((z**2).mean()), rel=1e-12)
    assert got.relative_rmse == pytest.approx(math.sqrt(((z / depth) ** 2).mean()), rel=1e-12)
    assert got.point_rmse_m == pytest.approx(math.sqrt((errors**2).sum(-1).mean()), rel=1e-12)
    assert got.abs_p50_m == pytest.approx(np.quantile(np.abs(z), 0.5), rel=3e-3)
    assert got.abs_p95_m == pytest.approx(np.quantile(np.abs(z), 0.95), rel=3e-3)
    seen = errors[..., VIEW]
    nees = np.einsum("tni,ij,tnj->tn", seen, np.linalg.inv(COVARIANCE), seen).mean()
    assert got.nees == pytest.approx(nees, rel=1e-9)
    np.testing.assert_allclose(stats.sum_view, seen.sum(axis=0).T, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(stats.sum_depth_w2, (seen[..., 0] ** 2 / COVARIANCE[0, 0]).sum(axis=0))


def test_failures_are_left_out_and_counted(errors: np.ndarray):
    errors[::3, 5] = np.nan
    errors[:, 9] = np.nan
    stats = gather(errors, np.zeros(N), COVARIANCE, 50)
    got = summarize(stats, np.ones(N), np.ones(N, dtype=bool), slice(0, 1))
    assert got is not None
    assert got.n == np.isfinite(errors[..., 2]).sum()
    assert got.rmse_m == pytest.approx(math.sqrt(np.nanmean(errors[..., 2] ** 2)), rel=1e-12)
    assert np.isnan(stats.depth_rmse_m[9])


def test_trials_at_infinity_count_but_have_no_metric_error():
    # 1/Z is 4 standard deviations from 0: -3.5 of them leave half of one, and that is at infinity
    stats = ErrorStatistics(1, np.zeros(1, dtype=np.int32), 1)
    whitening = np.array([1.0, 0, 1, 0, 0, 1])[:, None]
    view = np.zeros((3, 1, 3))
    view[:, 0, 0] = (1.0, -2.5, -3.5)
    stats.add(view * 100, view, whitening, np.array([4.0]))
    assert stats.count[0] == 3
    assert stats.n_finite[0] == 2
    got = summarize(stats, np.ones(1), np.ones(1, dtype=bool), slice(0, 1))
    assert got is not None
    assert stats.sum_depth_w2[0] == pytest.approx(1 + 2.5**2 + 3.5**2)
    assert got.nees == pytest.approx((1 + 2.5**2 + 3.5**2) / 3)


def test_points_out_of_every_group_do_not_move_quantiles(errors: np.ndarray):
    errors[:, 3] = 1e3
    groups = np.zeros(N)
    groups[3] = -1
    kept = groups >= 0
    got = summarize(gather(errors, groups, COVARIANCE, 50), np.ones(N), kept, slice(0, 1))
    assert got is not None
    assert got.abs_p95_m == pytest.approx(np.quantile(np.abs(errors[:, kept, 2]), 0.95), rel=3e-3)


def test_groups_keep_their_own_quantiles(errors: np.ndarray):
    groups = np.arange(N) % 2
    errors[:, 1::2] *= 10
    stats = gather(errors, groups, COVARIANCE, 50)
    for group in (0, 1):
        got = summarize(stats, np.ones(N), groups == group, slice(group, group + 1))
        assert got is not None
        expected = np.quantile(np.abs(errors[:, group::2, 2]), 0.5)
        assert got.abs_p50_m == pytest.approx(expected, rel=3e-3)


def test_nothing_succeeded_is_no_summary(errors: np.ndarray):
    stats = gather(errors * np.nan, np.zeros(N), COVARIANCE, 50)
    assert summarize(stats, np.ones(N), np.ones(N, dtype=bool), slice(0, 1)) is None


@pytest.mark.parametrize("n_trials", [2, 100])
def test_confidence_interval_covers_19_of_20(n_trials: int):
    rng = np.random.default_rng(1)
    sigma = rng.uniform(0.5, 3.0, 200)  # points differ: the interval is about these very points
    true_rmse = math.sqrt((sigma**2).mean())
    covered = 0
    repeats = 400
    for _ in range(repeats):
        errors = np.zeros((n_trials, 200, 3))
        errors[..., 2] = rng.standard_normal((n_trials, 200)) * sigma
        got = summarize(
            gather(errors, np.zeros(200), np.eye(3), n_trials),
            np.ones(200),
            np.ones(200, dtype=bool),
            slice(0, 1),
        )
        assert got is not None
        covered += got.ci_low_m <= true_rmse <= got.ci_high_m
    # 99.9 % of a binomial of 400 at 0.95; a two-trial variance estimate is heavy-tailed, which costs a little
    assert covered / repeats > (0.90 if n_trials == 2 else 0.91)
    assert covered / repeats < 0.99
