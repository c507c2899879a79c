"""Cut, binned and scaled pictures: where the pixels of the new camera look."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigsim.errors import InvalidRig
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.stereo import StereoRig
from tests.helpers.sampling import cameras, close

LENS = BrownConrady(-0.1, 0.02, 0.001, -0.002)
CAMERA = Intrinsics(640, 480, 500.0, 400.0, 300.0, 250.0, LENS)
POINTS = np.array([[0.3, -0.2, 1.0], [-0.5, 0.4, 2.0], [0.0, 0.0, 1.0]])


def test_by_hand() -> None:
    assert CAMERA.cropped(100, 40, 400, 300) == Intrinsics(400, 300, 500.0, 400.0, 200.0, 210.0, LENS)
    # the new pixel 0 is the old pixels 0 and 1, so that its middle is the old 0.5: 300 -> (300 - 0.5) / 2
    assert CAMERA.binned(2) == Intrinsics(320, 240, 250.0, 200.0, 149.75, 124.75, LENS)
    # 300.5 px from the left edge become 901.5, 250.5 from the upper one 501
    assert CAMERA.resized(1920, 960) == Intrinsics(1920, 960, 1500.0, 800.0, 901.0, 500.5, LENS)


def test_a_rig_changes_both_cameras_and_nothing_else() -> None:
    right = Intrinsics(640, 480, 510.0, 410.0, 310.0, 240.0, KannalaBrandt(0.01, 0.0, 0.0, 0.0))
    rig = StereoRig.verged(CAMERA, 0.12, 3.0, right=right)
    changed = rig.cropped(20, 30, 600, 440).binned(4).resized(300, 220)
    assert changed.left == CAMERA.cropped(20, 30, 600, 440).binned(4).resized(300, 220)
    assert changed.right == right.cropped(20, 30, 600, 440).binned(4).resized(300, 220)
    assert changed.right_from_left == rig.right_from_left


@given(cameras(distorted=True), st.integers(0, 9), st.integers(0, 7), st.integers(1, 5))
def test_a_point_moves_with_its_pixel(camera: Intrinsics, x: int, y: int, n: int) -> None:
    uv = camera.project(POINTS)
    close(camera.cropped(x, y, camera.width - x - 3, camera.height - y - 2).project(POINTS), uv - (x, y))
    grown = camera.resized(n * camera.width, n * camera.height)
    close(grown.project(POINTS), n * uv + (n - 1) / 2, rtol=1e-9, atol=1e-9)
    assert grown == camera.supersampled(n)
    back = grown.binned(n)
    close(back.project(POINTS), uv, rtol=1e-9, atol=1e-9)
    # the edges of the picture stay the edges: what is held is held
    close(grown.hfov_deg, camera.hfov_deg, rtol=1e-9)


def test_the_middle_of_a_spot_is_where_the_new_camera_says() -> None:
    """A drawn spot, averaged and resized by OpenCV: a shift by half a pixel would show as 0.25 px."""
    camera = Intrinsics(240, 180, 200.0, 200.0, 111.3, 95.7)
    point = np.array([[0.07, -0.11, 1.0]])
    at_u, at_v = camera.project(point)[0]
    v, u = np.mgrid[0:180, 0:240]
    picture = np.exp(-((u - at_u) ** 2 + (v - at_v) ** 2) / (2 * 4.0**2))

    def middle(image: np.ndarray) -> list[float]:
        rows, columns = np.mgrid[0 : image.shape[0], 0 : image.shape[1]]
        return [float((image * columns).sum() / image.sum()), float((image * rows).sum() / image.sum())]

    cut = picture[31:151, 42:202]
    close(middle(cut), camera.cropped(42, 31, 160, 120).project(point)[0], atol=1e-4)
    averaged = cut.reshape(60, 2, 80, 2).mean(axis=(1, 3))
    close(middle(averaged), camera.cropped(42, 31, 160, 120).binned(2).project(point)[0], atol=1e-4)
    for size in ((120, 90), (80, 60), (160, 60)):
        small = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
        close(middle(small), camera.resized(*size).project(point)[0], atol=5e-3)
    large = cv2.resize(picture, (480, 540), interpolation=cv2.INTER_LINEAR)
    close(middle(large), camera.resized(480, 540).project(point)[0], atol=1e-3)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (
            lambda camera: camera.cropped(600, 0, 50, 10),
            "crop 600,0,50,10: reaches out of the 640x480 picture",
        ),
        (lambda camera: camera.cropped(-1, 0, 50, 10), "crop -1,0,50,10: reaches out"),
        (lambda camera: camera.cropped(0, 0, 0, 10), "crop 0,0,0,10: both sides must be >= 1 px"),
        (lambda camera: camera.cropped(0.5, 0, 10, 10), "crop 0.5 px: must be a whole number"),
        (lambda camera: camera.binned(3), "binning 3: 640x480 px cannot be divided.*--crop 0,0,639,480"),
        (lambda camera: camera.binned(0), "binning 0: must be >= 1"),
        (lambda camera: camera.binned("2"), "binning .*must be a number"),
        (lambda camera: camera.resized(0, 4), "size 0x4: both sides must be >= 1 px"),
    ],
)
def test_what_cannot_be_is_one_line(change: object, says: str) -> None:
    assert callable(change)
    with pytest.raises(InvalidRig, match=says) as raised:
        change(CAMERA)
    assert "\n" not in str(raised.value)
