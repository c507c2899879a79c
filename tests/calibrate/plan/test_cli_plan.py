"""`rigsim calibrate plan` as people call it: answers, files, documents, and one line where it cannot be."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rigsim
from rigsim.errors import CalibrationUndetermined, InvalidRange
from rigsim.interop.files.covariance import read_covariance
from tests.helpers.cli import rigsim as run
from tests.helpers.documents import misplaced, valid

PLAN = ("calibrate", "plan", "--preset", "oak-d", "--board", "9x6@30mm")
QUICK = (*PLAN, "--poses", "6", "--at", "1,2m", "--depth-error", "30mm@2m")
FILES = [
    *("covariance.json", "plan.html", "plan.json", "plan.png"),
    *("poses.json", "poses.png", "projection.png"),
]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    folder = tmp_path_factory.mktemp("plan")
    done = run(*QUICK, "--out", "out", "--json", cwd=folder)
    assert done.returncode == 0, done.stderr
    return folder / "out", valid("calibrate-plan", done.stdout)


def test_the_document_has_the_promised_words(made: tuple[Path, dict[str, Any]]) -> None:
    _, document = made
    assert misplaced("calibrate-plan", document) == []
    assert [list(row) for row in document["depth_std"]] == [
        ["z_m", "calibration_mm", "observation_mm", "joint_mm"]
    ] * 2
    for row in document["depth_std"]:
        # pixel noise alone, by hand: sqrt(2) 0.25 px z^2 / (f b)
        assert row["observation_mm"] == pytest.approx(
            math.sqrt(2) * 0.25 * row["z_m"] ** 2 / (882.5 * 0.075) * 1e3, rel=1e-3
        )
        assert row["joint_mm"] == pytest.approx(math.hypot(row["calibration_mm"], row["observation_mm"]))
    needed = document["pictures_needed"]
    curve = {point["pictures"]: point["joint_mm"] for point in document["curve"]}
    assert curve[needed] <= 30 < (curve.get(needed - 1) or math.inf)
    assert len(document["poses"]) == document["pictures"] == 6
    assert len(document["next_pose"]["left_from_board"]) == 6
    assert 0 < document["next_pose"]["gain"] < 1
    assert document["written"]["files"] == FILES


def test_the_files_hold_what_was_said(made: tuple[Path, dict[str, Any]]) -> None:
    folder, document = made
    assert sorted(path.name for path in folder.iterdir()) == FILES
    plan = json.loads((folder / "plan.json").read_text())
    assert {**plan, "written": None} == {**document, "written": None}
    for name in ("plan.json", "covariance.json"):
        covariance = read_covariance(folder / name)
        std = covariance.depth_std([[0, 0, 2.0]])[0] * 1e3
        assert std == pytest.approx(document["depth_std"][1]["calibration_mm"], rel=1e-9)
    for name in ("plan", "poses", "projection"):
        assert (folder / f"{name}.png").read_bytes().startswith(b"\x89PNG")


def test_its_poses_read_back_give_the_same_depths(made: tuple[Path, dict[str, Any]]) -> None:
    folder, document = made
    done = run(*PLAN, "--poses", "poses.json", "--at", "1,2m", "--json", cwd=folder)
    again = valid("calibrate-plan", done.stdout)
    assert not again["best_first"]
    assert again["asked"]["poses"] is None
    for was, now in zip(document["depth_std"], again["depth_std"], strict=True):
        assert now == pytest.approx(was, rel=1e-6)


def test_people_get_the_answer_first(tmp_path: Path) -> None:
    done = run(*QUICK, cwd=tmp_path)
    assert done.stdout.startswith("6 pictures of the 9x6 board of 30 mm squares give ")
    assert "enough for 30 mm" in " ".join(done.stdout.split())
    assert "plan/plan.html" in done.stdout
    assert not list(tmp_path.iterdir())


def test_the_same_seed_is_the_same_plan(made: tuple[Path, dict[str, Any]], tmp_path: Path) -> None:
    _, document = made
    again = valid("calibrate-plan", run(*QUICK, "--json", cwd=tmp_path).stdout)
    assert again["poses"] == document["poses"]
    other = valid("calibrate-plan", run(*QUICK, "--seed", "1", "--json", cwd=tmp_path).stdout)
    assert other["poses"] != document["poses"]


def test_boards_without_tilt_are_explained_and_not_inverted(tmp_path: Path) -> None:
    done = run(*PLAN, "--tilt", "0", "--out", "out", "--json", cwd=tmp_path)
    assert done.returncode == 1
    document = json.loads(done.stdout)
    assert document["reason"] == "no_tilt"
    assert done.stderr == f"rigsim: error: {document['error']}\n"
    assert not (tmp_path / "out").exists()
    plain = run(*PLAN, "--tilt", "0", cwd=tmp_path)
    assert (plain.returncode, plain.stdout, plain.stderr) == (1, "", done.stderr)


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        ("--board 6", 2, "board '6': must be COLSxROWS@SQUARE, as 9x6@30mm"),
        ("--board 9x6", 2, "board '9x6': must be COLSxROWS@SQUARE"),
        ("--board 9x6@0mm", 2, "board's square 0 mm: must be > 0"),
        ("--board 9x6@30furlong", 2, "unknown unit 'furlong'"),
        ("--board 2x6@30mm", 2, "board of 2 columns"),
        ("--board 9x6@300mm", 2, "never fits both views"),
        ("--poses 0", 2, "0 poses: must be 2 to"),
        ("--poses 1", 2, "1 poses: must be 2 to"),
        ("--poses -4", 2, "-4 poses: must be 2 to"),
        ("--poses nofile.json", 1, "nofile.json: cannot be read"),
        ("--corner-noise -1", 2, "corner noise -1 px: must be > 0"),
        ("--corner-noise 99", 2, "corner noise 99 px: must be <= 10 px"),
        ("--at 1e9m", 2, "depth 1e+09 m: must be <= 10 km"),
        ("--board 9x6@0.1mm", 2, "squares too small (0.22 px at 400 mm"),
        ("--corner-noise 0", 2, "corner noise 0 px: must be > 0"),
        ("--noise -1", 2, "noise -1 px: must be >= 0"),
        ("--at 0", 2, "depth 0 mm: must be > 0"),
        ("--at 1,2", 2, "m or mm?"),
        ("--tilt 120deg", 2, "tilt 120 deg: must be < 90"),
        ("--range 2:1m", 2, "end 1000 mm must be > start 2000 mm"),
        ("--range 2:3", 2, "m or mm?"),
        ("--fix nonsense", 2, "fix 'nonsense': must be one of fx"),
        ("--fix k3,,k2", 2, "a name is empty"),
        ("--model nonsense", 2, "lens model 'nonsense': must be one of brown"),
        ("--depth-error 20", 2, "of what unit?"),
        ("--flatness -1mm", 2, "flatness -1 mm: must be >= 0"),
        ("--true-warp 1mm", 2, "add --verify"),
        ("--true-warp 1,2,3mm --simulate 10", 2, "must be one length, or two"),
    ],
)
def test_what_cannot_be_is_one_line_and_writes_nothing(
    words: str, code: int, says: str, tmp_path: Path
) -> None:
    done = run(*PLAN, *words.split(), "--out", "out", cwd=tmp_path)
    assert done.returncode == code
    assert says in done.stderr
    assert done.stderr.count("\n") == 1
    assert done.stdout == ""
    assert not list(tmp_path.iterdir())


def test_a_folder_in_use_is_refused_before_any_work(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "mine.txt").write_text("mine")
    done = run(*PLAN, "--out", "out", cwd=tmp_path)
    assert done.returncode == 1
    assert "out" in done.stderr
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["mine.txt"]


def test_python_takes_boards_poses_and_rigs_as_they_come(made: tuple[Path, dict[str, Any]]) -> None:
    folder, document = made
    rows = [pose["left_from_board"] for pose in document["poses"]]
    rig = rigsim.preset("oak-d").rig
    from_rows = rigsim.plan_calibration(rig, board=rigsim.Board(9, 6, 0.03), poses=np.array(rows), at_m=2)
    from_file = rigsim.plan_calibration("oak-d", poses=folder / "poses.json", at_m=[2.0])
    (one,), (other,) = (
        [row for row in found.plan.depths if row.place == "axis"] for found in (from_rows, from_file)
    )
    assert one.calibration_m == pytest.approx(other.calibration_m, rel=1e-6)
    assert one.calibration_m * 1e3 == pytest.approx(document["depth_std"][1]["calibration_mm"], rel=1e-6)
    assert from_rows.verdict is None
    assert list(from_rows.table.columns[:4]) == ["z_m", "calibration_mm", "observation_mm", "joint_mm"]
    assert "9x6 board" in from_rows._repr_html_()


def test_python_refuses_in_one_line() -> None:
    call: Any = rigsim.plan_calibration
    for given in (
        {"board": 9},
        {"board": "9x6"},
        {"poses": "word"},
        {"poses": []},
        {"poses": [[1, 2]]},
        {"poses": True},
        {"range_m": (1,)},
        {"tilt_deg": "steep"},
        {"at_m": []},
        {"model": 3},
        {"fix": "k9"},
        {"depth_error_pct": 200},
        {"depth_error_mm": 3, "depth_error_pct": 1},
    ):
        with pytest.raises(rigsim.RigsimError) as told:
            call("oak-d", **given)
        assert "\n" not in str(told.value), given


def test_one_error_has_a_reason_in_python_too() -> None:
    with pytest.raises(CalibrationUndetermined) as told:
        rigsim.plan_calibration("oak-d", tilt_deg=0)
    assert told.value.reason == "no_tilt"
    with pytest.raises(InvalidRange, match="1 poses"):
        rigsim.plan_calibration("oak-d", poses=1)


def test_a_leaner_model_has_fewer_parameters_and_what_is_held_is_told(tmp_path: Path) -> None:
    words = (*QUICK, "--fix", "k3,right.p1", "--fix", "aspect", "--json")
    document = valid("calibrate-plan", run(*words, cwd=tmp_path).stdout)
    held = document["asked"]["held"]
    assert held == ["left.fy", "left.k3", "right.fy", "right.p1", "right.k3"]
    names = [one["name"] for one in document["parameters"]]
    assert len(names) == 24 - 5
    assert not set(names) & set(held)
