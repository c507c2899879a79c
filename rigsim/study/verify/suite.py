"""Which cases a suite holds; a case is the same whatever else is asked for beside it."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np

from rigsim.errors import InvalidRange, NothingSeen
from rigsim.rig.stereo import StereoRig
from rigsim.study.scene.look import CORNERS_FROM_BOARDS
from rigsim.study.verify.case import Case
from rigsim.study.verify.geometries import GEOMETRIES, Geometry, random_geometry
from rigsim.study.verify.rendered import measured_case, scene_rig
from rigsim.study.verify.rendered import scene_cases as from_scene
from rigsim.study.verify.synthetic import degenerate, exact, noisy, special_rows

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
    many: int
    """Rows of the case that shows what is done in pieces."""
    pictures: bool
    """Whether the pictures of every scene are measured, patches too; else corners where boards abound."""


SIZES = {"quick": Size(200, 2000, 8, 10_007, False), "full": Size(2000, 40_000, 40, 70_001, True)}
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
    # the same strange rigs for every seed: what differs between seeds is points and noise alone
    drawn = (random_geometry(i, stream(0, f"rig {i}")) for i in range(1, size.random_rigs + 1))
    for geometry in (*own, *GEOMETRIES, *drawn):
        yield exact(geometry, size.exact, stream(seed, f"{geometry.name} exact"))
        yield noisy(geometry, size.noisy, stream(seed, f"{geometry.name} noisy"))
    yield from degenerate(size.exact, stream(seed, "degenerate"))
    yield from special_rows(size.many, stream(seed, "special rows"))


def scene_cases(
    suite: str,
    seed: int,
    scenes: Sequence[str],
    left_out: Callable[[str], None],
    rig: StereoRig | None = None,
    renderer: str = "auto",
    wanted: Callable[[str, str], bool] = lambda _name, _group: True,
) -> Iterator[Case]:
    """The cases of scenes, with the rig each is made for or with `rig`.

    Args:
        suite: quick or full.
        seed: seed of every random stream.
        scenes: names of bundled scenes or paths of MJCF files.
        left_out: is told what could not be made, and why, in a sentence.
        rig: the rig for all of them; None for each its own.
        renderer: auto, egl, osmesa or rays; pictures of rays have nothing to be measured.
        wanted: whether a case of that name and group is wanted: pictures are drawn only for those.

    Raises:
        InvalidScene: no such scene.
    """
    from rigsim.sim.simulator import Simulator

    size = _size(suite, seed)
    for scene in scenes:
        with Simulator(scene, renderer=renderer) as simulator:
            name = simulator.scene.name
            own = rig or scene_rig(name)
            try:
                yield from from_scene(simulator, own, size.noisy, lambda what: stream(seed, what))
            except NothingSeen as error:
                left_out(str(error))
                continue
            methods = ["patches"] if size.pictures else []
            if len(simulator.scene.boards) >= (1 if size.pictures else CORNERS_FROM_BOARDS):
                methods.append("corners")
            for method in methods:
                if not wanted(f"{name} {method}", name):
                    continue
                if simulator.backend == "rays":
                    left_out(f"{name} {method}: no GL renderer here, and pictures of rays have no texture")
                    continue
                case = measured_case(simulator, own, method, lambda what: stream(seed, what))
                if isinstance(case, str):
                    left_out(case)
                else:
                    yield case


def own_geometry(rig: StereoRig) -> Geometry:
    """A user's rig at the depths where its parallax is a quarter of the image down to 10 px."""
    reach = rig.left.fx * rig.baseline_m
    return Geometry(
        "your rig",
        rig,
        (reach / (_NEAREST_DISPARITY * rig.left.width), reach / _FARTHEST_PX),
    )


def selected(name: str, group: str, patterns: Sequence[str]) -> bool:
    """Whether a case's name or group matches one of the patterns (``verged*``); all match none given."""
    return not patterns or any(
        fnmatchcase(text.lower(), pattern.lower()) for pattern in patterns for text in (name, group)
    )


def _size(suite: str, seed: int) -> Size:
    if suite not in SIZES:
        raise InvalidRange(f"suite {suite!r}: choose one of {', '.join(SUITES)}")
    if seed < 0:
        raise InvalidRange(f"seed {seed}: must be >= 0")
    return SIZES[suite]
