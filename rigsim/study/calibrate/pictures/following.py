"""Where one more picture does the most."""

from __future__ import annotations

import numpy as np

from rigsim.errors import CalibrationUndetermined, InvalidRange
from rigsim.study.calibrate.pictures.asked import PicturesAsked
from rigsim.study.calibrate.pictures.fit import PicturesFit
from rigsim.study.calibrate.plan.asked import PlanAsked, Reach
from rigsim.study.calibrate.plan.curve import PosePool, next_pose
from rigsim.study.calibrate.plan.held import middle_of
from rigsim.study.calibrate.plan.reach import ReachedPoses, random_poses
from rigsim.study.calibrate.plan.result import NextPose
from rigsim.study.calibrate.plan.run import ALONE, CANDIDATES
from rigsim.study.calibrate.plan.terms import depth_terms

_NEARER, _FARTHER = 0.8, 1.25
"""How much nearer and farther than in the pictures the board can be held."""


def following(asked: PicturesAsked, fit: PicturesFit) -> NextPose | None:
    """The pose, of those about as near and as far as the pictures', that leaves the least depth variance at
    the middle one of the depths asked for; None where the board fits nowhere."""
    found = fit.adjusted
    middles = found.poses.points_left(middle_of(asked.board)[None])[:, 0]
    distances = np.linalg.norm(middles, axis=1)
    reach = Reach(_NEARER * float(distances.min()), _FARTHER * float(distances.max()))
    plan = PlanAsked(
        rig=found.rig,
        parameters=fit.parameters,
        board=asked.board,
        poses=found.poses,
        reach=reach,
        corner_noise_px=fit.noise_px,
        noise_px=asked.noise_px,
        at_m=asked.at_m,
    )
    held = ReachedPoses(found.poses, fit.sightings.cameras)
    try:
        reached = held.joined(random_poses(plan, CANDIDATES, np.random.default_rng(0), ALONE))
        terms = depth_terms(plan, reached, plan.chosen_for_m)
    except (InvalidRange, CalibrationUndetermined):
        return None
    places, picks = PosePool.of(plan, terms, reached, len(held)), list(range(len(held)))
    if not np.isfinite(places.stds(picks)[-1]):
        return None
    return next_pose(places, picks)
