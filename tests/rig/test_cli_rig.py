"""`rigsim rig`, and the pictures of a rig cut, binned and scaled by the options of every command."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import rigsim
from rigsim.cli.app import run
from tests.helpers.documents import misplaced, valid

INTRINSICS = """\
%YAML:1.0
---
M1: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 811.25, 0., 652.5, 0., 812.5, 469.75, 0., 0., 1. ]
D1: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ -0.11, 0.021, 0.0004, -0.0003, 0. ]
M2: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 809.75, 0., 631.25, 0., 811.5, 488.5, 0., 0., 1. ]
D2: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ -0.108, 0.019, 0.0002, 0.0001, 0. ]
"""
EXTRINSICS = """\
%YAML:1.0
---
R: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 1., 0., 0., 0., 1., 0., 0., 0., 1. ]
T: !!opencv-matrix
   rows: 3
   cols: 1
   dt: d
   data: [ -84.5, 0.25, 1.5 ]
"""


@pytest.fixture
def pair(tmp_path: Path) -> Path:
    folder = tmp_path / "calib"
    folder.mkdir()
    (folder / "intrinsics.yml").write_text(INTRINSICS)
    (folder / "extrinsics.yml").write_text(EXTRINSICS)
    return folder


@pytest.fixture
def said(capsys: pytest.CaptureFixture[str]) -> Any:
    def ask(*words: object) -> dict[str, Any]:
        capsys.readouterr()
        assert run(["rig", *map(str, words), "--json"]) == 0, capsys.readouterr().err
        document = valid("rig", capsys.readouterr().out)
        assert misplaced("rig", document) == []
        return document

    return ask


def test_a_pair_as_opencv_leaves_it(pair: Path, said: Any) -> None:
    document = said(pair / "intrinsics.yml", "--rig-unit", "mm", "--rig-size", "1280x960")
    assert document["format"] == "opencv"
    assert [Path(name).name for name in document["files"]] == ["intrinsics.yml", "extrinsics.yml"]
    assert document["baseline_mm"] == pytest.approx(math.hypot(84.5, 0.25, 1.5), rel=1e-12)
    assert (document["arrangement"], document["rectified"], document["doffs_px"]) == (
        "horizontal",
        False,
        None,
    )
    assert (document["vergence_deg"], document["pitch_deg"], document["roll_deg"]) == (0, 0, 0)
    right = document["right"]
    assert (right["model"], right["width_px"], right["height_px"]) == ("brown", 1280, 960)
    assert (right["fx_px"], right["fy_px"], right["cx_px"], right["cy_px"]) == (809.75, 811.5, 631.25, 488.5)
    assert [row["z_m"] for row in document["overlap"]] == [0.5, 1, 2, 5, 10]
    shares = [row["share"] for row in document["overlap"]]
    # at 1 m points lie 811 x 0.0845 px further left in the right picture, of which the lens leaves 84 % at
    # its edge, and 21 px by the principal points, which lie 19 rows apart
    assert shares[1] == pytest.approx((1 - (0.84 * 68.5 + 21) / 1280) * (1 - 19 / 960), abs=0.006)
    assert shares == sorted(shares)
    assert document["remarks"] == []


def test_files_folder_and_remarks_say_the_same(
    pair: Path, said: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    files = (pair / "extrinsics.yml", pair / "intrinsics.yml")
    one, two = said(pair, "--rig-unit", "mm"), said(*files, "--rig-unit", "mm")
    assert one == two
    assert [remark["code"] for remark in one["remarks"]] == ["no_size"]
    assert run(["rig", str(pair), "--rig-unit", "mm"]) == 0
    shown = capsys.readouterr()
    assert "a horizontal pair, not rectified, baseline 84.5 mm" in shown.out
    assert "no_size" in shown.out
    assert not shown.err  # it is said once
    assert run(["calc", "depth", "--z", "1m", "--rig", str(pair), "--rig-unit", "mm"]) == 0
    assert capsys.readouterr().err.count("rigsim: note: the calibration has no image size") == 1


def test_swapped_sides_are_said_and_mended(pair: Path, said: Any) -> None:
    (pair / "extrinsics.yml").write_text(EXTRINSICS.replace("-84.5", "84.5"))
    words = (pair, "--rig-unit", "mm", "--rig-size", "1280x960")
    assert [remark["code"] for remark in said(*words)["remarks"]] == ["swapped"]
    mended = said(*words, "--rig-swap")
    assert mended["remarks"] == []
    assert mended["left"]["cx_px"] == 631.25


def test_a_preset(said: Any) -> None:
    document = said("--preset", "oak-d")
    assert (document["format"], document["files"], document["remarks"]) == ("preset", [], [])
    assert (document["rectified"], document["doffs_px"], document["left"]["model"]) == (True, 0, "pinhole")
    # f B / Z of the width is lost
    assert document["overlap"][2]["share"] == pytest.approx(1 - 882.5 * 0.075 / 2 / 1280, rel=1e-9)


def test_the_picture_shows_who_sees_what(pair: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert run(["rig", str(pair), "--rig-unit", "mm", "--out", str(out)]) == 0
    assert sorted(path.name for path in out.iterdir()) == ["rig.json", "rig.png"]
    valid("rig", (out / "rig.json").read_text())
    pixels = np.asarray(Image.open(out / "rig.png").convert("RGB"), dtype=float)
    above = pixels[:, : pixels.shape[1] // 2]
    # from above: blue is left of orange, and what both see lies further up the page
    blue, orange = (_middle(above, color) for color in ((204, 227, 240), (247, 223, 204)))
    both = _middle(above, (179, 189, 195))
    assert blue[0] < both[0] < orange[0]
    assert both[1] < min(blue[1], orange[1])


def _middle(pixels: np.ndarray, color: tuple[int, int, int]) -> tuple[float, float]:
    rows, columns = np.nonzero(np.abs(pixels - color).max(axis=2) < 3)
    assert len(rows) > 500
    return float(columns.mean()), float(rows.mean())


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (["rig"], 2, "nothing to look at"),
        (["rig", "x.yml", "--preset", "bin"], 2, "give one"),
        (["rig", "missing.yml"], 1, "missing.yml"),
        (["rig", "--preset", "oak-d", "--rig-swap"], 2, "name its file"),
        (["rig", "--preset", "oak-d", "--binning", "3"], 1, "binning 3: 1280x800 px cannot be divided"),
        (["rig", "--preset", "oak-d", "--binning", "1.5"], 2, "must be a whole number"),
        (["rig", "--preset", "oak-d", "--crop", "1,2,3"], 2, "must be x,y,width,height"),
        (["rig", "--preset", "oak-d", "--crop", "1200,0,100,100"], 1, "reaches out of the 1280x800 picture"),
        (["rig", "--preset", "oak-d", "--resize", "640"], 2, "must be WIDTHxHEIGHT"),
        (
            ["calc", "depth", "--z", "1m", "--crop", "0,0,9,9", "--baseline", "60"],
            2,
            "with --rig or --preset",
        ),
        (
            ["calc", "limits", "--preset", "bin", "--resize", "64x48", "--resolution", "64x48"],
            2,
            "--resize and --resolution both given",
        ),
        (
            ["rig", "--preset", "oak-d", "--resize", "640x400,320x200"],
            2,
            "must be one width and height",
        ),
    ],
)
def test_what_cannot_be_is_one_line(
    words: list[str], code: int, says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(words) == code
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert says in error


# --- other pictures ---


def test_pictures_change_in_the_order_crop_binning_resize(pair: Path, said: Any) -> None:
    words = (pair, "--rig-unit", "mm", "--rig-size", "1280x960")
    changed = said(*words, "--crop", "40,80,1200,800", "--binning", "2", "--resize", "300x400")
    left = changed["left"]
    assert (left["width_px"], left["height_px"]) == (300, 400)
    assert left["fx_px"] == pytest.approx(811.25 / 4)
    assert left["fy_px"] == pytest.approx(812.5 / 2)
    # 653 px from the edge, 40 cut off, a quarter of that; 470.25 - 80, half
    assert left["cx_px"] == pytest.approx((652.5 + 0.5 - 40) / 4 - 0.5)
    assert left["cy_px"] == pytest.approx((469.75 + 0.5 - 80) / 2 - 0.5)
    # a cut that was asked for is nothing odd
    assert said(*words, "--crop", "0,0,800,600")["remarks"] == []


SWEEP = (
    *("sweep", "--measure", "none", "--renderer", "rays", "--points", "50", "--trials", "2"),
    *("--range", "1:3m", "--json"),
)


@pytest.mark.parametrize(
    ("start", "crop"),
    [
        ("--preset d435", "24,0,800,480"),
        ("--rig PAIR --rig-unit mm --rig-size 1280x960", "200,240,800,480"),
    ],
)
def test_every_command_takes_them(start: str, crop: str, pair: Path, tmp_path: Path, capsys: Any) -> None:
    words = start.replace("PAIR", str(pair)).split()
    changed = ["--crop", crop, "--binning", "2"]
    answers = []
    for more in ([], changed):
        capsys.readouterr()
        assert run(["calc", "depth", "--z", "2m", *words, *more, "--json"]) == 0
        answers.append(json.loads(capsys.readouterr().out))
    assert answers[1]["disparity_px"] == pytest.approx(answers[0]["disparity_px"] / 2, rel=1e-9)
    assert run(["export", "rig", *words, *changed, "--format", "opencv", "--out", str(tmp_path / "rig")]) == 0
    written = rigsim.read_rig(tmp_path / "rig")
    assert (written.left.width, written.left.height) == (400, 240)
    capsys.readouterr()
    assert run([*SWEEP, *words, *changed]) == 0
    (row,) = json.loads(capsys.readouterr().out)["rows"]
    assert (row["width_px"], row["height_px"]) == (400, 240)


def test_a_published_mode_has_its_own_field_of_view(capsys: Any) -> None:
    def ask(words: str) -> tuple[dict[str, Any], str]:
        capsys.readouterr()
        assert run([*f"calc limits --json {words}".split()]) == 0
        shown = capsys.readouterr()
        return json.loads(shown.out), shown.err

    vga, notes = ask("--preset d455 --resolution 640x480")
    assert vga["hfov_deg"] == pytest.approx(75)
    assert vga["focal_px"] == pytest.approx(320 / math.tan(math.radians(37.5)))
    assert notes == ""
    assert ask("--preset zed-mini --resolution 2208x1242")[0]["focal_px"] == 1400
    # of another size nothing is published: the field of view across stays, and it is said
    wide, notes = ask("--preset d435 --resolution 640x480")
    assert wide["hfov_deg"] == pytest.approx(90)
    assert "--resolution 640x480 has another shape than the rig's 848x480 px" in notes
    assert "grown by 118 rows" in notes  # 480 x 640 / 848 is 362
    assert "--crop" in notes
    assert "shape" in {remark["code"] for remark in wide["remarks"]}
    # nobody is asked who says the lens, or keeps the shape
    assert "another shape" not in ask("--preset d435 --resolution 640x480 --hfov 70")[1]
    assert "another shape" not in ask("--preset d435 --resolution 424x240")[1]


def test_what_is_read_of_a_file_shrinks_with_its_pictures(tmp_path: Path, capsys: Any) -> None:
    """The disparities of a Middlebury calib.txt are of its own pictures."""
    (tmp_path / "calib.txt").write_text(
        "cam0=[1000 0 400; 0 1000 300; 0 0 1]\ncam1=[1000 0 420; 0 1000 300; 0 0 1]\n"
        "doffs=20\nbaseline=100\nwidth=800\nheight=600\nndisp=120\n"
    )
    found = []
    for more in ([], ["--binning", "2"]):
        capsys.readouterr()
        assert run(["calc", "limits", "--rig", str(tmp_path / "calib.txt"), *more, "--json"]) == 0
        found.append(json.loads(capsys.readouterr().out))
    assert found[1]["search_max_px"] == pytest.approx(found[0]["search_max_px"] / 2)
    assert found[1]["min_depth"] == pytest.approx(found[0]["min_depth"], rel=1e-9)
