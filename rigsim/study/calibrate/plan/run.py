"""Plan a calibration: where to hold the board, how many times, and what that leaves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array
from rigsim.rig.noise import PixelNoise
from rigsim.rig.remark import Remark
from rigsim.study.calibrate.depths import depth_stds
from rigsim.study.calibrate.plan.asked import PlanAsked
from rigsim.study.calibrate.plan.choose import Picks, choose
from rigsim.study.calibrate.plan.curve import LONG, PosePool, curve, holds, next_pose
from rigsim.study.calibrate.plan.explain import (
    check_shared,
    focal_openness,
    lens_coefficients,
    rim_openness,
    undetermined,
)
from rigsim.study.calibrate.plan.given import counted
from rigsim.study.calibrate.plan.needed import pictures_needed
from rigsim.study.calibrate.plan.odd import little_room, oddities
from rigsim.study.calibrate.plan.reach import ReachedPoses, random_poses
from rigsim.study.calibrate.plan.result import CalibrationPlan, Inseparable
from rigsim.study.calibrate.plan.terms import depth_terms, plan_information
from rigsim.theory.calibration.covariance import CalibrationCovariance, Undetermined, covariance_of
from rigsim.theory.calibration.flatness import warp_moves
from rigsim.theory.calibration.information import BoardInformation

CANDIDATES, ALONE = 450, 100
"""Poses among which is chosen: that both cameras see, and that one alone does."""
_HARDLY_APART = 0.9
_HARDLY_SHOWN = 0.25
"""Half diagonals of the picture that its corners are open to; likewise."""
_HARDLY_KNOWN = 0.1
"""Share of itself that a focal length is open to: nothing of first order holds beyond."""
_MOST_PAIRS = 8


def run_plan(asked: PlanAsked) -> CalibrationPlan:
    """Choose where to hold the board, or judge where it was said to be held.

    Raises:
        InvalidRange: the board fits nowhere, or a number is out of bounds.
        CalibrationUndetermined: the boards leave some of the parameters open, and why.
    """
    drawing, choosing = (np.random.default_rng([asked.seed, stream]) for stream in (0, 1))
    places, picks, remarks = _places(asked, drawing)
    held = places.reached.chosen(np.array(picks, dtype=np.intp))
    covariance = plan_covariance(asked, held, by_hand=isinstance(asked.poses, int))
    needed, tried = pictures_needed(asked, places, picks)
    long = places.extended(tried, max(LONG, len(tried)))
    return CalibrationPlan(
        asked=asked,
        poses=held.poses,
        seen=held.seen,
        covariance=covariance,
        depths=depth_stds(covariance, asked.at_m, PixelNoise(asked.noise_px)),
        curve=curve(asked, places, long, choosing),
        needed=needed,
        next_pose=next_pose(places, picks),
        inseparable=inseparable(covariance),
        remarks=(*remarks, *oddities(held, covariance, asked)),
    )


def plan_covariance(asked: PlanAsked, held: ReachedPoses, *, by_hand: bool = False) -> CalibrationCovariance:
    """What boards leave of the rig, whose warp nobody knows if `flatness_m` says so.

    What that does, a bias of poses exactly as they are, is the root mean square over many times that
    somebody holds them, if they are held `by_hand`.

    Raises:
        CalibrationUndetermined: they leave some of it open, and why.
    """
    check_shared(held)
    parameters, noise_px = asked.parameters, asked.corner_noise_px
    told, warping = plan_information(asked, held, rooted=True)
    known = np.zeros(len(parameters.names))
    if parameters.warped and asked.flatness_m:
        known[parameters.warp] = asked.flatness_m**-2
    try:
        found = covariance_of(asked.rig, parameters, held.poses, told, noise_px, np.diag(known))
    except Undetermined as error:
        raise undetermined(asked, held, error.names) from None
    open_to = focal_openness(found)
    if open_to > _HARDLY_KNOWN:
        raise undetermined(asked, held, ("the focal lengths",))
    distance_m = float(np.median(np.linalg.norm(held.poses.t, axis=1)))
    if rim_openness(found, distance_m) > _HARDLY_SHOWN:
        raise undetermined(asked, held, lens_coefficients(asked))
    if parameters.warped or not asked.flatness_m:
        return found
    alone = _astray(found, held, warping, noise_px)
    astray = _astray_by_hand(asked, held, alone) if by_hand else alone
    return replace(found, matrix=found.matrix + asked.flatness_m**2 * astray)


def _astray(
    found: CalibrationCovariance, held: ReachedPoses, warping: BoardInformation, noise_px: float
) -> Array:
    """Squares and products (p + 6, p + 6) of what warps do that nobody looks for, per m^2 of each."""
    moves = warp_moves(replace(found, matrix=found.matrix / noise_px**2), held.poses, warping)
    return np.asarray(moves @ moves.T)


def _astray_by_hand(asked: PlanAsked, held: ReachedPoses, alone: Array) -> Array:
    """Their mean over many times that the boards are held; what it is for them `alone` if none settles."""
    noise_px, found = asked.corner_noise_px, []
    for again in holds(asked, held, np.ones(len(held), dtype=bool)):
        told, warping = plan_information(asked, again, rooted=True)
        try:
            covariance = covariance_of(asked.rig, asked.parameters, again.poses, told, noise_px)
        except Undetermined:
            continue
        found.append(_astray(covariance, again, warping, noise_px))
    return np.asarray(np.mean(found, axis=0)) if found else alone


def inseparable(covariance: CalibrationCovariance) -> tuple[Inseparable, ...]:
    """Pairs of free parameters that are hardly told apart, the strongest first."""
    names = covariance.parameters.names
    free = [names.index(name) for name in covariance.parameters.free_names(covariance.rig)]
    correlation: Array = covariance.correlation[np.ix_(free, free)]
    pairs = [
        Inseparable(names[free[i]], names[free[j]], float(correlation[i, j]))
        for i, j in zip(*np.triu_indices(len(free), 1), strict=True)
        if abs(correlation[i, j]) > _HARDLY_APART
    ]
    return tuple(sorted(pairs, key=lambda pair: -abs(pair.correlation))[:_MOST_PAIRS])


def _places(asked: PlanAsked, rng: np.random.Generator) -> tuple[PosePool, Picks, tuple[Remark, ...]]:
    """All poses that count, which of them are held, and what is odd about them."""
    if isinstance(asked.poses, int):
        reached = random_poses(asked, CANDIDATES, rng, ALONE)
        remarks = little_room(int(reached.both.sum()))
        terms = depth_terms(asked, reached, asked.chosen_for_m)
        places = PosePool.of(asked, terms, reached, 0)
        return places, choose(terms, reached, places.close, asked.poses), remarks
    held, remarks = counted(asked, asked.poses)
    check_shared(held)
    try:
        reached = held.joined(random_poses(asked, CANDIDATES, rng, ALONE))
    except InvalidRange as error:
        reached = held
        remarks = (*remarks, Remark("no_next", f"no next pose: {error}"))
    terms = depth_terms(asked, reached, asked.chosen_for_m)
    return PosePool.of(asked, terms, reached, len(held)), list(range(len(held))), remarks
