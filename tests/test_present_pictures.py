from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image as PillowImage
from test_present_synthetic import make_image

from rigsim.errors import OutputError
from rigsim.present.pictures import anaglyph, depth_picture, disparity_picture, encode, picture_limits


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
