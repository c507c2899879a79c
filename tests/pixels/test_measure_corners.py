"""Corners: the model against exact pictures, the fit against its bound, boards against homographies."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import map_coordinates

from benchmarks.subjects.checker_images import (
    blurred_saddle,
    board_corners,
    board_homography,
    board_image,
    cramer_rao_px,
    saddle_windows,
)
from benchmarks.subjects.corners import find_board, find_boards, refine_corners
from rigsim.errors import InvalidImage, MeasurementFailed
from rigsim.pixels.corners import saddle
from rigsim.pixels.corners.boards import canonical, find_sizes, turns
from rigsim.pixels.corners.lattice import fill, find_grids
from rigsim.pixels.corners.pairing import BoardMatches, match_boards, match_sizes, pair_boards
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig
from rigsim.sim.exposure import digitise

ROWS, COLS = 4, 5


def random_saddles(
    n: int, seed: int, opening_deg: tuple[float, float] = (60, 120)
) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    first = rng.uniform(0, np.pi, n)
    angles = np.stack([first, first + np.radians(rng.uniform(*opening_deg, n))], axis=1)
    return rng.uniform(-0.5, 0.5, (n, 2)), angles


def root_half_nees(error: np.ndarray, cov: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.einsum("ni,nij,nj->n", error, np.linalg.inv(cov), error)) / 2))


def mosaic(windows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Windows (N, S, S) side by side in one picture, and their middles (N, 2)."""
    n, size = windows.shape[:2]
    middles = np.stack([np.arange(n) * size + size // 2, np.full(n, size // 2)], axis=1).astype(float)
    return np.concatenate(list(windows), axis=1), middles


class TestModel:
    def test_a_sharp_upright_corner_by_hand(self) -> None:
        # edges at x = 0.2 and y = -0.3: the middle pixel is (0.3 - 0.7) bright-minus-dark across and
        # (0.8 - 0.2) down, hence 100 + 50 * (-0.4 * 0.6) = 88
        parameters = np.array([[100.0, 50.0, 0.2, -0.3, 0.0, np.pi / 2, 1e-6]])
        x, y = saddle.pixel_grid(3)
        assert saddle.model(parameters, x, y)[0, 4] == pytest.approx(88.0, abs=0.1)

    @pytest.mark.parametrize("blur", [0.3, 0.5, 1.0])
    def test_it_is_the_mean_over_the_pixel_of_the_exact_blurred_corner(self, blur: float) -> None:
        centers, angles = random_saddles(12, 3)
        exact = saddle_windows(centers, angles, blur=blur, offset=0.0, contrast=1.0)
        parameters = np.column_stack([np.zeros(12), np.ones(12), centers, angles, np.full(12, blur**2)])
        x, y = saddle.pixel_grid(11)
        error = np.abs(saddle.model(parameters, x, y).reshape(exact.shape) - exact)
        assert error.max() < {0.3: 0.02, 0.5: 0.004, 1.0: 0.0006}[blur]

    def test_the_exact_picture_is_itself_right_where_it_is_known(self) -> None:
        # upright edges separate into error functions: 2 Phi(1) - 1 = 0.6827, squared 0.4661
        assert blurred_saddle(np.array(1.0), np.array(1.0), 0.0, np.pi / 2, 1.0) == pytest.approx(
            0.46607, abs=1e-5
        )
        # at the corner itself, the quadrants' shares for rho = 1/2: 4 (1/4 + asin(1/2) / 2 pi) - 1 = 1/3
        assert blurred_saddle(np.array(0.0), np.array(0.0), 0.0, np.pi / 3, 1.0) == pytest.approx(
            1 / 3, abs=1e-9
        )


class TestFit:
    @pytest.mark.parametrize(
        ("blur", "bound_px"), [(0.15, 0.002), (0.3, 0.001), (0.5, 0.0003), (1.0, 0.0002)]
    )
    def test_without_noise_the_place_is_exact(self, blur: float, bound_px: float) -> None:
        centers, angles = random_saddles(25, 1)
        windows = saddle_windows(centers, angles, blur=blur)
        fit = saddle.fit(windows, np.ones_like(windows))
        assert fit.converged.all()
        error = fit.parameters[:, saddle.U : saddle.V + 1] - centers
        assert np.sqrt(np.mean(error**2)) < bound_px

    @pytest.mark.parametrize("blur", [0.5, 1.0])
    @pytest.mark.parametrize("noise", [1.0, 3.0])
    def test_with_noise_it_reaches_the_cramer_rao_bound_and_says_so(self, blur: float, noise: float) -> None:
        repeats, rng = 40, np.random.default_rng(7)
        centers, angles = random_saddles(30, 2)
        clean = saddle_windows(centers, angles, blur=blur, nodes=6)
        grey_var = noise**2 + 1 / 12
        bound = np.array(
            [
                cramer_rao_px(c, a, grey_var**0.5, blur=blur, nodes=6)
                for c, a in zip(centers, angles, strict=True)
            ]
        )
        windows = np.repeat(clean, repeats, axis=0)
        windows = np.rint(windows + noise * rng.standard_normal(windows.shape))
        picture, middles = mosaic(windows)
        found = refine_corners(picture.astype(np.uint8), middles)
        assert found.valid.all()
        error = found.uv - middles - np.repeat(centers, repeats, axis=0)
        assert np.sqrt(np.mean(error**2)) < 1.06 * np.sqrt(np.mean(bound**2))
        assert root_half_nees(error, found.cov) == pytest.approx(1.0, abs=0.05)
        assert np.median(found.grey_std) == pytest.approx(grey_var**0.5, rel=0.03)
        assert np.median(found.blur) == pytest.approx(blur, rel=0.03)

    def test_the_covariance_holds_for_photon_noise(self) -> None:
        # a small well: 4 to 7 grey levels of noise, more in the bright squares
        rng = np.random.default_rng(4)
        centers, angles = random_saddles(20, 8)
        clean = saddle_windows(centers, angles, blur=0.6, offset=125, contrast=65, nodes=6) / 255
        frames = digitise(
            np.concatenate(list(clean), axis=1), Sensor(full_well_e=900, read_noise_e=3), rng, frames=40
        )
        middles = mosaic(clean)[1]
        errors, covs = [], []
        for frame in frames:
            found = refine_corners(frame, middles)
            errors.append((found.uv - middles - centers)[found.valid])
            covs.append(found.cov[found.valid])
        assert len(np.concatenate(errors)) > 0.99 * 800
        assert root_half_nees(np.concatenate(errors), np.concatenate(covs)) == pytest.approx(1.0, abs=0.08)

    def test_the_covariance_holds_after_interpolation_which_hides_noise(self) -> None:
        rng = np.random.default_rng(5)
        centers, angles = random_saddles(60, 9)
        clean, middles = mosaic(saddle_windows(centers, angles, blur=0.8, half=8, nodes=6))
        v, u = np.mgrid[0 : clean.shape[0], 0 : clean.shape[1]]
        errors, covs = [], []
        for _ in range(12):
            noisy = clean + 2 * rng.standard_normal(clean.shape)
            moved = map_coordinates(noisy, (v + 0.4, u + 0.45), order=1, mode="nearest")
            found = refine_corners(moved, middles)
            errors.append((found.uv - middles - centers + (0.45, 0.4))[found.valid])
            covs.append(found.cov[found.valid])
        assert root_half_nees(np.concatenate(errors), np.concatenate(covs)) == pytest.approx(1.0, abs=0.12)

    @settings(max_examples=20, deadline=None)
    @given(
        shift=st.tuples(st.integers(-1, 1), st.integers(-1, 1)),
        gain=st.floats(0.3, 3.0),
        negative=st.booleans(),
        seed=st.integers(0, 10**6),
    )
    def test_the_place_moves_with_the_picture_and_not_with_its_brightness(
        self, shift: tuple[int, int], gain: float, negative: bool, seed: int
    ) -> None:
        centers, angles = random_saddles(1, seed)
        picture = saddle_windows(centers, angles, half=9, blur=0.6, nodes=4)[0]
        changed = np.roll(picture, (shift[1], shift[0]), axis=(0, 1))
        changed = 300.0 - gain * changed if negative else 5.0 + gain * changed
        here = refine_corners(picture, [[9.0, 9.0]])
        there = refine_corners(changed, [[9.0 + shift[0], 9.0 + shift[1]]])
        assert here.valid.all()
        assert there.valid.all()
        np.testing.assert_allclose(there.uv - here.uv, [shift], atol=2e-4)

    def test_u_is_x_and_v_is_y(self) -> None:
        centers, angles = np.array([[0.3, -0.2]]), np.array([[0.2, 1.7]])
        picture = saddle_windows(centers, angles, half=7)[0]
        upright = refine_corners(picture, [[7.0, 7.0]]).uv[0]
        mirrored = refine_corners(picture.T, [[7.0, 7.0]]).uv[0]
        np.testing.assert_allclose(upright, [7.3, 6.8], atol=1e-3)
        np.testing.assert_allclose(mirrored, [6.8, 7.3], atol=1e-3)

    def test_what_is_no_corner_is_not_valid_and_disturbs_no_other(self) -> None:
        rng = np.random.default_rng(0)
        centers, angles = random_saddles(4, 6)
        windows = saddle_windows(centers, angles, half=8)
        windows[1] = 128 + rng.standard_normal(windows[1].shape)  # flat
        windows[2] = np.where(np.arange(17) < 8, 60.0, 190.0)  # one edge only
        windows[2] += rng.standard_normal(windows[2].shape)
        picture, middles = mosaic(windows)
        starts = np.concatenate([middles, [[np.nan, 3.0], [-40.0, 5.0]]])
        found = refine_corners(picture, starts)
        assert found.valid.tolist() == [True, False, False, True, False, False]
        assert np.isnan(found.uv[~found.valid]).all()
        assert np.isnan(found.cov[~found.valid]).all()
        alone = refine_corners(mosaic(windows[:1])[0], middles[:1])
        np.testing.assert_allclose(found.uv[0], alone.uv[0], atol=1e-9)

    def test_a_start_a_pixel_off_ends_at_the_same_place(self) -> None:
        centers, angles = random_saddles(30, 11)
        picture, middles = mosaic(saddle_windows(centers, angles, half=9, nodes=6))
        rng = np.random.default_rng(3)
        off = refine_corners(picture, middles + rng.uniform(-1, 1, middles.shape))
        assert off.valid.all()
        np.testing.assert_allclose(off.uv, middles + centers, atol=1e-3)

    def test_no_corners_are_no_error(self) -> None:
        assert refine_corners(np.eye(9), np.zeros((0, 2))).uv.shape == (0, 2)


class Scene:
    """Planar boards seen by a rig: exact homographies, hence exact pictures and corners."""

    def __init__(
        self, rig: StereoRig, boards: list[tuple[tuple[float, float, float], tuple[float, float, float]]]
    ) -> None:
        self.rig = rig
        self.square_m = 0.05
        self.board_poses = [Pose.from_rotvec(rotation, place) for place, rotation in boards]

    def points_left(self) -> np.ndarray:
        row, col = np.mgrid[0:ROWS, 0:COLS]
        board = self.square_m * np.stack(
            [col - (COLS - 1) / 2, row - (ROWS - 1) / 2, np.zeros_like(row)], axis=-1
        ).reshape(-1, 3)
        return np.stack([pose.apply(board) for pose in self.board_poses])

    def picture(
        self, side: str, noise: float = 0.0, seed: int = 0, *, keep: tuple[int, ...] = (0, 1, 2)
    ) -> np.ndarray:
        camera = self.rig.left if side == "left" else self.rig.right
        from_left = Pose() if side == "left" else self.rig.right_from_left
        boards = []
        for i, pose in enumerate(self.board_poses):
            if i in keep:
                seen = from_left @ pose
                plane = np.column_stack([seen.R[:, 0] * self.square_m, seen.R[:, 1] * self.square_m, seen.t])
                boards.append((camera.K @ plane, ROWS, COLS))
        clean = board_image(boards, (camera.height, camera.width), blur=0.5, supersample=4)
        noisy = clean + noise * np.random.default_rng(seed + (side == "right")).standard_normal(clean.shape)
        return np.clip(np.rint(noisy), 0, 255).astype(np.uint8)


CAMERA = Intrinsics(400, 240, 300.0, 302.0, 197.3, 121.4)
BOARDS = [
    ((-0.42, -0.12, 1.15), (0.2, 0.3, 0.1)),
    ((0.02, 0.10, 0.95), (-0.2, -0.3, -0.2)),
    ((0.55, -0.08, 1.25), (0.0, 0.0, 0.0)),
]


@pytest.fixture(scope="module")
def scene() -> Scene:
    return Scene(StereoRig.rectified(CAMERA, 0.06), BOARDS)


@pytest.fixture(scope="module")
def pair(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    return scene.picture("left", noise=1.0), scene.picture("right", noise=1.0)


def worst_sigma(matches: BoardMatches, scene: Scene) -> float:
    """RMS over all boards of the positions' error against the projected truth, in predicted std."""
    truth = [scene.rig.project(points) for points in scene.points_left()]
    order = np.argsort([np.mean(uv[:, 0]) for uv, _ in truth])
    worst = []
    for side in (0, 1):
        exact = np.concatenate([truth[i][side] for i in order])
        uv = (matches.observations.uv_left, matches.observations.uv_right)[side]
        cov = (matches.cov_left, matches.cov_right)[side]
        good = matches.observations.valid
        if len(uv) != len(exact):
            return np.inf
        worst.append(root_half_nees((uv - exact)[good], cov[good]))
    return max(worst)


class TestBoards:
    def test_corners_of_a_pair_are_where_the_rig_projects_them(
        self, scene: Scene, pair: tuple[np.ndarray, np.ndarray]
    ) -> None:
        matches = match_boards(*pair, ROWS, COLS, rig=scene.rig)
        assert matches.observations.valid.sum() == 3 * ROWS * COLS
        assert worst_sigma(matches, scene) == pytest.approx(1.0, abs=0.2)
        assert matches.epipolar_rms_px < 0.01
        assert matches.board.tolist() == [i for i in range(3) for _ in range(ROWS * COLS)]
        assert matches.corner.tolist() == list(range(ROWS * COLS)) * 3

    def test_broken_detectors_are_caught(self, scene: Scene, pair: tuple[np.ndarray, np.ndarray]) -> None:
        matches = match_boards(*pair, ROWS, COLS, rig=scene.rig)
        good = matches.observations
        half_pixel = replace(
            matches, observations=replace(good, uv_left=good.uv_left + 0.5, uv_right=good.uv_right + 0.5)
        )
        swapped = replace(matches, observations=replace(good, uv_left=good.uv_right, uv_right=good.uv_left))
        order = np.arange(ROWS * COLS).reshape(ROWS, COLS)[:, ::-1].ravel()
        wrong = np.concatenate([order + i * ROWS * COLS for i in range(3)])
        mirrored = replace(matches, observations=replace(good, uv_right=good.uv_right[wrong]))
        turned = replace(
            matches,
            observations=replace(
                good, uv_left=good.uv_left[::-1].copy(), uv_right=good.uv_right[::-1].copy()
            ),
        )
        assert worst_sigma(matches, scene) < 1.3
        for broken in (half_pixel, swapped, mirrored, turned):
            assert worst_sigma(broken, scene) > 20

    def test_swapped_pictures_are_refused(self, scene: Scene, pair: tuple[np.ndarray, np.ndarray]) -> None:
        with pytest.raises(MeasurementFailed, match=r"behind the cameras.*swapped"):
            match_boards(pair[1][:, :270], pair[0][:, :270], ROWS, COLS)

    def test_pictures_of_another_rig_are_refused(
        self, scene: Scene, pair: tuple[np.ndarray, np.ndarray]
    ) -> None:
        tilted = StereoRig(
            scene.rig.left, scene.rig.right, Pose.from_rotvec((0.08, 0.0, 0.0), scene.rig.right_from_left.t)
        )
        with pytest.raises(MeasurementFailed, match="px off its epipolar lines"):
            match_boards(*pair, ROWS, COLS, rig=tilted)

    def test_a_board_hidden_from_one_camera_is_left_out(
        self, scene: Scene, pair: tuple[np.ndarray, np.ndarray]
    ) -> None:
        right = scene.picture("right", keep=(1, 2))
        matches = match_boards(pair[0], right, ROWS, COLS, rig=scene.rig)
        exact = np.concatenate([scene.rig.project(points)[0] for points in scene.points_left()[1:]])
        assert len(matches.observations.uv_left) == 2 * ROWS * COLS
        np.testing.assert_allclose(matches.observations.uv_left, exact, atol=0.03)

    def test_without_a_rig_rows_correspond(self, scene: Scene, pair: tuple[np.ndarray, np.ndarray]) -> None:
        with_rig = match_boards(*pair, ROWS, COLS, rig=scene.rig)
        without = match_boards(*pair, ROWS, COLS)
        np.testing.assert_array_equal(with_rig.observations.uv_right, without.observations.uv_right)

    def test_verged_and_rolled_cameras_keep_the_order(self) -> None:
        # the right camera is rolled by 100 deg: its picture alone would number the corners another way
        rig = StereoRig(CAMERA, CAMERA, Pose.from_rotvec((0.0, 0.0, 1.75), (0.0, 0.06, 0.0)))
        scene = Scene(rig, [((0.03, 0.02, 1.2), (0.1, -0.2, 0.15))])
        matches = match_boards(scene.picture("left"), scene.picture("right"), ROWS, COLS, rig=rig)
        uv_left, uv_right = rig.project(scene.points_left()[0])
        np.testing.assert_allclose(matches.observations.uv_left, uv_left, atol=0.01)
        np.testing.assert_allclose(matches.observations.uv_right, uv_right, atol=0.01)

    def test_rows_run_down_and_columns_right(self) -> None:
        for roll in (-0.6, 0.0, 0.6, 2.5):
            homography = board_homography((110.0, 90.0), 22.0, roll=roll, tilt=0.02)
            image = board_image([(homography, ROWS, COLS)], (180, 220), supersample=4)
            board = find_board(image, ROWS, COLS)
            exact = board_corners(homography, ROWS, COLS)
            if np.cos(roll) < 0:
                exact = exact[::-1]
            np.testing.assert_allclose(board.uv, exact, atol=0.02)
            grid = board.uv.reshape(ROWS, COLS, 2)
            assert (grid[:, -1] - grid[:, 0])[:, 0].min() > 0

    def test_polarity_tells_the_two_ends_of_an_odd_board_apart(self) -> None:
        homography = board_homography((110.0, 90.0), 22.0, roll=0.1, tilt=0.0)
        image = board_image([(homography, ROWS, COLS)], (180, 220), supersample=4)
        assert find_board(image, ROWS, COLS).polarity == -find_board(image[::-1, ::-1], ROWS, COLS).polarity
        assert find_board(image, ROWS, COLS).polarity == -find_board(250.0 - image, ROWS, COLS).polarity

    def test_canonical_order_does_not_depend_on_the_order_given(self) -> None:
        for rows, cols in ((3, 4), (4, 4)):
            grid = board_corners(board_homography((50, 50), 10, roll=0.3, tilt=0.0), rows, cols).reshape(
                rows, cols, 2
            )
            for turn in turns(grid):
                np.testing.assert_array_equal(canonical(turn), grid)
                np.testing.assert_array_equal(canonical(turn[:, ::-1]), grid)

    def test_colour_16_bit_and_floats_give_the_same_corners(
        self, pair: tuple[np.ndarray, np.ndarray]
    ) -> None:
        grey = find_boards(pair[0], ROWS, COLS)
        for image in (
            np.repeat(pair[0][..., None], 3, axis=2),
            pair[0].astype(np.uint16) * 200,
            pair[0] / 255.0,
        ):
            for board, same in zip(grey, find_boards(image, ROWS, COLS), strict=True):
                np.testing.assert_allclose(same.uv, board.uv, atol=0.002)

    def test_something_in_front_of_a_corner_costs_that_corner_alone(self) -> None:
        homography = board_homography((110.0, 90.0), 22.0, roll=0.1, tilt=0.01)
        exact = board_corners(homography, 5, 7)
        image = board_image([(homography, 5, 7)], (180, 220), supersample=4)
        u, v = np.round(exact[[9, 24]]).astype(int).T
        image[v[0] - 3 : v[0] + 2, u[0] - 2 : u[0] + 9] = 90.0
        image[v[1] - 9 : v[1] + 9, u[1] + 1 : u[1] + 4] = 150.0
        board = find_board(image, 5, 7)
        assert np.flatnonzero(~board.valid).tolist() == [9, 24]
        np.testing.assert_allclose(board.uv[board.valid], exact[board.valid], atol=0.005)

    def test_boards_are_found_in_clutter_and_by_their_size(self) -> None:
        rng = np.random.default_rng(2)
        small = board_homography((90.0, 90.0), 17.0, roll=0.4, tilt=0.03)
        large = board_homography((270.0, 110.0), 20.0, roll=-0.3, tilt=-0.02)
        image = board_image([(small, 4, 6), (large, 5, 7)], (220, 370), supersample=4)
        # rectangles of every brightness, which have edges and corners of their own, and stripes
        outside = image == 125.0
        clutter = np.zeros_like(image)
        for _ in range(400):
            v, u, h, w = rng.integers((0, 0, 3, 3), (210, 360, 20, 20))
            clutter[v : v + h, u : u + w] = rng.uniform(20, 230)
        image = np.where(outside, clutter, image) + rng.standard_normal(image.shape)
        for homography, rows, cols in ((small, 4, 6), (large, 5, 7)):
            (board,) = find_boards(image, rows, cols)
            assert board.valid.mean() > 0.9
            np.testing.assert_allclose(
                board.uv[board.valid], board_corners(homography, rows, cols)[board.valid], atol=0.05
            )
        assert find_boards(image, 6, 7) == ()
        assert [(board.rows, board.cols) for board in find_sizes(image, [(5, 7), (4, 6)])] == [(4, 6), (5, 7)]

    def test_opencv_finds_what_is_too_blurred_for_single_corners(self) -> None:
        homography = board_homography((160.0, 120.0), 40.0, roll=0.1, tilt=0.0)
        image = board_image([(homography, 4, 5)], (240, 320), supersample=2, blur=4.0)
        assert find_grids(image) == []
        detected = find_boards(image, 4, 5)
        assert len(detected) == 1
        good = detected[0].valid
        assert good.mean() > 0.5
        np.testing.assert_allclose(detected[0].uv[good], board_corners(homography, 4, 5)[good], atol=0.01)

    def test_missing_corners_are_filled_as_perspective_has_them(self) -> None:
        grid = board_corners(board_homography((50, 50), 10, roll=0.3, tilt=0.05), 5, 6).reshape(5, 6, 2)
        holes = grid.copy()
        holes[[0, 2, 4], [0, 3, 5]] = np.nan
        np.testing.assert_allclose(fill(holes), grid, atol=1e-9)

    def test_several_sizes_at_once(self, scene: Scene, pair: tuple[np.ndarray, np.ndarray]) -> None:
        one = match_boards(*pair, ROWS, COLS, rig=scene.rig)
        many = match_sizes(*pair, [(6, 9), (ROWS, COLS)], rig=scene.rig)
        np.testing.assert_array_equal(one.observations.uv_left, many.observations.uv_left)
        assert many.sizes.tolist() == [[ROWS, COLS]] * 3

    def test_small_squares_and_strong_noise(self) -> None:
        homography = board_homography((60.0, 50.0), 8.0, roll=0.3, tilt=0.01)
        clean = board_image([(homography, ROWS, COLS)], (100, 120), supersample=6)
        noisy = clean + 8 * np.random.default_rng(0).standard_normal(clean.shape)
        board = find_board(np.clip(np.rint(noisy), 0, 255).astype(np.uint8), ROWS, COLS)
        error = (board.uv - board_corners(homography, ROWS, COLS))[board.valid]
        assert board.valid.mean() > 0.9
        assert root_half_nees(error, board.cov[board.valid]) == pytest.approx(1.0, abs=0.25)


class TestBadInput:
    def test_no_board_says_in_which_picture_and_what_was_looked_for(
        self, scene: Scene, pair: tuple[np.ndarray, np.ndarray]
    ) -> None:
        empty = np.random.default_rng(0).integers(90, 110, pair[0].shape).astype(np.uint8)
        with pytest.raises(MeasurementFailed, match=r"^right image: no checker board of 4 x 5 inner corners"):
            match_boards(pair[0], empty, ROWS, COLS)
        with pytest.raises(MeasurementFailed, match=r"^left image: no checker board of 4 x 5"):
            match_boards(empty, pair[1], ROWS, COLS)
        with pytest.raises(MeasurementFailed, match=r"^left image: no checker board of 6 x 9"):
            match_boards(pair[0], pair[1], 6, 9)

    @pytest.mark.parametrize(
        ("image", "message"),
        [
            (np.zeros((60, 80), np.uint8), "left image: all black"),
            (np.full((60, 80), 255, np.uint8), "100% of the pixels are saturated"),
            (np.full((60, 80), 40, np.uint8), "every pixel is 40"),
            (np.zeros((60, 80, 2), np.uint8), r"shape \(60, 80, 2\): must be \(height, width\)"),
            (np.zeros(60, np.uint8), r"shape \(60,\)"),
            (np.zeros((0, 4), np.uint8), r"shape \(0, 4\)"),
            (np.zeros((60, 80), np.int32), "type int32: must be 8 or 16 bit"),
            (np.where(np.eye(60) > 0, np.nan, 1.0), "60 pixels are not finite"),
        ],
    )
    def test_pictures_that_cannot_be_measured(self, image: np.ndarray, message: str) -> None:
        with pytest.raises(InvalidImage, match=message) as caught:
            match_boards(image, image, ROWS, COLS)
        assert "\n" not in str(caught.value)

    def test_sizes_must_agree(self, scene: Scene, pair: tuple[np.ndarray, np.ndarray]) -> None:
        with pytest.raises(InvalidImage, match="left and right image are 400 x 240 and 399 x 240 px"):
            match_boards(pair[0], pair[1][:, 1:], ROWS, COLS)
        with pytest.raises(InvalidImage, match="left image 399 x 240 px: the rig says 400 x 240"):
            match_boards(pair[0][:, 1:], pair[1][:, 1:], ROWS, COLS, rig=scene.rig)

    def test_boards_have_a_least_size(self, pair: tuple[np.ndarray, np.ndarray]) -> None:
        with pytest.raises(InvalidImage, match="board of 2 rows of inner corners: must be >= 3"):
            find_boards(pair[0], 2, 5)

    def test_without_opencv_the_line_that_installs_it(
        self, monkeypatch: pytest.MonkeyPatch, pair: tuple[np.ndarray, np.ndarray]
    ) -> None:
        monkeypatch.setitem(sys.modules, "cv2", None)
        assert find_board(pair[0], ROWS, COLS).valid.all()
        with pytest.raises(MeasurementFailed, match=r"pip install 'rigsim\[vision\]'"):
            find_boards(pair[0], 6, 9)


def test_distorted_corners_pair_with_a_distorted_rig(pair: tuple[np.ndarray, np.ndarray]) -> None:
    # the pairing undistorts what it compares: strong distortion, and still every board finds itself
    lens = replace(CAMERA, lens=BrownConrady(-0.2, 0.05))
    rig = StereoRig.rectified(lens, 0.06)
    boards = [find_boards(image, ROWS, COLS) for image in pair]
    distorted = [
        tuple(replace(board, uv=lens.denormalize(CAMERA.normalize(board.uv))) for board in side)
        for side in boards
    ]
    assert pair_boards(*distorted, rig=rig).epipolar_rms_px < 0.01
    assert pair_boards(*distorted, max_epipolar_px=5.0).epipolar_rms_px > 0.1
