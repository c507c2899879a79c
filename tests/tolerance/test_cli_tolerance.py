"""`rigsim tolerance` from the shell: what is printed, written, and refused."""

from __future__ import annotations

import csv
import json
import math
import re
from pathlib import Path
from typing import Any

import pytest

from rigsim.cli.app import run
from rigsim.interop.documents.tolerance.models import OfCalibration
from rigsim.study.tolerance.sensitivities import QUANTITIES

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "reference" / "tolerance.md").read_text(
    encoding="utf-8"
)
FEW = ["tolerance", "--rigs", "300", "--points", "60"]


def document(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, Any]:
    assert run([*FEW, "--json", *words]) == 0
    read = json.loads(capsys.readouterr().out)
    assert isinstance(read, dict)
    return read


def test_json_by_hand(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--class", "none", "--tolerance", "baseline=200um", "--depth-error", "1%@3m", "--no-recalibrate")
    said = document(capsys, *words, "--baseline", "120", "--range", "1:5m")
    # Z/B x 0.2 mm = 5 mm at 3 m; 30 mm are allowed, and 1.2 mm of baseline make them
    bounds = {"depth_error_mm": 30.0, "distance_mm": 3000.0, "row_px": None}
    assert said["required"] == bounds | {"statistic": "rms"}
    (row,) = said["quantities"]
    assert (row["quantity"], row["unit"], row["tolerance"]) == ("baseline_mm", "mm", pytest.approx(0.2))
    assert row["depth_error_mm"] == pytest.approx([5 / 3, 5.0, 25 / 3])
    assert row["common_mm"] == pytest.approx(-5.0)
    # noise of 0.25 px errs 9000 x 0.35355 / 108 = 29.47 mm with a bias of 0.29 mm, and 4 e / Z more of its
    # square where the rig reads e farther: e^2 + (4 x 868.8 / 3000 + 2 x 0.29) e = 900 - 868.8 at 4.785 mm
    assert row["needed_alone"] == pytest.approx(4.785 / 25 / 1.96, rel=0.01)
    none = {"recalibrated": None, "recalibrated_informed": None}
    assert said["yield_build_alone"] == {"as_built": 1.0, **none}
    # and nearer at -6.52 mm: of a normal of 5 mm 73.5 % lie between
    assert said["yield"]["as_built"] == pytest.approx(0.735, abs=0.02)
    assert said["depths"][1]["noise_mm"] == pytest.approx(29.46, rel=1e-3)
    assert [item["distance_mm"] for item in said["depths"]] == [1000.0, 3000.0, 5000.0]


def test_noise_that_leaves_nothing_for_the_build_is_said_first(capsys: pytest.CaptureFixture[str]) -> None:
    # 25 m^2 x sqrt(2) x 0.25 px / (1000 px x 0.15 m) = 58.9 mm at 5 m
    rig = ["--baseline", "150", "--focal", "1000", "--resolution", "1280x960", "--range", "1:5m"]
    words = ["tolerance", *rig, "--rigs", "200", "--points", "60", "--depth-error"]
    assert run([*words, "50mm@5m"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert said.startswith("Pixel noise alone takes the error at 5 m to 59 mm, 50 mm are asked for: ")
    assert run([*words, "150mm@5m"]) == 0
    assert "no build meets that" not in capsys.readouterr().out


def test_units_of_tolerances(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["yaw=6arcmin", "axial=0.1cm", "principal=+-2px", "k1-both=±1e-3", "time=100us", "temperature=5K"]
    options = [part for word in words for part in ("--tolerance", word)]
    said = document(capsys, "--class", "none", *options, "--no-recalibrate", "--speed", "2")
    found = {row["quantity"]: row["tolerance"] for row in said["quantities"]}
    forms = {row["quantity"]: row["form"] for row in said["quantities"]}
    assert {key for key, form in forms.items() if form == "bound"} == {"right_cx_px", "both_k1"}
    assert {row["source"] for row in said["quantities"]} == {"given"}
    assert found == pytest.approx(
        {
            "yaw_deg": 0.1,
            "axial_mm": 1.0,
            "right_cx_px": 2.0,
            "both_k1": 1e-3,
            "time_offset_ms": 0.1,
            "temperature_k": 5.0,
        }
    )
    by_key = {row["quantity"]: row for row in said["quantities"]}
    # 2 m/s x 0.1 ms = 0.2 mm of baseline; B = 0.12 m, Z = 5 m
    assert by_key["time_offset_ms"]["common_mm"] == pytest.approx(0.2 * 5 / 0.12)


def test_a_time_offset_takes_every_motion(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--class", "none", "--tolerance", "time=1ms", "--no-recalibrate", "--rigs", "100")
    turned = document(capsys, *words, "--turn-rate", "1rad/s")
    assert turned["motion"] == {
        "speed_m_s": 0.0,  # 1 m/s only where nothing else is said
        "forward_speed_m_s": 0.0,
        "turn_rate_deg_s": pytest.approx(math.degrees(1)),
        "moving": "object",
    }
    # 1 mrad shifts the middle of the picture by 0.9 px: 5 m x 5 m x 0.9 px / 108 m px, and more beside it
    (row,) = turned["quantities"]
    assert -260 < row["common_mm"] < -209
    carried = document(capsys, *words, "--speed", "3.6km/h", "--moving", "rig")
    assert carried["quantities"][0]["common_mm"] == pytest.approx(-5 / 0.12)
    assert document(capsys, *words)["quantities"][0]["common_mm"] == pytest.approx(5 / 0.12)
    assert run(["tolerance", *words, "--forward-speed", "-2", "--turn-rate", "30"]) == 0
    says = (
        "During a time offset the object moves at -2 m/s straight ahead, and the rig turns right at 30 deg/s."
    )
    assert says in " ".join(capsys.readouterr().out.split())


def test_a_motion_without_a_time_offset_is_remarked_on(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--class", "none", "--tolerance", "yaw=0.1", "--no-recalibrate", "--rigs", "100")
    said = document(capsys, *words, "--turn-rate", "30")
    assert said["motion"] is None
    assert [remark["code"] for remark in said["remarks"]] == ["no_time_offset"]
    assert document(capsys, *words)["remarks"] == []


def test_recalibration_helps(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--class", "calibrated", "--depth-error", "36mm@3m")
    said = document(capsys, *words)
    assert said["yield"]["as_built"] < 0.4
    assert said["yield"]["recalibrated"] > said["yield"]["as_built"] + 0.2
    assert said["yield"]["recalibrated"] < said["yield_build_alone"]["recalibrated"]
    assert {row["quantity"] for row in said["quantities"][:2]} == {"left_cx_px", "right_cx_px"}
    # who knows the tolerances beforehand does better: that is told beside, not in front
    assert said["depths"][1]["informed_p50_mm"] < 0.9 * said["depths"][1]["recalibrated_p50_mm"]
    assert said["recalibration"]["averaged_noise_px"] == pytest.approx(0.25 / 10**0.5)
    # one picture of a dozen features and worse pixels leave more
    session = "--recalibration-features 12 --recalibration-pictures 1 --noise 0.5 --length-std 2mm"
    poor = document(capsys, *words, *session.split())
    assert poor["recalibration"]["features"] == 12
    assert poor["recalibration"]["pictures"] == 1
    assert poor["recalibration"]["length_std_mm"] == 2.0
    assert poor["depths"][1]["recalibrated_p50_mm"] > 1.5 * said["depths"][1]["recalibrated_p50_mm"]


def test_sobol_indices_stand_beside_the_first_order(capsys: pytest.CaptureFixture[str]) -> None:
    said = document(capsys, "--class", "calibrated", "--depth-error", "40mm@3m")
    for row in said["quantities"]:
        assert row["sobol_first"] == pytest.approx(row["variance_share"], abs=0.03)
        assert row["sobol_total"] == pytest.approx(row["variance_share"], abs=0.03)
    assert said["interactions"]["noticed"] == []
    lost = document(capsys, "--class", "printed", "--range", "1:5m")
    assert lost["quantities"][0]["sobol_first"] is None
    assert lost["interactions"]["says"].startswith("No Sobol indices at 5 m")


def test_sources_and_estimates_are_told(capsys: pytest.CaptureFixture[str]) -> None:
    said = document(capsys, "--tolerance", "roll=0.1")
    source = {row["quantity"]: row["source"] for row in said["quantities"]}
    assert source["yaw_deg"] == "ISO 2768-m"
    assert source["roll_deg"] == "given"
    assert source["right_k1"] == "estimate"
    assert run([*FEW, "--no-recalibrate"]) == 0
    rows = capsys.readouterr().out.splitlines()
    assert any(line.startswith("yaw ") and line.endswith("ISO 2768-m") for line in rows)
    assert any(line.startswith("right k1 ") and line.endswith("estimate") for line in rows)


def test_a_folder_and_a_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rig = tmp_path / "rig.toml"
    rig.write_text("baseline_mm = 100\nwidth_px = 640\nheight_px = 480\nfocal_px = 500\n", encoding="utf-8")
    folder = tmp_path / "out"
    words = ["--rig", str(rig), "--out", str(folder), "--distribution", "uniform"]
    assert run([*FEW, *words]) == 0
    said = capsys.readouterr().out
    assert "±" in said
    assert "Each quantity alone" in said
    assert re.search(r"% of the rigs meet the requirement as built, [\d.]+ % after recalibration", said)
    assert {path.name for path in folder.iterdir()} == {
        "tolerance.csv",
        "tolerance.json",
        "tolerance.png",
        "places.png",
    }
    rows = list(csv.DictReader((folder / "tolerance.csv").read_text(encoding="utf-8").splitlines()))
    written = json.loads((folder / "tolerance.json").read_text(encoding="utf-8"))
    assert [row["quantity"] for row in rows] == [row["quantity"] for row in written["quantities"]]
    assert float(rows[0]["depth_error_at_5000_mm"]) == pytest.approx(
        written["quantities"][0]["depth_error_mm"][2]
    )
    idle = {row["quantity"]: row for row in rows}["vertical_mm"]
    assert idle["needed_alone"] == ""
    for name in ("tolerance.png", "places.png"):
        assert (folder / name).read_bytes().startswith(b"\x89PNG")
    # once more into the same folder is refused
    assert run([*FEW, *words]) == 1


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--class", "welded"], "class 'welded': choose one of printed, machined, calibrated, none"),
        (["--class", "none"], "tolerances: all are 0"),
        (["--tolerance", "yaw=-1"], "tolerance yaw -1 deg: must be >= 0"),
        (["--tolerance", "yaw=1mm"], "tolerance yaw 1mm: unknown unit 'mm'"),
        (["--tolerance", "yaw"], "tolerance yaw: must be NAME=VALUE, as in yaw=0.05deg"),
        (["--tolerance", "tilt=1"], "tolerance 'tilt': choose one of yaw, pitch"),
        (["--tolerance", "yaw=1", "--tolerance", "yaw=2"], "tolerance yaw: given twice"),
        (["--depth-error", "10@3m"], "depth error 10@3m: of what unit?"),
        (["--depth-error", "10mm@3"], "depth error 10mm@3: of what unit?"),
        (["--depth-error", "120%"], "depth error 120%: must be < 100 %"),
        (["--depth-error", "0mm"], "depth error 0 mm: must be > 0"),
        (["--range", "1:5"], "range 1:5: m or mm?"),
        (["--range", "0:5m"], "depth 0 mm: must be > 0"),
        (["--range", "0.01:5m"], "depth 10 mm: no point there is in both images"),
        (["--distribution", "flat"], "distribution 'flat': choose one of normal, uniform"),
        (["--rigs", "0"], "rigs 0: must be >= 2"),
        (["--points", "3"], "points 3: must be >= 12"),
        (["--length-std", "0"], "known length's std 0 mm: must be > 0"),
        (["--tolerance", "yaw=+--1"], "tolerance yaw -1 deg: must be >= 0"),
        (["--tolerance", "focal=1mm"], "tolerance focal 1mm: unknown unit 'mm'; write one of px"),
        (["--tolerance", "temperature=5C"], "tolerance temperature 5C: unknown unit 'C'; write one of K"),
        (["--tolerance", "yaw=nan"], "tolerance yaw nan: must be a finite number"),
        (["--depth-error=-1mm"], "depth error -1 mm: must be > 0"),
        (["--depth-error", "0%"], "required depth error 0 mm: must be > 0"),
        (["--depth-error", "10mm@0m"], "depth 0 mm: must be > 0"),
        (["--range", "5:1m"], "depth 5:1m: end 1000 mm must be > start 5000 mm; swap them"),
        (["--recalibration-features", "7"], "recalibration features 7: must be >= 8"),
        (["--recalibration-features", "5000"], "recalibration features 5000: must be <= 1000"),
        (["--recalibration-pictures", "0"], "recalibration pictures 0: must be >= 1"),
        (["--noise=-1"], "noise -1 px: must be >= 0"),
        (["--speed=-1"], "speed -1 m/s: must be >= 0"),
        (["--moving", "car"], "moving 'car': choose one of rig, object"),
    ],
)
def test_slips_are_one_line_and_leave_nothing(
    words: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["tolerance", "--out", str(tmp_path / "out"), *words]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert message in said.err
    assert said.err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_the_page_holds_every_key_and_quantity(capsys: pytest.CaptureFixture[str]) -> None:
    said = document(capsys)
    keys = {
        *said,
        *said["quantities"][0],
        *said["depths"][0],
        *said["rig"],
        *said["required"],
        *said["yield"],
        *said["rows"],
        *said["interactions"],
        *said["recalibration"],
        *OfCalibration.model_fields,
    }
    documented = set(re.findall(r"`([\w.]+)`", PAGE))
    assert keys <= documented
    assert set(QUANTITIES) <= documented


def test_the_pages_table_is_what_is_printed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "110")
    (command,) = re.findall(r"^\./run (tolerance .*)$", PAGE, re.MULTILINE)
    (shown,) = re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL)
    assert run(command.split()) == 0
    printed = capsys.readouterr().out
    assert [line.rstrip() for line in printed.strip().splitlines()] == shown.strip().splitlines()
