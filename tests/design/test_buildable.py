"""Designs that can be built: what is expected of built rigs, and that the pick is one of them."""

from __future__ import annotations

import math

import pytest

import rigsim
from rigsim.present.design import console
from rigsim.present.design.tolerance import tolerance_says
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance.count import count_good
from rigsim.study.tolerance.first_order.predicted import expect
from rigsim.study.tolerance.recalibration.session import Build, Recalibration
from rigsim.study.tolerance.sensitivities import CLASSES, BuildRequirement, Tolerances

RIG = StereoRig.rectified(Intrinsics.from_focal(1280, 960, 1100.0), 0.2)
RANGE_M = (0.5, 3.0)


@pytest.mark.parametrize("name", ["machined", "calibrated"])
@pytest.mark.parametrize("recalibrated", [False, True])
def test_what_is_expected_is_what_is_built(name: str, recalibrated: bool) -> None:
    session = Recalibration() if recalibrated else None
    # where some are good and some are not
    required = BuildRequirement(0.022 if recalibrated else {"machined": 0.2, "calibrated": 0.03}[name], 3.0)
    build = Build(RIG, CLASSES[name].tolerances(RIG), 0.25, session)
    expected = expect(build, required, RANGE_M).good
    counted = count_good(build, required, RANGE_M, sizes=(1000,))
    assert 0.05 < expected < 0.98
    # first order, and the chance of two counts of 1000
    assert expected == pytest.approx(counted.share, abs=0.03 + 3 * counted.standard_error)


def test_the_quantity_that_limits_is_named() -> None:
    required = BuildRequirement(0.01, 3.0)
    # Z dB / B: 3 mm of 200 are 45 mm, and 0.01 deg of yaw f B / Z^2 ... 7.9 mm
    both = Tolerances(baseline_mm=3.0, yaw_deg=0.01)
    found = expect(Build(RIG, both, 0.25), required, RANGE_M)
    assert (found.limited_by, found.remaining_std) == ("baseline_mm", pytest.approx(0.003))
    assert expect(Build(RIG, Tolerances(yaw_deg=1e-4), 0.25), required, RANGE_M).limited_by == "noise"
    # after a calibration the bar grows: 23 ppm x 1000 K of 200 mm are 4.6 mm
    hot = Build(RIG, Tolerances(yaw_deg=0.01, temperature_k=1000.0), 0.25, Recalibration())
    assert expect(hot, required, RANGE_M).limited_by == "temperature_k"


def test_known_lengths_tell_the_focal_length_that_both_share() -> None:
    """X = u B / d alone does not: one length along the depth does."""
    build = Build(RIG, Tolerances(both_focal_px=55.0), 0.05, Recalibration(noise_px=0.05))
    # 5 % of the focal length are 5 % of the depth, 150 mm
    required = BuildRequirement(0.01, 3.0)
    assert count_good(Build(RIG, build.tolerances, 0.05), required, RANGE_M, sizes=(300,)).share < 0.15
    assert count_good(build, required, RANGE_M, sizes=(300,)).share > 0.97


def test_the_pick_can_be_built() -> None:
    asked = {"range_m": (0.5, 3), "depth_error_mm": 10, "fov_deg": 60, "proof": False}
    found = rigsim.design(**asked)
    cheapest = rigsim.design(**asked, prefer="cheapest")
    assert found.tolerance is not None
    assert cheapest.tolerance is not None
    name, _, count = found.tolerance.told
    best = found.document()["recommended"]
    assert count.is_enough
    assert (best["class"], best["class_enough"], best["limited_by"]) == (name, True, "noise")
    assert best["yield_pct"] == pytest.approx(100 * count.share)
    assert not cheapest.tolerance.told[2].is_enough
    assert found.rig.left.width > cheapest.rig.left.width


def test_own_tolerances_stand_in_for_the_class_s() -> None:
    found = rigsim.design(
        (1, 3),
        depth_error_mm=30,
        resolutions_px=(1280, 960),
        lenses_deg=60,
        proof=False,
        tolerances={"yaw_deg": 0.3},
    )
    assert found.tolerance is not None
    held = found.tolerance.result.tolerances
    assert math.isclose(held.yaw_deg, 0.3)
    assert held.pitch_deg == CLASSES["machined"].tolerances(found.rig).pitch_deg


def test_what_a_time_offset_is_taken_to_act_on_is_said() -> None:
    asked = {"range_m": (1, 3), "depth_error_mm": 30, "resolutions_px": (1280, 960), "lenses_deg": 60}
    late = rigsim.design(**asked, proof=False, tolerances={"time_offset_ms": 1.0})
    assert late.tolerance is not None
    said = tolerance_says(late.tolerance)
    assert "During a time offset the object moves at 1 m/s along the baseline: that is assumed" in said
    assert "left for build errors (--build-share asks for 50 %)." in " ".join(
        console.sentences(late.found, late.proofs)
    )
    still = rigsim.design(**asked, proof=False)
    assert still.tolerance is not None
    assert "time offset" not in tolerance_says(still.tolerance)


def test_the_smallest_resolution_that_would_do() -> None:
    """By hand: Z^2 sqrt(2) sigma / (f B) of 30 mm at 3 m, f = W / (2 tan 30 deg), B up to 200 mm, takes
    W >= 612; 1 to 1.3 times as wide leaves the build nothing."""
    asked = {
        "range_m": (1.5, 3),
        "depth_error_mm": 30,
        "lenses_deg": 60,
        "max_baseline_mm": 200,
        "proof": False,
    }
    sizes = ((480, 360), (640, 480), (1280, 960), (2560, 1920))
    found = rigsim.design(**asked, resolutions_px=sizes, prefer="most-accurate")
    assert found.rig.left.width == 2560
    assert found.smallest_resolution is not None
    assert found.smallest_resolution.camera.width_px == 640
    document = found.document()
    assert document["smallest_resolution"]["width_px"] == 640
    said = " ".join(console.sentences(found.found, found.proofs))
    assert (
        "By formula the smallest of the resolutions tried that will do is 640x480 px, with a baseline of"
        in said
    )
    built = rigsim.design(**asked, resolutions_px=sizes)
    assert built.smallest_resolution is not None
    assert built.smallest_resolution.camera.width_px == built.rig.left.width > 640
    said = " ".join(console.sentences(built.found, built.proofs))
    assert f"the smallest of the resolutions tried that will do is {built.rig.left.width}x" in said
    alone = rigsim.design(**asked, resolutions_px=(2560, 1920))
    assert alone.document()["smallest_resolution"] is None
    assert "resolution" not in " ".join(console.sentences(alone.found, alone.proofs))


@pytest.mark.parametrize("size", [(640, 480), (2560, 1920)])
def test_the_size_that_would_just_do_is_told_of_one_size_too(size: tuple[int, int]) -> None:
    """By hand: 530.3 px of focal length, 2 tan 30 deg times as wide, are 612.4 px, and 459.3 down."""
    asked = {"range_m": (1.5, 3), "depth_error_mm": 30, "lenses_deg": 60, "proof": False}
    found = rigsim.design(**asked, max_baseline_mm=200, resolutions_px=size)
    least = found.least_size
    assert least is not None
    assert (least.width_px, least.height_px, least.baseline_m) == (613, 460, pytest.approx(0.2))
    said = " ".join(console.sentences(found.found, found.proofs))
    assert "613x460 px would just do by formula, with a baseline of 200 mm and no build errors" in said
    assert found.document()["least_size"] == {"width_px": 613, "height_px": 460, "baseline_mm": 200.0}
    # it does, and one a hundredth smaller does not
    exact = rigsim.design(**asked, max_baseline_mm=200, resolutions_px=(613, 460), prefer="cheapest")
    assert exact.rig.baseline_m == pytest.approx(0.2, rel=2e-3)
    with pytest.raises(rigsim.RigsimError, match="no rig meets all requirements"):
        rigsim.design(**asked, max_baseline_mm=200, resolutions_px=(606, 455))


def test_a_search_of_the_matcher_does_not_set_the_size() -> None:
    """A smaller image has smaller disparities: f B / Z is held by noise and the error asked for alone."""
    asked = {"range_m": (1.5, 3), "depth_error_mm": 30, "lenses_deg": 60, "proof": False}
    found = rigsim.design(**asked, max_disparity_px=100, resolutions_px=(2560, 1920))
    least = found.least_size
    # overlap at 1.5 m: 0.5 x 2 tan 30 deg x 1.5 m = 0.866 m
    assert least is not None
    assert (least.width_px, least.baseline_m) == (142, pytest.approx(0.8660, abs=1e-4))


def test_a_part_of_the_pixels_is_no_smaller_picture_of_the_same_view() -> None:
    """Pixels of one pitch behind one lens: fewer of them see less, and nothing is said of a size."""
    asked = {"range_m": (0.8, 1.2), "depth_error_mm": 1, "resolutions_px": (2448, 2048), "lenses_mm": 4}
    assert rigsim.design(**asked, pixel_pitch_um=3.45, proof=False).least_size is None
