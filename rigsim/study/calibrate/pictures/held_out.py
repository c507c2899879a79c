"""Each picture predicted by the others.

The rig is calibrated without one pair; then that pair's board is put where the rig explains its corners best.
What is left over, ``r = P (e - J d)``, is the corners' own noise e and the held-out rig's error d, without
what the board's six numbers take up (P). With noise of variance s^2 and a rig of covariance C,

    E |r|^2 = s^2 (N - 6) + trace(A C),    A = J^T P J,

N coordinates, A what the pair would tell of the rig. The ratio is the root of what is observed over that; s
is the others' noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig.arrays import Array
from rigsim.study.calibrate.pictures.fit import PicturesFit, adjusted_from
from rigsim.study.calibrate.pictures.sightings import Sightings
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.covariance import Undetermined, rig_covariance
from rigsim.theory.calibration.information import slopes

_STEPS = 12
_STILL = 1e-12


@dataclass(frozen=True, slots=True, eq=False)
class HeldOut:
    """One pair as the others predict it."""

    ratio: float
    """Root of the observed over the predicted squared residual; NaN where the others leave the rig open."""
    residuals: Array
    """Its residuals (2, m, 2) px with the others' rig, its board put where it fits best."""
    fit: PicturesFit
    """The others' rig."""
    pose: BoardPoses
    """Where it has the board: one pose."""


def held_out(fit: PicturesFit, pair: int) -> HeldOut:
    """One of the pairs that were fitted, by the rig of all others."""
    start = fit.adjusted.poses.chosen(np.array([pair]))
    return predicted(without(fit, pair), fit.sightings, pair, start)


def without(fit: PicturesFit, pair: int) -> PicturesFit:
    """The same without one of the pairs."""
    others, found = np.arange(len(fit.sightings)) != pair, fit.adjusted
    return adjusted_from(fit.sightings.chosen(others), fit.parameters, found.rig, found.poses.chosen(others))


def predicted(fit: PicturesFit, sightings: Sightings, pair: int, start: BoardPoses) -> HeldOut:
    """A pair of `sightings` that is none of those that were fitted; `start` is about where its board was."""
    pose, J, J_pose, r = _put(fit, sightings, pair, start, (0, 1))
    residuals = np.where(
        np.isfinite(sightings.observed[pair]),
        sightings.observed[pair] - pose.project(fit.adjusted.rig, fit.adjusted.board)[0],
        np.nan,
    )
    N = int(np.count_nonzero(J_pose.any(axis=1)))
    try:
        C = rig_covariance(fit.adjusted.rig, fit.parameters, fit.information, 1.0)
    except Undetermined:
        return HeldOut(float("nan"), residuals, fit, pose)
    q, _ = np.linalg.qr(J_pose)
    rest = J - q @ (q.T @ J)
    expected = fit.noise_px**2 * (N - 6 + float(np.sum((rest @ C) * rest)))
    ratio = float(np.sqrt(r @ r / expected)) if expected > 0 and N > 6 else float("nan")
    return HeldOut(ratio, residuals, fit, pose)


def alone_rms(fit: PicturesFit, sightings: Sightings, pair: int, side: int, start: BoardPoses) -> float:
    """Root mean square residual of one coordinate, px, where one camera alone says where its board is."""
    *_, r = _put(fit, sightings, pair, start, (side,))
    return float(np.sqrt(np.mean(r * r))) if r.size else float("nan")


def _put(
    fit: PicturesFit, sightings: Sightings, pair: int, start: BoardPoses, sides: tuple[int, ...]
) -> tuple[BoardPoses, Array, Array, Array]:
    """A board where a rig explains its corners best; the weighted slopes (k, p) and (k, 6), and the residuals
    (k,) that are left."""
    rig, board = fit.adjusted.rig, fit.adjusted.board
    observed, weights = sightings.observed[pair, list(sides)], sightings.weights[pair, list(sides)]
    pose, best, damping = start, np.inf, 1e-9
    trial = start
    kept = (np.zeros((0, 0)), np.zeros((0, 6)), np.zeros(0))
    for _ in range(_STEPS):
        r = (observed - trial.project(rig, board)[0, list(sides)]) * weights[..., None]
        known = np.isfinite(r) & np.isfinite(observed)
        cost = float(np.sum(r[known] ** 2))
        if known.sum() == np.isfinite(observed).sum() and cost <= best:
            J, J_pose = slopes(rig, fit.parameters, board, trial)
            J, J_pose = (each[0, list(sides)] * weights[..., None, None] for each in (J, J_pose))
            done = best - cost <= _STILL * cost + 1e-18
            pose, best, damping = trial, cost, damping / 10
            kept = (J[known], J_pose[known], r[known])
            if done:
                break
        else:
            damping = max(damping, 1e-9) * 100
        if not kept[2].size:
            break
        A = kept[1].T @ kept[1]
        try:
            damped = A + damping * np.diag(np.diagonal(A))
            step: Array = np.asarray(np.linalg.solve(damped, kept[1].T @ kept[2]), dtype=np.float64)
            trial = pose.moved(step[None])
        except (np.linalg.LinAlgError, InvalidRig):
            break
    return pose, *kept
