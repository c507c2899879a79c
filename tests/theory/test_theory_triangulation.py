"""Every triangulator against hand-computed points; the optimal one against an independent solution."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigsim.errors import TriangulatorError
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.noise import PixelNoise
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.theory.triangulation import METHODS, resolve, triangulate
from rigsim.theory.uncertainty import parallax_px, predict_covariance
from tests.helpers.sampling import PLAIN, RIGS, close, noisy, points_in_view, rectified_rigs, rigs

RIGHT, DOWN = np.array([0.5, 0.0]), np.array([0.0, 0.5])  # half a pixel
GENERAL = [name for name in METHODS if name != "rectified"]


@pytest.mark.parametrize("method", METHODS)
def test_rectified_by_hand(method: str) -> None:
    left = Intrinsics(640, 480, 500.0, 400.0, 300.0, 250.0)
    rig = StereoRig.rectified(left, 0.2, right=replace(left, cx=310.0))
    # d = 425 - 410, doffs = 10: Z = 500*0.2/25; X = 125/500 Z; Y = -200/400 Z
    close(triangulate(rig, [[425.0, 50.0]], [[410.0, 50.0]], method), [[1.0, -2.0, 4.0]])


@pytest.mark.parametrize("method", GENERAL)
def test_verged_by_hand(method: str) -> None:
    # axes that meet at a right angle, 1 m from either camera
    rig = StereoRig.verged(Intrinsics(640, 480, 500.0, 400.0, 300.0, 250.0), math.sqrt(2), 90.0)
    # the point (0.2, 0.1, 1.1) of the left camera: the right one sees it at x = 1.1 - 1, z = 1 - 0.2
    uv_left = [[500 * 0.2 / 1.1 + 300, 400 * 0.1 / 1.1 + 250]]
    uv_right = [[500 * 0.1 / 0.8 + 300, 400 * 0.1 / 0.8 + 250]]
    close(triangulate(rig, uv_left, uv_right, method), [[0.2, 0.1, 1.1]])


def test_skew_rays_by_hand() -> None:
    # v differs by 2 px: everyone but `rectified` and `optimal` may choose, these take the mean
    rig = StereoRig.rectified(Intrinsics.from_focal(640, 480, 500.0, cx=0.0, cy=0.0), 0.1)
    for method in ("rectified", "optimal"):
        close(triangulate(rig, [[10.0, 1.0]], [[0.0, 3.0]], method), [[0.1, 0.02, 5.0]])


@pytest.mark.parametrize("method", GENERAL)
@given(rigs(distorted=True), st.integers(0, 2**32 - 1))
def test_exact_pixels_return_the_point(method: str, rig: StereoRig, seed: int) -> None:
    points = points_in_view(rig, 20, 1.0, 8.0, seed)
    close(triangulate(rig, *rig.project(points), method), points, atol=1e-8)


@given(rectified_rigs(), st.integers(0, 2**32 - 1))
def test_exact_pixels_return_the_point_when_rectified(rig: StereoRig, seed: int) -> None:
    points = points_in_view(rig, 20, 1.0, 8.0, seed)
    for method in METHODS:
        close(triangulate(rig, *rig.project(points), method), points, atol=1e-9)


def pixels(rig: StereoRig, points: Array) -> Array:
    """The projection written once more, in complex numbers so that it can be differentiated exactly."""
    columns = []
    for camera, pose in ((rig.left, Pose()), (rig.right, rig.right_from_left)):
        P = np.einsum("ij,nj->ni", pose.R, points) + pose.t
        x, y = P[:, 0] / P[:, 2], P[:, 1] / P[:, 2]
        if camera.lens is not None:
            lens, r2 = camera.lens, x * x + y * y
            radial = 1 + lens.k1 * r2 + lens.k2 * r2**2 + lens.k3 * r2**3
            x, y = (
                x * radial + 2 * lens.p1 * x * y + lens.p2 * (r2 + 2 * x * x),
                y * radial + 2 * lens.p2 * x * y + lens.p1 * (r2 + 2 * y * y),
            )
        columns += [camera.fx * x + camera.cx, camera.fy * y + camera.cy]
    return np.stack(columns, axis=1)


def maximum_likelihood(rig: StereoRig, start: Array, uv_left: Array, uv_right: Array) -> Array:
    """Gauss-Newton with complex-step derivatives, from the truth, until it stands still."""
    X, observed = start.copy(), np.hstack([uv_left, uv_right])
    for _ in range(100):
        residual = observed - pixels(rig, X)
        J = np.stack([pixels(rig, X + 1e-30j * axis).imag / 1e-30 for axis in np.eye(3)], axis=2)
        step = np.linalg.solve(
            np.einsum("nij,nik->njk", J, J), np.einsum("nij,ni->nj", J, residual)[..., None]
        )
        X += step[..., 0]
        if np.abs(step).max() < 1e-12:
            return X
    raise AssertionError(f"no rest after 100 steps: {np.abs(step).max()} m")


@pytest.mark.parametrize("kind", RIGS)
def test_optimal_is_maximum_likelihood(kind: str) -> None:
    rig = RIGS[kind]
    points = points_in_view(rig, 6000, 1.0, 6.0)
    points = points[parallax_px(rig, points) > 6.0]  # 8 sigma_d
    uv_left, uv_right = noisy(rig, points, 0.5)
    found = triangulate(rig, uv_left, uv_right, "optimal")
    assert np.isfinite(found).all()
    close(found, maximum_likelihood(rig, points, uv_left, uv_right), rtol=0, atol=1e-9)


def test_optimal_minimises_pixels_not_angles() -> None:
    # unequal lenses and pixels: a triangulator in normalised coordinates weighs the cameras wrongly
    rig = RIGS["unequal"]
    points = points_in_view(rig, 2000, 1.0, 6.0)
    uv_left, uv_right = noisy(rig, points, 0.5)
    unit = Intrinsics(1, 1, 1.0, 1.0, 0.0, 0.0)
    angular = triangulate(
        StereoRig(unit, unit, rig.right_from_left), rig.left.normalize(uv_left), rig.right.normalize(uv_right)
    )

    def cost(X: Array) -> Array:
        return ((np.hstack([uv_left, uv_right]) - np.hstack(rig.project(X))) ** 2).sum(axis=1)

    optimal = triangulate(rig, uv_left, uv_right)
    assert (cost(optimal) <= cost(angular) + 1e-12).all()
    assert cost(angular).sum() > 1.001 * cost(optimal).sum()


@pytest.mark.parametrize("kind", RIGS)
def test_optimal_is_efficient(kind: str) -> None:
    rig, sigma_px = RIGS[kind], 0.1
    points = points_in_view(rig, 120_000, 1.0, 5.0)
    points = points[parallax_px(rig, points) > math.sqrt(2) * sigma_px / 0.03]
    error = triangulate(rig, *noisy(rig, points, sigma_px)) - points
    weighted = np.linalg.solve(predict_covariance(rig, points, PixelNoise(sigma_px)), error[..., None])[
        ..., 0
    ]
    nees = np.einsum("ni,ni->n", error, weighted)
    assert len(points) > 40_000
    close(math.sqrt(nees.mean() / 3), 1.0, rtol=0.005)


def test_dlt_is_the_one_of_opencv() -> None:
    for kind in ("rectified", "verged", "forward", "unequal"):
        rig = RIGS[kind]
        uv_left, uv_right = noisy(rig, points_in_view(rig, 300, 1.0, 4.0), 0.3)
        P_left = rig.left.K @ np.eye(3, 4)
        P_right = rig.right.K @ np.column_stack([rig.right_from_left.R, rig.right_from_left.t])
        X = cv2.triangulatePoints(P_left, P_right, uv_left.T, uv_right.T)
        close(triangulate(rig, uv_left, uv_right, "dlt"), (X[:3] / X[3]).T, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("kind", RIGS)
def test_midpoint_is_nearest_to_both_rays(kind: str) -> None:
    rig = RIGS[kind]
    uv_left, uv_right = noisy(rig, points_in_view(rig, 50, 1.0, 4.0), 0.5)
    found = triangulate(rig, uv_left, uv_right, "midpoint")

    def distances(X: Array) -> Array:
        total = np.zeros(len(X))
        for camera, uv, P in (
            (rig.left, uv_left, X),
            (rig.right, uv_right, rig.right_from_left.apply(X)),
        ):
            ray = np.column_stack([camera.normalize(uv), np.ones(len(uv))])
            ray /= np.linalg.norm(ray, axis=1, keepdims=True)
            total += (np.cross(ray, P) ** 2).sum(axis=1)
        return total

    for step in 1e-4 * np.vstack([np.eye(3), -np.eye(3)]):
        assert (distances(found + step) > distances(found)).all()


BAD = [math.nan, math.inf, -math.inf]


@pytest.mark.parametrize(
    ("kind", "method"), [("rectified", "rectified"), *((kind, method) for kind in RIGS for method in GENERAL)]
)
def test_bad_points_are_nan_and_leave_the_others_alone(kind: str, method: str) -> None:
    rig = RIGS[kind]
    points = points_in_view(rig, 40, 1.0, 4.0)
    uv_left, uv_right = rig.project(points)
    for row, (side, column, value) in enumerate((s, c, v) for s in (0, 1) for c in (0, 1) for v in BAD):
        (uv_left, uv_right)[side][row, column] = value
    uv_left[12:14], uv_right[12:14] = [[math.inf, 0], [0, math.inf]], [[math.inf, 0], [0, -math.inf]]
    found = triangulate(rig, uv_left, uv_right, method)
    assert np.isnan(found[:14]).all()
    close(found[14:], points[14:], atol=1e-8)
    assert np.isnan(triangulate(rig, uv_left[:14], uv_right[:14], method)).all()
    assert triangulate(rig, np.empty((0, 2)), np.empty((0, 2)), method).shape == (0, 3)


@pytest.mark.parametrize("method", METHODS)
def test_no_disparity_and_swapped_images_are_nan(method: str) -> None:
    rig = StereoRig.rectified(PLAIN, 0.1)
    uv = np.array([[700.0, 500.0], [710.0, 500.0]])
    assert np.isnan(triangulate(rig, uv, uv, method)).all()
    assert np.isnan(triangulate(rig, uv, uv + 10 * RIGHT, method)).all()


@pytest.mark.parametrize("method", GENERAL)
def test_a_point_behind_the_right_camera_alone_is_nan(method: str) -> None:
    rig = RIGS["forward"]
    behind = np.array([[0.02, 0.01, 0.2]])
    uv_left, _ = rig.project(behind)
    # the line through the right camera's centre meets its image plane all the same
    P = rig.right_from_left.apply(behind)
    uv_right = P[:, :2] / P[:, 2:] * (800.0, 800.0) + (PLAIN.cx, PLAIN.cy)
    assert np.isnan(triangulate(rig, uv_left, uv_right, method)).all()


@pytest.mark.parametrize("kind", RIGS)
def test_blocks_do_not_show(kind: str) -> None:
    rig = RIGS[kind]
    points = np.tile(points_in_view(rig, 997, 1.0, 4.0), (53, 1))  # more than one block of any method
    uv_left, uv_right = noisy(rig, points, 0.3)
    uv_left[-1] = math.nan
    whole = triangulate(rig, uv_left, uv_right)
    ends = np.r_[0:5, 12280:12300, 49140:49160, -5:0]
    close(whole[ends], triangulate(rig, uv_left[ends], uv_right[ends]), rtol=1e-9)
    assert np.isnan(whole[-1]).all()


def test_the_inputs_may_be_lists_integers_or_views() -> None:
    rig = StereoRig.rectified(PLAIN, 0.1)
    expected = triangulate(rig, [[700.0, 500.0]], [[690.0, 500.0]])
    close(expected[:, 2], [8.0])
    for kind in (np.int64, np.float32):
        close(triangulate(rig, np.array([[700, 500]], kind), np.array([[690, 500]], kind)), expected)
    close(triangulate(rig, np.array([[700.0], [500.0]]).T, np.array([[690.0], [500.0]]).T), expected)


# --- broken on purpose ---------------------------------------------------------------------------

Broken = Callable[[StereoRig, Array, Array], Array]
BROKEN: dict[str, Broken] = {
    "swapped cameras": lambda rig, left, right: triangulate(
        StereoRig(rig.right, rig.left, rig.right_from_left.inverse), right, left
    ),
    "half a pixel to the right": lambda rig, left, right: triangulate(rig, left + RIGHT, right + RIGHT),
    "half a pixel down": lambda rig, left, right: triangulate(rig, left + DOWN, right + DOWN),
    "mm for m": lambda rig, left, right: 1e3 * triangulate(rig, left, right),
    "doffs ignored": lambda rig, left, right: triangulate(
        replace(rig, right=replace(rig.right, cx=rig.left.cx)), left, right
    ),
    "y flipped": lambda rig, left, right: triangulate(rig, left, right) * (1, -1, 1),
    "sign of the principal point": lambda rig, left, right: triangulate(
        replace(rig, left=mirrored(rig.left), right=mirrored(rig.right)), left, right
    ),
    "inverse pose": lambda rig, left, right: triangulate(
        replace(rig, right_from_left=rig.right_from_left.inverse), left, right
    ),
    "fx for fy": lambda rig, left, right: triangulate(
        replace(rig, left=replace(rig.left, fy=rig.left.fx), right=replace(rig.right, fy=rig.right.fx)),
        left,
        right,
    ),
}


def mirrored(camera: Intrinsics) -> Intrinsics:
    """The principal point on the wrong side of the image's middle."""
    return replace(camera, cx=camera.width - 1 - camera.cx, cy=camera.height - 1 - camera.cy)


def worst_error_m(kind: str, triangulator: Broken) -> float:
    """Largest error on exact pixels of a rig; infinite when a point is lost."""
    rig = RIGS[kind]
    points = points_in_view(rig, 100, 1.0, 3.0)
    found = triangulator(rig, *rig.project(points))
    return float(np.nan_to_num(np.abs(found - points), nan=math.inf).max())


@pytest.mark.parametrize("kind", ["rectified", "unequal"])
@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_triangulator_is_caught(name: str, kind: str) -> None:
    assert worst_error_m(kind, triangulate) < 1e-9
    assert worst_error_m(kind, BROKEN[name]) > 1e-4


# --- a user's own ------------------------------------------------------------------------------


def halfway(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    """A user's triangulator that cannot do the first point."""
    found = triangulate(rig, uv_left, uv_right, "midpoint")
    found[0] = math.nan
    uv_left[:] = 0.0
    return found


def test_a_callable_fills_the_slot() -> None:
    rig = RIGS["verged"]
    points = points_in_view(rig, 5, 1.0, 2.0)
    uv_left, uv_right = rig.project(points)
    for method in (halfway, f"{__name__}:halfway", resolve(halfway)):
        found = triangulate(rig, uv_left, uv_right, method)
        assert np.isnan(found[0]).all()
        close(found[1:], points[1:])
    close(uv_left, rig.project(points)[0])  # its scribbles stayed its own


def test_infinities_of_a_callable_become_nan_rows() -> None:
    found = triangulate(
        RIGS["verged"], np.zeros((2, 2)), np.zeros((2, 2)), lambda *_: [[1, 2, math.inf], [1, 2, 3]]
    )
    assert np.isnan(found[0]).all()
    close(found[1], [1.0, 2.0, 3.0])


def test_names_resolve_to_the_built_in_methods() -> None:
    for name, method in METHODS.items():
        assert resolve(name) is method
        assert resolve(method) is method


def raises(*_: object) -> Array:
    raise RuntimeError("no luck\nwith two lines")


def test_a_module_of_the_working_folder_is_found(tmp_path, monkeypatch) -> None:
    (tmp_path / "own_triangulator.py").write_text(
        "import numpy as np\n\n\nclass Mine:\n    @staticmethod\n"
        "    def go(rig, left, right):\n        return np.full((len(left), 3), 7.0)\n"
    )
    (tmp_path / "broken_triangulator.py").write_text("1 / 0\n")
    monkeypatch.chdir(tmp_path)
    close(triangulate(RIGS["verged"], [[0, 0]], [[0, 0]], "own_triangulator:Mine.go"), [[7.0, 7.0, 7.0]])
    with pytest.raises(TriangulatorError, match=r"cannot import broken_triangulator \(ZeroDivisionError"):
        resolve("broken_triangulator:f")


@pytest.mark.parametrize(
    ("method", "says"),
    [
        (
            "best",
            "unknown triangulator 'best': choose one of optimal, rectified, dlt, midpoint, or package.mod",
        ),
        (
            "nowhere.at_all:f",
            r"cannot import nowhere.at_all \(ModuleNotFoundError: No module named 'nowhere'\)",
        ),
        ("math:nope", "'math:nope': AttributeError: module 'math' has no attribute 'nope'"),
        ("math:pi", "pi is a float, not a function"),
        (":f", "must be written package.module:function"),
        (3, "triangulator 3: must be a name or a function"),
        (raises, "triangulator 'raises' raised RuntimeError: no luck$"),
        (lambda *_: np.zeros((2, 4)), r"returned shape \(2, 4\): must be \(2, 3\)"),
        (lambda *_: np.zeros((3, 2)), r"returned shape \(3, 2\): must be \(2, 3\)"),
        (lambda *_: None, r"returned shape \(\): must be"),
        (lambda *_: np.zeros((2, 3), complex), "returned type complex128: must be real"),
        (lambda *_: [["a", "b", "c"]] * 2, "returned type <U1: must be real"),
        ("rectified", "the rig is not rectified .*: use 'optimal'"),
    ],
)
def test_a_triangulator_that_does_not_do_is_named_in_one_line(method, says: str) -> None:
    with pytest.raises(TriangulatorError, match=says) as caught:
        triangulate(RIGS["verged"], np.zeros((2, 2)), np.zeros((2, 2)), method)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("left", "right", "says"),
    [
        (np.zeros((2, 3)), np.zeros((2, 2)), r"left pixels of shape \(2, 3\): must be \(N, 2\)"),
        (np.zeros((2, 2)), np.zeros(2), r"right pixels of shape \(2,\): must be \(N, 2\)"),
        (np.zeros((2, 2)), np.zeros((3, 2)), "2 left and 3 right pixels: must be as many"),
        ([["a", "b"]], np.zeros((1, 2)), "left pixels: must be numbers"),
        ([[1, 2], [3]], np.zeros((2, 2)), "left pixels: must be numbers"),
    ],
)
def test_pixels_of_the_wrong_shape_are_named(left, right, says: str) -> None:
    for method in (*METHODS, halfway):
        with pytest.raises(TriangulatorError, match=says):
            triangulate(RIGS["rectified"], left, right, method)
