"""The scene that is made for a design: where it needs something to see, and for which cameras."""

from __future__ import annotations

from collections.abc import Sequence

from rigsim.sim.scenes.made import MadeScene, made_scene
from rigsim.study.design.solve import Candidate, Specification


def proof_distances_m(specification: Specification) -> tuple[float, ...]:
    """Where a proof needs something to see, m: every depth error's distance, and the ends of the range."""
    errors = (asked.depth_m for asked in specification.requirements if asked.kind == "depth_error")
    return tuple(sorted({specification.near_m, *errors, specification.far_m}))


def scene_for(distances_m: Sequence[float], candidate: Candidate) -> MadeScene:
    """A scene with something to see at each distance for the candidate's camera at any of its baselines."""
    camera, longest_m = candidate.camera, candidate.interval.upper.baseline_m
    return made_scene(distances_m, camera.hfov_rad, camera.vfov_rad, longest_m)
