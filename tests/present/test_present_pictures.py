from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image as PillowImage

from rigsim import present
from rigsim.errors import OutputError
from rigsim.present.kit.pictures import (
    anaglyph,
    depth_picture,
    disparity_picture,
    encode,
    picture_limits,
    with_scale,
)
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.sim.frame import StereoFrame, View
from rigsim.study.scene.snapshot import Snapshot
from tests.helpers.synthetic_sweeps import make_image


def test_the_left_image_is_red_and_the_right_one_cyan() -> None:
    left = np.zeros((2, 3, 3), np.uint8)
    right = np.zeros((2, 3, 3), np.uint8)
    left[0, 0] = 200
    right[1, 2] = 100
    picture = anaglyph(left, right)
    assert picture[0, 0].tolist() == [200, 0, 0]
    assert picture[1, 2].tolist() == [0, 100, 100]
    assert picture[0, 1].tolist() == [0, 0, 0]


def test_an_anaglyph_needs_images_of_one_size() -> None:
    with pytest.raises(OutputError, match="left image 3x2 and right image 4x2"):
        anaglyph(np.zeros((2, 3, 3), np.uint8), np.zeros((2, 4, 3), np.uint8))


def test_disparity_without_a_value_is_grey_and_the_rest_is_not() -> None:
    disparity = np.linspace(5.0, 60.0, 200).reshape(10, 20)
    disparity[2, 3] = np.nan
    disparity[4, 5] = np.inf
    picture = disparity_picture(disparity)
    assert picture.dtype == np.uint8
    grey = (picture == 60).all(axis=-1)
    assert grey.sum() == 2
    assert grey[2, 3]
    assert grey[4, 5]


def test_near_is_bright_in_both_pictures() -> None:
    disparity = np.array([[1.0, 50.0]])
    far, near = disparity_picture(disparity, (0.0, 60.0)).sum(axis=-1)[0]
    assert near > far
    # Z = f b / d: the same scene as a depth map has the same colours
    np.testing.assert_array_equal(
        depth_picture(60.0 / disparity, (1.0, 60.0)), disparity_picture(disparity, (1.0, 60.0))
    )


def test_depth_that_is_none_is_grey() -> None:
    picture = depth_picture(np.array([[1.0, 0.0, -1.0, np.nan, 3.0]]), (0.5, 5.0))
    assert (picture == 60).all(axis=-1)[0].tolist() == [False, True, True, True, False]


def test_limits_leave_out_the_outermost_hundredths_and_survive_a_constant() -> None:
    values = np.arange(1001.0)
    assert picture_limits(values) == (10.0, 990.0)
    low, high = picture_limits(np.full(5, 7.0))
    assert low < 7.0 < high
    assert picture_limits(np.full(3, np.nan)) == (0.0, 1.0)
    assert (disparity_picture(np.full((2, 2), np.nan)) == 60).all()


def test_png_keeps_every_value_and_jpeg_shrinks() -> None:
    image = make_image(320, 200)
    with PillowImage.open(io.BytesIO(encode(image))) as back:
        np.testing.assert_array_equal(np.asarray(back), image)
    with PillowImage.open(io.BytesIO(encode(image, "jpeg", width=160))) as back:
        assert back.format == "JPEG"
        assert back.size == (160, 100)
    with PillowImage.open(io.BytesIO(encode(image, "jpeg", width=999))) as back:
        assert back.size == (320, 200)


def test_a_scale_under_a_picture_leaves_the_picture_as_it_is() -> None:
    picture = disparity_picture(np.linspace(5, 60, 400 * 100).reshape(100, 400))
    scaled = with_scale(picture, (5.0, 60.0), "disparity, px")
    assert scaled.shape == (162, 400, 3)
    np.testing.assert_array_equal(scaled[:100], picture)
    bar = scaled[100 + 13]  # a line through the colour bar: dark and blue at the left, bright at the right
    assert bar[60].sum() < bar[330].sum()
    assert (scaled[100:] == 255).all(axis=-1).mean() > 0.5


def snapshot(right_width: int = 320) -> Snapshot:
    def view(width: int, shift: int) -> View:
        return View(
            make_image(width, 200, shift),
            np.full((200, width), 2.0),
            np.zeros((200, width), dtype=np.int32),
        )

    rig = StereoRig.rectified(
        Intrinsics.from_focal(320, 200, 300.0),
        0.1,
        right=Intrinsics.from_focal(right_width, 200, 300.0),
    )
    disparity = np.full((200, 320), 15.0)
    disparity[:, :40] = np.nan
    return Snapshot("made-up", rig, StereoFrame(view(320, 0), view(right_width, 15)), disparity, {})


def test_render_files_hold_both_images_as_they_are() -> None:
    shot = snapshot()
    files = present.render_files(shot)
    assert set(files) == {"left.png", "right.png", "disparity.png", "anaglyph.png"}
    for name, expected in (("left", shot.frame.left.image), ("right", shot.frame.right.image)):
        with PillowImage.open(io.BytesIO(files[f"{name}.png"])) as back:
            np.testing.assert_array_equal(np.asarray(back), expected)
    with PillowImage.open(io.BytesIO(files["anaglyph.png"])) as back:
        np.testing.assert_array_equal(
            np.asarray(back), anaglyph(shot.frame.left.image, shot.frame.right.image)
        )
    with PillowImage.open(io.BytesIO(files["disparity.png"])) as back:
        grey = (np.asarray(back)[:200] == 60).all(axis=-1)
    assert grey[:, :40].all()
    assert not grey[:, 40:].any()


def test_images_of_two_sizes_have_no_anaglyph() -> None:
    assert "anaglyph.png" not in present.render_files(snapshot(300))


def test_plot_points_is_a_picture() -> None:
    png = present.plot_points(snapshot().rig, [[0.1, 0.0, 2.0]], PixelNoise(0.25), "One point")
    with PillowImage.open(io.BytesIO(png)) as back:
        assert back.size[0] == 1080
