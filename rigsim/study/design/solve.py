"""From a specification to candidate rigs: which cameras can do it, at which baselines, and which to take.

A camera's interval of baselines comes from `rigsim.theory.inverse`. Rigs are picked from it with room on
either side and for what the build errs (`rigsim.study.design.budget`), compared by four numbers (depth error
at the far end, baseline, field of view, pixels), and ordered: those that leave less for the build than asked
for come last, before them those whose interval leaves no room, whatever the preference:

- ``buildable``: fewest pixels, then shortest baseline, where 95 of 100 built rigs are good with their noise
  (`rigsim.study.design.buildable`); where none is, the one with the most good rigs;
- ``smallest``: shortest baseline, then fewest pixels;
- ``cheapest``: fewest pixels (sensor, cable and processor follow them), then shortest baseline;
- ``most-accurate``: smallest depth error at the far end, then fewest pixels.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np

from rigsim.errors import InvalidRange, InvalidRig
from rigsim.rig import extent
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.counted import DesignCalibration
from rigsim.study.design import words as words
from rigsim.study.design.budget import BUILD_SHARE, MARGIN, check_share, least_baseline_m, picks, taken_shares
from rigsim.study.design.buildable import MACHINISTS, Builder, buildable_first
from rigsim.study.saying import Saying
from rigsim.theory.inverse import (
    GATES,
    LOWER,
    Camera,
    Interval,
    Relaxation,
    Requirement,
    asked_of,
    baseline_interval,
    disparity_std_px,
    relaxations,
)
from rigsim.theory.inverse_error import noise_error
from rigsim.theory.uncertainty import LEAST_DEPTH_SIGMAS

PREFERENCES: tuple[str, ...] = ("buildable", "smallest", "cheapest", "most-accurate")

NoiseSource: TypeAlias = Literal["given", "assumed", "measured"]
"""Where a pixel noise may come from."""
PRIOR_NOISE_PX = 0.25
"""Pixel noise where none is given, px: what good matching of natural surfaces reaches."""
MIN_OVERLAP = 0.5
"""Share of the left image that the right camera sees at the near end, unless asked for otherwise."""

RESOLUTIONS: tuple[tuple[int, int], ...] = (
    (640, 480),
    (1280, 720),
    (1280, 960),
    (1600, 1200),
    (1920, 1080),
    (2448, 2048),
)
"""Image sizes tried when none is given, px."""
HFOVS_DEG: tuple[float, ...] = (30, 40, 50, 60, 70, 80, 90, 100)
"""Lenses tried when none is given, by horizontal field of view, deg."""
LENSES_MM: tuple[float, ...] = (2.1, 2.8, 3.6, 4, 6, 8, 12, 16, 25)
"""Lenses tried behind a named sensor when none is given: what S and C mounts are sold with, mm."""

_GIVEN = Saying("given")


@dataclass(frozen=True, slots=True)
class Specification:
    """What a rig has to do."""

    near_m: float
    """Near end of the working range, m."""
    far_m: float
    """Far end, m."""
    requirements: tuple[Requirement, ...]
    """All requirements, those that follow from the range among them."""
    noise_px: float
    """Standard deviation of one pixel coordinate, px."""
    noise_source: NoiseSource = "given"
    """Where the noise comes from."""
    noise_from: Saying = _GIVEN
    """The same, to be put into words."""
    build_share: float = BUILD_SHARE
    """Share of a depth error's variance that a pick leaves for what its build errs, 0 to below 1."""
    builder: Builder = MACHINISTS
    """Who builds it."""
    row_px: float | None = None
    """Largest row misalignment of a built rig, px, as in `BuildRequirement`; None for any."""
    calibration: DesignCalibration | None = None
    """What counts in the depth errors beside the noise; None for nothing."""

    @property
    def disparity_std_px(self) -> float:
        """Standard deviation of a disparity, px."""
        return disparity_std_px(self.noise_px)

    def parts(self, asked: Requirement, pick: Candidate) -> tuple[float, float, float]:
        """What noise, the calibration, and both make of a depth error, by the formulas, in its unit."""
        camera, baseline_m, sigma_d = pick.camera, pick.baseline_m, self.disparity_std_px
        return (
            replace(asked, calibration=None).achieved(camera, baseline_m, sigma_d),
            asked.of_calibration(camera.focal_px, baseline_m),
            asked.achieved(camera, baseline_m, sigma_d),
        )

    def asked_of(self, camera: Camera) -> tuple[Requirement, ...]:
        """All requirements of a rig with that camera, whose body is one more where it is known."""
        return asked_of(camera, self.requirements)


@dataclass(frozen=True, slots=True)
class Candidate:
    """One rig that meets the specification by the formulas."""

    interval: Interval
    """Its camera, and the baselines allowed."""
    baseline_m: float
    """Its baseline, m."""
    far_error_m: float
    """Root mean square depth error at the far end, from noise, m."""
    noise_share: float = 0.0
    """Share of the variance that noise takes of the depth error asked for; of the worst where several are."""
    calibration_share: float = 0.0
    """What the calibration takes of the same; 0 where none is counted."""
    keeps_share: bool = True
    """Whether both leave for the build what the specification asks for."""

    @property
    def camera(self) -> Camera:
        """Its camera."""
        return self.interval.camera

    @property
    def margin(self) -> float:
        """Room to the nearer end of the interval, as a share of the baseline."""
        low, high = self.interval.lower.baseline_m, self.interval.upper.baseline_m
        return min(self.baseline_m / low if low > 0 else math.inf, high / self.baseline_m) - 1

    @property
    def is_tight(self) -> bool:
        """Whether it stands closer than `MARGIN` to an end: its interval has no more room."""
        return self.margin < MARGIN * (1 - 1e-6)

    @property
    def rig(self) -> StereoRig:
        """The rig."""
        lens = Intrinsics.from_focal(self.camera.width_px, self.camera.height_px, self.camera.focal_px)
        return StereoRig.rectified(lens, self.baseline_m)


@dataclass(frozen=True, slots=True)
class Design:
    """Everything the formulas say."""

    specification: Specification
    """What was asked for."""
    intervals: tuple[Interval, ...]
    """Every camera tried, feasible or not."""
    candidates: tuple[Candidate, ...]
    """Picks, best first by the preference."""
    pareto: tuple[Candidate, ...]
    """Those that no other beats in one of the four numbers without losing in another."""
    preference: str
    """What "best" means."""

    @property
    def feasible(self) -> tuple[Interval, ...]:
        """The cameras that can do it."""
        return tuple(interval for interval in self.intervals if interval.is_feasible)


def specify(
    near_m: float,
    far_m: float,
    requirements: Sequence[Requirement],
    *,
    noise_px: float = PRIOR_NOISE_PX,
    min_overlap: float = MIN_OVERLAP,
    nearest_focus_m: float = 0.0,
    build_share: float = BUILD_SHARE,
) -> Specification:
    """A specification for a working range: overlap at its near end and a useful disparity at its far end too.

    Args:
        near_m: near end of the range, m.
        far_m: far end, m.
        requirements: what else is asked for.
        noise_px: standard deviation of one pixel coordinate, px.
        min_overlap: share of the left image that the right camera sees at the near end, where
            `requirements` ask for none there.
        nearest_focus_m: the nearest distance at which the lenses draw sharply, m.
        build_share: share of a depth error's variance that is the build's, 0 to below 1; the rest is the
            noise's.

    Raises:
        InvalidRange: the range is empty, starts at 0 or nearer than the lenses focus, no depth error is asked
            for, a requirement lies outside the range, the noise is not positive, or the share cannot be.
    """
    if not (math.isfinite(far_m) and 0 < near_m < far_m):
        raise InvalidRange(f"range {near_m:g}:{far_m:g} m: must be 0 < near < far; no rig sees from 0 on")
    if near_m < nearest_focus_m * (1 - 1e-9):
        raise InvalidRange(
            f"range {near_m:g}:{far_m:g} m: starts nearer than the lenses focus, {nearest_focus_m:g} m; "
            "start there, or choose lenses that focus nearer"
        )
    disparity_std_px(noise_px)
    check_share(build_share)
    if not any(asked.kind == "depth_error" for asked in requirements):
        raise InvalidRange("no depth error asked for: give at least one, as in 10mm@3m or 1%")
    for asked in requirements:
        if asked.depth_m < near_m * (1 - 1e-9) or asked.depth_m > far_m * (1 + 1e-9):
            raise InvalidRange(
                f"{words.name(asked)}: outside the range of {near_m:g} to {far_m:g} m; widen --range"
            )
    implied = [Requirement("far_disparity", LEAST_DEPTH_SIGMAS, far_m)]
    if not any(asked.kind == "overlap" and asked.depth_m == near_m for asked in requirements):
        implied.insert(0, Requirement("overlap", min_overlap, near_m))
    return Specification(near_m, far_m, (*requirements, *implied), noise_px, build_share=build_share)


def solve(specification: Specification, cameras: Sequence[Camera], preference: str = "buildable") -> Design:
    """All cameras' intervals, and candidates picked from them.

    Raises:
        InvalidRig: no camera can do it; the message says what collides and what to relax by how much.
        InvalidRange: no camera, or an unknown preference.
    """
    if preference not in PREFERENCES:
        raise InvalidRange(f"preference {preference!r}: choose one of {', '.join(PREFERENCES)}")
    if not cameras:
        raise InvalidRange("no camera to try: give at least one resolution and lens")
    extent.CAMERAS.check(len(cameras))
    asked, noise_px = specification.requirements, specification.noise_px
    intervals = tuple(baseline_interval(camera, asked, noise_px) for camera in cameras)
    candidates = [
        _candidate(interval, baseline_m, specification)
        for interval in intervals
        if interval.is_feasible
        for baseline_m in picks(interval, _least_m(interval, specification))
    ]
    if not candidates:
        ways = relaxations([interval.camera for interval in intervals], asked, noise_px)
        raise InvalidRig(why_not(specification, intervals, ways))
    candidates.sort(key=lambda candidate: _rank(candidate, preference))
    if preference == "buildable":
        candidates = buildable_first(candidates, specification)
    return Design(specification, intervals, tuple(candidates), pareto_front(candidates), preference)


def pareto_front(candidates: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Those that no other candidate equals or beats in all of error, baseline, pixels and field of view."""
    if not candidates:
        return ()
    merits = np.array(
        [(c.far_error_m, c.baseline_m, float(c.camera.pixels), -c.camera.hfov_rad) for c in candidates]
    )
    others, own = merits[:, None], merits[None]
    beaten = ((others <= own).all(axis=2) & (others != own).any(axis=2)).any(axis=0)
    return tuple(candidate for candidate, lost in zip(candidates, beaten, strict=True) if not lost)


def _rank(candidate: Candidate, preference: str) -> tuple[float, ...]:
    pixels, baseline, error = candidate.camera.pixels, candidate.baseline_m, candidate.far_error_m
    # of those that leave too little for the build, the one that leaves most is the least wrong
    taken = candidate.noise_share + candidate.calibration_share
    first = (0.0 if candidate.keeps_share else taken, float(candidate.is_tight))
    match preference:
        case "smallest":
            return (*first, baseline, pixels, error)
        case "buildable":
            return (float(candidate.is_tight), pixels, baseline, error)
        case "cheapest":
            return (*first, pixels, baseline, error)
        case _:
            return (*first, error, pixels, baseline)


def _least_m(interval: Interval, specification: Specification) -> float:
    spec = specification
    return least_baseline_m(interval.camera, spec.requirements, spec.noise_px, spec.build_share)


def _candidate(interval: Interval, baseline_m: float, specification: Specification) -> Candidate:
    camera, sigma_d, far_m = interval.camera, specification.disparity_std_px, specification.far_m
    error_m = far_m * noise_error(far_m * sigma_d / (camera.focal_px * baseline_m))
    noise, calibration = taken_shares(camera, baseline_m, specification.requirements, sigma_d)
    keeps = noise + calibration <= 1 - specification.build_share + 1e-9
    return Candidate(interval, baseline_m, error_m, noise, calibration, keeps)


def why_not(specification: Specification, intervals: Sequence[Interval], ways: Sequence[Relaxation]) -> str:
    """What collides where no camera can do it, and which single requirement to relax: one of `ways`."""
    asked, noise_px = specification.requirements, specification.noise_px
    if ways:
        ends = [interval for interval in intervals if interval.camera == ways[0].camera]
        advice = "; or ".join(words.relaxation(way, noise_px) for way in ways[:3])
        bodies = [
            way.camera for way in ways[:3] if way.requirement and way.requirement.kind == "min_baseline"
        ]
        return f"no rig meets all requirements: {_collision(ends[0])}; relax one: {advice}{_assumed(bodies)}"
    fitting = [interval for interval in intervals if not interval.failed]
    if not fitting:
        failed = dict.fromkeys(requirement for interval in intervals for requirement in interval.failed)
        return (
            f"no rig meets all requirements: none of the {len(intervals)} cameras has "
            f"{' and '.join(words.whole(requirement) for requirement in failed)}; try other --resolution, "
            "--sensor or --lens"
        )
    nearest = min(fitting, key=lambda interval: _gap(interval))
    return (
        f"no rig meets all requirements: {_collision(nearest)}; no single requirement would do, relax one "
        f"that asks for a longer baseline ({_kinds(nearest.camera, asked, True)}) and one that limits it "
        f"({_kinds(nearest.camera, asked, False)}){_assumed([nearest.camera])}"
    )


def _assumed(cameras: Sequence[Camera]) -> str:
    """Whose bodies were assumed to keep two cameras apart; nothing where none were."""
    says = dict.fromkeys(words.body(camera) for camera in cameras if camera.body_m)
    return f" ({'; '.join(says)})" if says else ""


def _collision(interval: Interval) -> str:
    if interval.failed:
        return f"{words.whole(interval.failed[0])} fails with {words.camera(interval.camera)}"
    low, high = interval.lower, interval.upper
    if not math.isfinite(low.baseline_m):
        return (
            f"{words.whole(low.requirement)} is less than the calibration alone leaves at any baseline"
            f" ({words.camera(interval.camera)})"
        )
    allows = f"allows <= {words.size(high.baseline_m)}" if high.baseline_m > 0 else "allows none"
    return (
        f"{words.whole(low.requirement)} needs a baseline >= {words.size(low.baseline_m)}, but "
        f"{words.whole(high.requirement)} {allows} ({words.camera(interval.camera)})"
    )


def _gap(interval: Interval) -> float:
    high = interval.upper.baseline_m
    return interval.lower.baseline_m / high if high > 0 else math.inf


def _kinds(camera: Camera, asked: Sequence[Requirement], lower: bool) -> str:
    names = [
        words.name(requirement)
        for requirement in asked_of(camera, asked)
        if (requirement.kind in LOWER) is lower and requirement.kind not in (*GATES, "far_disparity")
    ]
    return ", ".join(dict.fromkeys(names))
