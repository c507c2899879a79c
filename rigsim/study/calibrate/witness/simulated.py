"""Whole calibrations of simulated corners: exact projections, noise, least squares; many times."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from rigsim import interrupts
from rigsim.study.calibrate.witness.bench import CalibrationBench
from rigsim.study.calibrate.witness.conclude import Calibrated, Met, conclude
from rigsim.study.calibrate.witness.judge import SIMULATED
from rigsim.study.calibrate.witness.result import CalibrationWitness
from rigsim.theory.calibration.adjust import adjust


def simulate_calibrations(
    bench: CalibrationBench,
    *,
    count: int = 300,
    seed: int = 0,
    progress: Callable[[int], None] | None = None,
) -> CalibrationWitness:
    """Calibrate `count` times, with new noise on the corners each time.

    Args:
        bench: What is calibrated.
        count: How often.
        seed: Of the noise; each calibration has a stream of its own.
        progress: Called with the number done. When it is interrupted (KeyboardInterrupt), what is done by
            then is concluded from.

    Raises:
        Undetermined: the boards leave a parameter open.
    """
    predicted = bench.covariance(bench.corner_noise_px)
    done: list[Calibrated | None] = []
    try:
        for k in range(count):
            rng = np.random.default_rng((seed, k))
            done.append(_calibrated(bench, rng))
            if progress:
                progress(len(done))
    except KeyboardInterrupt:
        if not done:
            raise
        interrupts.caught()
    met = Met("simulated", len(done), bench.corner_noise_px, SIMULATED)
    witness = conclude(met, [one for one in done if one is not None], bench, predicted)
    return replace(witness, boards=len(bench.poses))


def _calibrated(bench: CalibrationBench, rng: np.random.Generator) -> Calibrated | None:
    """One calibration; None where it does not settle."""
    this = bench.drawn(rng)
    exact = this.exact
    observed = exact + bench.corner_noise_px * rng.standard_normal(exact.shape)
    found = adjust(bench.rig, bench.parameters, bench.board, bench.poses, observed)
    # a warp that is looked for has an error of its own; one that is not, no more than what it does to the rig
    errors = (this if bench.parameters.warped else bench).errors(found.rig, found.poses, found.board)
    if not (found.settled and np.isfinite(errors.depth_m).all()):
        return None
    return Calibrated(errors, found.rms_px, int(np.isfinite(observed).sum()))
