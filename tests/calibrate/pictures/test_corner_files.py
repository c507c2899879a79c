"""Corners that other programs found: corners.vnl and CSV tables."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rigsim.errors import InvalidRange, MeasurementFailed
from rigsim.interop.corner_files.looked import looked_from
from rigsim.interop.corner_files.read import PictureCorners, read_corners
from rigsim.interop.corner_files.table import table_text
from rigsim.rig.board import Board

BOARD = Board(3, 3, 0.02)
SIZES = ((100, 80), (100, 80))
COUNT = 9


def vnl(names: list[str], level: str = "0") -> str:
    lines = [f"{name} {10 * k + 1}.5 {5 * k} {level}" for name in names for k in range(COUNT)]
    return "\n".join(["## by a finder", "# filename x y level", *lines]) + "\n"


def written(folder: Path, text: str, name: str = "corners.vnl") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_a_vnl_of_both_cameras(tmp_path: Path) -> None:
    text = vnl(["left1.png", "right1.png", "left2.png"], "1") + "right2.png - - -\nleft3.png - - -\n"
    found = looked_from([written(tmp_path, text)], BOARD, SIZES)
    assert found.sightings.names == ("left1/right1", "left2/right2")
    np.testing.assert_array_equal(found.sightings.observed[0, 1, 2], [21.5, 10])
    assert found.sightings.weights[0, 0, 0] == 0.5  # found in a halved picture: twice the noise
    assert found.seen == (("found", "found"), ("found", "not_found"))
    assert np.isnan(found.sightings.observed[1, 1]).all()
    assert [remark.code for remark in found.remarks] == ["unpaired"]
    assert "left3.png" in found.remarks[0].text


def test_a_negative_level_is_no_corner(tmp_path: Path) -> None:
    text = vnl(["a1"]).replace("a1 21.5 10 0", "a1 21.5 10 -1")
    (corners,) = read_corners(written(tmp_path, text), COUNT)
    assert np.isnan(corners.uv[2]).all()
    assert np.isfinite(np.delete(corners.uv, 2, axis=0)).all()


def test_a_weight_is_one_over_the_noise(tmp_path: Path) -> None:
    text = vnl(["a1"], "0.25").replace("level", "weight")
    (corners,) = read_corners(written(tmp_path, text), COUNT)
    np.testing.assert_allclose(2.0**-corners.level, 0.25)


def test_two_files_are_left_and_right(tmp_path: Path) -> None:
    left = written(tmp_path, vnl(["x1.png", "x2.png"]), "l.vnl")
    right = written(tmp_path, vnl(["x1.png", "x2.png"]).replace(" 1.5 0 ", " 2.5 0 "), "r.vnl")
    found = looked_from([left, right], BOARD, SIZES)
    assert found.sightings.names == ("x1", "x2")
    assert found.sightings.observed[0, :, 0, 0].tolist() == [1.5, 2.5]


def test_a_table_reads_back(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    uv = rng.uniform(0, 80, (COUNT, 2)).round(6)
    uv[4] = np.nan
    std = np.full(COUNT, 0.125)
    pictures = [PictureCorners("1", camera, uv, np.zeros(COUNT), std) for camera in ("left", "right")]
    back = read_corners(written(tmp_path, table_text(pictures), "c.csv"), COUNT)
    assert [(each.picture, each.camera) for each in back] == [("1", "left"), ("1", "right")]
    for each in back:
        np.testing.assert_array_equal(each.uv, uv)
        np.testing.assert_array_equal(each.std_px[np.isfinite(uv[:, 0])], 0.125)


HEAD = "picture,camera,corner,u_px,v_px\n"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("picture,camera,u_px,v_px\n1,left,2,3\n", "has no column corner"),
        ("# filename x\na 1\n", "has no column y"),
        (HEAD + "1,middle,0,2,3\n", "line 2: camera 'middle': must be left or right"),
        (HEAD + "1,left,9,2,3\n", "line 2: corner 9: must be a whole number, 0 to 8"),
        (HEAD + "1,left,0,two,3\n", "line 2: 'two': must be a number"),
        (HEAD + "1,left,0,2\n", "line 2: 4 values, must be 5"),
        ("# filename x y level\na 1 2\n", "line 2: 3 values, must be 4"),
        ("# filename x y level\na 1 2 0\na 2 2 0\n", "a has 2 corners, the board has 9"),
        ("hello\n", "must be a corners.vnl .* or a CSV table"),
    ],
)
def test_a_bad_file_is_one_line(tmp_path: Path, text: str, says: str) -> None:
    with pytest.raises(InvalidRange, match=says) as caught:
        read_corners(written(tmp_path, text), COUNT)
    assert "\n" not in str(caught.value)


def test_what_no_file_tells_is_asked_for(tmp_path: Path) -> None:
    path = written(tmp_path, vnl(["left1.png", "right1.png"]))
    with pytest.raises(InvalidRange, match="give --size WxH"):
        looked_from([path], BOARD, None)
    with pytest.raises(
        InvalidRange, match=r"corners reach 82,40 px, the pictures are 50x40: give their --size"
    ):
        looked_from([path], BOARD, ((50, 40), (50, 40)))
    empty = written(tmp_path, "# filename x y level\nleft1 - - -\nright1 - - -\n", "empty.vnl")
    with pytest.raises(MeasurementFailed, match="holds no corner"):
        looked_from([empty], BOARD, SIZES)


def table(*rows: str) -> str:
    return "\n".join(["picture,camera,corner,u_px,v_px,std_px", *rows]) + "\n"


@pytest.mark.parametrize(
    ("row", "says"),
    [
        ("a,left,1,20,30,-0.1", r"line 3: std_px -0.1: must be >= 0.0001 px"),
        ("a,left,1,20,30,0", r"line 3: std_px 0: must be >= 0.0001 px"),
        ("a,left,1,20,30,1e-9", r"line 3: std_px 1e-09: must be >= 0.0001 px"),
        ("a,left,0,20,30,0.1", r"line 3: corner 0 of a, left, stands on line 2 already"),
    ],
)
def test_what_no_finder_says_is_one_line(tmp_path: Path, row: str, says: str) -> None:
    with pytest.raises(InvalidRange, match=says):
        read_corners(written(tmp_path, table("a,left,0,10,30,0.1", row)), COUNT)


def test_the_same_corner_of_another_camera_is_no_duplicate(tmp_path: Path) -> None:
    text = table("a,left,0,10,30,0.1", "a,right,0,10,30,", "b,left,0,10,30,0.0001")
    assert len(read_corners(written(tmp_path, text), COUNT)) == 3


def test_a_table_of_exact_corners_is_read_back(tmp_path: Path) -> None:
    exact = PictureCorners("a", "left", np.ones((COUNT, 2)), np.zeros(COUNT), np.full(COUNT, 1e-7))
    (back,) = read_corners(written(tmp_path, table_text([exact])), COUNT)
    np.testing.assert_array_equal(back.std_px, np.full(COUNT, 1e-4))


def test_corners_divided_by_the_pictures_size_are_told(tmp_path: Path) -> None:
    rows = [
        f"{k},{side},{c},0.{c}1,0.{k}2," for k in (1, 2) for side in ("left", "right") for c in range(COUNT)
    ]
    with pytest.raises(InvalidRange, match=r"all lie within 0.81 px of 0,0: they look divided"):
        looked_from([written(tmp_path, table(*rows))], BOARD, SIZES)
