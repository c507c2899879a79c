"""The parts of design.json: what its keys mean."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from rigsim.interop.documents.base import Golden, Part, SeenRig
from rigsim.interop.documents.tolerance.models import Quantity, Required
from rigsim.theory.inverse import RequirementKind

Kind = RequirementKind
"""A requirement's name."""

Preference = Literal["buildable", "smallest", "cheapest", "most-accurate"]

Unit = Literal["mm", "px", "fraction", "deg", "standard deviations"]
"""What a requirement's numbers are in."""


class Camera(Part):
    """A sensor behind a lens."""

    name: str
    """What it is called; empty without a sensor's name."""
    focal_px: float
    """Focal length, px."""
    width_px: int
    """Image width, px."""
    height_px: int
    """Image height, px."""
    hfov_deg: float
    """Horizontal field of view, degrees."""
    sensor: str | None
    """The sensor, by name; null where none was asked for."""
    focal_mm: float | None
    """Focal length, mm; null without a sensor."""


class Candidate(SeenRig):
    """A rig that meets the requirements by the formulas."""

    name: str
    """What its camera is called; empty without a sensor's name."""
    sensor: str | None
    """The sensor, by name; null where none was asked for."""
    focal_mm: float | None
    """Focal length, mm; null without a sensor."""
    depth_error_far_mm: float
    """Root mean square depth error at the far end that noise makes, mm."""


class Recommended(Candidate):
    """The rig to take."""

    verified: bool
    """Whether the simulation confirmed it."""
    reason: str
    """Why, or why not."""
    margin: float
    """Distance of the baseline from its nearest limit, as a share of the baseline."""
    noise_share: float
    """What pixel noise takes of the variance of the depth error asked for; of the worst of several."""
    calibration_share: float
    """What the calibration takes of the same; 0 where none is counted."""
    class_name: Literal["printed", "machined", "calibrated"] | None = Field(alias="class")
    """The widest class of which 95 of 100 rigs keep the farthest depth error with noise, else the class asked
    for; null where no built rig can be judged."""
    class_state: Literal["as_built", "recalibrated"] | None
    """How: as built, or once every rig is recalibrated."""
    class_enough: bool | None
    """Whether 95 of 100 are good; null where that is not told."""
    yield_pct: float | None
    """Good rigs of that class in that state, noise and build together, %."""
    limited_by: str | None
    """What limits that yield: a quantity, by its key as in `tolerance.quantities`, or `noise`."""


class CountedCalibration(Part):
    """The calibration that counts in the depth errors."""

    file: str
    """The file's name."""
    source: str
    """What it comes from."""


class Housing(Part):
    """A camera body that was assumed: two cameras do not stand closer than it is wide."""

    width_mm: float
    """Its width, mm."""
    camera: str
    """Whose."""
    source: str
    """Where that is published."""


class Proved(Candidate):
    """A rig that was rendered and simulated."""

    verified: bool
    """Whether that confirmed it."""
    reason: str
    """Why, or why not."""
    scene: str
    """Where: a scene by its name, or a scene made for the range."""
    sensor: str | None
    """What the pictures were taken with; null where none was."""
    measured_method: str | None
    """What was measured in them; null when nothing was."""


class Bound(Part):
    """An end of the recommended rig's interval of baselines."""

    baseline_mm: float
    """Where it is, mm."""
    requirement: Kind | None
    """The requirement that puts it there; null when none does."""
    says: str
    """The same in words."""


class Binding(Part):
    """What keeps the baseline from being shorter or longer."""

    shortest: Bound
    longest: Bound


class Achieved(Part):
    """A requirement, and what the recommended rig makes of it; all in `unit`."""

    requirement: Kind
    """Its name."""
    statistic: Literal["std", "p95"]
    """What a depth error means: its root mean square (std), or what 95 of 100 stay under."""
    at_mm: float | None
    """Distance that it holds at, mm; null where it holds anywhere."""
    unit: Unit
    """Unit of the numbers below."""
    bound: Literal["at least", "at most"]
    """Which way it binds."""
    required: float
    """What was asked for."""
    achieved: float
    """What the rig does by the formulas."""
    by_noise: float | None
    """What pixel noise alone makes of a depth error; null where no calibration is counted in it."""
    by_calibration: float | None
    """What the calibration alone makes of it; the two add as squares. Null likewise."""
    simulated: float | None
    """What it did in the scene; null where that was not simulated."""
    shown_by: Literal["points", "plane", "rays", "pictures", "cameras"] | None
    """What showed it; null without a proof."""
    points_n: int
    """Points of the scene that rests on; 0 where it rests on none."""
    nearest_mm: float | None
    """Depth of the nearest of what showed it, mm; null where no points or plane did."""
    farthest_mm: float | None
    """Depth of the farthest, mm; more than 1.25 times off the distance where the scene has too few nearer."""
    measured: float | None
    """What was measured in the pictures; null where nothing was."""
    measured_n: int
    """Matches that rests on."""
    met: bool
    """Whether it is met, by all that is known."""
    verdict: Literal["met", "not_met", "not_shown"]
    """The same; not_shown where the scene has nothing that could show it."""


class Feasible(Camera):
    """A camera with which some baselines meet every requirement."""

    baseline_min_mm: float
    """The shortest, mm."""
    baseline_max_mm: float
    """The longest, mm."""
    binding_min: Kind | None
    """The requirement that makes it the shortest."""
    binding_max: Kind | None
    """The requirement that makes it the longest."""


class CountedYield(Part):
    """Rigs of one class that meet the requirement with their noise."""

    as_built: float
    """Share as built, 0 to 1."""
    as_built_se: float
    """Its standard error."""
    as_built_rigs: int
    """How many were built."""
    as_built_enough: bool | None
    """Whether at least 95 of 100 are good; null where that is not told."""
    recalibrated: float
    """Share after a recalibration that does not use the tolerances, 0 to 1."""
    recalibrated_se: float
    """Its standard error."""
    recalibrated_rigs: int
    """How many were recalibrated."""
    recalibrated_enough: bool | None
    """Whether at least 95 of 100 are good; null where that is not told."""


class Tried(Part):
    """One thing changed, for the class that comes nearest."""

    says: str
    """What was changed."""
    yields: float = Field(alias="yield")
    """Share of good rigs then, 0 to 1."""
    yield_se: float
    """Its standard error."""
    enough: bool | None
    """Whether at least 95 of 100 are good; null where that is not told."""


class DesignTolerance(Part):
    """What must be held how tightly for the recommended rig to keep its depth error."""

    class_name: str = Field(alias="class")
    """Class of the tolerances."""
    required: Required
    rigs: int
    """How many were built."""
    points: int
    """Points that each was judged by."""
    distances_mm: list[float]
    """Distances of the quantities' depth errors, mm."""
    quantities: list[Quantity]
    """The worst first."""
    noise_mm: float
    """RMS depth error at the required distance that pixel noise alone makes, mm."""
    yields: dict[str, CountedYield] = Field(alias="yield")
    """Share of good rigs with their noise, by class."""
    tried: list[Tried]
    """What was changed where no class will do; empty where one does, or where it is not told."""
    says: str
    """The same in words."""


class LeastImage(Part):
    """The smallest image, in the recommended rig's field of view and shape, that meets all by formula."""

    width_px: int
    """Image width, px."""
    height_px: int
    """Image height, px."""
    baseline_mm: float
    """The baseline that it takes, mm: the longest that the other requirements allow."""


class DesignDocument(Part):
    """The rigs that meet requirements, and one of them recommended and proved."""

    recommended: Recommended
    binding: Binding
    calibration: CountedCalibration | None
    """Null where none is counted."""
    housing: Housing | None
    """What stands for the recommended rig's cameras; null where their width was said, or is not known."""
    requirements: list[Achieved]
    """Those asked for and those implied."""
    range_mm: tuple[float, float]
    """Near and far end of the working range, mm."""
    build_share: float
    """Share of a depth error's variance that a pick was to leave for the build."""
    noise_px: float
    """Standard deviation of one pixel coordinate, px."""
    noise_source: Literal["given", "assumed", "measured"]
    """Where that comes from."""
    noise_says: str
    """The same in words."""
    preference: Preference
    """What --prefer asked for."""
    cameras_tried: int
    """How many, feasible or not."""
    feasible: list[Feasible]
    """Those with which some baseline meets every requirement."""
    smallest_resolution: Candidate | None
    """Of the resolutions tried, the candidate with the fewest pixels, which enough built rigs should hold
    where that is preferred; null for none, or where one resolution was tried."""
    least_size: LeastImage | None
    """The image that would just do without build errors, tried or not; null where nothing limits the
    baseline."""
    pareto: list[Candidate]
    """Pareto-optimal rigs; best first."""
    proof: list[Proved]
    """Rigs that were rendered and simulated, in that order."""
    tolerance: DesignTolerance | None
    """Null where it was not looked into."""
    golden: Golden | None
    """Null without --golden and --update."""
