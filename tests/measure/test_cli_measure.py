"""`rigsim measure` as people type it: good pairs, broken ones, and one line for each fault."""

from __future__ import annotations

import csv
import json
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image as Pillow

from rigsim.cli.app import run
from rigsim.interop.formats.middlebury import disparity_png, read_disparity
from rigsim.interop.formats.rig_toml import read_rig, write_rig
from rigsim.pixels.dense.pfm import pfm_bytes
from rigsim.study.measure.columns import COLUMNS
from tests.helpers.documents import misplaced, valid
from tests.helpers.textured_images import affine_pair, noisy

DOFFS = 5.0
D = 20.0
CALIB = f"""cam0=[400 0 99.5; 0 400 74.5; 0 0 1]
cam1=[400 0 {99.5 + DOFFS}; 0 400 74.5; 0 0 1]
doffs={DOFFS}
baseline=100
width=200
height=150
ndisp=40
"""
FILES = {"disparity.png", "matches.csv", "measure.json", "points.ply", "provenance.json", "rig.toml"}
DENSE_FILES = {"disparity.pfm", "cloud.ply"}
MATCHERS = """
import os, time
import numpy as np
def good(left, right, rig):
    assert left.dtype == np.uint8
    return np.full(left.shape[:2], 20.25)
def small(left, right, rig):
    return np.zeros((3, 4))
def nothing(left, right, rig):
    return np.full(left.shape[:2], np.nan)
def raises(left, right, rig):
    raise ValueError("no luck")
def dies(left, right, rig):
    os._exit(7)
def hangs(left, right, rig):
    time.sleep(60)
"""


def save(path: Path, pixels: np.ndarray) -> None:
    levels = pixels if pixels.dtype.kind == "u" else np.clip(np.round(pixels), 0, 255).astype(np.uint8)
    Pillow.fromarray(levels).save(path)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A pair of a wall with a texture, 1.6 m away, and everything that can be wrong with it."""
    folder = tmp_path_factory.mktemp("pair")
    pair = affine_pair(1, width=200, height=150, d=D, doffs=DOFFS)
    left, right = noisy(pair.left, 1.0, 0), noisy(pair.right, 1.0, 1)
    save(folder / "left.png", left)
    save(folder / "right.png", right)
    save(folder / "low.png", np.roll(right, 1, axis=0))
    save(
        folder / "left_rgb.png", np.repeat(np.clip(np.round(left), 0, 255).astype(np.uint8)[..., None], 3, 2)
    )
    for side, image in (("left", left), ("right", right)):
        save(folder / f"{side}16.png", np.clip(np.round(image), 0, 255).astype(np.uint16) * 257)
    save(folder / "small.png", left[:100])
    save(folder / "black.png", 0 * left)
    save(folder / "white.png", 0 * left + 255)
    save(folder / "grey.png", 0 * left + 99)
    rows = np.repeat(np.arange(150.0)[:, None] % 50, 200, axis=1)
    save(folder / "rows.png", rows + 50)
    save(folder / "rows2.png", rows + 60)
    (folder / "text.png").write_text("no picture")
    (folder / "half.png").write_bytes((folder / "left.png").read_bytes()[:4000])
    (folder / "calib.txt").write_text(CALIB)
    (folder / "rig.toml").write_text(write_rig(pair.rig))
    truth = np.full((150, 200), D)
    truth[:20] = np.nan
    np.save(folder / "truth.npy", truth)
    (folder / "truth.pfm").write_bytes(pfm_bytes(truth))
    (folder / "truth.png").write_bytes(disparity_png(truth))
    save(folder / "truth8.png", np.where(np.isfinite(truth), 4 * D, 0).astype(np.uint8))
    np.save(folder / "small.npy", truth[30:40])
    (folder / "mine.py").write_text(MATCHERS)
    return folder


@pytest.fixture
def here(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(folder)
    monkeypatch.setenv("COLUMNS", "100")
    return folder


def document(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, Any]:
    capsys.readouterr()
    assert run(["measure", *words, "--json"]) == 0, capsys.readouterr().err
    return valid("measure", capsys.readouterr().out)


PAIR = ("left.png", "right.png", "--rig", "calib.txt")


# --- one document -------------------------------------------------------------------------------


def test_the_document_holds_what_it_promises(here: Path, capsys: pytest.CaptureFixture[str]):
    said = document(capsys, *PAIR, "--truth", "truth.npy")
    assert said["n_matches"] == said["patches"]["n"] > 100
    assert 0 < said["epipolar_rms_px"] < 0.1
    assert 0 < said["patches"]["median_abs_px"] < said["patches"]["predicted_std_px"] < 0.1
    assert said["patches"]["within_3_std_pct"] > 97
    # Z = 400 * 100 mm / (20 + 5)
    assert said["patches"]["depth_median_mm"] == pytest.approx(1600, abs=1)
    dense = said["dense"]
    assert dense["median_abs_px"] < 0.15
    assert dense["rms_px"] < 0.5
    assert dense["bad_1_pct"] < 1
    assert dense["fill_pct"] > 80
    assert dense["regions"]["all"]["n"] == 130 * 200
    assert sum(dense["phase"]["count"]) == sum(dense["phase"]["measured_count"]) > 10000
    assert said["rig"] == {
        "width_px": 200,
        "height_px": 150,
        "focal_px": 400.0,
        "baseline_mm": pytest.approx(100),
        "doffs_px": DOFFS,
        "rectified": True,
    }
    assert said["warnings"] == []


def test_without_a_truth_errors_are_null(here: Path, capsys: pytest.CaptureFixture[str]):
    said = document(capsys, *PAIR)
    assert said["patches"]["median_abs_px"] is None
    assert said["dense"]["median_abs_px"] is None
    assert said["dense"]["regions"] is None
    assert said["dense"]["fill_pct"] == said["dense"]["image_fill_pct"] > 70
    assert said["patches"]["predicted_std_px"] > 0
    plain = document(capsys, *PAIR, "--no-dense")
    assert plain["dense"] is plain["written"] is None


@pytest.mark.parametrize(
    "truth", [["truth.pfm"], ["truth.png"], ["truth8.png", "--truth-scale", "4"]], ids=lambda words: words[0]
)
def test_a_truth_may_have_any_of_its_formats(
    truth: list[str], here: Path, capsys: pytest.CaptureFixture[str]
):
    said = document(capsys, *PAIR, "--no-dense", "--truth", *truth)
    assert abs(said["patches"]["mean_px"]) < 0.01
    assert said["patches"]["n_truth"] < said["patches"]["n"]


def test_the_rig_may_come_in_any_form(here: Path, capsys: pytest.CaptureFixture[str]):
    calib = document(capsys, *PAIR, "--no-dense")
    toml = document(capsys, *PAIR[:2], "--rig", "rig.toml", "--no-dense")
    words = document(capsys, *PAIR[:2], "--baseline", "100", "--focal", "400", "--no-dense")
    assert calib["rig"] == toml["rig"]
    assert calib["patches"]["depth_median_mm"] == pytest.approx(toml["patches"]["depth_median_mm"], rel=1e-3)
    # no doffs: 400 * 100 mm / 20
    assert words["patches"]["depth_median_mm"] == pytest.approx(2000, abs=1)


def test_a_calib_is_a_rig_for_every_command(here: Path, capsys: pytest.CaptureFixture[str]):
    # at infinity the right camera sees the point `doffs` further right
    words = ["calc", "point", "--left", "99.5,74.5", "--right", "79.5,74.5", "--rig", "calib.txt", "--json"]
    assert run(words) == 0
    assert json.loads(capsys.readouterr().out)["z"] == pytest.approx(1600)


def test_a_calibs_search_range_is_used(here: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    (tmp_path / "near.txt").write_text(CALIB.replace("ndisp=40", "vmin=30\nvmax=60"))
    # the wall's 20 px are not among them
    assert run(["measure", *PAIR[:2], "--rig", str(tmp_path / "near.txt")]) == 1
    assert "none of" in capsys.readouterr().err
    # typed disparities come first
    assert run(["measure", *PAIR[:2], "--rig", str(tmp_path / "near.txt"), "--disparity", "0:40"]) == 0


@pytest.mark.parametrize("left", ["left_rgb.png", "left16.png"])
def test_colour_and_depth_make_no_difference(left: str, here: Path, capsys: pytest.CaptureFixture[str]):
    right = "right16.png" if "16" in left else "right.png"
    said = document(capsys, left, right, "--rig", "calib.txt", "--truth", "truth.npy")
    plain = document(capsys, *PAIR, "--truth", "truth.npy")
    assert said["n_matches"] == pytest.approx(plain["n_matches"], abs=5)
    for found in (said, plain):
        assert abs(found["patches"]["mean_px"]) < 0.01
    assert said["dense"]["regions"]["textureless"]["n"] == plain["dense"]["regions"]["textureless"]["n"]


def test_keys_stand_in_the_order_of_the_model(here: Path, capsys: pytest.CaptureFixture[str]):
    told = document(capsys, *PAIR, "--truth", "truth.npy", "--target", "40,40,100x80")
    assert misplaced("measure", told) == []
    # made by hand from the docs: the rig's size before its focal length, the counts before the errors
    assert list(told["rig"])[:4] == ["width_px", "height_px", "focal_px", "baseline_mm"]
    assert list(told["dense"])[:7] == [
        *("matcher", "rectified_first", "view", "image_fill_pct", "n", "invalid_pct", "bad_0_5_pct")
    ]


# --- files --------------------------------------------------------------------------------------


def test_everything_is_written(here: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    out = tmp_path / "out"
    assert run(["measure", *PAIR, "--truth", "truth.npy", "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    assert str(out) in printed
    assert {path.name for path in out.iterdir()} == FILES | DENSE_FILES
    said = valid("measure", (out / "measure.json").read_text())
    assert said["written"] == {"folder": str(out), "files": sorted(FILES | DENSE_FILES)}
    assert read_rig(out / "rig.toml") == read_rig(here / "rig.toml")

    with (out / "matches.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == [name for name in COLUMNS if name not in ("board", "corner")]
    assert len(rows) == said["n_matches"]
    for row in rows[:20]:
        disparity = float(row["u_left_px"]) - float(row["u_right_px"])
        assert float(row["disparity_px"]) == pytest.approx(disparity)
        assert float(row["z_mm"]) == pytest.approx(40_000 / (disparity + DOFFS))
        if row["truth_px"]:
            assert float(row["error_px"]) == pytest.approx(disparity - D, abs=1e-7)

    disparity = read_disparity(out / "disparity.pfm")
    assert disparity.shape == (150, 200)
    assert np.nanmedian(disparity) == pytest.approx(D, abs=0.2)
    assert f"element vertex {len(rows)}".encode() in (out / "points.ply").read_bytes()
    assert f"element vertex {np.isfinite(disparity).sum()}".encode() in (out / "cloud.ply").read_bytes()
    with Pillow.open(out / "disparity.png") as picture:
        assert picture.width == 200
        assert picture.height > 150
    made = json.loads((out / "provenance.json").read_text())
    assert made["left"]["file"] == "left.png"
    assert len(made["left"]["sha256"]) == 64
    assert {"rigsim", "opencv", "numpy", "command"} <= set(made)

    assert run(["measure", *PAIR, "--out", str(out)]) == 1
    assert "--force" in capsys.readouterr().err
    assert run(["measure", *PAIR, "--no-dense", "--out", str(out), "--force"]) == 0


def test_matches_alone_are_drawn_on_the_picture(
    here: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    told = document(capsys, *PAIR, "--no-dense", "--out", str(tmp_path / "out"))
    assert told == valid("measure", (tmp_path / "out" / "measure.json").read_text())
    assert {path.name for path in (tmp_path / "out").iterdir()} == FILES
    with Pillow.open(tmp_path / "out" / "disparity.png") as picture:
        pixels = np.asarray(picture)[:150].astype(int)
    assert (np.ptp(pixels, axis=2) > 0).any()  # the dots
    assert (np.ptp(pixels, axis=2) == 0).any()  # the picture between them


# --- what people read ---------------------------------------------------------------------------


def test_people_are_told_what_it_means(here: Path, capsys: pytest.CaptureFixture[str]):
    assert run(["measure", *PAIR, "--truth", "truth.npy", "--target", "40,40,100x80"]) == 0
    said = capsys.readouterr().out
    noise = said.split("corresponds to --noise ")[1].split()[0]
    assert 0.001 < float(noise) < 0.02
    assert "Warning" not in said
    for words in ("1.60 m", "D1", "occluded", "fraction of a pixel", "plane-fit RMS", "Z accuracy"):
        assert words in said
    assert all(len(line) <= 100 for line in said.splitlines())


def test_a_row_too_low_is_a_warning_and_no_error(here: Path, capsys: pytest.CaptureFixture[str]):
    assert run(["measure", "left.png", "low.png", "--rig", "calib.txt", "--no-dense"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "Warning: The pair is not rectified as the rig says" in said
    assert "px too low" in said
    told = document(capsys, "left.png", "low.png", "--rig", "calib.txt", "--no-dense")
    assert told["epipolar_rms_px"] == pytest.approx(1.0, abs=0.15)
    assert [warning["key"] for warning in told["warnings"]] == ["not_rectified"]


# --- other people's matchers --------------------------------------------------------------------


def test_a_matcher_of_ones_own(here: Path, capsys: pytest.CaptureFixture[str]):
    dense = document(capsys, *PAIR, "--truth", "truth.npy", "--matcher", "mine:good")["dense"]
    assert dense["matcher"] == "mine:good"
    assert dense["mean_px"] == pytest.approx(0.25)
    assert dense["bad_0_5_pct"] == 0


def test_a_matcher_that_is_a_command(here: Path, capsys: pytest.CaptureFixture[str]):
    command = f"sh -c 'test -s {{left}} && test -s {{right}} && cp {here / 'truth.pfm'} {{out}}'"
    dense = document(capsys, *PAIR, "--truth", "truth.npy", "--matcher", command)["dense"]
    assert dense["rms_px"] == 0
    assert dense["image_fill_pct"] == pytest.approx(100 * 130 / 150)


# --- one line a fault, and nothing half-written ---------------------------------------------------


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        ("right.png left.png --rig calib.txt", 1, "left and right image are swapped"),
        ("left.png left.png --rig calib.txt", 1, "the same picture"),
        ("left.png small.png --rig calib.txt", 1, "200 x 150 and 200 x 100 px"),
        ("left.png --rig calib.txt", 2, "missing argument 'RIGHT'"),
        ("left.png right.png low.png --rig calib.txt", 2, "unexpected extra argument"),
        ("left.png black.png --rig calib.txt", 1, "right image: all black"),
        ("white.png right.png --rig calib.txt", 1, "left image: 100% of the pixels are saturated"),
        ("grey.png right.png --rig calib.txt", 1, "every pixel is 99"),
        ("rows.png rows2.png --rig calib.txt", 1, "no texture"),
        ("text.png right.png --rig calib.txt", 1, "text.png: no picture that can be read"),
        ("half.png right.png --rig calib.txt", 1, "half.png: no picture that can be read"),
        ("none.png right.png --rig calib.txt", 1, "none.png: cannot be read (No such file"),
        ("left.png right.png", 2, "--rig is missing"),
        ("left.png right.png --rig none.txt", 1, "none.txt: cannot be read (No such file"),
        ("left.png right.png --rig mine.py", 1, "mine.py"),
        ("left.png right.png --preset boards", 1, "the rig's left camera has 1280 x 720"),
        ("left.png right.png --rig calib.txt --truth small.npy", 1, "truth of 200 x 10 px"),
        ("left.png right.png --rig calib.txt --truth text.png", 1, "no disparity map"),
        ("left.png right.png --rig calib.txt --truth none.pfm", 1, "none.pfm: cannot be read (No such file"),
        ("left.png right.png --rig calib.txt --truth truth8.png", 2, "--truth-scale"),
        ("left.png right.png --rig calib.txt --truth truth.png --truth-scale 0", 2, "truth scale 0"),
        ("left.png right.png --rig calib.txt --board 3x4", 1, "left image: no checker board of 3 x 4 inner"),
        ("left.png right.png --rig calib.txt --board 3", 2, "rows and columns of inner corners"),
        ("left.png right.png --rig calib.txt --board 1x4", 1, "must be >= 3"),
        ("left.png right.png --rig calib.txt --disparity 20", 2, "two ends"),
        ("left.png right.png --rig calib.txt --target 1,2,3", 2, "400,300,200x100"),
        ("left.png right.png --rig calib.txt --target 1,2,3x400", 2, "must lie on the pictures"),
        ("left.png right.png --rig calib.txt --timeout 0", 2, "time limit 0 s"),
        ("left.png right.png --rig calib.txt --matcher nonsense", 1, "unknown matcher 'nonsense'"),
        ("left.png right.png --rig calib.txt --matcher mine:small", 1, "shape (3, 4)"),
        ("left.png right.png --rig calib.txt --matcher mine:nothing", 1, "no finite disparity"),
        ("left.png right.png --rig calib.txt --matcher mine:raises", 1, "ValueError: no luck"),
        ("left.png right.png --rig calib.txt --matcher mine:dies", 1, "exit code 7"),
        ("left.png right.png --rig calib.txt --matcher mine:none", 1, "cannot be imported"),
        (
            "left.png right.png --rig calib.txt --matcher mine:hangs --timeout 1.5",
            1,
            "longer than 1.5 s: killed",
        ),
    ],
)
def test_one_line_and_nothing_written(
    words: str, code: int, says: str, here: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
):
    assert run(["measure", *words.split(), "--out", str(tmp_path / "out")]) == code
    said = capfd.readouterr()
    assert said.err.startswith("rigsim: error: ")
    assert says in said.err
    assert said.err.count("\n") == 1
    assert said.out == ""
    assert list(tmp_path.iterdir()) == []


def test_without_opencv_the_line_that_installs_it(
    here: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setitem(sys.modules, "cv2", None)
    assert run(["measure", *PAIR, "--out", str(tmp_path / "out")]) == 1
    assert "pip install 'rigsim[vision]'" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


# --- an independent witness: a rendered pair ----------------------------------------------------


def test_a_rendered_pair_is_measured_where_it_was_rendered(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """The renderer's depth and the renderer's disparity, against what the command makes of the pictures."""
    calib = tmp_path / "calib.txt"
    calib.write_text(
        "cam0=[300 0 170; 0 300 119.5; 0 0 1]\ncam1=[300 0 150; 0 300 119.5; 0 0 1]\n"
        "doffs=-20\nbaseline=150\nwidth=320\nheight=240\n"
    )
    scene, pair = "branch", tmp_path / "pair"
    assert run(["render", "--scene", scene, "--rig", str(calib), "--out", str(pair)]) == 0
    pictures = [str(pair / "left.png"), str(pair / "right.png")]
    said = document(capsys, *pictures, "--rig", str(calib), "--truth", str(pair / "disparity.npy"))
    assert said["rig"]["doffs_px"] == -20
    assert said["patches"]["n_truth"] > 50
    assert said["patches"]["median_abs_px"] < 0.05
    assert said["patches"]["within_3_std_pct"] > 90
    assert said["dense"]["median_abs_px"] < 0.4
    assert abs(said["dense"]["depth"]["z_accuracy_pct"]) < 2

    out = tmp_path / "out"
    assert run(["measure", *pictures, "--rig", str(pair / "rig.toml"), "--no-dense", "--out", str(out)]) == 0
    depth = np.load(pair / "depth_left.npy")
    with (out / "matches.csv").open() as file:
        rows = list(csv.DictReader(file))
    off = [
        float(row["z_mm"]) / 1e3 / depth[round(float(row["v_left_px"])), round(float(row["u_left_px"]))] - 1
        for row in rows
    ]
    assert np.isfinite(off).sum() > 100  # the sky has no depth
    # at 7.4 m the disparity is 6 px: 2e-3 are 0.012 px, of which curved bark takes 0.008
    assert abs(np.nanmedian(off)) < 2e-3
    assert np.nanmedian(np.abs(off)) < 5e-3


def test_depth_is_missing_only_behind_the_cameras(here: Path, tmp_path: Path):
    """A rig whose doffs are too small puts the wall behind infinity: no depth, and no crash."""
    calib = tmp_path / "wrong.txt"
    calib.write_text(CALIB.replace("104.5", "69.5").replace("doffs=5.0", "doffs=-30"))
    out = tmp_path / "out"
    words = ["left.png", "right.png", "--rig", str(calib), "--disparity", "0:40", "--out", str(out)]
    assert run(["measure", *words]) == 0
    said = json.loads((out / "measure.json").read_text())
    assert said["patches"]["depth_median_mm"] is None
    assert said["n_matches"] > 100
    assert b"element vertex 0" in (out / "points.ply").read_bytes()
    assert math.isfinite(said["patches"]["predicted_std_px"])


def test_help_says_how(capsys: pytest.CaptureFixture[str]):
    assert run(["measure", "--help"]) == 0
    said = capsys.readouterr().out
    for words in ("--rig", "--truth", "--board", "--matcher", "--target", "--json", "calib.txt"):
        assert words in said
