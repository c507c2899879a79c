"""The scene in space: shapes that stand where the rig's own geometry says."""

from __future__ import annotations

import numpy as np
import pytest

from rigsim.present.live.colors import colors, scale_for
from rigsim.present.live.space import REACH
from rigsim.studio.logic.numbers import RigNumbers, numbers_of
from rigsim.studio.logic.space import Space, cameras_of, space_of, told
from rigsim.studio.pages.rig.page import DEFAULTS

FAR_M = 5.0
UNIT = REACH / FAR_M


def found_for(**words: str) -> RigNumbers:
    return numbers_of(DEFAULTS.with_words(**words))


def space_for(**words: str) -> Space:
    found = space_of(found_for(**words), None)
    assert found is not None
    return found


def test_cameras_stand_a_baseline_apart_and_look_ahead() -> None:
    shown = cameras_of(found_for(baseline="500mm"))
    assert shown is not None
    left, right = (np.array(camera.at) for camera in shown[1])
    np.testing.assert_allclose(right - left, [0.5 * UNIT, 0, 0], atol=1e-6)
    for camera in shown[1]:
        np.testing.assert_allclose(np.array(camera.turn) @ [0, 0, 1], [0, 1, 0], atol=1e-6)
        np.testing.assert_allclose(np.array(camera.turn) @ [0, 1, 0], [0, 0, -1], atol=1e-6)
        half_width = max(corner[0] for corner in camera.corners)
        assert half_width == pytest.approx(REACH * 640 / 900, rel=1e-6)


def test_verged_cameras_turn_inwards() -> None:
    shown = cameras_of(found_for(vergence="10deg"))
    assert shown is not None
    ahead = [np.array(camera.turn) @ [0, 0, 1] for camera in shown[1]]
    np.testing.assert_allclose(
        [axis[0] for axis in ahead], [np.sin(np.radians(5)), -np.sin(np.radians(5))], atol=1e-6
    )


def test_points_lie_within_both_pictures_and_carry_the_predicted_errors() -> None:
    found = space_for(vergence="3deg")
    assert 40 < len(found.cloud.points_left) <= 80
    for uv in (found.cloud.uv_left, found.cloud.uv_right):
        assert ((uv >= -0.5) & (uv <= np.array([1279.5, 719.5]))).all()
    # the errors are the ellipsoids' extents along the axes
    turned = found.cloud.turns * found.cloud.half_axes_m[:, None, :]
    np.testing.assert_allclose(1e3 * np.linalg.norm(turned, axis=2), found.cloud.std_mm)


def test_the_longest_axis_of_an_ellipsoid_points_at_the_rig() -> None:
    found = space_for()
    longest = found.shapes.turns[:, :, 2]
    towards = found.shapes.at / np.linalg.norm(found.shapes.at, axis=1)[:, None]
    assert (np.abs(np.einsum("ni,ni->n", longest, towards)) > 0.999).all()
    np.testing.assert_allclose(np.linalg.det(found.shapes.turns), 1.0)


def test_points_of_a_scene_that_one_camera_misses_or_that_lie_far_off_are_left_out() -> None:
    points = np.array([[0, 0, 2.0], [-1.4, 0, 2.0], [0, 0, 50.0], [9.0, 0, 2.0]])
    found = space_of(found_for(), points)
    assert found is not None
    assert found.cloud.points_left.tolist() == [[0, 0, 2.0]]
    said = told(found.cloud, 0)
    assert said["Z ± std"] == ("2000 ± 13", "mm")
    assert said["left pixel"][0] == "639.50, 359.50"


def test_without_a_rig_there_is_nothing_in_space() -> None:
    assert space_of(found_for(baseline="0"), None) is None
    assert cameras_of(found_for(range="")) is None


def test_colours_run_from_low_to_high_and_grey_is_unknown() -> None:
    values = np.array([1.0, 100.0, np.nan, 10.0])
    scale = scale_for(values)
    assert scale is not None
    assert scale.log
    assert scale.middle == pytest.approx(10.0)
    low, high, unknown, middle = colors(values, scale)
    assert (low, high, unknown, middle) == ("#3b528b", "#fde725", "#8a8a8a", "#28ae80")
    assert scale_for(np.array([np.nan])) is None
