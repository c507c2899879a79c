"""`rigsim.sweep` in plain words, and what every result has."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import rigsim
from rigsim.api.kit.sweep_plan import SweepOptions, swept
from rigsim.api.result import Result
from rigsim.api.sweep import Sweep
from rigsim.errors import InvalidRange, OutputError, RigsimError
from rigsim.rig.sensor import Sensor

sweep: Any = rigsim.sweep  # a person's script is checked by nothing
SMALL = {"resolutions_px": (160, 100), "points": 60, "trials": 5, "renderer": "rays"}


@pytest.fixture(scope="module")
def small() -> Sweep:
    found = sweep(rig="oak-d", baselines_mm=[50, 100], scene="boards", **SMALL)
    assert isinstance(found, Sweep)
    return found


def test_words_are_the_same_sweep_as_a_plan(small: Sweep) -> None:
    # oak-d: 75 mm, 882.5 px on 1280x800, so 160 px wide it is 882.5 / 8 = 110.3125 px
    lens = rigsim.Intrinsics.from_focal(160, 100, 110.3125)
    rigs = [rigsim.StereoRig.rectified(lens, metres) for metres in (0.05, 0.1)]
    sensors = {"ideal, 2 grey": Sensor(grey_noise=2.0)}
    plan = rigsim.Plan(n_points=60, n_trials=5, renderer="rays", sensors=sensors)
    by_plan = rigsim.sweep(rigs, plan)
    assert by_plan.rows.equals(small.rows)
    assert small.table["baseline_mm"].tolist() == [50.0, 100.0]
    assert small.table["focal_px"].tolist() == [110.3125] * 2


def test_the_example_of_the_issue_has_what_it_asks_for() -> None:
    grid: Any = swept(SweepOptions("oak-d", baselines_mm=[50, 100]))
    assert [rig.baseline_m for rig in grid] == [0.05, 0.1]
    assert [(rig.left.width, rig.left.fx) for rig in grid] == [(1280, 882.5)] * 2


def test_a_result_has_table_verdict_figures_files_and_document(small: Sweep, tmp_path: Path) -> None:
    assert isinstance(small, Result | rigsim.SweepResult)
    assert small.table.columns.tolist() == small.rows.columns.tolist()
    assert small.table["agreement"].tolist() == ["agrees", "agrees"]
    assert [agreement.kind for agreement in small.rows["agreement"]] == ["agrees", "agrees"]
    assert small.verdict.headline == small.headline
    assert list(small.figures) == ["depth_error", "topdown"]  # rays measure nothing
    assert small.figure().axes
    assert small.figure("topdown").axes[0].get_xlabel()
    with pytest.raises(InvalidRange, match=r"figure 'pie': choose one of depth_error, topdown"):
        small.figure("pie")
    html = small._repr_html_()
    assert html.count("<tr") == 3  # heads and two rigs
    assert "baseline_mm" in html
    written = small.write(tmp_path / "out")
    assert written.files == sorted(path.name for path in (tmp_path / "out").iterdir())
    assert {"report.html", "sweep.csv", "rig.toml"} <= set(written.files)
    assert json.loads(small.to_json())["written"] is None
    document = json.loads(small.to_json(written))
    assert document["written"] == {"folder": str(tmp_path / "out"), "files": written.files}
    assert [row["baseline_mm"] for row in document["rows"]] == [50.0, 100.0]
    with pytest.raises(OutputError):
        small.write(tmp_path / "out")
    small.write(tmp_path / "out", force=True)


def test_it_prints_what_the_command_prints(small: Sweep, capsys: pytest.CaptureFixture[str]) -> None:
    small.print()
    assert " ".join(small.headline.replace("`", "").split())[:40] in " ".join(capsys.readouterr().out.split())


def test_a_file_brings_its_sensor_and_its_perturbation(tmp_path: Path) -> None:
    rig = rigsim.StereoRig.rectified(rigsim.Intrinsics.from_focal(160, 100, 110.0), 0.1)
    text = rigsim.write_rig(rig, sensor=Sensor(grey_noise=3.0)) + "\n[perturbation]\nyaw_deg = 0.5\n"
    path = tmp_path / "rig.toml"
    path.write_text(text)
    words = {"points": 60, "trials": 5, "renderer": "rays"}
    by_path, by_text = sweep(rig=path, **words), sweep(rig=text, **words)
    assert by_path.table["sensor"].tolist() == ["ideal, 3 grey"]
    # 0.5 deg of yaw is about 110 * 0.0087 = 0.96 px of disparity, far more than the noise of 0.25
    plain = sweep(rig=rig, **words)
    assert by_path.table["depth_rmse_mm"].iloc[0] > 2 * plain.table["depth_rmse_mm"].iloc[0]
    assert by_text.table.equals(by_path.table)
    with pytest.raises(InvalidRange, match=r"\[perturbation\] already"):
        sweep(rig=path, assume="oak-d", **words)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ({}, "no rig to sweep"),
        ({"plan": rigsim.Plan(), "rigs": "oak-d", "points": 10}, "a plan and points both given"),
        ({"rigs": rigsim.preset("oak-d").rig, "baselines_mm": 50}, "rigs and baselines_mm both given"),
        ({"rigs": "oak-d", "rig": "oak-d"}, "rigs and rig both given"),
        ({"rig": "oak-d", "hfovs_deg": 60, "focals_px": 500}, "give one"),
        ({"rig": "oak-d", "baselines_mm": "word"}, "baselines_mm 'word': must be a number"),
        ({"rig": "oak-e"}, "no preset has that name"),
        ({"rig": "oak-d", "sensor": 3}, "a sensor's name, or a Sensor"),
        ({"rig": "oak-d", "points": "many"}, "points 'many': must be a number"),
    ],
)
def test_what_cannot_be_is_one_line(words: dict[str, Any], says: str) -> None:
    with pytest.raises(RigsimError) as told:
        sweep(**words)
    assert says in str(told.value)
    assert "\n" not in str(told.value)


def test_a_word_that_is_none_is_told_by_python() -> None:
    with pytest.raises(TypeError, match="baseline_mm"):
        sweep(rig="oak-d", baseline_mm=50)
    assert "baselines_mm" in str(__import__("inspect").signature(rigsim.sweep))


def test_other_axes_and_isolation_are_said_as_well(tmp_path: Path) -> None:
    with pytest.raises(InvalidRange, match=r"axis 'colour': must be one of .*baseline"):
        sweep(rig="oak-d", more={"colour": 3}, **SMALL)
    with pytest.raises(InvalidRange, match="timeout 0 s: must be > 0"):
        sweep(rig="oak-d", timeout_s=0, **SMALL)
