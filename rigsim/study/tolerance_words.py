"""What a tolerance study says, in sentences."""

from __future__ import annotations

import numpy as np

from rigsim.study.tolerance_inputs import QUANTITIES
from rigsim.study.tolerance_yield import ToleranceResult


def interactions_sentence(result: ToleranceResult) -> str:
    """Whether quantities act on one another, by the Sobol indices of the depth error; empty without any."""
    found, at = result.interactions, f"{result.required.depth_m:g} m"
    if found is None:
        if np.isfinite(result.judged.per_rig_mm).all():
            return ""
        return (
            f"No Sobol indices at {at}: some rigs have no depth at all there, so its error has no variance;"
            " judge the rigs at a nearer distance."
        )
    error = found.error
    if not error.noticed:
        return (
            "Each quantity acts on its own: no interaction beyond 1 % of the variance and the sampling error."
        )
    worst = sorted(error.noticed, key=lambda place: -error.together[place])
    named = ", ".join(
        f"{QUANTITIES[found.keys[place]]} ({100 * error.total[place]:.1f} % with others,"
        f" {100 * error.first[place]:.1f} % alone)"
        for place in worst[:3]
    )
    return f"Quantities act on one another: {named}. Shares of the first order do not say all."


def recalibration_sentence(result: ToleranceResult) -> str:
    """What the recalibration has to work with, and that reality is worse; empty without one."""
    session, length_m = result.recalibration, result.known_length_m
    if session is None or length_m is None:
        return ""
    return (
        f"Recalibration at its best: {session.features} features in {session.pictures} pictures,"
        f" {session.noise_px:g} px each, averaged to {session.averaged_px:.2g} px; one length of"
        f" {length_m:.3g} m known to {session.length_std_mm:g} mm; no false match, no lens error but the"
        " tolerances' own."
    )
