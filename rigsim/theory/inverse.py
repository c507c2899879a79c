"""From requirements to rigs: the baselines that one camera allows, in closed form, and what binds there.

The rig is rectified, with two equal pinhole cameras: W by H px, focal length f px, baseline B. A
requirement is one line in (f, B); for a given camera it is a bound on B:

==================  ==========================================  ==========================
requirement         says, at the depth Z                        baseline
==================  ==========================================  ==========================
``depth_error``     ``Z^2 sigma_d / (f B) <= e``                ``B >= Z^2 sigma_d / (f e)``
``far_disparity``   ``f B / Z >= n sigma_d``                    ``B >= n sigma_d Z / f``
``max_disparity``   ``f B / Z <= N``                            ``B <= N Z / f``
``overlap``         ``1 - f B / (Z W) >= o``                    ``B <= (1 - o) W Z / f``
``cover``           ``W Z / f - B >= c``                        ``B <= W Z / f - c``
``cover_height``    ``H Z / f >= c``                            none: the camera fits or not
``max_baseline``    ``B <= B_max``                              itself
``min_baseline``    ``B >= B_min``                              itself
``fov``             ``2 atan(W / 2 f) >= fov``                  none: the camera fits or not
``vfov``            ``2 atan(H / 2 f) >= vfov``                 none: the camera fits or not
``pixels``          ``W H <= p``                                none: the camera fits or not
==================  ==========================================  ==========================

``sigma_d = sqrt(2) sigma`` for the noise sigma of a pixel coordinate. Where this first order of a depth error
is off by over 1 %, further orders count and the bound is found numerically (`rigsim.theory.inverse_error`).
What a calibration leaves of a disparity adds to sigma_d as squares (`rigsim.theory.calibration.disparity`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

from rigsim.errors import InvalidRange
from rigsim.theory.calibration.disparity import CalibrationDisparity
from rigsim.theory.inverse_error import P95_OVER_STD, noise_allowed, noise_error

RequirementKind: TypeAlias = Literal[
    "depth_error",
    "far_disparity",
    "max_disparity",
    "overlap",
    "cover",
    "cover_height",
    "max_baseline",
    "min_baseline",
    "fov",
    "vfov",
    "pixels",
]

LOWER: frozenset[RequirementKind] = frozenset({"depth_error", "far_disparity", "min_baseline"})
"""Requirements that ask for a long baseline."""
GATES: frozenset[RequirementKind] = frozenset({"fov", "vfov", "pixels", "cover_height"})
"""Requirements on the camera alone."""
_AT_LEAST: frozenset[RequirementKind] = frozenset(
    {"far_disparity", "overlap", "cover", "cover_height", "min_baseline", "fov", "vfov"}
)
_LONGER, _HALVINGS = 1e4, 50
"""How much longer a baseline may be for what a calibration leaves, and how finely it is found."""
_ANYWHERE: frozenset[RequirementKind] = frozenset({"fov", "vfov", "pixels", "max_baseline", "min_baseline"})


@dataclass(frozen=True, slots=True)
class Camera:
    """One of two equal pinhole cameras, its principal point in the middle."""

    width_px: int
    """Image width, px."""
    height_px: int
    """Image height, px."""
    focal_px: float
    """Focal length, px."""
    name: str = ""
    """What it is made of, for people."""
    sensor: str = ""
    """Name of its sensor; empty when none was named."""
    focal_mm: float | None = None
    """Focal length of its lens, mm; None when the pixel pitch is unknown."""
    pitch_um: float | None = None
    """Pixel pitch, micrometres; None when it is unknown."""
    merged: float = 1.0
    """Pixels of the sensor that make one of the image, across and down."""
    body_m: float = 0.0
    """Width of its body, m: two do not stand closer; 0 where it does not matter."""

    def __post_init__(self) -> None:
        if not (self.width_px >= 1 and self.height_px >= 1 and 0 < self.focal_px < math.inf):
            raise InvalidRange(
                f"camera {self.width_px}x{self.height_px} px, focal length {self.focal_px:g} px: must be > 0"
            )

    @property
    def hfov_rad(self) -> float:
        """Horizontal field of view, rad."""
        return 2 * math.atan(self.width_px / 2 / self.focal_px)

    @property
    def vfov_rad(self) -> float:
        """Vertical field of view, rad."""
        return 2 * math.atan(self.height_px / 2 / self.focal_px)

    @property
    def pixels(self) -> int:
        """Pixels of one image."""
        return self.width_px * self.height_px


@dataclass(frozen=True, slots=True)
class Requirement:
    """One line of a specification."""

    kind: RequirementKind
    """What it speaks of; see the module's table."""
    limit: float
    """The bound: m, rad, px, a share, or standard deviations (``far_disparity``)."""
    depth_m: float = math.nan
    """Where it holds, m; NaN where it holds anywhere."""
    per_std: float = 1.0
    """1 for a root mean square, `P95_OVER_STD` for what 95 of 100 errors stay under (depth error)."""
    calibration: CalibrationDisparity | None = None
    """What a calibration leaves, which counts in a depth error; None for nothing."""

    def __post_init__(self) -> None:
        if not (
            math.isfinite(self.limit) and (self.limit > 0 or (self.kind == "overlap" and self.limit == 0))
        ):
            raise InvalidRange(f"{self.kind.replace('_', ' ')} {self.limit:g}: must be > 0 and finite")
        if self.kind == "overlap" and not self.limit < 1:
            raise InvalidRange(
                f"overlap {self.limit * 100:g} %: must be < 100 %; only a rig without baseline has it"
            )
        if self.kind in ("fov", "vfov") and not self.limit < math.pi:
            raise InvalidRange(f"field of view {math.degrees(self.limit):g} deg: must be < 180 deg")
        if self.kind not in _ANYWHERE and not 0 < self.depth_m < math.inf:
            raise InvalidRange(
                f"{self.kind.replace('_', ' ')} at {self.depth_m:g} m: the distance must be > 0"
            )

    def baseline_m(self, camera: Camera, disparity_std_px: float) -> float:
        """The baseline, m, at which the requirement is just met; NaN for those on the camera alone.

        Not positive where no baseline meets it, however short.
        """
        f, W, Z = camera.focal_px, camera.width_px, self.depth_m
        match self.kind:
            case "depth_error":
                alone_m = Z * disparity_std_px / (f * noise_allowed(self.limit / Z, self.is_p95))
                return (
                    alone_m if self.calibration is None else self._longer_m(camera, disparity_std_px, alone_m)
                )
            case "far_disparity":
                return self.limit * disparity_std_px * Z / f
            case "max_disparity":
                return self.limit * Z / f
            case "overlap":
                return (1 - self.limit) * W * Z / f
            case "cover":
                return W * Z / f - self.limit
            case "max_baseline" | "min_baseline":
                return self.limit
            case _:
                return math.nan

    def achieved(self, camera: Camera, baseline_m: float, disparity_std_px: float) -> float:
        """What a rig has of what is required, in the unit of `limit`."""
        f, W, Z = camera.focal_px, camera.width_px, self.depth_m
        match self.kind:
            case "depth_error":
                both_px = math.hypot(disparity_std_px, self.left_px(baseline_m))
                return Z * noise_error(Z * both_px / (f * baseline_m), self.is_p95)
            case "far_disparity":
                return f * baseline_m / (Z * disparity_std_px)
            case "max_disparity":
                return f * baseline_m / Z
            case "overlap":
                return 1 - f * baseline_m / (Z * W)
            case "cover":
                return W * Z / f - baseline_m
            case "cover_height":
                return camera.height_px * Z / f
            case "max_baseline" | "min_baseline":
                return baseline_m
            case "fov":
                return camera.hfov_rad
            case "vfov":
                return camera.vfov_rad
            case "pixels":
                return float(camera.pixels)

    def left_px(self, baseline_m: float) -> float:
        """Standard deviation of a disparity, px, that the calibration leaves; 0 without one."""
        return 0.0 if self.calibration is None else self.calibration.at(self.depth_m / baseline_m)

    def of_calibration(self, focal_px: float, baseline_m: float) -> float:
        """What the calibration alone makes of a depth error, in the unit of `limit`; first order."""
        per_std = P95_OVER_STD if self.is_p95 else 1.0
        return per_std * self.depth_m**2 * self.left_px(baseline_m) / (focal_px * baseline_m)

    def _longer_m(self, camera: Camera, disparity_std_px: float, alone_m: float) -> float:
        """The baseline, m, of a depth error with what a calibration leaves: no shorter than `alone_m`, which
        noise alone asks for; infinite where the calibration alone is too much at any."""
        low, high = math.log(alone_m), math.log(alone_m * _LONGER)
        if self.achieved(camera, alone_m * _LONGER, disparity_std_px) > self.limit:
            return math.inf
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            enough = self.achieved(camera, math.exp(middle), disparity_std_px) <= self.limit
            low, high = (low, middle) if enough else (middle, high)
        return math.exp(high)

    def is_met(self, achieved: float) -> bool:
        """Whether that value of `achieved` fulfils the requirement; arithmetic's last digits are forgiven."""
        slack = 1e-9 * self.limit
        return achieved >= self.limit - slack if self.at_least else achieved <= self.limit + slack

    @property
    def is_p95(self) -> bool:
        """Whether `limit` is what 95 of 100 errors stay under."""
        return self.per_std != 1

    @property
    def at_least(self) -> bool:
        """Whether more is better."""
        return self.kind in _AT_LEAST


@dataclass(frozen=True, slots=True)
class BaselineBound:
    """One end of an interval of baselines."""

    baseline_m: float
    """Where it is, m."""
    requirement: Requirement | None
    """What binds there; None at 0, where nothing does."""


@dataclass(frozen=True, slots=True)
class Interval:
    """The baselines that a camera allows."""

    camera: Camera
    """The camera."""
    lower: BaselineBound
    """Shortest baseline and why."""
    upper: BaselineBound
    """Longest baseline and why."""
    failed: tuple[Requirement, ...]
    """Requirements that the camera itself does not meet, whatever the baseline."""

    @property
    def is_feasible(self) -> bool:
        """Whether there is any baseline."""
        low, high = self.lower.baseline_m, self.upper.baseline_m
        return not self.failed and high > 0 and low <= high


@dataclass(frozen=True, slots=True)
class Relaxation:
    """One requirement, and the value at which it alone would let a rig through."""

    requirement: Requirement | None
    """What to relax; None for the pixel noise, to be lowered."""
    camera: Camera
    """The camera that it would let through."""
    needed: float
    """The value that would do, in the unit of the requirement's limit; px per coordinate for the noise."""
    factor: float
    """By how much, as a ratio > 1 of the two values."""


def disparity_std_px(noise_px: float) -> float:
    """Standard deviation of a disparity from that of each pixel coordinate, px."""
    if not (math.isfinite(noise_px) and noise_px > 0):
        raise InvalidRange(
            f"noise {noise_px:g} px: must be > 0; without noise every baseline measures exactly"
        )
    return math.sqrt(2) * noise_px


def asked_of(camera: Camera, requirements: Sequence[Requirement]) -> tuple[Requirement, ...]:
    """All that a rig of `camera` has to do: `requirements`, and that its bodies fit beside each other."""
    own = (Requirement("min_baseline", camera.body_m),) if camera.body_m else ()
    return (*requirements, *own)


def baseline_interval(camera: Camera, requirements: Sequence[Requirement], noise_px: float) -> Interval:
    """The baselines that meet all `requirements` with `camera`, and what binds at each end.

    Args:
        camera: one of the two cameras.
        requirements: any number of each kind; the camera's body is one more.
        noise_px: standard deviation of one pixel coordinate, px.

    Raises:
        InvalidRange: the noise is not positive.
    """
    return _interval(camera, asked_of(camera, requirements), noise_px)


def _interval(camera: Camera, requirements: Sequence[Requirement], noise_px: float) -> Interval:
    sigma_d = disparity_std_px(noise_px)
    lower, upper = BaselineBound(0.0, None), BaselineBound(math.inf, None)
    failed = []
    for requirement in requirements:
        if requirement.kind in GATES:
            if not requirement.is_met(requirement.achieved(camera, math.nan, sigma_d)):
                failed.append(requirement)
            continue
        bound = BaselineBound(requirement.baseline_m(camera, sigma_d), requirement)
        if requirement.kind in LOWER:
            lower = max(lower, bound, key=lambda end: end.baseline_m)
        else:
            upper = min(upper, bound, key=lambda end: end.baseline_m)
    return Interval(camera, lower, upper, tuple(failed))


def relaxations(
    cameras: Sequence[Camera], requirements: Sequence[Requirement], noise_px: float
) -> tuple[Relaxation, ...]:
    """Which single requirement to relax, and by how much, when no camera allows any baseline.

    Returns:
        The least relaxation of each requirement that can do it alone, over all cameras, and of the noise;
        least change first, the noise last among equals. Empty when two requirements would have to give.

    Raises:
        InvalidRange: the noise is not positive.
    """
    best: dict[int, Relaxation] = {}
    for camera in cameras:
        for place, found in _relax(camera, asked_of(camera, requirements), noise_px):
            if place not in best or found.factor < best[place].factor:
                best[place] = found
    return tuple(sorted(best.values(), key=lambda found: (round(found.factor, 9), not found.requirement)))


def _relax(
    camera: Camera, requirements: Sequence[Requirement], noise_px: float
) -> list[tuple[int, Relaxation]]:
    sigma_d = disparity_std_px(noise_px)
    found = []
    for place, requirement in enumerate(requirements):
        rest = _interval(camera, [other for i, other in enumerate(requirements) if i != place], noise_px)
        if not rest.is_feasible:
            continue
        end = rest.upper if requirement.kind in LOWER else rest.lower
        if not 0 < end.baseline_m < math.inf:
            continue
        needed = requirement.achieved(camera, end.baseline_m, sigma_d)
        if needed > 0 and not requirement.is_met(needed) and requirement.kind != "far_disparity":
            ratio = needed / requirement.limit
            found.append((place, Relaxation(requirement, camera, needed, max(ratio, 1 / ratio))))
    whole = _interval(camera, requirements, noise_px)
    of_noise = _interval(
        camera, [other for other in requirements if other.kind != "min_baseline"], noise_px
    ).lower.baseline_m
    least = max((other.limit for other in requirements if other.kind == "min_baseline"), default=0.0)
    if (
        # what a calibration leaves does not fall with the noise
        not any(other.calibration for other in requirements)
        and not whole.failed
        and max(0.0, least) <= whole.upper.baseline_m < of_noise
        and whole.upper.baseline_m > 0
    ):
        # every other lower bound is proportional to the noise: orders beyond the first go with it as well
        factor = of_noise / whole.upper.baseline_m
        found.append((-1, Relaxation(None, camera, noise_px / factor, factor)))
    return found
