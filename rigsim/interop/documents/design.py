"""What `rigsim design --json` prints and design.json holds."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from rigsim.interop.documents.base import Part, SeenRig
from rigsim.interop.documents.tolerance import Quantity, Required, Yield

Kind = Literal[
    "depth_error", "far_disparity", "max_disparity", "overlap", "cover", "max_baseline", "fov", "pixels"
]
"""A requirement's name."""


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
    """Standard deviation of the depth at the far end, mm."""


class Recommended(Candidate):
    """The rig to take."""

    verified: bool
    """Whether the simulation confirmed it."""
    reason: str
    """Why, or why not."""
    margin: float
    """Room to the nearer end of its interval, as a share of the baseline."""


class Proved(Candidate):
    """A rig that was rendered and simulated."""

    verified: bool
    """Whether that confirmed it."""
    reason: str
    """Why, or why not."""
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
    """What a depth error means: one standard deviation, or what 95 of 100 stay under."""
    at_mm: float | None
    """Distance that it holds at, mm; null where it holds anywhere."""
    unit: Literal["mm", "px", "fraction", "deg", "standard deviations"]
    """Unit of the numbers below."""
    bound: Literal["at least", "at most"]
    """Which way it binds."""
    required: float
    """What was asked for."""
    achieved: float
    """What the rig does by the formulas."""
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
    yields: dict[str, Yield] = Field(alias="yield")
    """Share of good rigs, by class."""
    says: str
    """The same in words."""


class DesignDocument(Part):
    """The rigs that meet requirements, and one of them recommended and proved."""

    recommended: Recommended
    binding: Binding
    requirements: list[Achieved]
    """Those asked for and those implied."""
    range_mm: tuple[float, float]
    """Near and far end of the working range, mm."""
    noise_px: float
    """Standard deviation of one pixel coordinate, px."""
    noise_source: Literal["given", "assumed", "measured"]
    """Where that comes from."""
    noise_says: str
    """The same in words."""
    preference: Literal["smallest", "cheapest", "most-accurate"]
    """What --prefer asked for."""
    cameras_tried: int
    """How many, feasible or not."""
    feasible: list[Feasible]
    """Those with which some baseline meets every requirement."""
    pareto: list[Candidate]
    """Rigs that no other beats in everything; best first."""
    proof: list[Proved]
    """Rigs that were rendered and simulated, in that order."""
    tolerance: DesignTolerance | None
    """Null where it was not looked into."""
