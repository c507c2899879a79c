"""`rigsim calibrate pictures` as people type it: good pictures, broken ones, and one line for each fault."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as Pillow

import rigsim as front
from rigsim.interop.formats.rig_toml import read_rig
from rigsim.study.calibrate.pictures.look import look
from rigsim.study.calibrate.pictures.pairs import PicturePair
from tests.helpers.calibrate.board_photos import PHOTO_BOARD, PHOTO_RIG, photograph
from tests.helpers.cli import Done, rigsim
from tests.helpers.documents import misplaced, valid

COUNT = 8
FILES = {
    "calibration.json",
    "corners.csv",
    "coverage.png",
    "covariance.json",
    "residuals.png",
    "rig.toml",
}


@pytest.fixture(scope="module")
def photos(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("photos")
    photograph(folder, COUNT, empty=5)
    return folder


def calibrate(folder: Path, *words: object) -> Done:
    return rigsim("calibrate", "pictures", *words, "--model", "pinhole", cwd=folder)


@pytest.fixture(scope="module")
def done(photos: Path) -> Done:
    return calibrate(photos, "left*.png", "right*.png", "--board", "6x5@30mm", "--json", "--out", "out")


def test_pictures_give_the_rig_and_say_how_good_it_is(photos: Path, done: Done) -> None:
    assert done.returncode == 0, done.stderr
    document = valid("calibrate-pictures", done.stdout)
    assert not misplaced("calibrate-pictures", document)
    assert document["baseline_mm"] == pytest.approx(60.01, abs=4 * document["baseline_std_mm"])
    assert 0 < document["baseline_std_mm"] < 0.2
    for side, true in (("left", PHOTO_RIG.left), ("right", PHOTO_RIG.right)):
        found = document[side]
        for name in ("fx", "fy", "cx", "cy"):
            assert abs(found[f"{name}_px"] - getattr(true, name)) < 4 * found["std"][name], name
    verdicts = [picture["verdict"] for picture in document["pictures"]]
    assert verdicts == ["good"] * 5 + ["not_found"] + ["good"] * 2
    assert document["pictures"][5]["rms_px"] is None
    assert document["corner_noise_px"] == pytest.approx(document["claimed_noise_px"], rel=0.5)
    assert [row["z_m"] for row in document["depth_std"]] == [1, 2, 3, 5]
    for row in document["depth_std"]:
        assert row["joint_mm"] == pytest.approx(np.hypot(row["calibration_mm"], row["observation_mm"]))
    assert "no board" in done.stderr


def test_the_files_are_what_was_told(photos: Path, done: Done) -> None:
    out = photos / "out"
    assert {path.name for path in out.iterdir()} == FILES
    document = json.loads(done.stdout)
    assert set(document["written"]["files"]) == FILES
    rig = read_rig(out / "rig.toml")
    assert rig.baseline_m * 1e3 == pytest.approx(document["baseline_mm"], rel=1e-12)
    assert json.loads((out / "calibration.json").read_text())["left"] == document["left"]
    covariance = json.loads((out / "covariance.json").read_text())
    assert covariance["matrix"] == document["covariance"]["matrix"]
    for name in ("coverage.png", "residuals.png"):
        with Pillow.open(out / name) as picture:
            assert picture.width > 500


def test_its_corners_can_be_read_in_the_place_of_pictures(photos: Path, done: Done) -> None:
    again = calibrate(
        photos, "--corners", "out/corners.csv", "--size", "320x240", "--board", "6x5@30mm", "--json"
    )
    assert again.returncode == 0, again.stderr
    first, second = json.loads(done.stdout), json.loads(again.stdout)
    assert second["baseline_mm"] == pytest.approx(first["baseline_mm"], rel=1e-5)
    assert second["claimed_noise_px"] == pytest.approx(first["claimed_noise_px"], rel=1e-3)


def test_people_read_it_too(photos: Path) -> None:
    said = calibrate(photos, ".", "--board", "6x5@30mm", "--at", "1m")
    assert said.returncode == 0, said.stderr
    for words in ("Rig from 7 pairs: baseline 59.9", "left05/right05", "no board", "Hold the board next:"):
        assert words in said.stdout


def test_a_board_told_the_other_way_round_is_the_same_board(photos: Path, done: Done) -> None:
    turned = calibrate(photos, ".", "--board", "5x6@30mm", "--json")
    assert turned.returncode == 0, turned.stderr
    document = json.loads(turned.stdout)
    assert document["baseline_mm"] == pytest.approx(json.loads(done.stdout)["baseline_mm"], rel=1e-6)
    assert "board_turned" in {remark["code"] for remark in document["remarks"]}
    assert "both ways were tried" in turned.stderr


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (("left*.png", "right*.png", "--board", "7x6@30mm"), 1, "give --board 6x5@"),
        (("left00.png", "right00.png", "--board", "6x5@30mm"), 1, "must be >= 2"),
        (("left*.png", "left*.png", "--board", "6x5@30mm"), 1, "are the same: give those of two"),
        (("nothing*.png", "right*.png", "--board", "6x5@30mm"), 1, "no file matches this pattern"),
        (("--board", "6x5@30mm"), 2, "pictures are missing"),
        ((".", "--board", "6x5"), 2, "must be COLSxROWS@SQUARE"),
        ((".", "--board", "6x5@30mm", "--fix", "k9"), 2, "fix 'k9'"),
        ((".", "--board", "6x5@30mm", "--corners", "out/corners.csv"), 2, "give one or the other"),
    ],
)
def test_bad_input_is_one_line(photos: Path, words: tuple[str, ...], code: int, says: str) -> None:
    done = calibrate(photos, *words)
    assert done.returncode == code, done.stderr
    assert says in done.stderr
    assert done.stderr.count("rigsim: error:") == 1
    assert done.stdout == ""


def test_pictures_of_another_size_are_told(photos: Path, tmp_path: Path) -> None:
    for name in ("left00.png", "left01.png", "right00.png", "right01.png"):
        shutil.copy(photos / name, tmp_path / name)
    with Pillow.open(photos / "left01.png") as picture:
        picture.crop((0, 0, 300, 240)).save(tmp_path / "left01.png")
    done = calibrate(tmp_path, ".", "--board", "6x5@30mm", "--out", "out")
    assert done.returncode == 1
    assert "left01.png: 300x240 px, but left00.png has 320x240" in done.stderr
    assert not (tmp_path / "out").exists()


def test_a_broken_picture_is_named_and_left_out(photos: Path, tmp_path: Path) -> None:
    for name in photos.glob("*0[0-4].png"):
        shutil.copy(name, tmp_path)
    (tmp_path / "right02.png").write_bytes(b"no picture")
    done = calibrate(tmp_path, ".", "--board", "6x5@30mm", "--json")
    document = json.loads(done.stdout)
    assert "right02.png: cannot be read as a picture" in done.stderr
    assert document["headline"].startswith("Rig from 4 pairs: ")
    assert [picture["verdict"] for picture in document["pictures"]] == [
        "good",
        "good",
        "unreadable",
        "good",
        "good",
    ]


def test_ctrl_c_keeps_what_was_found(photos: Path) -> None:
    pairs = [
        PicturePair(str(photos / f"left{k:02d}.png"), str(photos / f"right{k:02d}.png")) for k in range(4)
    ]

    def interrupt(_: str, done: int, __: int) -> None:
        if done == 3:
            raise KeyboardInterrupt

    found = look(PHOTO_BOARD, pairs, interrupt)
    assert found.interrupted
    assert len(found.sightings) == 3


def test_the_library_takes_two_lists(photos: Path) -> None:
    names = [f"{k:02d}.png" for k in (0, 1, 2, 3)]
    found = front.calibrate_pictures(
        ([photos / f"left{name}" for name in names], [photos / f"right{name}" for name in names]),
        board=PHOTO_BOARD,
        model="pinhole",
        at_m=2,
    )
    assert found.rig.baseline_m == pytest.approx(0.06, rel=0.02)
    assert list(found.table["name"]) == [
        "left00/right00",
        "left01/right01",
        "left02/right02",
        "left03/right03",
    ]
    assert set(found.figures) == {"coverage", "residuals"}
    assert found.headline.startswith("Rig from 4 pairs")
