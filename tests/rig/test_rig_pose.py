"""Poses form a group, and `b_from_a` maps a to b."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given

from rigsim.errors import InvalidRig
from rigsim.rig.pose import Pose, rotation_from_rotvec, rotvec_from_rotation, skew
from tests.helpers.sampling import close, poses, vectors


def test_apply_by_hand() -> None:
    # a quarter turn about y takes z to x and x to -z
    pose = Pose.from_rotvec((0.0, np.pi / 2, 0.0), (10.0, 20.0, 30.0))
    close(
        pose.apply([[1.0, 2.0, 3.0], [0.0, 0.0, 0.0]]), [[13.0, 22.0, 29.0], [10.0, 20.0, 30.0]], atol=1e-14
    )


def test_product_applies_the_right_one_first() -> None:
    turn = Pose.from_rotvec((0.0, 0.0, np.pi / 2))
    shift = Pose(t=np.array([1.0, 0.0, 0.0]))
    close((turn @ shift).apply([0.0, 0.0, 0.0]), [0.0, 1.0, 0.0], atol=1e-15)
    close((shift @ turn).apply([0.0, 0.0, 0.0]), [1.0, 0.0, 0.0], atol=1e-15)


@given(poses(), poses(), poses(), vectors(5.0))
def test_composition_is_associative_and_acts(c: Pose, b: Pose, a: Pose, x: np.ndarray) -> None:
    close(((c @ b) @ a).apply(x), (c @ (b @ a)).apply(x), atol=1e-13)
    close((b @ a).apply(x), b.apply(a.apply(x)), atol=1e-13)


@given(poses(), vectors(5.0))
def test_inverse_undoes(pose: Pose, x: np.ndarray) -> None:
    close(pose.inverse.apply(pose.apply(x)), x, atol=1e-13)
    close((pose @ pose.inverse).R, np.eye(3), atol=1e-14)
    close((pose.inverse @ pose).t, np.zeros(3), atol=1e-13)


@given(vectors(1.8))
def test_rotvec_returns(rotvec: np.ndarray) -> None:
    close(rotvec_from_rotation(rotation_from_rotvec(rotvec)), rotvec, atol=1e-14)


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0.6, 0.0, -0.8), (2 / 3, -2 / 3, 1 / 3)])
@pytest.mark.parametrize("angle", [0.0, 1e-9, 1.0, np.pi - 1e-9, np.pi])
def test_rotvec_at_zero_and_at_pi(axis: tuple[float, float, float], angle: float) -> None:
    R = rotation_from_rotvec(angle * np.array(axis))
    rotvec = rotvec_from_rotation(R)
    close(rotation_from_rotvec(rotvec), R, atol=1e-15)
    close(np.linalg.norm(rotvec), angle, atol=1e-15)


def test_half_turn_by_hand() -> None:
    close(rotation_from_rotvec(np.array([0.0, 0.0, np.pi])), np.diag([-1.0, -1.0, 1.0]), atol=1e-15)
    close(rotvec_from_rotation(np.diag([-1.0, 1.0, -1.0])), [0.0, np.pi, 0.0])


@given(vectors(3.0), vectors(3.0))
def test_skew_is_the_cross_product(v: np.ndarray, w: np.ndarray) -> None:
    close(skew(v) @ w, np.cross(v, w), atol=1e-14)


def test_equal_poses_share_a_hash_and_cannot_be_written() -> None:
    one, other = (Pose.from_rotvec((0.1, 0.2, 0.3), (1, 2, 3)) for _ in range(2))
    assert one == other
    assert hash(one) == hash(other)
    assert one != one.inverse
    with pytest.raises(ValueError, match="read-only"):
        one.t[0] = 5.0


def test_a_pose_keeps_its_own_copy() -> None:
    t = np.array([1.0, 2.0, 3.0])
    pose = Pose(t=t)
    t[0] = 9.0
    close(pose.t, [1.0, 2.0, 3.0])


@pytest.mark.parametrize(
    ("R", "t", "says"),
    [
        (np.diag([1.0, 1.0, -1.0]), np.zeros(3), r"R is no rotation .*det = -1\b"),
        (2 * np.eye(3), np.zeros(3), r"\|R R\^T - 1\| = 3\b"),
        (np.eye(2), np.zeros(3), "R must be 3x3"),
        (np.eye(3), np.zeros(2), "t must have 3 numbers"),
        (np.eye(3), np.array([0.0, np.nan, 0.0]), "finite"),
    ],
)
def test_impossible_poses_are_named(R: np.ndarray, t: np.ndarray, says: str) -> None:
    with pytest.raises(InvalidRig, match=says):
        Pose(R, t)
