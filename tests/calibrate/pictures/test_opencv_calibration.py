"""OpenCV's calibration of exact corners gives the rig back; what it cannot do is one line."""

from __future__ import annotations

import numpy as np
import pytest

from rigsim.errors import InvalidRange, MeasurementFailed
from rigsim.pixels.calibration.stereo import FoundRig, calibrate_stereo
from rigsim.rig.arrays import Array
from rigsim.rig.board import Board
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.mei import Mei
from rigsim.rig.lens.rational import Rational
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from tests.helpers.calibrate.board_pictures import boards_in_view

BOARD = Board(9, 6, 0.03)
SIZES = ((1280, 960), (1280, 960))
PRISM_AND_TILT = ("s1", "s2", "s3", "s4", "tau_x", "tau_y")


def some_rig(left: Lens | None, right: Lens | None, focal_px: float = 1000.0, cx: float = 645.0) -> StereoRig:
    return StereoRig(
        Intrinsics(1280, 960, focal_px, 1.001 * focal_px, cx, 470.0, left),
        Intrinsics(1280, 960, 1.01 * focal_px, 1.012 * focal_px, 630.0, 485.0, right),
        Pose.from_rotvec([0.01, 0.05, -0.02], [-0.12, 0.002, 0.003]),
    )


def pinhole_errors(found: StereoRig, true: StereoRig) -> Array:
    """Relative errors of focal lengths, principal points and baseline."""
    pairs = ((found.left, true.left), (found.right, true.right))
    names = ("fx", "fy", "cx", "cy")
    errors = [getattr(a, name) / getattr(b, name) - 1 for a, b in pairs for name in names]
    return np.array([*errors, found.baseline_m / true.baseline_m - 1])


@pytest.mark.parametrize(
    ("lenses", "focal_px", "fix"),
    [
        ((None, None), 1000.0, ()),
        ((BrownConrady(-0.2, 0.05, 1e-3, -5e-4, 0.01), BrownConrady(-0.21, 0.06, 5e-4, 5e-4)), 1000.0, ()),
        (
            (
                Rational(0.3, -0.1, 1e-3, -5e-4, 0.01, 0.5, 0.02, 5e-3),
                Rational(0.31, -0.1, 5e-4, 5e-4, 0.01, 0.5, 0.02, 5e-3),
            ),
            *(700.0, PRISM_AND_TILT),
        ),
        ((KannalaBrandt(0.05, -0.01, 2e-3, -1e-3), KannalaBrandt(0.04, -0.01, 2e-3)), 400.0, ()),
    ],
)
def test_exact_corners_give_the_rig_back(
    lenses: tuple[Lens | None, Lens | None], focal_px: float, fix: tuple[str, ...]
) -> None:
    rig = some_rig(*lenses, focal_px)
    poses = boards_in_view(rig, BOARD, 16)
    models = (None if lenses[0] is None else type(lenses[0]), None if lenses[1] is None else type(lenses[1]))
    found = calibrate_stereo(BOARD, poses.project(rig, BOARD), SIZES, models, fix)
    assert np.abs(pinhole_errors(found.rig, rig)).max() < 1e-6
    assert np.abs(found.rig.right_from_left.R - rig.right_from_left.R).max() < 1e-6
    assert np.abs(found.rig.right_from_left.t - rig.right_from_left.t).max() < 1e-6 * rig.baseline_m
    assert np.abs(found.left_from_board - poses.rows).max() < 1e-6
    assert found.rms_px < 1e-4
    # coefficients of a quotient may trade with one another: what they show counts
    uv = found.rig.left.project(poses.points_left(BOARD.points).reshape(-1, 3))
    assert np.abs(uv - poses.project(rig, BOARD)[:, 0].reshape(-1, 2)).max() < 1e-3


def test_boards_of_one_camera_and_half_hidden_ones_count() -> None:
    rig = some_rig(BrownConrady(-0.2, 0.05), BrownConrady(-0.21, 0.06))
    poses = boards_in_view(rig, BOARD, 12)
    observed = poses.project(rig, BOARD)
    observed[0, 1] = np.nan  # seen by the left camera alone
    observed[1, 0] = np.nan  # by the right one alone
    observed[2, 0, :20] = np.nan
    observed[3, 1, 40:] = np.nan
    observed[4] = np.nan
    found = calibrate_stereo(BOARD, observed, SIZES, (BrownConrady, BrownConrady))
    assert np.abs(pinhole_errors(found.rig, rig)).max() < 1e-6
    known = np.arange(12) != 4
    assert np.abs(found.left_from_board - poses.rows)[known].max() < 1e-6
    assert np.isnan(found.left_from_board[4]).all()


def test_what_is_held_stays() -> None:
    middle = Intrinsics.from_focal(1280, 960, 1000.0, lens=BrownConrady(-0.2, 0.05))
    rig = StereoRig(middle, middle, Pose.from_rotvec([0.0, 0.05, 0.0], [-0.12, 0.0, 0.0]))
    rng = np.random.default_rng(3)
    observed = boards_in_view(rig, BOARD, 10).project(rig, BOARD)
    noisy = observed + 0.2 * rng.standard_normal(observed.shape)
    lenses = (BrownConrady, BrownConrady)
    found = calibrate_stereo(BOARD, noisy, SIZES, lenses, ("aspect", "k3", "principal", "tangential")).rig
    for camera in (found.left, found.right):
        assert (camera.cx, camera.cy) == (639.5, 479.5)  # of 1280 x 960: whole numbers are pixel centres
        assert camera.fx == camera.fy
        assert isinstance(camera.lens, BrownConrady)
        assert (camera.lens.k3, camera.lens.p1, camera.lens.p2) == (0, 0, 0)
        assert camera.fx != 1000.0
        assert abs(camera.fx - 1000.0) < 5
    held = calibrate_stereo(BOARD, noisy, SIZES, lenses, ("focal", "k1"), start=rig).rig
    assert (held.left.fx, held.right.fy) == (1000.0, 1000.0)
    assert isinstance(held.left.lens, BrownConrady)
    assert held.left.lens.k1 == -0.2


def test_a_warped_board_is_believed() -> None:
    rig, bent = some_rig(None, None), Board(9, 6, 0.03, (2e-3, -1e-3))
    observed = boards_in_view(rig, BOARD, 12).project(rig, bent)
    found: FoundRig = calibrate_stereo(bent, observed, SIZES, (None, None))
    assert np.abs(pinhole_errors(found.rig, rig)).max() < 1e-6
    flat = calibrate_stereo(BOARD, observed, SIZES, (None, None))
    assert flat.rms_px > 0.1


@pytest.mark.parametrize(
    ("lenses", "fix", "says"),
    [
        ((BrownConrady, Rational), (), "brown and rational: OpenCV calibrates both cameras in the same one"),
        ((Mei, Mei), (), "mei: OpenCV calibrates pinhole, brown, rational and kannala_brandt"),
        ((BrownConrady, BrownConrady), ("right.k3",), "OpenCV holds what it holds of both cameras alike"),
        ((BrownConrady, BrownConrady), ("fx",), "fix fx: OpenCV cannot hold this"),
        ((BrownConrady, BrownConrady), ("pose",), "fix pose: OpenCV cannot hold this"),
        ((KannalaBrandt, KannalaBrandt), ("aspect",), "fix aspect: OpenCV cannot hold this"),
        ((BrownConrady, BrownConrady), ("focal",), "give a rig to start from"),
    ],
)
def test_what_opencv_cannot_do_is_one_line(
    lenses: tuple[type[Lens], type[Lens]], fix: tuple[str, ...], says: str
) -> None:
    rig = some_rig(None, None)
    observed = boards_in_view(rig, BOARD, 3).project(rig, BOARD)
    with pytest.raises(InvalidRange, match=says) as caught:
        calibrate_stereo(BOARD, observed, SIZES, lenses, fix)
    assert "\n" not in str(caught.value)


def test_one_board_is_too_few() -> None:
    rig = some_rig(None, None)
    observed = boards_in_view(rig, BOARD, 3).project(rig, BOARD)
    observed[1:, 1] = np.nan
    with pytest.raises(MeasurementFailed, match=r"the right camera saw 1 board\(s\): must be >= 2"):
        calibrate_stereo(BOARD, observed, SIZES, (None, None))
