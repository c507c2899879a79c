"""Which cases a suite holds; a case is the same whatever else is asked for beside it."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig.stereo import StereoRig
from rigsim.study.verify.case import Case
from rigsim.study.verify.synthetic import GEOMETRIES, Geometry, degenerate, exact, noisy, random_geometry

SUITES = ("quick", "full")
"""Names of the suites: quick for every commit, full before a release."""

_NEAREST_DISPARITY = 0.25  # of the image's width
_FARTHEST_PX = 10.0


@dataclass(frozen=True, slots=True)
class Size:
    """How much of everything a suite holds."""

    exact: int
    """Rows of a case without noise."""
    noisy: int
    """Rows of a case with noise."""
    random_rigs: int
    """Rigs drawn at random."""


SIZES = {"quick": Size(200, 2000, 4), "full": Size(2000, 40_000, 40)}
"""Sizes by suite."""


def stream(seed: int, name: str) -> np.random.Generator:
    """The random stream of one case."""
    digest = hashlib.sha256(name.encode()).digest()
    key = tuple(int.from_bytes(digest[i : i + 4], "little") for i in range(0, 16, 4))
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))


def synthetic_cases(suite: str, seed: int, rig: StereoRig | None = None) -> Iterator[Case]:
    """The cases that need no scene, those of `rig` first when one is given.

    Raises:
        InvalidRange: unknown suite or negative seed.
    """
    size = _size(suite, seed)
    own = () if rig is None else (own_geometry(rig),)
    drawn = (random_geometry(i, stream(seed, f"rig {i}")) for i in range(1, size.random_rigs + 1))
    for geometry in (*own, *GEOMETRIES, *drawn):
        yield exact(geometry, size.exact, stream(seed, f"{geometry.name} exact"))
        yield noisy(geometry, size.noisy, stream(seed, f"{geometry.name} noisy"))
    yield from degenerate(size.exact, stream(seed, "degenerate"))


def own_geometry(rig: StereoRig) -> Geometry:
    """A user's rig at the depths where its parallax is a quarter of the image down to 10 px."""
    reach = rig.left.fx * rig.baseline_m
    return Geometry(
        "your rig",
        rig,
        (reach / (_NEAREST_DISPARITY * rig.left.width), reach / _FARTHEST_PX),
        "The rig that was given.",
    )


def selected(case: Case, patterns: tuple[str, ...]) -> bool:
    """Whether a case's name or group matches one of the patterns (``verged*``); all match none given."""
    return not patterns or any(
        fnmatchcase(name.lower(), pattern.lower()) for pattern in patterns for name in (case.name, case.group)
    )


def _size(suite: str, seed: int) -> Size:
    if suite not in SIZES:
        raise InvalidRange(f"suite {suite!r}: choose one of {', '.join(SUITES)}")
    if seed < 0:
        raise InvalidRange(f"seed {seed}: must be >= 0")
    return SIZES[suite]
