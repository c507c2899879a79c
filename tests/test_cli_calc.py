"""`rigsim calc` as a user types it: others' worked examples, each with its source, and what goes wrong."""

from __future__ import annotations

import csv
import io
import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rigsim import __version__
from rigsim.cli.app import run
from rigsim.interop.rig_toml import write_rig
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig
from tests.documents import valid

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
    assert (1 - answer["overlap_fraction"]) * 1000 == pytest.approx(51.6, abs=0.05)
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
        "x", "y", "z", "disparity_px", "world_per_pixel", "depth_std", "depth_near", "depth_far", "unit",
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
    assert by_file == calc("depth --z 3m --preset branch")
    assert by_file == calc("depth --z 3m --focal 1200 --baseline 15cm --resolution 1280x960")
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


# --- forms ---


def test_csv_holds_the_numbers_of_json(calc: Any, capsys: pytest.CaptureFixture[str]) -> None:
    expected = calc(f"point {W1}")
    assert run(["calc", "point", *W1.split(), "--csv"]) == 0
    (row,) = csv.DictReader(io.StringIO(capsys.readouterr().out))
    assert row.pop("unit") == expected.pop("unit")
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

    monkeypatch.setattr("rigsim.cli.calc.single_rig", interrupt)
    assert run(["calc", "depth", "--z", "3m", "--preset", "boards"]) == 130
    assert capsys.readouterr() == ("", "")


def test_a_bug_is_not_dressed_up_as_a_user_s_mistake(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("rigsim.cli.calc.single_rig", fail)
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
