"""`rigsim design` as people type it."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from rigsim.cli.app import run
from rigsim.interop.formats.rig_toml import read_rig
from rigsim.theory.limits import overlap_at_depth
from tests.helpers.sampling import close

ASKED = ["--range", "0.5:3m", "--depth-error", "60mm@3m"]
pytestmark = pytest.mark.usefixtures("few_built_rigs")
SMALL = ["--resolution", "640x480", "--lens", "70deg"]


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")


def answer(capsys: pytest.CaptureFixture[str], *words: str, code: int = 0) -> dict[str, object]:
    assert run(["design", *words, "--json"]) == code
    document = json.loads(capsys.readouterr().out)
    assert isinstance(document, dict)
    return document


def test_a_verified_rig_with_its_files(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    words = [*ASKED, *SMALL, "--fov", "60deg", "--cover", "1m@2m"]
    assert run(["design", *words, "--out", "out"]) == 0
    printed = capsys.readouterr().out
    assert printed.startswith("Verified: ")
    assert "Report: out/design.html" in printed
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"rig.toml", "design.json", "design.html"}
    document = json.loads((tmp_path / "out" / "design.json").read_text())
    best = document["recommended"]
    assert best["verified"] is True
    rig = read_rig(tmp_path / "out" / "rig.toml")
    close([rig.baseline_m * 1e3, rig.left.fx], [best["baseline_mm"], best["focal_px"]], rtol=1e-9)
    assert (rig.left.width, rig.left.height) == (best["width_px"], best["height_px"]) == (640, 480)
    asked = {item["requirement"]: item for item in document["requirements"]}
    close(float(overlap_at_depth(rig, 0.5).fraction), asked["overlap"]["achieved"], rtol=1e-9)
    close(float(overlap_at_depth(rig, 2.0).width_m) * 1e3, asked["cover"]["achieved"], rtol=1e-9)
    assert asked["depth_error"]["points_n"] >= 100
    assert asked["depth_error"]["nearest_mm"] < asked["depth_error"]["farthest_mm"]
    assert (asked["overlap"]["points_n"], asked["fov"]["nearest_mm"]) == (0, None)
    close(asked["depth_error"]["simulated"], asked["depth_error"]["achieved"], rtol=0.03)
    page = (tmp_path / "out" / "design.html").read_text()
    assert "Verified by simulation" in page
    assert len(re.findall("<svg ", page)) == 4
    assert "<script" not in page
    assert not re.search(r'(src|href)="https?:', page)


def test_the_report_says_what_to_buy_and_what_to_hold(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    words = [*ASKED, "--sensor", "ov9282", "--lens", "4mm", "--noise", "0.25", "--no-proof"]
    assert run(["design", *words, "--class", "calibrated", "--out", "out"]) == 0
    printed = capsys.readouterr().out
    assert re.search(
        r"Yield with pixel noise, [\d, to]+ rigs per class \(%\), as built / recalibrated: "
        r"printed (?:< )?\d+ /",
        printed,
    )
    assert "Of calibrated rigs" in printed
    page = (tmp_path / "out" / "design.html").read_text()
    for said in ("OmniVision OV9282, 3.84 × 2.40 mm", "4 mm, image circle at least 4.5 mm", "Mounting"):
        assert said in page
    assert "Not verified: formulas only" in page
    badges = re.findall(r'<span class="badge (\w+)">[^<]* % of (\w+) rigs', page)
    enough = (
        "agrees"
        if json.loads((tmp_path / "out" / "design.json").read_text())["recommended"]["class_enough"]
        else "flagged"
    )
    assert [kind for kind, _ in badges] == [enough]
    assert not re.search(r"\d\.\d{7}", re.sub(r"<svg.*?</svg>|data:[^\"]*", "", page, flags=re.DOTALL))
    document = json.loads((tmp_path / "out" / "design.json").read_text())
    held = document["tolerance"]
    assert held["class"] == "calibrated"
    assert set(held["yield"]) == {"printed", "machined", "calibrated"}
    close([held["required"]["depth_error_mm"], held["required"]["distance_mm"]], [60, 3000])
    assert (document["noise_source"], document["noise_px"]) == ("given", 0.25)


def test_where_the_noise_comes_from(capsys: pytest.CaptureFixture[str]) -> None:
    sensor = ["--sensor", "mt9m031", "--binning", "2", "--lens", "4mm"]
    assert answer(capsys, *ASKED, *sensor, "--no-proof")["noise_source"] == "assumed"
    document = answer(capsys, *ASKED, *sensor)
    assert document["noise_source"] == "measured"
    assert "MT9M031" in str(document["noise_says"])
    assert isinstance(document["requirements"], list)
    error = document["requirements"][0]
    assert error["measured_n"] >= 30
    assert 0 < error["measured"] <= 60 * 1.3
    assert error["shown_by"] == "points"
    assert error["met"] is True


def test_overlap_may_be_asked_for_elsewhere(capsys: pytest.CaptureFixture[str]) -> None:
    lens = ["--lens", "1000px", "--resolution", "1280x960", "--noise", "0.25", "--no-proof"]
    document = answer(capsys, *ASKED, *lens, "--min-overlap", "90%@1m", "--min-overlap", "10%")
    asked = {
        item["at_mm"]: item["required"]
        for item in document["requirements"]
        if item["requirement"] == "overlap"
    }
    assert asked == {1000: 0.9, 500: 0.1}
    # 10 % of 1280 px at 1 m are 128 px of 1000: 128 mm
    close(document["feasible"][0]["baseline_max_mm"], 128, rtol=1e-9)


def test_by_hand(capsys: pytest.CaptureFixture[str]) -> None:
    # f 1000 px, sigma_d 0.5 px, 45 mm at 3 m: 9 x 0.5 / (1000 x 0.045) = 100 mm; 250 px at 0.5 m: 125 mm
    words = [
        "--range",
        "0.5:3m",
        "--lens",
        "1000px",
        "--resolution",
        "1280x960",
        "--noise",
        "0.3535533905932738",
    ]
    document = answer(capsys, *words, "--depth-error", "45mm", "--max-disparity", "250", "--no-proof")
    assert isinstance(document["feasible"], list)
    (only,) = document["feasible"]
    close([only["baseline_min_mm"], only["baseline_max_mm"]], [100, 125], rtol=1e-9)
    assert (only["binding_min"], only["binding_max"]) == ("depth_error", "max_disparity")
    assert isinstance(document["recommended"], dict)
    # half of the variance is the build's: sqrt(2) of 100 mm is past the interval's end, so the end less 5 %
    words += ["--prefer", "cheapest"]
    assert document["recommended"]["baseline_mm"] == 119
    assert document["recommended"]["verified"] is False
    limits = ["--depth-error", "45mm", "--max-disparity", "250", "--no-proof"]
    whole = answer(capsys, *words, *limits, "--build-share", "0%")
    assert isinstance(whole["recommended"], dict)
    assert whole["recommended"]["baseline_mm"] == 105


@pytest.mark.parametrize("text", ["1.5%", "1.5%@3m", "4.5cm", "p95:88.1983792543018mm@3m", "0.045m@300cm"])
def test_ways_to_say_the_same_depth_error(capsys: pytest.CaptureFixture[str], text: str) -> None:
    words = [
        "--range",
        "0.5:3m",
        "--lens",
        "1000px",
        "--resolution",
        "1280x960",
        "--noise",
        "0.3535533905932738",
    ]
    document = answer(capsys, *words, "--depth-error", text, "--no-proof")
    assert isinstance(document["feasible"], list)
    close(document["feasible"][0]["baseline_min_mm"], 100, rtol=1e-9)


def test_a_sensor_and_its_lenses(capsys: pytest.CaptureFixture[str]) -> None:
    words = [*ASKED, "--sensor", "imx264,OV9282", "--lens", "4,8mm", "--no-proof", "--max-pixels", "6MP"]
    document = answer(capsys, *words)
    assert document["cameras_tried"] == 4
    assert isinstance(document["feasible"], list)
    focal = {item["name"]: item["focal_px"] for item in document["feasible"]}
    close(focal["OV9282 with 4 mm"], 4 / 0.003, rtol=1e-9)
    close(focal["IMX264 with 8 mm"], 8 / 0.00345, rtol=1e-9)


@pytest.mark.parametrize(
    ("depth_range", "says"), [("50:90m", "scene boards"), ("4:12m", "`boards` has too few points near 12 m")]
)
def test_what_the_scene_cannot_show_is_not_shown(
    depth_range: str, says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--range", depth_range, "--depth-error", "5%", "--scene", "boards", *SMALL]
    document = answer(capsys, *words, "--measure", "none", code=3)
    best, asked = document["recommended"], document["requirements"]
    assert isinstance(best, dict)
    assert isinstance(asked, list)
    assert best["verified"] is False
    assert says in best["reason"]
    # nothing there shows the depth error; what both cameras see is known without points
    told = {item["requirement"]: (item["verdict"], item["met"], item["simulated"]) for item in asked}
    assert told["depth_error"] == ("not_shown", False, None)
    assert told["overlap"][:2] == told["far_disparity"][:2] == ("met", True)
    assert run(["design", *words, "--measure", "none", "--out", "out"]) == 3
    printed = capsys.readouterr().out
    (row,) = [line for line in printed.splitlines() if line.startswith("depth error at")]
    assert row.endswith("–  not shown")
    assert printed.startswith("Recommended, not verified: ")


def test_verified_elsewhere_is_never_said_bare(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    # the back wall of `boards` is 5 m away: within a factor of 2 of 7 m, and beyond 1.25
    words = ["--range", "4:7m", "--depth-error", "10%", "--scene", "boards", "--measure", "none", *SMALL]
    assert run(["design", *words, "--out", "out"]) == 0
    where = "at 5 m (asked for at 7 m)"
    printed = capsys.readouterr().out
    assert printed.startswith(f"Verified {where}: ")
    assert f"  Verified {where}: simulated in boards on 100 points there, " in printed
    document = json.loads((tmp_path / "out" / "design.json").read_text())
    assert document["recommended"]["reason"].startswith(f"verified {where}: simulated in `boards` on")
    assert document["proof"][-1]["scene"] == "boards"
    assert f"✓ Verified by simulation {where}</span>" in (tmp_path / "out" / "design.html").read_text()
    # in a scene made for it the same is verified where it was asked for
    made = [word for word in words if word not in ("--scene", "boards")]
    assert run(["design", *made, "--out", "made"]) == 0
    printed = capsys.readouterr().out
    assert printed.startswith("Verified: ")
    assert "Verified: simulated in a scene made for 4 to 7 m on" in printed
    document = json.loads((tmp_path / "made" / "design.json").read_text())
    assert document["proof"][-1]["scene"] == "a scene made for 4 to 7 m"
    assert "in a scene made for 4 to 7 m" in document["recommended"]["reason"]
    assert document["requirements"][0]["nearest_mm"] >= 7000 / 1.25


def test_preference_changes_the_pick(capsys: pytest.CaptureFixture[str]) -> None:
    picks = {
        prefer: answer(capsys, *ASKED, "--prefer", prefer, "--no-proof")["recommended"]
        for prefer in ("smallest", "cheapest", "most-accurate")
    }
    small, cheap, fine = picks.values()
    assert isinstance(small, dict)
    assert isinstance(cheap, dict)
    assert isinstance(fine, dict)
    assert small["baseline_mm"] < cheap["baseline_mm"] < fine["baseline_mm"]
    assert cheap["width_px"] < small["width_px"]
    assert fine["depth_error_far_mm"] < small["depth_error_far_mm"]


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (["--range", "0:3m", "--depth-error", "1%"], 2, "starts at 0"),
        (["--range", "0.5:3", "--depth-error", "1%"], 2, "m or mm"),
        (["--range", "3:0.5m", "--depth-error", "1%"], 2, "swap them"),
        (["--range", "0.5:3m", "--depth-error", "120%"], 2, "must be <= 100 %"),
        (["--range", "0.5:3m", "--depth-error", "0%"], 2, "must be > 0"),
        (["--range", "0.5:3m", "--depth-error", "10@3m"], 2, "mm or %"),
        (["--range", "0.5:3m", "--depth-error", "10mm@3"], 2, "Write the unit"),
        (["--range", "0.5:3m", "--depth-error", "10mm@4m"], 2, "outside the range"),
        (["--range", "0.5:3m"], 2, "--depth-error"),
        ([*ASKED, "--min-overlap", "100%"], 2, "< 100 %"),
        ([*ASKED, "--min-overlap", "80"], 2, "percent or share"),
        ([*ASKED, "--max-pixels", "2"], 2, "MP or px"),
        ([*ASKED, "--noise", "0"], 2, "must be > 0"),
        ([*ASKED, "--prefer", "best"], 2, "buildable, smallest, cheapest, most-accurate"),
        ([*ASKED, "--sensor", "imx999"], 1, "choose one of imx219"),
        ([*ASKED, "--lens", "2.8,4"], 1, "mm, px or deg"),
        ([*ASKED, "--lens", "4mm"], 2, "how large is a pixel"),
        ([*ASKED, "--sensor", "imx264", "--resolution", "6400x480"], 2, "only 2448x2048 px"),
        ([*ASKED, "--scene", "nowhere"], 1, "nowhere"),
        ([*ASKED, "--max-baseline", "1"], 1, "baseline limit from 1 mm to"),
        ([*ASKED, "--max-disparity", "10"], 1, "relax one: "),
        ([*ASKED, "--fov", "60deg", "--lens", "30deg"], 1, "field of view from 60° to 30°"),
        ([*ASKED, "--cover", "50m@3m"], 1, "coverage at 3 m >= 50 m"),
        ([*ASKED, "--nearest-focus", "0.6m"], 2, "nearer than the lenses focus, 0.6 m"),
        ([*ASKED, "--nearest-focus", "0.6"], 2, "Write the unit"),
        ([*ASKED, "--min-overlap", "80%@4m"], 2, "outside the range"),
        ([*ASKED, "--min-overlap", "80%@1"], 2, "Write the unit"),
        ([*ASKED, "--class", "cast"], 2, "printed, machined, calibrated"),
        ([*ASKED, "--sensor", "imx264,IMX264"], 2, "is given twice"),
        ([*ASKED, "--image-noise", "1,2"], 2, "takes one"),
        ([*ASKED, "--measure", "circles"], 2, "choose one of auto"),
        ([*ASKED, "--depth-error", "-5mm"], 2, "must be"),
        ([*ASKED, "--max-baseline", "-1"], 2, "must be > 0"),
    ],
)
def test_bad_input_is_one_line_and_writes_nothing(
    words: list[str], code: int, says: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert run(["design", *words, "--out", "out"]) == code
    error = capsys.readouterr().err.strip()
    assert says in error
    assert "\n" not in error
    assert list(tmp_path.iterdir()) == []
