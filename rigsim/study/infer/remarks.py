"""What is odd about depth errors and the noise behind them: questions and warnings, no refusals."""

from __future__ import annotations

import numpy as np

from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.study.infer.run import Inference, disparities_on_axis
from rigsim.theory.uncertainty import LEAST_DEPTH_SIGMAS

_LEAST_PX, _MOST_PX = 0.002, 5.0
"""Disparity noise of matchers lies well within: .05 px of a board's corner to 2 px of a coarse search."""
_UNEVEN = 1.25
"""Ratio between the two sides of bounds that rounding of a data sheet does not explain."""


def remarks(inference: Inference, units_written: bool = False) -> tuple[Remark, ...]:
    """What a person should know beside `inference`; `units_written` where no unit can have been mistaken."""
    return (*_noisy(inference), *_units(inference, units_written))


def bounds_remark(rig: StereoRig, said: str, near_m: float, depth_m: float, far_m: float) -> Remark | None:
    """A word on bounds ``near:far@depth`` that no single disparity error gives; None where one does."""
    near_px, middle_px, far_px = disparities_on_axis(rig, np.array([near_m, depth_m, far_m]))
    nearer, farther = float(near_px - middle_px), float(middle_px - far_px)
    if max(nearer, farther) <= _UNEVEN * min(nearer, farther):
        return None
    return Remark(
        "uneven_bounds",
        f"claim {said}: the near bound is {nearer:.3g} px of disparity away and the far one {farther:.3g} px,"
        " and one disparity error has both signs; their mean,"
        f" {(nearer + farther) / 2:.3g} px, is taken: write one error, as in 10mm@3m, where that is meant",
    )


def _noisy(inference: Inference) -> list[Remark]:
    errors = inference.errors
    sigmas = errors.means_m / errors.stds_m
    far = np.flatnonzero(sigmas < LEAST_DEPTH_SIGMAS)
    if not len(far):
        return []
    where = ", ".join(f"{errors.depths_m[i] * 1e3:g} mm ({sigmas[i]:.2g} sigma)" for i in far[:3])
    more = f" and {len(far) - 3} more" if len(far) > 3 else ""
    return [
        Remark(
            "far_too_noisy",
            f"the depth is under {LEAST_DEPTH_SIGMAS:g} of its own standard deviations at {where}{more}:"
            " depth errors are far from normal there, and a standard deviation says little; nearer distances"
            " tell more",
        )
    ]


def _units(inference: Inference, units_written: bool) -> list[Remark]:
    sigma = inference.disparity_std_px
    if _LEAST_PX <= sigma <= _MOST_PX:
        return []
    depths_mm = inference.errors.depths_m * 1e3
    span = f"{depths_mm.min():g} to {depths_mm.max():g} mm" if np.ptp(depths_mm) else f"{depths_mm[0]:g} mm"
    question = "check the distances, the errors and the rig"
    if not units_written and _LEAST_PX <= sigma / 1e3 <= _MOST_PX:
        # K goes with the square of the distance: both in metres make the noise 1000 times too large
        question = f"are these metres? Columns are in mm; times 1000 the noise is {sigma / 1e3:.2g} px"
    elif not units_written and sigma < _LEAST_PX:
        question = "is the standard deviation in metres, and the distance in mm?"
    text = f"a disparity noise of {sigma:.3g} px at {span}, while matchers reach 0.05 to 2 px: {question}"
    return [Remark("unit", text)]
