"""The room where rigs are tried: rendered in a scene with their sensor, and measured in the pictures.

A sensor's noise, as a design needs it, is what is found there: patches of the pictures are matched, and the
errors of their disparities against the truth give a standard deviation. Surfaces are what a rig is bought
for, so corners of calibration boards, which are ten times as exact, do not count.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import TracebackType

import numpy as np

from rigsim.errors import InvalidRig, NothingSeen
from rigsim.rig.noise import PixelNoise
from rigsim.rig.remark import Remark
from rigsim.rig.sensor import Sensor
from rigsim.sim.scenes.made import MadeScene
from rigsim.sim.simulator import Simulator
from rigsim.statistics import rms, robust_rms
from rigsim.study.design import words as words
from rigsim.study.design.checks import FEWEST_MATCHES, nearest_points
from rigsim.study.design.solve import Candidate, Design, Specification, solve
from rigsim.study.saying import Saying, saying
from rigsim.study.scene.columns import Row
from rigsim.study.scene.look import (
    Look,
    Outcome,
    all_rows,
    look,
    measure_pictures,
    measuring_method,
    simulate,
)
from rigsim.study.scene.pictures import without_noise
from rigsim.study.scene.plan import Plan
from rigsim.study.scene.showcase import Showcase
from rigsim.study.scene.third_witness import MeasuredMatches
from rigsim.theory.inverse import Camera

ROUNDS = 3
"""Designs, each from the noise measured with the one before, before it is left at that."""
AGREES = 0.1
"""A measured noise this near the assumed one, as a share of it, confirms it."""
MANY_PIXELS = 4e6
"""Larger pictures are drawn with one sample a pixel: a proof must not take a minute."""
_STARTS_PX = (0.05, 0.0125, 0.003)  # less when no rig meets the requirements with it


@dataclass(frozen=True, slots=True)
class Fitting:
    """What pictures of a camera are taken with."""

    label: str
    """What it is called in tables."""
    sensor: Sensor
    """Lens and sensor."""


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """One rig in the scene."""

    fitting: Fitting
    """Its sensor."""
    plan: Plan
    """How it was tried; the noise in it is no part of the pictures."""
    seen: Look | None
    """Pictures and truth points; None where the rig sees nothing."""
    measured: Mapping[str, MeasuredMatches]
    """What a sweep measures in the pictures, by the sensor's label; empty when nothing was measured."""
    matches: MeasuredMatches | None
    """Matches that depth errors are held to: of surfaces where the room asks for them, else the sweep's."""
    why: str = ""
    """Why the rig sees nothing."""


class Room:
    """A scene, kept open while candidates are tried in it; use it as a context manager."""

    def __init__(
        self,
        plan: Plan,
        fit: Callable[[Camera], Fitting] | None = None,
        *,
        surfaces: bool = False,
        make: Callable[[Candidate], MadeScene] | None = None,
    ) -> None:
        """Open the scene.

        Args:
            plan: as for a sweep.
            fit: what a camera's pictures are taken with; the plan's first sensor by default.
            surfaces: match patches for the depth errors, whatever else a sweep measures.
            make: the scene for a candidate, in place of the plan's; where the plan leaves open what is
                measured in it, that is patches.

        Raises:
            InvalidScene: scene or mount cannot be used.
            RenderUnavailable: the renderer asked for does not work here.
        """
        label, sensor = next(iter(plan.sensors.items()))
        self.plan = plan
        self._fit = fit or (lambda camera: Fitting(label, sensor))
        self._surfaces = surfaces
        self._make = make
        self._made: MadeScene | None = None
        self._opened = [] if make else [Simulator(plan.scene, plan.mount, plan.renderer)]
        self._remarks: dict[str, Remark] = {}
        self._trials: list[tuple[Camera, float, Trial]] = []

    def __enter__(self) -> Room:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._close()

    def _close(self) -> None:
        for simulator in self._opened:
            self._remarks |= {remark.code: remark for remark in simulator.remarks}
            simulator.close()
        self._opened.clear()

    def _open(self, candidate: Candidate) -> None:
        """Have the scene open that is made for the candidate, where one is."""
        if self._make is None or (made := self._make(candidate)) == self._made:
            return
        self._close()
        self._made = made
        self._opened.append(Simulator(made, None, self.plan.renderer))

    @property
    def _simulator(self) -> Simulator:
        return self._opened[0]

    @property
    def where(self) -> str:
        """What the scene is called in a sentence."""
        return f"`{self.plan.scene}`" if self._made is None else f"a scene {self._made.name}"

    @property
    def remarks(self) -> tuple[Remark, ...]:
        """What is odd about the scene or the candidates' place in it."""
        said = [remark for simulator in self._opened for remark in simulator.remarks]
        return tuple({**self._remarks, **{remark.code: remark for remark in said}}.values())

    @property
    def centres_apart_m(self) -> float:
        """Distance of the cameras placed last, m."""
        left, right = (self._simulator.scene.world_from_camera(side) for side in (0, 1))
        return float(np.linalg.norm(left.t - right.t))

    def trial(self, candidate: Candidate) -> Trial:
        """Place, draw and measure `candidate`; what was tried last is remembered.

        Raises:
            RenderMismatch: the renderer disagrees with the rig or with rays.
            RenderUnavailable: the pictures are too large.
        """
        for camera, baseline_m, trial in self._trials:
            if (camera, baseline_m) == (candidate.camera, candidate.baseline_m):
                self._simulator.place(candidate.rig)
                return trial
        trial = self._try(candidate)
        self._trials[:] = [(candidate.camera, candidate.baseline_m, trial)]
        return trial

    def _try(self, candidate: Candidate) -> Trial:
        fitting = self._fit(candidate.camera)
        self._open(candidate)
        plan = replace(self.plan, sensors={fitting.label: fitting.sensor})
        if self._made and plan.measure == "auto" and measuring_method(self._simulator, plan) == "corners":
            plan = replace(plan, measure="patches")
        if candidate.camera.pixels > MANY_PIXELS:
            plan = replace(plan, supersample=1)
        try:
            seen = look(self._simulator, candidate.rig, plan)
        except NothingSeen as error:
            return Trial(fitting, plan, None, {}, None, str(error))
        measured = measure_pictures(self._simulator, candidate.rig, plan, seen)
        matches = measured.get(fitting.label)
        if self._surfaces and matches is not None and matches.method != "patches":
            patches = replace(plan, measure="patches")
            matches = measure_pictures(self._simulator, candidate.rig, patches, seen)[fitting.label]
        return Trial(fitting, plan, seen, measured, matches)

    def row(self, candidate: Candidate, noise: PixelNoise) -> tuple[Row, Showcase]:
        """The row that a sweep of `candidate` gives, and points and pictures."""
        trial, rig = self.trial(candidate), candidate.rig
        if trial.seen is None:
            raise InvalidRig(trial.why)
        truth = trial.seen.truth
        plan = replace(trial.plan, noises=(noise,))
        outcome: Outcome = all_rows(self._simulator, rig, plan, trial.seen, trial.measured)
        if outcome.broken:
            raise outcome.broken[0]
        _, stats = simulate(
            self._simulator, rig, truth, noise, plan, np.zeros(len(truth.visible), dtype=np.int32)
        )
        depth_rmse_m = np.full(len(truth.visible), math.nan)
        depth_rmse_m[truth.visible] = next(iter(stats.values())).depth_rmse_m
        frame = trial.seen.exposures[without_noise(trial.fitting.sensor)].frame
        show = Showcase(
            row=0,
            rig=rig,
            noise=noise,
            image_left=frame.left.image,
            image_right=frame.right.image,
            points_left=truth.points_left,
            visible=truth.visible,
            sensor=trial.fitting.sensor,
            depth_rmse_m=depth_rmse_m,
        )
        return outcome.rows[0], show


def measured_noise_px(
    measured: MeasuredMatches, range_m: tuple[float, float], depths_m: Sequence[float]
) -> float:
    """Noise of one coordinate, px, that the matches' disparities show; NaN with fewer than 30 of them.

    The robust ``1.4826 median |error| / sqrt(2)`` of all matches within `range_m`, or the RMS over sqrt(2) of
    those near one of `depths_m`, where an error is asked for and tails count: whichever is worst. Both are
    about the truth, so that a bias counts too.
    """
    depth_m = measured.points_left[:, 2]
    good = ~measured.outlier & (depth_m >= range_m[0]) & (depth_m <= range_m[1])
    if good.sum() < FEWEST_MATCHES:
        return math.nan
    depth_m, error_px = depth_m[good], measured.disparity_error_px[good]
    found = [robust_rms(error_px)]
    for at_m in depths_m:
        near = nearest_points(depth_m, at_m, FEWEST_MATCHES)
        if len(near):
            found.append(rms(error_px[near]))
    return max(found) / math.sqrt(2)


def settle(specification: Specification, cameras: Sequence[Camera], preference: str, room: Room) -> Design:
    """The design whose noise is what its own sensor achieves in `room`.

    Solve with a guess, measure with the rig recommended, solve again with what was measured, rounded up to
    two digits, until it is confirmed within `AGREES`, `ROUNDS` at most.

    Raises:
        InvalidRig: no rig meets the requirements, with the noise measured last.
        RenderMismatch: as `Room.trial`.
        RenderUnavailable: as `Room.trial`.
    """
    design = _start(specification, cameras, preference)
    for done in range(1, ROUNDS + 1):
        assumed_px = design.specification.noise_px
        found = measure_noise(specification, design.candidates[0], room, saying("round", number=done))
        if found.noise_source != "measured":
            return solve(found, cameras, preference)
        agreed = abs(found.noise_px / assumed_px - 1) <= AGREES
        if agreed:
            found = replace(found, noise_px=max(assumed_px, found.noise_px))
        design = solve(found, cameras, preference)
        if agreed:
            break
    return design


def measure_noise(
    specification: Specification, candidate: Candidate, room: Room, when: Saying
) -> Specification:
    """The specification with the noise that `candidate` shows in `room`, rounded up to two digits.

    Where too little was matched it keeps its noise, as one assumed; `when` tells which measurement it is.
    """
    trial, matches = room.trial(candidate), room.trial(candidate).matches
    depths_m = [asked.depth_m for asked in specification.requirements if asked.kind == "depth_error"]
    range_m = (specification.near_m, specification.far_m)
    noise_px = math.nan if matches is None else measured_noise_px(matches, range_m, depths_m)
    if matches is None or not noise_px > 0:
        found_few = saying("few-matches", sensor=trial.fitting.label, fewest=FEWEST_MATCHES)
        return replace(
            specification, noise_source="assumed", noise_from=saying("assumed", why=trial.why or found_few)
        )
    return replace(
        specification,
        noise_px=words.rounded(noise_px, up=True, digits=2),
        noise_source="measured",
        noise_from=saying(
            "measured",
            scene=room.where,
            sensor=trial.fitting.label,
            matches=int((~matches.outlier).sum()),
            method=matches.method,
            when=when,
        ),
    )


def _start(specification: Specification, cameras: Sequence[Camera], preference: str) -> Design:
    """A first design, by the largest guess of the noise that leaves any rig at all."""
    for guess_px in _STARTS_PX[:-1]:
        try:
            return solve(replace(specification, noise_px=guess_px), cameras, preference)
        except InvalidRig:
            continue
    return solve(replace(specification, noise_px=_STARTS_PX[-1]), cameras, preference)
