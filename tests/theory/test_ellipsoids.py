"""Ellipsoids of covariances: they give the covariances back."""

from __future__ import annotations

import numpy as np

from rigsim.theory.ellipsoids import ellipsoids


def test_half_axes_and_turns_give_the_covariances_back() -> None:
    root = np.random.default_rng(3).normal(size=(40, 3, 3))
    covariances = root @ root.transpose(0, 2, 1)
    half_axes, turns = ellipsoids(covariances)
    again = turns @ (half_axes[:, :, None] ** 2 * turns.transpose(0, 2, 1))
    np.testing.assert_allclose(again, covariances, atol=1e-12 * np.abs(covariances).max())
    np.testing.assert_allclose(np.linalg.det(turns), 1.0)
    assert (np.diff(half_axes, axis=1) >= 0).all()


def test_what_is_not_known_has_no_ellipsoid_and_spoils_no_other() -> None:
    half_axes, turns = ellipsoids(np.stack([np.full((3, 3), np.nan), np.diag([1.0, 4.0, 9.0])]))
    assert np.isnan(half_axes[0]).all()
    assert half_axes[1].tolist() == [1.0, 2.0, 3.0]
    assert np.isfinite(turns).all()
