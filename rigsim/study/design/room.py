"""The room where rigs are tried: rendered in a scene with their sensor, and measured in the pictures."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import TracebackType

import numpy as np

from rigsim.errors import InvalidRig, NothingSeen
from rigsim.rig.noise import PixelNoise
from rigsim.rig.remark import Remark
from rigsim.rig.sensor import Sensor
from rigsim.sim.scenes.made import MadeScene
from rigsim.sim.simulator import Simulator
from rigsim.study.design.solve import Candidate
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

MANY_PIXELS = 4e6
"""Larger pictures are drawn with one sample a pixel: a proof must not take a minute."""


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
        if self._made is not None:
            plan = replace(plan, n_points=max(plan.n_points, self._made.n_points))
            if plan.measure == "auto" and measuring_method(self._simulator, plan) == "corners":
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
