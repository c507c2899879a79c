"""How many pictures a goal takes, or what stands in its way."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.study.calibrate.plan.asked import MOST_POSES, PlanAsked
from rigsim.study.calibrate.plan.choose import Picks, extended
from rigsim.study.calibrate.plan.curve import PosePool, first_that_meets, observation_std
from rigsim.study.calibrate.plan.reach import random_poses
from rigsim.study.calibrate.plan.result import PicturesNeeded, Remedy
from rigsim.study.calibrate.plan.terms import depth_terms

_TILT_RAD = math.radians(45)
_FEW, _CANDIDATES = 20, 150


def pictures_needed(asked: PlanAsked, places: PosePool, picks: Picks) -> tuple[PicturesNeeded, Picks]:
    """The fewest pictures that meet the goal, and the poses that were looked at, best first."""
    if asked.goal is None:
        return PicturesNeeded(None), picks
    observation = observation_std(asked, asked.goal.z_m)
    if observation >= asked.goal.error_m:
        return PicturesNeeded(None, "observation", observation), picks
    count, tried = first_that_meets(asked, places, picks)
    if count is not None:
        return PicturesNeeded(count, "", observation), tried
    left = math.hypot(float(places.stds(tried)[-1]), observation)
    remedies = _remedies(asked, observation)
    # what changes nothing is no remedy
    remedies = tuple(each for each in remedies if each.joint_m < left)
    hindrance = remedies[0].code if remedies else "corner_noise"
    return PicturesNeeded(None, hindrance, observation, left, remedies), picks


def _remedies(asked: PlanAsked, observation_m: float) -> tuple[Remedy, ...]:
    tried = []
    for code, changed in _changes(asked).items():
        try:
            calibration = _with_most_pictures(changed)
        except InvalidRange:  # the larger board, or the nearer one, fits nowhere
            continue
        tried.append(Remedy(code, math.hypot(calibration, observation_m)))
    return tuple(sorted(tried, key=lambda each: each.joint_m))


def _changes(asked: PlanAsked) -> Mapping[str, PlanAsked]:
    reach, board = asked.reach, asked.board
    larger = replace(board, square_m=2 * board.square_m, warp_m=(2 * board.warp_m[0], 2 * board.warp_m[1]))
    changes = {
        "board": replace(asked, board=larger),
        "range": replace(asked, reach=replace(reach, near_m=reach.near_m / 2)),
        "corner_noise": replace(asked, corner_noise_px=asked.corner_noise_px / 2),
    }
    if reach.tilt_rad < _TILT_RAD:
        changes["tilt"] = replace(asked, reach=replace(reach, tilt_rad=_TILT_RAD))
    if asked.flatness_m and not asked.parameters.warped:
        changes["flatness"] = replace(asked, flatness_m=0.0)
    return changes


def _with_most_pictures(asked: PlanAsked) -> float:
    """Depth std with a few poses, well chosen, each held again and again, m."""
    rng = np.random.default_rng(asked.seed)
    reached = random_poses(asked, _CANDIDATES, rng, _CANDIDATES // 4)
    terms = depth_terms(asked, reached, asked.chosen_for_m)
    picks = extended(terms, reached, [], _FEW)
    noise = terms.axis_noise(terms.boards.chosen(picks).total().times(MOST_POSES / _FEW))
    # twice is enough to see what hands do
    return float(np.sqrt(noise + PosePool.of(asked, terms, reached, 0).astray(picks * 2)[-1]))
