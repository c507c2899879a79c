"""Which baselines are feasible over focal lengths, for one image size, and each requirement's line there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.study.design.solve import Specification
from rigsim.theory.inverse import Camera, Requirement, baseline_interval

_UPRIGHT = ("fov", "vfov", "cover_height")


@dataclass(frozen=True, slots=True, eq=False)
class LimitLine:
    """Where a requirement is just met."""

    place: int
    """Which of all requirements it is."""
    requirement: Requirement
    """The requirement."""
    focal_px: Array
    """Focal lengths (n,), px; two that are the same where the requirement is on the camera alone."""
    baseline_m: Array
    """Baselines (n,), m."""


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """What is feasible with one image size."""

    camera: Camera
    """A camera of that size."""
    focal_px: Array
    """Focal lengths (n,), px, ascending."""
    shortest_m: Array
    """Shortest baseline allowed at each (n,), m; NaN where none is."""
    longest_m: Array
    """Longest baseline allowed at each (n,), m; NaN where none is."""
    span_m: tuple[float, float]
    """Baselines that are looked at, m."""
    lines: tuple[LimitLine, ...]
    """Of the requirements that limit anything between those ends."""


def region(
    specification: Specification, chip: Camera, focal_px: Array, span_m: tuple[float, float]
) -> Region:
    """What is feasible with cameras of `chip`'s image size, by their focal lengths.

    Args:
        specification: what is asked for.
        chip: any camera of the image size.
        focal_px: focal lengths (n,) to look at, px, ascending.
        span_m: shortest and longest baseline to look at, m.
    """
    cameras = [replace(chip, focal_px=float(focal)) for focal in focal_px]
    shortest, longest = np.full(len(cameras), np.nan), np.full(len(cameras), np.nan)
    for place, camera in enumerate(cameras):
        found = baseline_interval(camera, specification.requirements, specification.noise_px)
        if found.is_feasible:
            shortest[place], longest[place] = found.lower.baseline_m, found.upper.baseline_m
    lines = limit_lines(specification, chip, focal_px, span_m)
    return Region(chip, focal_px, shortest, longest, span_m, lines)


def limit_lines(
    specification: Specification, chip: Camera, focal_px: Array, span_m: tuple[float, float]
) -> tuple[LimitLine, ...]:
    """Each requirement's line over focal lengths (n,) px, ascending, where it lies within `span_m`."""
    found = []
    cameras = [replace(chip, focal_px=float(focal)) for focal in focal_px]
    for place, asked in enumerate(specification.asked_of(chip)):
        if asked.kind in _UPRIGHT:
            widest = longest_focal_px(asked, chip)
            if focal_px[0] <= widest <= focal_px[-1]:
                found.append(LimitLine(place, asked, np.full(2, widest), np.array(span_m)))
        elif asked.kind != "pixels":
            line = _line(place, asked, cameras, specification.disparity_std_px)
            # coverage ends where one camera alone sees too little
            there = line.baseline_m > 0
            ends_m = line.baseline_m[there]
            if there.any() and ends_m.max() >= span_m[0] and ends_m.min() <= span_m[1]:
                found.append(replace(line, focal_px=line.focal_px[there], baseline_m=ends_m))
    return tuple(found)


def _line(place: int, asked: Requirement, cameras: Sequence[Camera], disparity_std_px: float) -> LimitLine:
    baselines = [asked.baseline_m(camera, disparity_std_px) for camera in cameras]
    return LimitLine(place, asked, np.array([camera.focal_px for camera in cameras]), np.array(baselines))


def longest_focal_px(asked: Requirement, chip: Camera) -> float:
    """The focal length, px, beyond which a camera of that image size sees too little."""
    if asked.kind == "cover_height":
        return chip.height_px * asked.depth_m / asked.limit
    side_px = chip.width_px if asked.kind == "fov" else chip.height_px
    return side_px / 2 / math.tan(asked.limit / 2)
