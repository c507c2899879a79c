"""`rigsim calc` as a user types it: others' worked examples, each with its source, and what goes wrong."""

from __future__ import annotations

import csv
import io
import json
import math
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares

from rigsim import __version__
from rigsim.cli.app import run
from rigsim.interop.formats.rig_toml import write_rig
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig
from tests.helpers.documents import misplaced, valid

W1 = "--focal 1200 --baseline 150 --left 980,500 --right 910,500"


@pytest.fixture
def calc(capsys: pytest.CaptureFixture[str]) -> Any:
    """Run ``calc ... --json`` and return what it says."""

    def answer(words: str) -> dict[str, Any]:
        capsys.readouterr()
        assert run(["calc", *words.split(), "--json"]) == 0
        return valid(f"calc-{words.split()[0]}", capsys.readouterr().out)

    return answer


# --- worked examples ---


def test_w1_multiview_calculator_branch(calc: Any) -> None:
    # Multiview Calculator, example 1; it prints X 2098.6 where its own formula gives 2100.0
    answer = calc(f"point {W1}")
    assert answer["disparity_px"] == 70.0
    assert answer["z"] == pytest.approx(1200 * 150 / 70, rel=1e-14)
    assert answer["z"] == pytest.approx(2571.43, abs=5e-3)
    assert answer["x"] == pytest.approx(2100.0, rel=1e-14)
    assert answer["y"] == pytest.approx(1071.43, abs=5e-3)
    assert answer["unit"] == "mm"


def test_w2_multiview_calculator_artifact(calc: Any) -> None:
    # Multiview Calculator, example 2
    answer = calc("point --focal 2000 --baseline 80 --left 1400,1050 --right 1250,1050")
    assert answer["disparity_px"] == 150.0
    assert answer["z"] == pytest.approx(1066.67, abs=5e-3)
    assert answer["x"] == pytest.approx(746.67, abs=5e-3)
    assert answer["y"] == pytest.approx(560.0, abs=5e-3)


@pytest.mark.parametrize(("size", "focal_px"), [("640x400", 441.251), ("1280x800", 882.503)])
def test_w3_luxonis_focal_of_a_field_of_view(calc: Any, size: str, focal_px: float) -> None:
    # Luxonis, depth documentation: HFOV 71.9 deg
    answer = calc(f"limits --hfov 71.9 --resolution {size} --baseline 75")
    assert answer["focal_px"] == pytest.approx(focal_px, abs=5e-4)
    assert answer["hfov_deg"] == pytest.approx(71.9, abs=1e-12)


def test_w4_luxonis_depth_of_a_disparity(calc: Any) -> None:
    # Luxonis, depth documentation: f 441.25, B 75 mm, 50 px
    answer = calc("point --focal 441.25 --baseline 75 --left 50,0 --right 0,0")
    assert answer["z"] == pytest.approx(661.9, abs=0.05)


@pytest.mark.parametrize(("focal_px", "min_mm"), [(882.5, 697), (441, 348)])
def test_w5_luxonis_least_depth(calc: Any, focal_px: float, min_mm: float) -> None:
    # Luxonis, depth documentation: 95 px of disparity searched
    answer = calc(f"limits --focal {focal_px} --baseline 75 --resolution 1280x800 --disparities 0:95")
    assert answer["min_depth"] == pytest.approx(min_mm, abs=0.5)
    assert answer["max_depth"] is None


def test_w6_luxonis_dead_band(calc: Any) -> None:
    # Luxonis, depth documentation: 33.03 px; its 51.6 mm is that share, 33.03 / 640, of one metre
    answer = calc("limits --hfov 72 --resolution 640x400 --baseline 75 --z 1m")
    assert answer["dead_band_px"] == pytest.approx(33.03, abs=5e-3)
    assert (1 - answer["overlap_share"]) * 1000 == pytest.approx(51.6, abs=0.05)
    assert answer["dead_band"] == pytest.approx(75.0, rel=1e-9)


@pytest.mark.parametrize(("z", "std_mm"), [("2m", 20), ("10m", 500), ("20m", 2000)])
def test_w7_visual_slam_roadmap_depth_std(calc: Any, z: str, std_mm: float) -> None:
    # changh95, visual-slam-roadmap: f 500, B 0.1 m, 0.25 px of disparity
    answer = calc(f"depth --z {z} --focal 500 --baseline 0.1m --noise {0.25 / math.sqrt(2)!r}")
    assert answer["depth_std"] == pytest.approx(std_mm, rel=1e-12)


def test_w8_pinhole_stereo_error_bounds(calc: Any) -> None:
    # g-rousseau, pinhole-stereo-error: HFOV 90 deg, 1280 px, B 0.1 m, +-1.5 px at 10 m
    answer = calc("depth --z 10m --hfov 90 --resolution 1280x720 --baseline 0.1m --disparity-error 1.5")
    assert answer["depth_near"] == pytest.approx(8100, abs=5)
    assert answer["depth_far"] == pytest.approx(13060, abs=5)


def test_w9_opencv_forum_disparity(calc: Any) -> None:
    # OpenCV forum: 1920 px, HFOV 70 deg, B 63.5 mm, 1 m
    answer = calc("depth --z 1m --hfov 70 --resolution 1920x1080 --baseline 63.5")
    assert answer["focal_px"] == pytest.approx(1371.02, abs=5e-3)
    assert answer["disparity_px"] == pytest.approx(87.06, abs=5e-3)


def test_w10_simstereocam_field_of_view(calc: Any) -> None:
    # I3DR SimStereoCam: 2448 px of 3.45 um behind 8 mm
    answer = calc("limits --focal 8mm --pixel-pitch 3.45um --resolution 2448x2048 --baseline 300")
    assert answer["hfov_deg"] == pytest.approx(55.65, abs=5e-3)


def test_w11_strands_robots_focal_in_mm(calc: Any) -> None:
    # strands robots: a sensor of 6.4 x 4.8 mm, focal 6 mm, 320 x 240 px
    words = "--focal 6mm --sensor-width 6.4mm --resolution 320x240 --baseline 100"
    assert calc(f"limits {words}")["focal_px"] == pytest.approx(300.0, rel=1e-14)
    # principal (1.5, 0.8) mm is (85, 80) px where W/2 is the middle: a point there lies on the axis
    answer = calc(f"point {words} --principal 85,80 --left 85,80 --right 55,80")
    assert (answer["x"], answer["y"], answer["z"]) == pytest.approx((0.0, 0.0, 1000.0), abs=1e-9)


# --- what the answers mean ---


def test_point_has_exactly_the_promised_keys(calc: Any) -> None:
    assert list(calc(f"point {W1}")) == [
        "seen_by", "x", "y", "z", "disparity_px", "residual_px", "residual_sigma", "world_per_pixel",
        "depth_std", "depth_near", "depth_far", "uv_origin", "remarks", "golden", "unit",
    ]  # fmt: skip


def test_point_uncertainty_by_hand(calc: Any) -> None:
    answer = calc(f"point {W1} --noise 0.5")
    z, fb, sigma_d = 1200 * 150 / 70, 1200 * 150, 0.5 * math.sqrt(2)
    assert answer["world_per_pixel"] == pytest.approx(z / 1200, rel=1e-12)
    assert answer["depth_std"] == pytest.approx(z * z / fb * sigma_d, rel=1e-9)
    assert answer["depth_near"] == pytest.approx(fb / (70 + sigma_d), rel=1e-9)
    assert answer["depth_far"] == pytest.approx(fb / (70 - sigma_d), rel=1e-9)


def test_principal_point_is_the_middle_once_a_size_is_known(calc: Any) -> None:
    on_axis = "--focal 1200 --baseline 150 --left 639.5,479.5 --right 569.5,479.5"
    assert calc(f"point {on_axis} --resolution 1280x960")["x"] == pytest.approx(0.0, abs=1e-9)
    assert calc(f"point {on_axis}")["x"] == pytest.approx(639.5 * 150 / 70, rel=1e-12)
    moved = calc(f"point {on_axis} --resolution 1280x960 --principal 600,479.5")
    assert moved["x"] == pytest.approx(39.5 * 150 / 70, rel=1e-12)


def test_a_rig_may_come_from_a_preset_or_a_file_and_be_changed(calc: Any, tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text(write_rig(StereoRig.rectified(Intrinsics.from_focal(1280, 960, 1200.0), 0.150)))
    by_file = calc(f"depth --z 3m --rig {path}")
    by_name = calc("depth --z 3m --preset branch")
    by_hand = calc("depth --z 3m --focal 1200 --baseline 15cm --resolution 1280x960")
    names = [said["rows"][0].pop("rig") for said in (by_file, by_name, by_hand)]
    assert names == [str(path), "branch", "rig"]
    assert by_file == by_name == by_hand
    halved = calc(f"depth --z 3m --rig {path} --baseline 75")
    assert halved["disparity_px"] == pytest.approx(by_file["disparity_px"] / 2, rel=1e-12)


def test_a_verged_point_is_where_it_was_projected_from(calc: Any) -> None:
    rig = StereoRig.verged(Intrinsics.from_focal(1280, 960, 1200.0), 0.150, 5.0)
    uv_left, uv_right = rig.project(np.array([[0.2, -0.1, 1.5]]))
    words = f"--left {uv_left[0, 0]!r},{uv_left[0, 1]!r} --right {uv_right[0, 0]!r},{uv_right[0, 1]!r}"
    words = words.replace("np.float64(", "").replace(")", "")
    answer = calc(f"point --preset branch --vergence 5 {words}")
    assert (answer["x"], answer["y"], answer["z"]) == pytest.approx((200.0, -100.0, 1500.0), abs=1e-6)


def test_limits_of_a_verged_rig_leave_out_the_search_range(calc: Any) -> None:
    answer = calc("limits --preset branch --vergence 5")
    assert answer["min_depth"] is None
    assert answer["overlap_fov_deg"] == pytest.approx(
        calc("limits --preset branch")["hfov_deg"] - 5, abs=1e-9
    )


def test_limits_by_hand(calc: Any) -> None:
    answer = calc(
        "limits --focal 640 --baseline 100 --resolution 1280x720 --z 2m --disparities 8:64 --shift 16"
    )
    assert answer["min_depth"] == pytest.approx(64000 / 80, rel=1e-12)
    assert answer["max_depth"] == pytest.approx(64000 / 24, rel=1e-12)
    assert answer["hfov_deg"] == pytest.approx(90.0, rel=1e-12)
    assert answer["overlap_fov_deg"] == pytest.approx(90.0, rel=1e-12)
    assert answer["blind_zone"] == pytest.approx(50.0, rel=1e-12)
    assert answer["overlap_width"] == pytest.approx(4000 - 100, rel=1e-12)
    assert answer["dead_band_px"] == pytest.approx(32.0, rel=1e-12)
    assert answer["depth_step"] == pytest.approx(2000**2 / 64000, rel=1e-12)


# --- who sees it, and what is odd ---


def codes(answer: dict[str, Any]) -> list[str]:
    return [remark["code"] for remark in answer["remarks"]]


def test_a_point_that_a_camera_cannot_see_has_no_error(calc: Any, capsys: pytest.CaptureFixture[str]) -> None:
    # f 900 px, half the width 640 px, B 120 mm: the right camera sees the left axis from 900 B / 640 on
    assert calc("depth --z 169mm --preset boards")["seen_by"] == "both"
    answer = calc("depth --z 168mm --preset boards")
    assert (answer["seen_by"], codes(answer)) == ("left", ["not_seen_right"])
    for key in ("disparity_px", "depth_std", "depth_near", "depth_far", "depth_bias"):
        assert answer[key] is None
    assert run(["calc", "depth", "--z", "168mm", "--preset", "boards"]) == 0
    shown = capsys.readouterr()
    # 639.5 - 900 * 120 / 168
    assert (
        "the right camera does not see the point at Z = 168 mm: it would lie at -3.3571,359.5 px" in shown.err
    )
    assert "from Z = 168.8 mm on" in shown.err
    assert "depth std               –" in shown.out


@pytest.mark.parametrize(
    ("words", "seen_by"),
    [
        # 61 m aside at 1 m: 89 degrees off the right camera's axis
        ("depth --z 1m --focal 900 --baseline 61m", "left"),
        ("depth --z 1m --focal 900 --baseline 1m", "both"),
        # the right camera looks away by 120 degrees
        ("depth --z 1m --preset boards --vergence -120", "left"),
        ("point --preset boards --left 1000,-1340 --right 900,-1340", "neither"),
        ("point --preset boards --left 1280,5 --right 900,5", "right"),
        ("point --preset boards --left 1279.5,5 --right -0.5,5", "both"),
        ("point --preset boards --left 100,5 --right -1,5", "left"),
    ],
)
def test_who_sees_a_point(calc: Any, words: str, seen_by: str) -> None:
    answer = calc(words)
    assert answer["seen_by"] == seen_by
    assert (answer["depth_std"] is None) == (seen_by != "both")
    assert sum(code.startswith("not_seen") for code in codes(answer)) == {"both": 0, "neither": 2}.get(
        seen_by, 1
    )


def test_a_row_mismatch_is_told(calc: Any, capsys: pytest.CaptureFixture[str]) -> None:
    # rows 200 px apart: the best point is 100 px off in each image, 100 sqrt(2) in all, 400 sqrt(2) sigma
    answer = calc("point --preset boards --left 1000,100 --right 900,300")
    assert answer["residual_px"] == pytest.approx(100 * math.sqrt(2), rel=1e-9)
    assert answer["residual_sigma"] == pytest.approx(400 * math.sqrt(2), rel=1e-9)
    assert codes(answer) == ["residual"]
    assert "the rows differ by 200 px" in answer["remarks"][0]["text"]
    # 3 sigma of 0.25 px are 0.75 px in all, 1.0607 px of rows
    assert codes(calc("point --preset boards --left 1000,100 --right 900,101.07")) == ["residual"]
    assert codes(calc("point --preset boards --left 1000,100 --right 900,101.05")) == []
    exact = calc("point --preset boards --left 1000,100 --right 900,100")
    assert (exact["residual_px"], exact["residual_sigma"]) == (0.0, 0.0)


def test_the_residual_of_verged_cameras_is_the_least_any_point_leaves(calc: Any) -> None:
    rig = StereoRig.verged(Intrinsics.from_focal(1280, 960, 1200.0), 0.150, 5.0)
    uv_left, uv_right = (uv[0] for uv in rig.project(np.array([[0.2, -0.1, 1.5]])))
    shifted = uv_right + np.array([0.0, 3.0])
    seen = np.concatenate([uv_left, shifted])
    best = least_squares(lambda x: np.hstack(rig.project(x[None]))[0] - seen, [0.2, -0.1, 1.5], xtol=1e-15)
    left, right = (",".join(map(str, uv.tolist())) for uv in (uv_left, shifted))
    answer = calc(f"point --preset branch --vergence 5 --left {left} --right {right}")
    assert answer["residual_px"] == pytest.approx(np.linalg.norm(best.fun), rel=1e-6)
    assert answer["residual_px"] == pytest.approx(3 / math.sqrt(2), rel=0.01)


def test_bounds_and_std_are_one_definition_for_unequal_lenses(calc: Any, tmp_path: Path) -> None:
    # right camera zoomed three times: sigma_Z = Z^2 / (f B) sigma sqrt(1 + 1/9), and so the bounds
    lens = Intrinsics.from_focal(1280, 960, 800.0)
    rig = StereoRig.rectified(lens, 0.1, right=Intrinsics.from_focal(1280, 960, 2400.0))
    path = tmp_path / "rig.toml"
    path.write_text(write_rig(rig))
    answer = calc(f"depth --z 2m --rig {path}")
    assert answer["depth_std"] == pytest.approx(4000 / 80 * 0.25 * math.sqrt(1 + 1 / 9), rel=1e-9)
    dq = 0.25 * math.sqrt(1 + 1 / 9) / 80
    assert answer["depth_near"] == pytest.approx(1e3 / (0.5 + dq), rel=1e-9)
    assert answer["depth_far"] == pytest.approx(1e3 / (0.5 - dq), rel=1e-9)


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        ("depth --z 3m --focal 0.8 --baseline 120", "focal", "focal length 0.8 px: mm meant?"),
        ("depth --z 3m --focal 0.8 --baseline 120 --resolution 640x480", "focal", "179.7 deg wide"),
        (
            "point --preset boards --principal 5000,5 --left 900,5 --right 890,5",
            "principal_point",
            "5000,5 px",
        ),
        ("depth --z 20 --preset boards", "unit", "write 20m if metres are meant"),
        ("depth --z 3m --focal 900 --baseline 0.12", "unit", "baseline 0.12 mm"),
        ("limits --preset boards --vergence -150", "nothing_shared", "no common point at any distance"),
        ("limits --preset boards --z 50mm", "nothing_shared", "nearest common point lies at Z = 84.38 mm"),
    ],
)
def test_odd_input_is_remarked_on(
    calc: Any, words: str, code: str, says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    answer = calc(words)
    assert says in next(remark["text"] for remark in answer["remarks"] if remark["code"] == code)
    assert run(["calc", *words.split()]) == 0
    err = capsys.readouterr().err
    assert says in err
    assert all(line.startswith("rigsim: note: ") for line in err.splitlines())


def test_where_pixels_count_from_is_said(calc: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert calc(f"point {W1}")["uv_origin"] == "optical axis"
    assert calc(f"point {W1} --resolution 1280x960")["uv_origin"] == "first pixel"
    assert calc(f"point {W1} --principal 0,0")["uv_origin"] == "first pixel"
    assert run(["calc", "point", *W1.split()]) == 0
    assert "right of the left camera's axis, where u = 0" in capsys.readouterr().out


def test_digits_follow_the_error(capsys: pytest.CaptureFixture[str]) -> None:
    # Z^2 / (f B) sqrt(2) 0.0001 px = 0.0118 mm: near, Z and far differ in what is shown
    assert run(["calc", "depth", "--z", "3m", "--preset", "boards", "--noise", "0.0001"]) == 0
    shown = capsys.readouterr().out
    for name, value in (("Z", "3000.0000"), ("nearest depth", "2999.9882"), ("farthest depth", "3000.0118")):
        assert re.search(rf"^{name} +{value}  mm", shown, re.MULTILINE)


# --- limits ---


@pytest.mark.parametrize(
    ("words", "min_mm"),
    [
        # f B / 95 px: 882.5 * 75 / 95, and W = 640 px at 73 deg
        ("--preset oak-d", 882.5 * 75 / 95),
        ("--preset oak-d-lite", 320 / math.tan(math.radians(36.5)) * 75 / 95),
        ("--preset oak-d --disparities 1:128", 882.5 * 75 / 128),
        ("--preset boards", 900 * 120 / 128),
    ],
)
def test_a_preset_is_searched_as_published(calc: Any, words: str, min_mm: float) -> None:
    assert calc(f"limits {words}")["min_depth"] == pytest.approx(min_mm, rel=1e-9)


def test_a_calib_file_is_searched_as_it_says(calc: Any, tmp_path: Path) -> None:
    text = (
        "cam0=[1000 0 319.5; 0 1000 239.5; 0 0 1]\ncam1=[1000 0 319.5; 0 1000 239.5; 0 0 1]\n"
        "doffs=0\nbaseline=100\nwidth=640\nheight=480\nndisp=200\n"
    )
    (tmp_path / "calib.txt").write_text(text)
    answer = calc(f"limits --rig {tmp_path / 'calib.txt'}")
    assert answer["min_depth"] == pytest.approx(100_000 / answer["search_max_px"], rel=1e-12)
    assert answer["search_max_px"] > 150


def test_the_shift_that_reaches_a_range(calc: Any) -> None:
    # f B = 64 000 px mm: 300 mm is 213.33 px, 85.33 more than 128
    words = "limits --focal 640 --baseline 100 --resolution 1280x720"
    answer = calc(f"{words} --reach 0.3m")
    assert answer["shift_px"] == 86
    assert answer["min_depth"] == pytest.approx(64000 / 214, rel=1e-12)
    assert calc(f"{words} --shift 86")["min_depth"] == answer["min_depth"] <= 300
    assert calc(f"{words} --shift 85")["min_depth"] > 300
    assert calc(f"{words} --reach 1m")["shift_px"] == 0
    # to reach 2 m as well the least disparity may be 32 px at most
    assert calc(f"{words} --reach 0.45:2m --disparities 0:128")["shift_px"] == 15
    short = calc(f"{words} --reach 0.3:20m")
    assert (short["shift_px"], short["min_depth"], codes(short)) == (None, None, ["no_shift"])
    # 86 + 128 px down to 3.2 px, in whole shifts: 86 - 2 more than there are
    assert "takes 211 px of search, there are 127" in short["remarks"][0]["text"]


def test_limits_at_several_distances(calc: Any, capsys: pytest.CaptureFixture[str]) -> None:
    words = "limits --focal 640 --baseline 100 --resolution 1280x720"
    answer = calc(f"{words} --z 1,2m")
    assert [row["z"] for row in answer["at"]] == [1000, 2000]
    # f B / (Z W) = 0.05 and 0.025
    assert [row["overlap_share"] for row in answer["at"]] == pytest.approx([0.95, 0.975], rel=1e-12)
    assert answer["overlap_share"] is None
    one = calc(f"{words} --z 2m")
    assert one["overlap_share"] == one["at"][0]["overlap_share"] == pytest.approx(0.975, rel=1e-12)
    assert run(["calc", *f"{words} --z 1,2m --csv".split()]) == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert [float(row["overlap_share"]) for row in rows] == pytest.approx([0.95, 0.975], rel=1e-12)
    assert len({row["blind_zone"] for row in rows}) == 1


# --- forms ---


@pytest.mark.parametrize(
    "words",
    [
        f"point {W1}",
        "depth --focal 1200 --baseline 150 --resolution 640x480 --z 20",
        "limits --preset oak-d --z 1,3m",
        "limits --preset oak-d",
    ],
)
def test_keys_stand_in_the_order_of_the_model(calc: Any, words: str) -> None:
    assert misplaced(f"calc-{words.split()[0]}", calc(words)) == []


def test_a_published_whole_number_stays_one(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["calc", "limits", "--preset", "oak-d", "--json"]) == 0
    assert '"search_max_px": 95,' in capsys.readouterr().out


def test_csv_holds_the_numbers_of_json(calc: Any, capsys: pytest.CaptureFixture[str]) -> None:
    expected = calc(f"point {W1}")
    assert run(["calc", "point", *W1.split(), "--csv"]) == 0
    (row,) = csv.DictReader(io.StringIO(capsys.readouterr().out))
    for word in ("unit", "seen_by"):
        assert row.pop(word) == expected.pop(word)
    del expected["remarks"], expected["uv_origin"], expected["golden"]
    assert {key: float(value) for key, value in row.items()} == expected


def test_people_get_few_digits(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["calc", "point", *W1.split()]) == 0
    shown = capsys.readouterr().out
    assert "2571.4  mm    depth, in front of the left camera" in shown
    assert "2571.42" not in shown
    assert run(["calc", "point", *W1.split(), "--markdown"]) == 0
    assert "| Z | 2571.4 | mm | depth, in front of the left camera |" in capsys.readouterr().out


def test_plot_is_a_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "topdown.png"
    words = f"calc point --preset branch --left 900,500 --right 830,500 --plot {path} --json"
    assert run(words.split()) == 0
    assert path.read_bytes().startswith(b"\x89PNG")
    assert json.loads(capsys.readouterr().out)["disparity_px"] == 70.0
    assert [file.name for file in tmp_path.iterdir()] == ["topdown.png"]


def test_far_bound_beyond_infinity_is_said(calc: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert calc("depth --z 100m --focal 500 --baseline 100 --disparity-error 1")["depth_far"] is None
    assert run(["calc", "depth", "--z", "100m", "--preset", "bin"]) == 0
    shown = capsys.readouterr()
    assert "note: disparity 0.66 px is under 1.41 px, 4 times its noise" in shown.err


# --- what goes wrong ---

P = "--focal 1200 --baseline 150"
CALC = f"calc point {P} --left 9,1 --right 0,1"


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (
            f"calc point {P} --left 910,0 --right 980,0",
            1,
            "disparity -70 px: must be > 0; left and right swapped",
        ),
        (
            f"calc point {P} --left 910,0 --right 910,0",
            1,
            "disparity 0 px: must be > 0; the point is at infinity",
        ),
        (f"calc point {P} --vergence 5 --left 0,0 --right 300,0", 1, "do not meet in front of both cameras"),
        (f"calc point {P} --left 910 --right 0,0", 2, "left position 910: must be two numbers u,v"),
        (f"calc point {P} --left 910,1", 2, "missing option '--right'; see rigsim calc point --help"),
        (f"{CALC} --principal 5", 2, "principal point 5: must be two numbers"),
        (f"{CALC} --noise -1", 2, "noise -1 px: must be >= 0"),
        (f"{CALC} --disparity-error -1", 2, "disparity error -1 px: must be >= 0"),
        (f"{CALC} --json --csv", 2, "exclude each other"),
        (f"calc point {P} --left 1000,1e300 --right 0,1", 2, "must be between -1,000,000 and 1,000,000 px"),
        ("calc depth --z 0.2 --preset boards", 2, "depth 0.2: m or mm? Write the unit, as in 0.2m"),
        ("calc limits --z 1,3 --preset boards", 2, "m or mm? Write the unit"),
        ("calc limits --preset boards --reach 1m --shift 3", 2, "--reach finds the shift, give one"),
        (
            "calc limits --preset boards --vergence 5 --reach 1m",
            1,
            "disparity shift: the rig is not rectified",
        ),
        (
            "calc depth --z 3m --baseline 60 --focal 4 --pixel-pitch 3um",
            2,
            "focal length 4 is in px, and needs no --sensor-width or --pixel-pitch: write the unit, as in 4m",
        ),
        (
            "calc depth --z 3m --baseline 60 --focal 4px --sensor-width 6mm --resolution 64x48",
            2,
            "write the unit, as in 4mm",
        ),
        (
            "calc depth --z 3m --preset boards --focal 4mm --pixel-pitch 3um --sensor-width 9mm",
            2,
            "sensor width 9 mm: 1280 px of 3 um make 3.84 mm; give --sensor-width or --pixel-pitch",
        ),
        (f"{CALC} --plot x.png", 2, "--plot needs --resolution"),
        (f"{CALC} --resolution 64x48 --plot /nowhere/x.png", 1, "output file /nowhere/x.png: No such file"),
        ("calc depth --z 3m --focal 1200", 2, "--baseline is missing"),
        ("calc depth --z 3m --baseline 150", 2, "--focal or --hfov is missing"),
        ("calc depth --z 3m --baseline 0 --focal 1200", 2, "baseline 0 mm: must be > 0"),
        ("calc depth --z 3m --baseline -5 --focal 1200", 2, "baseline -5 mm: must be > 0"),
        ("calc depth --z 3m --baseline nan --focal 1200", 2, "baseline nan: must be a finite number"),
        ("calc depth --z 3m --baseline 150 --focal 0", 2, "focal length 0 px: must be > 0"),
        ("calc depth --z 3m --baseline 150 --focal 6mm", 2, "mm needs --sensor-width or --pixel-pitch"),
        ("calc depth --z 3m --baseline 150 --hfov 70", 2, "--hfov 70 needs --resolution"),
        ("calc depth --z 3m --baseline 150 --hfov 180 --resolution 64x48", 2, "must be < 180"),
        ("calc depth --z 3m --baseline 150 --hfov 70 --resolution 0x48", 2, "width and height must be >= 1"),
        ("calc depth --z 3m --baseline 50:500 --focal 1200", 2, "10 rigs given"),
        ("calc depth --z 0 --preset boards", 2, "depth 0 mm: must be > 0"),
        ("calc depth --z 3m --preset nix", 1, "unknown preset 'nix': choose one of boards, branch"),
        ("calc depth --z 3m --rig /nowhere/rig.toml", 1, "/nowhere/rig.toml: cannot be read"),
        ("calc depth --z 3m --rig a --preset boards", 2, "--rig and --preset"),
        (f"calc limits {P}", 2, "calc limits needs --resolution"),
        ("calc limits --preset boards --disparities 9:1", 2, "end 1 px must be > start 9 px"),
        ("calc limits --preset boards --disparities 1:9 --shift -20", 2, "must be > 0"),
        ("calc nix", 2, "no such command 'nix'"),
        ("nix", 2, "no such command 'nix'; see rigsim --help"),
        ("--nix", 2, "no such option"),
    ],
)
def test_slips_get_one_line(words: str, code: int, says: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(words.split()) == code
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err.startswith("rigsim: error: ")
    assert shown.err.count("\n") == 1
    assert says in shown.err


def test_version_and_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["--version"]) == 0
    assert capsys.readouterr().out == f"rigsim {__version__}\n"
    for words, title in (([], "Usage: rigsim"), (["-h"], "Usage: rigsim"), (["calc"], "Usage: rigsim calc")):
        assert run(words) == 0
        assert capsys.readouterr().out.startswith(title)


# --- the process ---


def test_an_interrupt_is_silent(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def interrupt(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("rigsim.cli.calc.calc.single_rig", interrupt)
    assert run(["calc", "depth", "--z", "3m", "--preset", "boards"]) == 130
    assert capsys.readouterr() == ("", "")


def test_a_bug_is_not_dressed_up_as_a_user_s_mistake(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("rigsim.cli.calc.calc.single_rig", fail)
    with pytest.raises(ZeroDivisionError):
        run(["calc", "depth", "--z", "3m", "--preset", "boards"])


def test_an_error_message_stays_on_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["calc", "depth", "--z", "3m\n?", "--preset", "boards"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize("words", [["--help"], ["calc", "point", *W1.split()]])
def test_a_reader_that_left_is_no_error(words: list[str]) -> None:
    code = "import sys; from rigsim.cli import main; sys.exit(main())"
    with subprocess.Popen(
        [sys.executable, "-c", code, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == ""
    assert process.returncode == 1
