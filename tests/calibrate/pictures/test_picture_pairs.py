"""Pictures are paired by the sides and the digits in their names."""

from __future__ import annotations

import pytest

from rigsim.errors import InvalidRange
from rigsim.study.calibrate.pictures.pairs import paired


@pytest.mark.parametrize(
    "files",
    [
        ["left01.jpg", "left02.jpg", "right01.jpg", "right02.jpg"],
        ["cam0_003.png", "cam1_003.png", "cam0_004.png", "cam1_004.png"],
        ["L/001.png", "L/002.png", "R/001.png", "R/002.png"],
        ["0001_l.png", "0001_r.png", "0002_l.png", "0002_r.png"],
        ["image_02/000.png", "image_02/001.png", "image_03/000.png", "image_03/001.png"],
        ["imageL9.png", "imageL10.png", "imageR9.png", "imageR10.png"],
        ["leftcam-9.png", "leftcam-10.png", "rightcam-09.png", "rightcam-10.png"],
    ],
)
def test_names_tell_left_from_right(files: list[str]) -> None:
    found = paired([[file] for file in files])
    left = [file for file in files if file[0] == files[0][0] and ("R" not in file and "_r" not in file)]
    left = [file for file in left if not file.startswith(("cam1", "image_03"))]
    assert [pair.left for pair in found.pairs] == left
    assert not set(left) & {pair.right for pair in found.pairs}
    assert len(found.pairs) == 2
    assert found.alone == ()
    assert not found.by_order


def test_two_groups_are_left_and_right() -> None:
    found = paired([["a/001.png", "a/002.png", "a/007.png"], ["b/x002.png", "b/x001.png"]])
    assert [(pair.left, pair.right) for pair in found.pairs] == [
        ("a/001.png", "b/x001.png"),
        ("a/002.png", "b/x002.png"),
    ]
    assert found.alone == ("a/007.png",)


def test_numbers_are_in_order_of_size_not_of_letters() -> None:
    found = paired([["left9.png", "left10.png", "left2.png"], ["right2.png", "right10.png", "right9.png"]])
    assert [pair.name for pair in found.pairs] == ["left2/right2", "left9/right9", "left10/right10"]


def test_unpaired_pictures_are_listed() -> None:
    found = paired([["left1.png", "left3.png"], ["right2.png", "right3.png"]])
    assert [pair.name for pair in found.pairs] == ["left3/right3"]
    assert found.alone == ("left1.png", "right2.png")


def test_names_without_a_number_go_by_order() -> None:
    found = paired([["a/x.png", "a/y.png"], ["b/p.png", "b/q.png"]])
    assert [pair.name for pair in found.pairs] == ["x/p", "y/q"]
    assert found.by_order


@pytest.mark.parametrize(
    ("groups", "says"),
    [
        ([["a/x.png"]], r"1 picture\(s\): give those of both cameras"),
        ([["img_1.png"], ["img_2.png"], ["img_3.png"]], "nothing in their names tells left from right"),
        ([["left1.png", "left2.png"], ["right3.png"]], "no two have the same number"),
    ],
)
def test_what_does_not_pair_is_one_line(groups: list[list[str]], says: str) -> None:
    with pytest.raises(InvalidRange, match=says):
        paired(groups)
