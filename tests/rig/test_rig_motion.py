"""Cameras that are not triggered at once: signs by hand, the law to first order, and what is relative."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rigsim
from rigsim.errors import InvalidRange
from rigsim.rig.motion import Motion
from rigsim.rig.noise import PixelNoise
from rigsim.study.calc.motion import motion_at, motion_remarks, shift_of
from tests.helpers.sampling import close

# f = 1000 px, B = 100 mm, principal point (500, 400)
RIG = rigsim.make_rig(baseline_mm=100, focal_px=1000, resolution_px=(1001, 801))
SPEEDS = st.floats(-3, 3)


def seen_late(motion: Motion, point: tuple[float, float, float]) -> list[float]:
    (uv,) = motion.apply(RIG).project([point])[1]
    return [float(value) for value in uv]


def test_a_thing_that_passes_to_the_right_is_seen_further_right_and_farther() -> None:
    # 2 m/s x 5 ms = 10 mm; 1000 x (-0.1 + 0.01) / 2 instead of 1000 x -0.1 / 2
    object_ = Motion(0.005, 2.0, moving="object")
    close(seen_late(object_, (0, 0, 2)), [500 - 45, 400])
    # a disparity of 45 px instead of 50: 1000 x 0.1 / 45
    close(shift_of(RIG, object_, np.array([[0, 0, 2.0]])).depth_error_m, [100 / 45 - 2])
    # a rig that goes there leaves it behind
    close(seen_late(replace(object_, moving="rig"), (0, 0, 2)), [500 - 55, 400])
    # and a right picture that is first shows the other way
    close(seen_late(replace(object_, time_offset_s=-0.005), (0, 0, 2)), [500 - 55, 400])


def test_a_rig_that_goes_forward_sees_things_spread() -> None:
    # 50 m/s x 10 ms = 0.5 m: the point 0.3 m to the right of the right camera, 0.5 below, is 2 m away
    close(seen_late(Motion(0.01, 0.0, 50.0), (0.4, 0.5, 2.5)), [500 + 150, 400 + 250])
    close(seen_late(Motion(0.01, 0.0, -50.0, moving="object"), (0.4, 0.5, 2.5)), [650, 650])


def test_a_rig_that_goes_down_the_picture_sees_things_go_up_across_the_rows() -> None:
    # 4 m/s x 5 ms = 20 mm, at 20 m: 1000 x 0.02 / 20 = 1 px, up; the disparity stays
    motion = Motion(0.005, vertical_speed_m_s=4.0)
    close(seen_late(motion, (0, 0, 20)), [500 - 5, 400 - 1])
    close(seen_late(Motion(0.005, moving="object", vertical_speed_m_s=4.0), (0, 0, 20)), [500 - 5, 401])
    found = motion_at(RIG, motion, 20.0, PixelNoise(0.25), sized=True)
    assert (found.along_px, found.allowed_s) == (pytest.approx(0, abs=1e-9), math.inf)
    assert found.across_px == pytest.approx(-1) == found.most_across_px
    # half a pixel takes half as long
    assert found.allowed_rows_s == pytest.approx(0.0025)


def test_a_turn_to_the_right_moves_the_picture_left() -> None:
    """30 deg/s and 2 ms are a px at 1000 px of focal length: 1000 tan(0.06 deg) = 1.0472."""
    motion = Motion(0.002, turn_rate_rad_s=math.radians(30))
    far = 1e7
    close(seen_late(motion, (0.05, 0, far)), [500 - 1000 * math.tan(math.radians(0.06)), 400], atol=1e-4)
    # a quarter turn about the middle of the baseline: the right camera comes to stand behind it, by B / 2
    quarter = Motion(1.0, turn_rate_rad_s=math.pi / 2)
    # 2 m to the right of the middle is 2 m ahead then, and 0.05 m to the left of the right camera
    close(seen_late(quarter, (0.05 + 2.0, 0.5, 0.0)), [500 - 25, 400 + 250])


@given(
    st.tuples(SPEEDS, SPEEDS, SPEEDS),
    st.floats(-60, 60),
    st.tuples(st.floats(-0.4, 0.4), st.floats(-0.3, 0.3), st.floats(1, 20)),
)
def test_small_motions_follow_the_formula_of_the_docs(
    speeds: tuple[float, float, float], turn_deg_s: float, at: tuple[float, float, float]
) -> None:
    (sideways, down, forward), (x, y, depth) = speeds, at
    dt, turn = 1e-6, math.radians(turn_deg_s)
    point = np.array([[x * depth + 0.1, y * depth, depth]])  # the right camera sees it at (x, y)
    shift = shift_of(RIG, Motion(dt, sideways, forward, turn, vertical_speed_m_s=down), point)
    # swung about the middle of the baseline the right camera also goes back, by B w dt / 2
    ahead = forward - 0.05 * turn
    along = 1000 * dt * (-sideways / depth + x * ahead / depth - (1 + x * x) * turn)
    across = 1000 * dt * (-down / depth + y * ahead / depth - x * y * turn)
    close(shift.along_px, [along], rtol=1e-4, atol=1e-9)
    close(shift.across_px, [across], rtol=1e-4, atol=1e-9)
    close(shift.depth_error_m, [depth**2 * along / 100], rtol=2e-2, atol=1e-7)


@given(SPEEDS, SPEEDS, SPEEDS)
def test_only_what_moves_against_the_other_counts(sideways: float, forward: float, down: float) -> None:
    rig = rigsim.make_rig(RIG, vergence_deg=5, vertical_mm=3)
    motion = Motion(0.01, sideways, forward, vertical_speed_m_s=down)
    other = Motion(0.01, -sideways, -forward, moving="object", vertical_speed_m_s=-down)
    assert motion.apply(rig) == other.apply(rig)
    close(Motion(0.01).apply(rig).right_from_left.t, rig.right_from_left.t, atol=1e-15)


def test_a_distance_is_told_with_its_surroundings() -> None:
    motion = Motion(0.004, 0.0, 5.0)
    found = motion_at(RIG, motion, 1.0, PixelNoise(0.25), sized=True)
    # 20 mm ahead of 1 m; the lower edge at y = 0.4005: 1000 x 0.4005 x (1/0.98 - 1) = 8.173 px
    assert abs(found.most_across_px) == pytest.approx(8.173, abs=1e-3)
    assert found.along_px == pytest.approx(-100 / 0.98 + 100)
    # the shift grows with the time: 0.3536 px of a disparity's noise
    allowed = motion_at(
        RIG, replace(motion, time_offset_s=found.allowed_s), 1.0, PixelNoise(0.25), sized=True
    )
    assert abs(allowed.most_along_px) == pytest.approx(0.25 * math.sqrt(2), rel=0.03)
    (remark,) = motion_remarks(found, 1.0)
    assert remark.code == "rows"
    unsized = motion_at(RIG, motion, 1.0, PixelNoise(0.25), sized=False)
    assert math.isnan(unsized.most_along_px)
    assert unsized.along_px == found.along_px
    still = motion_at(RIG, Motion(0.004), 1.0, PixelNoise(0.25), sized=True)
    assert (still.along_px, still.most_across_px, still.allowed_s) == (0.0, 0.0, math.inf)
    assert still.allowed_rows_s == math.inf


def test_a_shift_that_leaves_no_disparity_has_no_depth() -> None:
    found = motion_at(RIG, Motion(0.1, 2.0, moving="object"), 2.0, PixelNoise(0.25), sized=True)
    assert math.isnan(found.depth_error_m)
    assert "no_depth" in [remark.code for remark in motion_remarks(found, 2.0)]


@pytest.mark.parametrize(
    ("words", "told"),
    [({"moving": "scene"}, "moving 'scene': must be one of rig, object"), ({"speed_m_s": math.nan}, "nan")],
)
def test_motions_that_are_none(words: dict[str, Any], told: str) -> None:
    with pytest.raises(InvalidRange, match=told):
        Motion(0.001, **words)
