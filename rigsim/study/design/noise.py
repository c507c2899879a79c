"""A sensor's noise, as a design needs it: what is found where rigs are tried (`rigsim.study.design.room`).

Patches of the pictures are matched, and the errors of their disparities against the truth give a standard
deviation. Surfaces are what a rig is bought for, so corners of calibration boards, which are ten times as
exact, do not count.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from rigsim.errors import InvalidRig
from rigsim.statistics import rms, robust_rms
from rigsim.study.design import words as words
from rigsim.study.design.checks import FEWEST_MATCHES, nearest_points
from rigsim.study.design.room import Room
from rigsim.study.design.solve import Candidate, Design, Specification, solve
from rigsim.study.saying import Saying, saying
from rigsim.study.scene.third_witness import MeasuredMatches
from rigsim.theory.inverse import Camera

ROUNDS = 3
"""Designs, each from the noise measured with the one before, before it is left at that."""
AGREES = 0.1
"""A measured noise this near the assumed one, as a share of it, confirms it."""
_STARTS_PX = (0.05, 0.0125, 0.003)  # less when no rig meets the requirements with it


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
