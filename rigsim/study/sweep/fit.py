"""Mistakes with an amount, fitted to the answers of a triangulator, and two rigs told apart.

Amounts are fitted in the views ``(1/Z, X/Z, Y/Z)``, where errors are linear in the pixels, weighted by
their covariance under pixel noise.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig.arrays import Array
from rigsim.rig.lens.distortion import are_brown, brown_of
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.study.agreement.views import views
from rigsim.study.saying import Saying, saying
from rigsim.study.sweep.models import Model, models
from rigsim.theory.triangulation import triangulate

_STEPS = 8
_FITTED_OUT = 8
_NO_ANSWER = 1e6
_ROUNDING = 1e-12
_SMALL_PART = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A mistake with the amount that explains the answers best."""

    model: Model
    """The mistake."""
    amount: float
    """Truth minus what the triangulation takes, in `Model.unit`."""
    amount_se: float
    """Its standard error from what the fit leaves, in `Model.unit`."""
    explained: float
    """Share of the weighted mean square error that it explains."""

    @property
    def said(self) -> Saying:
        """The mistake with its amount."""
        amount = saying("amount", amount=self.amount, amount_se=self.amount_se, unit=self.model.unit)
        return saying(f"{self.model.name}: {'more' if self.amount >= 0 else 'less'}", amount=amount)


def fits(rig: StereoRig, points_left: Array, found_left: Array, whitening: Array) -> list[Fit]:
    """The mistakes with an amount that explain found points (N, 3) m best, the likelier first.

    Every one is tried with one step of Newton's; the best of these are fitted out.
    """
    tried = [fit(model, found_left, whitening, 1) for model in models(rig, points_left)]
    least = sorted((one.explained for one in tried), reverse=True)[_FITTED_OUT - 1]
    return [fit(one.model, found_left, whitening) for one in tried if one.explained >= least]


def fit(model: Model, found_left: Array, whitening: Array, steps: int = _STEPS) -> Fit:
    """The amount of a mistake that comes nearest to found points (N, 3) m; none of them NaN.

    Args:
        model: the mistake.
        found_left: what came back.
        whitening: (N, 3, 3) that makes errors of the views white.
        steps: of Newton's, at most.
    """
    target = views(found_left)
    start = target - views(model.answers(0.0))
    total = _square(whitening, start)
    amount, residual, square, slope2 = 0.0, start, total, 0.0
    for _ in range(steps):
        ahead, behind = (views(model.answers(amount + step)) for step in (model.step, -model.step))
        slope = np.einsum("nij,nj->ni", whitening, (ahead - behind) / (2 * model.step))
        slope2 = float(np.nansum(slope**2))
        if not slope2 > 0:
            break
        white = np.einsum("nij,nj->ni", whitening, residual)
        tried = amount + float(np.nansum(slope * white)) / slope2
        try:
            residual_then = target - views(model.answers(tried))
        except InvalidRig:
            break  # no rig has such an amount
        square_then = _square(whitening, residual_then)
        if not square_then < square:
            break
        change = abs(tried - amount)
        amount, residual, square = tried, residual_then, square_then
        if change <= 1e-6 * abs(amount):
            break
    spread2 = square / max(3 * len(found_left) - 1, 1)
    se = math.sqrt(spread2 / slope2) if slope2 > 0 else math.inf
    explained = 1 - square / total if total > 0 else 0.0
    return Fit(model, amount * model.scale, se * model.scale, explained)


def _square(whitening: Array, residual: Array) -> float:
    white = np.einsum("nij,nj->ni", whitening, residual)
    # an answer that the mistake does not have explains nothing
    return float((np.where(np.isfinite(white), white, _NO_ANSWER) ** 2).sum())


def rig_differences(assumed: StereoRig, true: StereoRig, points_left: Array, whitening: Array) -> list[Fit]:
    """What tells two rigs apart, each with the share of the mean square error it makes alone, largest first.

    Shares may add up to more or less than 1, as effects cancel or help each other; those under a twentieth of
    the largest are left out.
    """
    known = _differences(assumed, true)
    total = _square(whitening, views(triangulate(assumed, *true.project(points_left))) - views(points_left))
    found = []
    for model in models(assumed, points_left):
        if known.get(model.name):
            off = views(model.answers(known[model.name])) - views(points_left)
            share = _square(whitening, off) / total
            found.append(Fit(model, known[model.name] * model.scale, 0.0, share))
    found.sort(key=lambda one: -one.explained)
    return [one for one in found if one.explained >= _SMALL_PART * found[0].explained]


def _differences(assumed: StereoRig, true: StereoRig) -> dict[str, float]:
    """True minus assumed for every parameter of a rig, by the name of its mistake; rounding left out."""
    turn = Pose(assumed.right_from_left.R @ true.right_from_left.R.T, np.zeros(3)).rotvec_rad
    centre, centre_true = assumed.right_from_left.inverse.t, true.right_from_left.inverse.t
    longer = true.baseline_m / assumed.baseline_m - 1
    aside = centre_true - centre * (1 + longer)
    result = {"baseline": longer, "pitch": turn[0], "yaw": turn[1], "roll": turn[2]}
    result |= {"axial": aside[2], "vertical": aside[1]}
    lenses = {}
    for side, was, now in (("left", assumed.left, true.left), ("right", assumed.right, true.right)):
        bent = (now.lens, was.lens)
        k1 = [brown_of(lens, "k1").k1 for lens in bent] if are_brown(*bent) else [0.0, 0.0]
        lenses[side] = {
            "focal": now.fy / was.fy - 1,
            "fx": now.fx / was.fx - now.fy / was.fy,
            "cx": now.cx - was.cx,
            "cy": now.cy - was.cy,
            "k1": k1[0] - k1[1],
        }
    for name, left in lenses["left"].items():
        right = lenses["right"][name]
        same = abs(left - right) <= 1e-6 * abs(left)
        result |= {f"both-{name}": left} if same else {f"left-{name}": left, f"right-{name}": right}
    return {name: float(amount) for name, amount in result.items() if abs(amount) > _ROUNDING}
