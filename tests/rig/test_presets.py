"""Commercial cameras, by name: figures with sources, and rigs that follow from them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from rigsim.cli.app import run
from rigsim.errors import InvalidScene
from rigsim.rig.presets import PRESETS, preset
from rigsim.theory.limits import depth_range_for_disparities

BOUGHT = [name for name, item in PRESETS.items() if item.figures]


@pytest.fixture
def answer(capsys: pytest.CaptureFixture[str]) -> Any:
    def ask(*words: str) -> dict[str, Any]:
        capsys.readouterr()
        assert run([*words, "--json"]) == 0
        return dict(json.loads(capsys.readouterr().out))

    return ask


def test_every_camera_asked_for_is_there() -> None:
    assert set(BOUGHT) == {"oak-d", "oak-d-lite", "d405", "d415", "d435", "d455", "zed-2i", "zed-mini"}
    assert list(PRESETS)[:5] == ["boards", "branch", "artifact", "corridor", "bin"]


@pytest.mark.parametrize(
    ("name", "baseline_mm", "size", "focal_px"),
    [
        ("oak-d", 75, (1280, 800), 882.5),  # Luxonis stereo depth FAQ, word for word
        ("oak-d-lite", 75, (640, 480), 432.455),  # 320 / tan(36.5 deg)
        ("d405", 18, (1280, 720), 710.792),  # 640 / tan(42 deg)
        ("d415", 55, (1280, 720), 1004.597),  # 640 / tan(32.5 deg)
        ("d435", 50, (848, 480), 424.0),  # 424 / tan(45 deg)
        ("d455", 95, (848, 480), 446.796),  # 424 / tan(43.5 deg)
        ("zed-2i", 120, (1280, 720), 609.465),  # 640 / tan(46.4 deg)
        ("zed-mini", 63, (1280, 720), 700.0),  # Stereolabs help centre, word for word
    ],
)
def test_rigs_follow_from_the_first_figures(
    name: str, baseline_mm: float, size: tuple[int, int], focal_px: float
) -> None:
    rig = preset(name).rig
    assert rig.is_rectified
    assert rig.baseline_m == pytest.approx(baseline_mm / 1e3, rel=1e-15)
    assert (rig.left.width, rig.left.height) == size
    assert rig.left.fx == pytest.approx(focal_px, abs=1e-2)


@pytest.mark.parametrize("name", BOUGHT)
def test_every_figure_has_a_source_with_an_address(name: str) -> None:
    for figure in preset(name).figures:
        assert figure.value > 0
        assert "." in figure.source, figure
        assert "www." not in figure.source
        assert (figure.at_mm is not None) == (figure.quantity == "accuracy_pct")


@pytest.mark.parametrize("name", ["oak-d", "d405", "d415", "d455"])
def test_the_least_depth_is_what_baseline_lens_and_search_give(name: str) -> None:
    # three numbers of different origin against a fourth
    item = preset(name)
    search = item.first("max_disparity_px")
    assert search is not None
    nearest_m, _ = depth_range_for_disparities(item.rig, search, 0.0)
    assert nearest_m * 1e3 == pytest.approx(item.first("min_depth_mm"), rel=0.03)


@pytest.mark.parametrize(
    "typed", ["oak-d-lite", "OAK-D-LITE", "OAK-D Lite", "oak_d_lite", " Luxonis OAK-D Lite "]
)
def test_names_are_read_in_any_case(typed: str) -> None:
    assert preset(typed) is PRESETS["oak-d-lite"]


def test_makers_may_be_named() -> None:
    assert preset("Intel RealSense D435") is PRESETS["d435"]
    assert preset("Stereolabs ZED 2i") is PRESETS["zed-2i"]
    with pytest.raises(InvalidScene, match=r"unknown preset 'D999': choose one of boards, .*zed-mini"):
        preset("D999")


def test_contradictions_are_both_told(answer: Any) -> None:
    figures = answer("presets", "OAK-D")["figures"]
    fields = [figure["value"] for figure in figures if figure["quantity"] == "hfov_deg"]
    assert fields == [72, 80]
    claims = [
        (figure["value"], figure["at_mm"]) for figure in figures if figure["quantity"] == "accuracy_pct"
    ]
    assert claims == [(2, 4000), (4, 7000), (6, 10500)]


def test_what_rests_on_a_users_word_alone_says_so(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    hearsay = {
        (item.name, figure.quantity, figure.value)
        for item in PRESETS.values()
        for figure in item.figures
        if figure.hearsay
    }
    assert hearsay == {
        ("d435", "baseline_mm", 50),
        ("d435", "accuracy_pct", 2),
        ("d405", "accuracy_pct", 1.4),
    }
    # no figure says it in other words and escapes the mark
    for item in PRESETS.values():
        for figure in item.figures:
            assert figure.hearsay == ("user" in figure.source)
    assert run(["presets"]) == 0
    rows = {line.split()[0]: line for line in capsys.readouterr().out.splitlines() if line.strip()}
    assert " 50? " in rows["d435"]
    assert rows["d435"].endswith("0.5%@1m, 2%@2m?")
    assert "?" not in rows["d455"]


def test_figures_that_differ_by_mode_or_year_are_all_told(answer: Any) -> None:
    figures = answer("presets", "d405")["figures"]
    depths = [(figure["value"], figure["note"]) for figure in figures if figure["quantity"] == "min_depth_mm"]
    assert depths[:2] == [(100, "at 1280x720"), (70, "at 848x480")]
    claims = [
        (figure["value"], figure["at_mm"]) for figure in figures if figure["quantity"] == "accuracy_pct"
    ]
    assert claims == [(2, 500), (1.4, 200)]


def test_the_list_as_json_holds_what_each_says_alone(answer: Any) -> None:
    listed = answer("presets")["presets"]
    assert [item["name"] for item in listed] == list(PRESETS)
    assert listed[-1] == answer("presets", "zed-mini")
    assert listed[0]["min_depth_mm"] is None


def test_every_key_is_in_the_schema(answer: Any) -> None:
    schema = (Path(__file__).resolve().parents[2] / "docs" / "reference" / "presets.md").read_text()
    item = answer("presets", "d455")
    quantities = {figure["quantity"] for figure in item["figures"]}
    for key in (*item, *item["figures"][0], *quantities):
        assert f"`{key}`" in schema, key
    for name in BOUGHT:
        assert f"| {name} |" in schema, name


def test_other_commands_take_them(answer: Any) -> None:
    limits = answer("calc", "limits", "--preset", "OAK-D", "--disparities", "0:95")
    assert limits["min_depth"] == pytest.approx(882.5 * 75 / 95, rel=1e-12)


def test_tables_fit_a_terminal(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    assert run(["presets"]) == 0
    listed = capsys.readouterr().out
    assert all(len(line) <= 80 for line in listed.splitlines())
    assert all(name in listed for name in PRESETS)
    assert run(["presets", "d455"]) == 0
    shown = capsys.readouterr().out
    assert "least depth         340  mm" in shown
    assert "issues/9241" in shown
    assert run(["presets", "boards"]) == 0
    assert "Source: rigsim" in capsys.readouterr().out


def test_an_unknown_name_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["presets", "kinect"]) == 1
    assert (
        capsys.readouterr().err.splitlines()[0].startswith("rigsim: error: unknown preset 'kinect': choose")
    )
