"""What would give a sweep a result that has none: every way out is tried in the scene before it is named."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rigsim.errors import InvalidRig, NothingSeen
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.sim.simulator import Simulator
from rigsim.study.agreement.agreement import Agreement, Reason
from rigsim.study.scene.plan import Plan, RigGrid
from rigsim.theory.uncertainty import LEAST_DEPTH_SIGMAS, depth_in_sigmas

_POINTS = 400
_SHARED = 0.1  # of what the left camera sees: less is hardly a stereo rig
_PASSING = 0.5
_NEAREST_M, _FARTHEST_M = 1e-4, 100.0  # baselines that are tried
_STEPS_A_DECADE = 8
_SLIP = 1000.0  # between metres and millimetres
_MOST_MOUNTS = 3


@dataclass(frozen=True, slots=True)
class _Sight:
    """What a placed rig makes of the scene."""

    shared: float = 0.0
    """Share of what the left camera sees that the right one sees too."""
    passing: float = 0.0
    """Share of that with a depth of at least `LEAST_DEPTH_SIGMAS` standard deviations."""
    near_m: float = math.nan
    """Nearest depth of those, m."""
    far_m: float = math.nan
    """Farthest, m."""

    @property
    def is_good(self) -> bool:
        return self.shared >= _SHARED and self.passing >= _PASSING


_NONE: dict[Reason, str] = {
    "all-failed": "every triangulation failed",
    "nothing-shared": "left and right see nothing in common",
    "too-far": f"every depth is below {LEAST_DEPTH_SIGMAS:g} of its standard deviations",
}


def why_none(agreement: Agreement) -> str:
    """Why a row has no result, as part of an error."""
    return agreement.cause or _NONE.get(agreement.reason, agreement.reason)


def advise(simulator: Simulator, rigs: RigGrid | Sequence[StereoRig], plan: Plan) -> str:
    """What to type instead, for rigs that have no result: a question and an order, or what cannot be.

    Args:
        simulator: the scene; a rig stays placed in it.
        rigs: the rigs that were swept.
        plan: of the sweep.
    """
    tried = list(rigs)
    rig, noise = tried[len(tried) // 2], min(plan.noises, key=lambda one: one.std_px)

    def sight(one: StereoRig, range_m: tuple[float, float] | None = plan.range_m) -> _Sight:
        return _look(simulator, one, replace(plan, range_m=range_m), noise)

    found = [*_baselines(rig, sight), *_range(rig, plan, sight)]
    found = found or [*_noise(rig, noise, simulator, plan), *_mounts(rig, simulator, plan, noise)]
    if found:
        return "; or ".join(found[:2])
    return "no baseline, --range, --noise or named --mount of this scene gives this lens a result"


def _look(simulator: Simulator, rig: StereoRig, plan: Plan, noise: PixelNoise) -> _Sight:
    try:
        true_rig, assumed_rig = plan.true_and_assumed(rig)
        simulator.place(true_rig)
        rng = plan.stream("advice", simulator.scene.name, rig)
        truth = simulator.truth(_POINTS, rng, plan.range_m)
    except (NothingSeen, InvalidRig):
        return _Sight()
    points = truth.points_left[truth.visible]
    if not len(points):
        return _Sight()
    passing = depth_in_sigmas(assumed_rig, points, noise) >= LEAST_DEPTH_SIGMAS
    depth_m = points[passing, 2]
    ends = (float(depth_m.min()), float(depth_m.max())) if len(depth_m) else (math.nan, math.nan)
    return _Sight(float(truth.visible.mean()), float(passing.mean()), *ends)


def _baselines(rig: StereoRig, sight: Callable[[StereoRig], _Sight]) -> Iterator[str]:
    """The nearest baseline with a result, and whether a unit was meant."""
    own_m = rig.baseline_m

    def with_baseline(length_m: float) -> StereoRig:
        return next(iter(RigGrid(rig, baselines_m=(length_m,))))

    for slip_m in (own_m * _SLIP, own_m / _SLIP):
        if _NEAREST_M <= slip_m <= _FARTHEST_M and sight(with_baseline(slip_m)).is_good:
            yield f"{_mm(own_m)} of baseline: {_mm(slip_m)} meant? Then give --baseline {_typed(slip_m)}"
            break
    exponents = np.arange(math.log10(_NEAREST_M), math.log10(_FARTHEST_M) + 1e-9, 1 / _STEPS_A_DECADE)
    lengths = [float(f"{10**exponent:.2g}") for exponent in exponents]
    good = [length_m for length_m in lengths if sight(with_baseline(length_m)).is_good]
    longer, shorter = [b for b in good if b > own_m], [b for b in good if b < own_m]
    if longer and (not shorter or longer[0] / own_m < own_m / shorter[-1]):
        yield f"give a longer --baseline: from {_typed(longer[0])} on half of the points have a usable depth"
    elif shorter:
        yield f"give a shorter --baseline: up to {_typed(shorter[-1])} both cameras see enough of the scene"


def _range(rig: StereoRig, plan: Plan, sight: Callable[..., _Sight]) -> Iterator[str]:
    """The depths that have a result, where those asked for have none."""
    whole = sight(rig, None)
    if not whole.passing or whole.shared < _SHARED:
        return
    # inwards, so that whoever types it stays among the points
    near, far = _up(whole.near_m), _down(whole.far_m)
    if (
        near < far
        and (plan.range_m is None or (near, far) != plan.range_m)
        and sight(rig, (near, far)).is_good
    ):
        yield f"give --range {near:g}:{far:g}m, where the depths of this rig are usable"


def _noise(rig: StereoRig, noise: PixelNoise, simulator: Simulator, plan: Plan) -> Iterator[str]:
    """The pixel noise with which the rig has a result."""
    std_px = noise.std_px
    while std_px > 1e-3:
        std_px = float(f"{std_px / 2:.2g}")
        if _look(simulator, rig, plan, replace(noise, std_px=std_px)).is_good:
            yield f"give a --noise of {std_px:g} px or less, if your matcher is that good"
            return


def _mounts(rig: StereoRig, simulator: Simulator, plan: Plan, noise: PixelNoise) -> Iterator[str]:
    """Other places of the scene where the rig has a result."""
    good = []
    for mount in simulator.scene.mounts:
        if mount == simulator.scene.mount:
            continue
        with Simulator(plan.scene, mount, "rays") as other:
            if _look(other, rig, replace(plan, range_m=None), noise).is_good:
                good.append(mount)
        if len(good) == _MOST_MOUNTS:
            break
    if good:
        yield f"give --mount {' or '.join(good)}, from where both cameras see the scene"


def _up(value: float) -> float:
    digit = 10 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.ceil(value / digit) * digit:.2g}")


def _down(value: float) -> float:
    digit = 10 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.floor(value / digit) * digit:.2g}")


def _mm(length_m: float) -> str:
    return f"{length_m:.3g} m" if length_m >= 1 else f"{length_m * 1e3:.3g} mm"


def _typed(length_m: float) -> str:
    """A length as the command line takes it."""
    return f"{length_m:.3g}m" if length_m >= 1 else f"{length_m * 1e3:.3g}"
