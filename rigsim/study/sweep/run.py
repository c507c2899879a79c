"""The sweep: many rigs in one scene, predicted and simulated, in tables."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd

from rigsim import interrupts
from rigsim.errors import InvalidRange, InvalidScene, MeasurementFailed, TriangulatorError
from rigsim.pixels.dense.rectify import rectify
from rigsim.pixels.dense.views import RowView
from rigsim.rig import extent, given
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.sim.simulator import Simulator
from rigsim.study.scene import columns as col
from rigsim.study.scene.columns import AXES, DEPTH_COLUMNS, ROW_COLUMNS
from rigsim.study.scene.look import Look, Outcome, far_limit_m, look, simulate
from rigsim.study.scene.pictures import without_noise
from rigsim.study.scene.plan import Held, Plan, RigGrid
from rigsim.study.scene.provenance import simulator_provenance
from rigsim.study.scene.showcase import Showcase
from rigsim.study.sweep.advice import advise, why_none
from rigsim.study.sweep.choice import rank
from rigsim.study.sweep.limits import limits, swept_axes
from rigsim.study.sweep.processes import run_all
from rigsim.study.sweep.requirement import DepthRequirement, answer_first, hold_rows
from rigsim.study.sweep.result import SweepResult
from rigsim.study.tolerance.joint.cause import check_rig
from rigsim.study.triangulators.registry import label as label_of
from rigsim.study.triangulators.registry import started


def sweep(
    rigs: RigGrid | StereoRig | Iterable[StereoRig],
    plan: Plan | None = None,
    *,
    jobs: int = 1,
    progress: Callable[[int], None] | None = None,
    require: Sequence[DepthRequirement] = (),
) -> SweepResult:
    """Predict and simulate every rig in the scene, beside each other.

    Args:
        rigs: a `RigGrid`, or any rigs.
        plan: scene, noise, triangulators, points, trials and seed.
        jobs: processes; the numbers do not depend on it.
        progress: called with the number of rigs done. When it or a worker is interrupted
            (KeyboardInterrupt), the result holds what is done by then.
        require: depth errors asked for: the row that meets them, or comes nearest, is the best then.

    Raises:
        InvalidScene: the scene cannot be used, or no rig sees anything with both cameras.
        TriangulatorError: a triangulator is unknown; or all of them raise or return the wrong thing. Where
            some do, on some rigs, those rows say so in place of a result.
        RenderUnavailable: the renderer asked for does not work here.
    """
    plan = given.a(Plan, plan or Plan(), "a Plan: what is simulated")
    jobs = int(given.real(jobs, "jobs"))
    extent.JOBS.check(jobs)
    todo = rigs if isinstance(rigs, RigGrid) else _rigs(rigs)
    if len(todo) == 0:
        raise InvalidRange("no rig to sweep: give at least one")
    if plan.assumed is not None and len(todo) > 1:
        raise InvalidRange(
            f"{len(todo)} rigs and one that is assumed: it goes with one true rig; "
            "a perturbation goes with every rig"
        )
    if plan.calibration is not None:
        if len(todo) > 1:
            raise InvalidRange(
                f"{len(todo)} rigs and {plan.calibration.name}, which is the calibration of one: sweep that"
                " one alone"
            )
        check_rig(plan.calibration.covariance.rig, next(iter(todo)), plan.calibration.name)
    if len(todo) == 1:
        plan.true_and_assumed(next(iter(todo)))  # fail before anything is drawn
    if plan.range_m is None:
        plan = replace(plan, far_limit_m=far_limit_m(todo, plan.noises))
    jobs = min(jobs, len(todo))
    with (
        started(plan.triangulators, plan.timeout_s) as methods,  # fail before anything is drawn
        Simulator(plan.scene, plan.mount, plan.renderer) as simulator,
    ):
        here = replace(plan, triangulators=methods)  # processes start their own
        done = _run_all(todo, here if jobs == 1 else plan, jobs, simulator, progress)
        lens_held: Held = rigs.lens_held if isinstance(rigs, RigGrid) else ""
        return _conclude(done, here, simulator, lens_held, require)


@dataclass(slots=True)
class _Done:
    """What is done of a sweep so far."""

    results: list[tuple[StereoRig, Outcome]] = field(default_factory=list)
    complete: bool = True

    @property
    def rigs(self) -> list[StereoRig]:
        return [rig for rig, _ in self.results]

    @property
    def outcomes(self) -> list[Outcome]:
        return [outcome for _, outcome in self.results]

    @property
    def beyond_fraction(self) -> float:
        return max((outcome.beyond_fraction for outcome in self.outcomes), default=0.0)

    @property
    def broken(self) -> list[TriangulatorError]:
        return [error for outcome in self.outcomes for error in outcome.broken]

    @property
    def only_broken(self) -> bool:
        """Whether every triangulator broke on every rig so far."""
        return all(len(outcome.broken) == len(outcome.rows) for outcome in self.outcomes)

    @property
    def remarks(self) -> tuple[Remark, ...]:
        """One of each code, the latest first."""
        found: dict[str, Remark] = {}
        for outcome in self.outcomes:
            found = {remark.code: remark for remark in outcome.remarks} | found
        return tuple(found.values())

    @property
    def breakage(self) -> str:
        """Of `SweepResult.broken`."""
        if not self.broken:
            return ""
        n = sum(len(outcome.rows) for outcome in self.outcomes)
        why = list(dict.fromkeys(map(str, self.broken)))
        more = f"; and {len(why) - 3} other errors" if len(why) > 3 else ""
        have = "has" if len(self.broken) == 1 else "have"
        return f"{len(self.broken)} of {n} rows {have} no result: {'; '.join(why[:3])}{more}"


def _run_all(
    todo: RigGrid | list[StereoRig],
    plan: Plan,
    jobs: int,
    simulator: Simulator,
    progress: Callable[[int], None] | None,
) -> _Done:
    """Run the rigs until all are done or somebody interrupts."""
    done = _Done()
    outcomes = run_all(todo, plan, jobs, simulator)
    try:
        for rig, outcome in zip(todo, outcomes, strict=True):
            done.results.append((rig, outcome))
            if done.only_broken:
                outcomes.close()
                raise outcome.broken[0]
            if progress:
                progress(len(done.results))
    except KeyboardInterrupt:
        outcomes.close()
        if not done.results:
            raise
        interrupts.caught()
        done.complete = False
    return done


def _rigs(rigs: object) -> list[StereoRig]:
    """One rig, or several."""
    return [given.a(StereoRig, rig, "a StereoRig, several, or a RigGrid") for rig in given.several(rigs)]


def _conclude(
    done: _Done, plan: Plan, simulator: Simulator, lens_held: Held, require: Sequence[DepthRequirement]
) -> SweepResult:
    rows = [row for outcome in done.outcomes for row in outcome.rows]
    by_depth = [row for outcome in done.outcomes for row in outcome.by_depth]
    table = pd.DataFrame(rows, columns=list(ROW_COLUMNS))
    depth_table = pd.DataFrame(by_depth, columns=list(DEPTH_COLUMNS))
    order = rank(table, depth_table)
    if not order and done.broken:
        raise done.broken[0]
    if not order:
        where = f"scene {simulator.scene.name}: "
        reasons = dict.fromkeys(why_none(one).removeprefix(where) for one in table[col.AGREEMENT])
        why = "; ".join(list(reasons)[:3])
        raise InvalidScene(f"{where}no rig has a result ({why}): {advise(simulator, done.rigs, plan)}")
    held = hold_rows(table, depth_table, require)
    order = answer_first(table, order, held)
    first = (col.BASELINE, col.HFOV, col.WIDTH) if lens_held else AXES
    swept = swept_axes(table, tuple(dict.fromkeys((*plan.asked, *first))))
    per_rig = len(plan.noises) * len(plan.triangulators) * len(plan.sensors)
    return SweepResult(
        rows=table,
        by_depth=depth_table,
        swept=swept,
        best=order,
        limits=limits(table),
        lens_held=lens_held,
        showcase=_showcase(simulator, done.rigs[order[0] // per_rig], order[0], plan),
        provenance={
            **simulator_provenance(simulator),
            "seed": plan.seed,
            "points": plan.n_points,
            "trials": plan.n_trials,
            **plan.extra,
        },
        far_limit_m=plan.far_limit_m if done.beyond_fraction > 0 else math.inf,
        beyond_fraction=done.beyond_fraction,
        has_two_rigs=plan.assumed is not None or plan.perturbation is not None,
        complete=done.complete,
        broken=done.breakage,
        faults=tuple(fault for outcome in done.outcomes for fault in outcome.faults),
        remarks=(*done.remarks, *_calibration_remarks(plan)),
        requirements=held,
    )


def _calibration_remarks(plan: Plan) -> Iterator[Remark]:
    if plan.calibration is not None:
        yield Remark(
            "calibration",
            f"every trial is triangulated with another calibration of the rig ({plan.calibration.name},"
            f" {plan.calibration.source}): predicted and simulated errors hold both noise and calibration, as"
            " squares; pictures are measured with the exact rig",
        )


def _showcase(simulator: Simulator, rig: StereoRig, row: int, plan: Plan) -> Showcase:
    """The best configuration once more, with its pictures and point by point: the streams repeat it."""
    seen: Look = look(simulator, rig, plan)
    truth = seen.truth
    # rows run over the rigs, then the noise levels, the triangulators and the sensors
    rest, sensor_index = divmod(row, len(plan.sensors))
    rest, label_index = divmod(rest, len(plan.triangulators))
    noise = plan.noises[rest % len(plan.noises)]
    sensor = list(plan.sensors.values())[sensor_index]
    frame = seen.exposures[without_noise(sensor)].frame
    method = plan.triangulators[label_index]
    alone = replace(plan, triangulators=(method,))  # another may break here
    _, stats = simulate(simulator, rig, truth, noise, alone, np.zeros(len(truth.visible), dtype=np.int32))
    label = label_of(method)
    depth_rmse_m = np.full(len(truth.visible), math.nan)
    depth_rmse_m[truth.visible] = stats[label].depth_rmse_m
    return Showcase(
        row=row,
        rig=rig,
        noise=noise,
        image_left=frame.left.image,
        image_right=frame.right.image,
        points_left=truth.points_left,
        visible=truth.visible,
        sensor=sensor,
        depth_rmse_m=depth_rmse_m,
        view=_matched_in(plan, rig),
    )


def _matched_in(plan: Plan, rig: StereoRig) -> RowView:
    """What the pictures of a rig are turned into; nothing was matched where they cannot be."""
    try:
        return rectify(rig, plan.rectify).view
    except MeasurementFailed:
        return "perspective"
