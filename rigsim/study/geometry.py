"""One rig in one scene: render once, then every noise level and triangulator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.errors import NothingSeen
from rigsim.rig.arrays import Ids
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.sim.frame import StereoFrame
from rigsim.sim.points import GroundTruth, depth_edges_m
from rigsim.sim.simulator import Simulator
from rigsim.study.plan import Plan, triangulator_label
from rigsim.study.rows import Evidence, Row, configuration, depth_rows, empty_row, overall_row
from rigsim.study.statistics import ErrorStatistics
from rigsim.study.trial import Prediction, predict, run_trials


@dataclass(frozen=True, slots=True)
class Outcome:
    """The rows of one rig: one for each noise level and triangulator."""

    rows: list[Row]
    """Rows of sweep.csv."""
    by_depth: list[Row]
    """Rows of sweep_by_depth.csv."""


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """What a placed rig sees."""

    frame: StereoFrame
    """Both pictures."""
    truth: GroundTruth
    """Its ground-truth points."""


def look(simulator: Simulator, rig: StereoRig, plan: Plan) -> Look:
    """Place the rig, draw both pictures and sample the truth."""
    simulator.place(rig)
    frame = simulator.render(plan.supersample)
    rng = plan.stream("truth", simulator.scene.name, rig)
    return Look(frame, simulator.truth(plan.n_points, rng, plan.range_m))


def run_rig(simulator: Simulator, rig: StereoRig, plan: Plan) -> Outcome:
    """All rows of one rig; a noise level or a triangulator draws nothing again."""
    try:
        truth = look(simulator, rig, plan).truth
    except NothingSeen as error:
        return _blind(simulator, rig, plan, str(error))
    depth_m = truth.points_left[:, 2]
    near_m, far_m = plan.range_m or (float(depth_m.min()), float(depth_m.max()))
    edges_m = depth_edges_m(near_m, far_m)
    if plan.range_m is not None:
        edges_m = np.unique(edges_m.clip(near_m, far_m))
    bins = np.searchsorted(edges_m[1:-1], depth_m, side="right").astype(np.int32)
    outcome = Outcome([], [])
    for noise in plan.noises:
        prediction, all_stats = simulate(simulator, rig, truth, noise, plan, bins)
        for label, stats in all_stats.items():
            head = configuration(simulator.scene.name, rig, noise, label)
            evidence = Evidence(
                depth_m, truth.visible, truth.in_right_image, bins, edges_m, prediction, stats
            )
            outcome.rows.append(overall_row(head, evidence))
            outcome.by_depth.extend(depth_rows(head, evidence))
    return outcome


def _blind(simulator: Simulator, rig: StereoRig, plan: Plan, why: str) -> Outcome:
    """The rows of a rig that sees nothing: one such rig does not end a sweep."""
    labels = [triangulator_label(method) for method in plan.triangulators]
    heads = (
        configuration(simulator.scene.name, rig, noise, label) for noise in plan.noises for label in labels
    )
    return Outcome([empty_row(head, plan.n_trials, why) for head in heads], [])


def simulate(
    simulator: Simulator,
    rig: StereoRig,
    truth: GroundTruth,
    noise: PixelNoise,
    plan: Plan,
    bins: Ids,
) -> tuple[Prediction, dict[str, ErrorStatistics]]:
    """Prediction for, and simulated errors of, the points that both cameras see."""
    points_left = truth.points_left[truth.visible]
    prediction = predict(rig, points_left, noise)
    stats = run_trials(
        rig,
        rig,
        points_left,
        noise,
        {triangulator_label(method): method for method in plan.triangulators},
        prediction.whitening,
        np.where(prediction.low_disparity, -1, bins[truth.visible]).astype(np.int32),
        plan.n_trials,
        plan.stream("noise", simulator.scene.name, rig, repr(noise), plan.n_trials),
    )
    return prediction, stats
