"""Every picture predicted by the others, to first order about the rig of all: one linearisation for all.

With a board's six numbers eliminated, a pair has residuals r and slopes M. The rig of the others differs by
``d = -C M^T r``, C the inverse of the sum of the others' ``M^T M``; the pair's residuals with it are
``r - M d``, and the others' sum of squares is less by ``d^T C^-1 d`` than at the rig of all. What is
predicted is as in `rigsim.study.calibrate.pictures.held_out`, which calibrates anew.
"""

from __future__ import annotations

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.study.calibrate.pictures.fit import PicturesFit
from rigsim.theory.calibration.information import slopes

_LEAST_VALUE = 1e-7
"""Of the others' slopes, over the largest one: below, they leave something open."""


def ratios_at_once(fit: PicturesFit) -> Array:
    """Root of the observed over the predicted squared residual of each pair (n,); NaN where the others leave
    the rig open."""
    reduced = [_reduced(fit, k) for k in range(len(fit.sightings))]
    triangles = [np.linalg.qr(M, mode="r") for M, _, _ in reduced]
    squares = np.array([float(r @ r) for _, r, _ in reduced])
    counts = np.array([count for *_, count in reduced])
    free = fit.parameters.basis(fit.adjusted.rig).shape[1]
    ratios = np.full(len(reduced), np.nan)
    for k, (M, r, count) in enumerate(reduced):
        others = np.arange(len(reduced)) != k
        stacked = np.concatenate([triangles[j] for j in np.flatnonzero(others)])
        scale = np.sqrt((stacked * stacked).sum(axis=0))
        spare = counts[others].sum() - 6 * others.sum() - free
        if (scale == 0).any() or spare <= 0 or count <= 6:
            continue
        _, values, rows = np.linalg.svd(stacked / scale, full_matrices=False)
        if len(values) < free or values[-1] <= _LEAST_VALUE * values[0]:
            continue
        root = rows.T / values / scale[:, None]  # C = root root^T
        across = M @ root
        toward = across.T @ r
        held = r + across @ toward
        noise2 = (squares[others].sum() - float(toward @ toward)) / spare
        ratios[k] = np.sqrt(held @ held / (noise2 * (count - 6 + float(np.sum(across * across)))))
    return ratios


def _reduced(fit: PicturesFit, pair: int) -> tuple[Array, Array, int]:
    """Slopes (N, q) of the free parameters and residuals (N,) of one pair beside its board's pose, and N."""
    found = fit.adjusted
    at = np.array([pair])
    J, J_pose = slopes(found.rig, fit.parameters, found.board, found.poses.chosen(at))
    weights = fit.sightings.weights[pair][..., None]
    r = found.residuals[pair] * weights
    known = np.isfinite(r)
    J, J_pose = (each[0] * weights[..., None] for each in (J, J_pose))
    q, _ = np.linalg.qr(J_pose[known])
    M = J[known] @ fit.parameters.basis(found.rig)
    return M - q @ (q.T @ M), r[known] - q @ (q.T @ r[known]), int(known.sum())
