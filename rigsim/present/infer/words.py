"""What an inference says, in a sentence."""

from __future__ import annotations

from rigsim.present.kit.format import number, plain, with_interval
from rigsim.study.infer.run import Inference, Transfer


def sentence(inference: Inference) -> str:
    """What follows from the fit, in words."""
    fit = inference.fit
    if fit is None:
        sigma = inference.disparity_std_px
        return (
            f"A disparity noise of {number(sigma)} px, {number(sigma / 2**0.5)} px per pixel coordinate, "
            "would explain it. Whether it is stereo noise is untested: at least three different distances "
            "tell it from other causes."
        )
    exponent, low, high = with_interval(fit.exponent, fit.exponent_low, fit.exponent_high)
    grows = f"the error grows as distance to the power {exponent} ({low} to {high})"
    if fit.verdict == "consistent":
        if fit.best == "quadratic":
            return f"Stereo noise can explain it: {grows}, and 2 is in that range."
        return (
            f"Stereo noise may explain it: {grows}. A {fit.best} law fits a little better, but not"
            " significantly."
        )
    if fit.best == "quadratic":
        return f"Not stereo noise alone: {grows}, and 2 is not in that range."
    return (
        f"This cannot be stereo noise: a {fit.best} law fits better"
        f" ({_percent(fit.misfit[fit.best])} misfit against {_percent(fit.misfit['quadratic'])});"
        f" {grows}. The disparity noise below is an average, not a law."
    )


def whose(inference: Inference, carried: Transfer) -> str:
    """Which rig the noise is carried over to."""
    return "same rig" if carried.rig == inference.rig else "other rig"


def _percent(share: float) -> str:
    return f"{plain(100 * share, 2)} %" if share >= 1e-4 else "no"
