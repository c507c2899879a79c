"""One rig in one scene: draw once, then every sensor, noise level and triangulator."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, partial

import numpy as np

from rigsim.errors import NothingSeen, TriangulatorError
from rigsim.rig.arrays import Ids
from rigsim.rig.noise import PixelNoise
from rigsim.rig.remark import Remark
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig
from rigsim.sim.simulator import Simulator
from rigsim.sim.truth.points import GroundTruth, away, depth_bins, depth_edges_m, image_weights
from rigsim.study.agreement.fault import Fault
from rigsim.study.calibrate.drawn import calibrations
from rigsim.study.scene.columns import Row
from rigsim.study.scene.pictures import Exposure, expose_pair, without_noise
from rigsim.study.scene.plan import Plan
from rigsim.study.scene.rows import RowEvidence, broken_row, configuration, empty_row, rows_of
from rigsim.study.scene.statistics import ErrorStatistics
from rigsim.study.scene.third_witness import MeasuredMatches, measure
from rigsim.study.scene.trials import Prediction, predict, run_trials
from rigsim.study.sweep.diagnosis import find_fault
from rigsim.study.triangulators.registry import label as label_of
from rigsim.theory.reach import reach_m

CORNERS_FROM_BOARDS = 3
"""With fewer boards in a scene its corners say little about it: patches are measured instead."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """The rows of one rig: one for each noise level, triangulator and sensor."""

    rows: list[Row]
    """Rows of sweep.csv."""
    by_depth: list[Row]
    """Rows of sweep_by_depth.csv."""
    faults: list[Fault | None] = field(default_factory=list)
    """What is off in each of `rows`; None where nothing is flagged or found."""
    beyond_fraction: float = 0.0
    """Share of the left image that shows surfaces beyond the far limit, which are left out."""
    remarks: tuple[Remark, ...] = ()
    """What is odd about the scene or the rig's place in it."""
    broken: list[TriangulatorError] = field(default_factory=list)
    """Why rows have no result: of each, the error of its triangulator."""


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """What a placed rig sees."""

    exposures: Mapping[Sensor, Exposure]
    """Both views, once for each lens among the sensors; empty where nobody looks at them."""
    truth: GroundTruth
    """Its ground-truth points."""


def far_limit_m(rigs: Iterable[StereoRig], noises: Iterable[PixelNoise]) -> float:
    """End of the bin of depth, m, in which the last of the rigs comes down to ``Z / sigma_Z`` of 4."""
    noises = tuple(noises)
    farthest_m = max((reach_m(rig, noise) for rig in rigs for noise in noises), default=math.inf)
    if not 0 < farthest_m < math.inf:
        return math.inf
    return float(depth_edges_m(farthest_m, farthest_m)[-1])


def look(simulator: Simulator, rig: StereoRig, plan: Plan, with_pictures: bool = True) -> Look:
    """Place the rig, sample the truth and draw both views: a rig that sees nothing draws nothing.

    Without pictures the drawn depth is still held to rays, and a lens that distorts is drawn all the same:
    that it can be is found out there.
    """
    true_rig, _ = plan.true_and_assumed(rig)
    simulator.place(true_rig)
    rng = plan.stream("truth", simulator.scene.name, rig)
    truth = simulator.truth(plan.n_points, rng, plan.range_m, plan.far_limit_m)
    lenses = dict.fromkeys(without_noise(sensor) for sensor in plan.sensors.values())
    distortions = [lens.distortion for lens in lenses]
    distortions += [true_rig.left.lens, true_rig.right.lens]
    if not with_pictures and all(one is None for one in distortions):
        simulator.check(plan.supersample)
        return Look({}, truth)
    exposures = {lens: expose_pair(simulator, true_rig, lens, plan.supersample) for lens in lenses}
    return Look(exposures, truth)


def run_rig(simulator: Simulator, rig: StereoRig, plan: Plan) -> Outcome:
    """All rows of one rig; a noise level, of pixels or of grey levels, draws nothing again."""
    try:
        seen = look(simulator, rig, plan, measuring_method(simulator, plan) != "none")
    except NothingSeen as error:
        outcome = _blind(simulator, rig, plan, str(error))
    else:
        outcome = all_rows(simulator, rig, plan, seen, measure_pictures(simulator, rig, plan, seen))
    return replace(outcome, remarks=simulator.remarks)


def all_rows(
    simulator: Simulator, rig: StereoRig, plan: Plan, seen: Look, measured: Mapping[str, MeasuredMatches]
) -> Outcome:
    """All rows of a placed rig from what it sees and what was measured, by the sensor's name."""
    truth = seen.truth
    depth_m = away(rig.left, truth.points_left)
    near_m, far_m = plan.range_m or (float(depth_m.min()), float(depth_m.max()))
    edges_m = depth_edges_m(near_m, far_m)
    if plan.range_m is not None:
        edges_m = np.unique(edges_m.clip(near_m, far_m))
    bins = depth_bins(depth_m, edges_m)
    coverage_bins = depth_bins(truth.coverage.depth_m, edges_m)
    methods = {label_of(method): method for method in plan.triangulators}
    beyond = truth.coverage.beyond / truth.coverage.n_rays if plan.range_m is None else 0.0
    outcome = Outcome([], [], beyond_fraction=beyond)
    true_rig, assumed_rig = plan.true_and_assumed(rig)
    uv_left, _ = true_rig.project(truth.points_left)
    for noise in plan.noises:
        predictions, all_stats = tried(simulator, rig, truth, noise, plan, bins)
        for label, stats in all_stats.items():
            usable = truth.points_left[truth.visible][~predictions[label].low_disparity]
            # once for all sensors, and only when a row is flagged
            diagnose = cache(partial(find_fault, true_rig, assumed_rig, usable, noise, methods[label]))
            for sensor in plan.sensors:
                head = configuration(simulator.scene.name, rig, noise, label, sensor)
                try:
                    if isinstance(stats, TriangulatorError):
                        raise stats
                    evidence = RowEvidence(
                        rig=assumed_rig,
                        points_left=truth.points_left,
                        uv_left=uv_left,
                        visible=truth.visible,
                        in_right_image=truth.in_right_image,
                        coverage=truth.coverage,
                        coverage_bins=coverage_bins,
                        image_weight=image_weights(bins, coverage_bins, len(edges_m) - 1),
                        bins=bins,
                        edges_m=edges_m,
                        prediction=predictions[label],
                        stats=stats,
                        measured=measured.get(sensor),
                        triangulator=methods[label],
                        diagnose=diagnose,
                    )
                    row, by_depth, fault = rows_of(head, evidence)
                except TriangulatorError as error:
                    row, by_depth, fault = broken_row(head, truth, plan.n_trials, error), [], None
                    outcome.broken.append(error)
                outcome.faults.append(fault)
                outcome.rows.append(row)
                outcome.by_depth.extend(by_depth)
    return outcome


def measuring_method(simulator: Simulator, plan: Plan) -> str:
    """What is measured in this scene when the plan leaves it open."""
    if plan.measure != "auto":
        return plan.measure
    if simulator.backend == "rays":
        return "none"  # their pictures have no texture to measure
    return "corners" if len(simulator.scene.boards) >= CORNERS_FROM_BOARDS else "patches"


def measure_pictures(
    simulator: Simulator, rig: StereoRig, plan: Plan, seen: Look
) -> dict[str, MeasuredMatches]:
    """What the pictures of each sensor say, by the sensor's name; empty when nothing is to be measured."""
    method = measuring_method(simulator, plan)
    if method == "none":
        return {}
    result = {}
    for label, sensor in plan.sensors.items():
        rng = plan.stream("picture", simulator.scene.name, rig, repr(sensor))
        pictures = seen.exposures[without_noise(sensor)].pictures(sensor, rng)
        true_rig, assumed_rig = plan.true_and_assumed(rig)
        result[label] = measure(method, simulator, true_rig, pictures, assumed_rig, plan.rectify)
    return result


def _blind(simulator: Simulator, rig: StereoRig, plan: Plan, why: str) -> Outcome:
    """The rows of a rig that sees nothing: one such rig does not end a sweep."""
    heads = (
        configuration(simulator.scene.name, rig, noise, label_of(method), sensor)
        for noise in plan.noises
        for method in plan.triangulators
        for sensor in plan.sensors
    )
    rows = [empty_row(head, plan.n_trials, why) for head in heads]
    return Outcome(rows, [], [None] * len(rows))


def simulate(
    simulator: Simulator,
    rig: StereoRig,
    truth: GroundTruth,
    noise: PixelNoise,
    plan: Plan,
    bins: Ids,
) -> tuple[dict[str, Prediction], dict[str, ErrorStatistics]]:
    """Predictions for, and simulated errors of, the points that both cameras see, by the triangulator.

    Raises:
        TriangulatorError: one of them breaks.
    """
    predictions, found = tried(simulator, rig, truth, noise, plan, bins)
    stats = {}
    for label, one in found.items():
        if isinstance(one, TriangulatorError):
            raise one
        stats[label] = one
    return predictions, stats


def tried(
    simulator: Simulator,
    rig: StereoRig,
    truth: GroundTruth,
    noise: PixelNoise,
    plan: Plan,
    bins: Ids,
) -> tuple[dict[str, Prediction], dict[str, ErrorStatistics | TriangulatorError]]:
    """The same, with the error of a triangulator that breaks in the place of its errors."""
    points_left = truth.points_left[truth.visible]
    rigs = plan.true_and_assumed(rig)
    covariance = None if plan.calibration is None else plan.calibration.covariance
    predictions = {
        label_of(method): predict(rigs[1], points_left, noise, method, covariance)
        for method in plan.triangulators
    }
    too_far = next(iter(predictions.values())).low_disparity
    assumed: StereoRig | tuple[StereoRig, ...] = rigs[1]
    if covariance is not None:
        rng = plan.stream("calibration", simulator.scene.name, rig, repr(noise), plan.n_trials)
        assumed = calibrations(covariance, rigs[1], plan.n_trials, rng)
    stats = run_trials(
        (rigs[0], assumed),
        points_left,
        noise,
        predictions,
        np.where(too_far, -1, bins[truth.visible]).astype(np.int32),
        plan.n_trials,
        plan.stream("noise", simulator.scene.name, rig, repr(noise), plan.n_trials),
    )
    return predictions, stats
