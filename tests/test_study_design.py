"""Candidates, preference, Pareto front, words of failure and the proof."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from sampling import close

from rigsim.errors import InvalidRange, InvalidRig, InvalidScene
from rigsim.rig.noise import PixelNoise
from rigsim.study.design import MARGIN, PREFERENCES, Candidate, Design, pareto_front, solve, specify
from rigsim.study.design_document import design_document, recommended
from rigsim.study.design_proof import check, prove
from rigsim.study.plan import Plan
from rigsim.theory.inverse import P95_OVER_STD, Camera, Requirement

CAMERAS = [
    Camera(w, h, w / 2 / math.tan(math.radians(fov) / 2))
    for w, h in ((320, 240), (640, 480), (1280, 960))
    for fov in (50, 70, 90)
]
SPEC = specify(0.5, 3.0, [Requirement("depth_error", 0.060, 3.0), Requirement("fov", math.radians(60))])
PLAN = Plan(range_m=(0.5, 3.0), noises=(PixelNoise(0.25),), n_points=1500, n_trials=30, measure="none")


def merits(c: Candidate) -> tuple[float, ...]:
    return (c.far_error_m, c.baseline_m, c.camera.pixels, -c.camera.hfov_rad)


@pytest.mark.parametrize("preference", PREFERENCES)
def test_candidates_meet_every_requirement_in_the_order_preferred(preference: str) -> None:
    design = solve(SPEC, CAMERAS, preference)
    for candidate in design.candidates:
        for asked in SPEC.requirements:
            achieved = asked.achieved(candidate.camera, candidate.baseline_m, SPEC.disparity_std_px)
            assert asked.is_met(achieved), (asked, achieved)
    roomy = [c for c in design.candidates if not c.is_tight]
    assert design.candidates[: len(roomy)] == tuple(roomy)
    key = {"smallest": 1, "cheapest": 2, "most-accurate": 0}[preference]
    values = [merits(c)[key] for c in roomy]
    assert values == sorted(values)
    assert roomy[0].margin >= MARGIN * 0.999


def test_far_error_by_hand() -> None:
    # f 1000 px, sigma_d 0.5 px, 3 m: 100 mm leaves 9 x 0.5 / (1000 x 0.1) = 45 mm
    spec = specify(1.0, 3.0, [Requirement("depth_error", 0.045, 3.0)], noise_px=0.5 / 2**0.5)
    design = solve(spec, [Camera(2000, 1000, 1000.0)], "smallest")
    close(design.intervals[0].lower.baseline_m, 0.1, rtol=1e-12)
    first = design.candidates[0]
    close([first.baseline_m, first.far_error_m], [0.105, 0.045 / 1.05], rtol=1e-9)


def test_pareto_front_is_what_no_other_beats() -> None:
    candidates = solve(SPEC, CAMERAS).candidates
    front = pareto_front(candidates)
    assert front
    for candidate in candidates:
        beaten = any(
            all(np.array(merits(o)) <= merits(candidate)) and merits(o) != merits(candidate)
            for o in candidates
        )
        assert (candidate in front) is not beaten


def test_what_collides_is_said_with_ways_out() -> None:
    spec = specify(
        0.5,
        3.0,
        [Requirement("depth_error", 0.010, 3.0), Requirement("max_disparity", 128, 0.5)],
        noise_px=0.25,
    )
    with pytest.raises(InvalidRig) as caught:
        solve(spec, CAMERAS)
    # f B: 9 x 0.35355 / 0.01 = 318.2 against 128 x 0.5 = 64, a factor of 4.97
    message = str(caught.value)
    for words in (
        "depth error at 3 m <= 10 mm needs a baseline >=",
        "disparity search at 0.5 m <= 128 px allows <=",
        "depth error at 3 m from 10 mm to 49.8 mm",
        "disparity search at 0.5 m from 128 px to 637 px",
        "noise from 0.25 px to 0.0502 px",
    ):
        assert words in message, message


def test_cameras_that_never_fit_are_said() -> None:
    spec = specify(0.5, 3.0, [Requirement("depth_error", 0.06, 3.0), Requirement("fov", math.radians(120))])
    with pytest.raises(InvalidRig, match="field of view >= 120°"):
        solve(spec, CAMERAS)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: specify(0.0, 3.0, []), "0 < near < far"),
        (lambda: specify(0.5, 3.0, []), "no depth error"),
        (lambda: specify(0.5, 3.0, [Requirement("depth_error", 0.01, 5.0)]), "outside the range"),
        (lambda: solve(SPEC, []), "no camera"),
        (lambda: solve(SPEC, CAMERAS, "best"), "choose one of"),
    ],
)
def test_bad_specifications(make: object, words: str) -> None:
    assert callable(make)
    with pytest.raises(InvalidRange, match=words):
        make()


def test_a_check_scales_by_the_square_of_the_distance() -> None:
    depth_m = np.linspace(2.0, 3.0, 400)
    asked = Requirement("depth_error", 0.010, 3.0)
    held = check(asked, depth_m, 0.0099 * (depth_m / 3.0) ** 2)
    close(held.simulated_m, 0.0099, rtol=1e-12)
    assert held.is_met
    assert held.nearest_m >= 3 / 1.25
    p95 = Requirement("depth_error", 0.010, 3.0, P95_OVER_STD)
    held = check(p95, depth_m, 0.0099 * (depth_m / 3.0) ** 2)
    close(held.simulated_m, 0.0099 * P95_OVER_STD, rtol=1e-12)
    assert not held.is_met
    assert not check(asked, np.full(500, 1.0), np.full(500, 1e-6)).is_met  # nothing near 3 m


def test_the_pick_is_verified_in_the_scene() -> None:
    design = solve(SPEC, CAMERAS)
    proofs = prove(design, PLAN)
    assert [proof.verified for proof in proofs] == [True]
    held = proofs[0].checks[0]
    close(held.simulated_m, design.candidates[0].far_error_m, rtol=0.03)
    document = json.loads(json.dumps(design_document(design, proofs), allow_nan=False))
    assert document["recommended"]["verified"] is True
    assert document["recommended"]["baseline_mm"] == design.candidates[0].baseline_m * 1e3
    assert document["binding"]["shortest"]["requirement"] == "depth_error"
    close(document["requirements"][0]["simulated"], held.simulated_m * 1e3, rtol=1e-9)


def test_what_the_simulation_denies_is_not_verified_and_the_next_is_taken() -> None:
    design = solve(SPEC, CAMERAS, "smallest")
    # twice the noise that the formulas were given: the shortest baseline cannot keep its promise
    proofs = prove(design, replace(PLAN, noises=(PixelNoise(0.5),)), attempts=2)
    assert [proof.verified for proof in proofs] == [False, False]
    assert [proof.candidate for proof in proofs] == list(design.candidates[:2])
    close(proofs[0].checks[0].simulated_m, 2 * design.candidates[0].far_error_m, rtol=0.03)
    assert "asked for 60 mm" in proofs[0].why
    denied_then_kept = Design(
        design.specification,
        design.intervals,
        (design.candidates[0], max(design.candidates, key=lambda c: c.baseline_m * c.camera.focal_px)),
        design.pareto,
        "smallest",
    )
    proofs = prove(denied_then_kept, replace(PLAN, noises=(PixelNoise(0.5),)))
    assert [proof.verified for proof in proofs] == [False, True]
    assert recommended(denied_then_kept, proofs) == denied_then_kept.candidates[1]


def test_a_scene_without_anything_there_proves_nothing() -> None:
    spec = specify(50.0, 90.0, [Requirement("depth_error", 5.0, 90.0)])
    design = solve(spec, CAMERAS)
    proofs = prove(design, replace(PLAN, range_m=(50.0, 90.0)))
    assert len(proofs) == 1
    assert not proofs[0].verified
    assert proofs[0].result is None
    with pytest.raises(InvalidScene):
        prove(design, replace(PLAN, scene="no-such-scene"))
