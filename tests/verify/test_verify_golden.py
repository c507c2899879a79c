"""Golden results: what moved, by how much, and whether that is more than noise."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rigsim.cli.app import run
from rigsim.errors import OutputError
from rigsim.interop.files.golden import read_golden, write_golden
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.sim.scenes import library
from rigsim.sim.simulator import Simulator
from rigsim.study.golden.compare import Number, Record, compare
from rigsim.study.verify import session
from rigsim.study.verify.golden import scene_record, triangulator_record
from rigsim.study.verify.rendered import scene_rig
from rigsim.study.verify.runner import verify
from rigsim.study.verify.suite import synthetic_cases
from rigsim.theory.custom import TriangulatorFunction
from rigsim.theory.triangulation import METHODS, triangulate
from tests.helpers.documents import valid
from tests.helpers.verify_results import quick

ABOUT = {"rigsim": "0.1.0", "mujoco": "4.0.0", "seed": "0"}


def record(*numbers: Number, **about: str) -> Record:
    return Record("scene-x", {**ABOUT, **about}, numbers)


@pytest.mark.parametrize(
    ("then", "now", "verdict"),
    [
        (Number("z", 2.0, "m", 1e-9), Number("z", 2.0, "m", 1e-9), "same"),
        (Number("z", 2.0, "m", 1e-9), Number("z", 2.0 + 5e-10, "m", 1e-9), "within tolerance"),
        (Number("z", 2.0, "m", 1e-9), Number("z", 2.0 + 2e-9, "m", 1e-9), "moved"),
        (Number("e", 10.0, "mm", 0, 0.3), Number("e", 10.0 + 9e-6, "mm", 0, 0.3), "within tolerance"),
        (Number("e", 10.0, "mm", 0, 0.3), Number("e", 10.0 + 2e-5, "mm", 0, 0.3), "moved"),
        (Number("z", np.nan, "m", 1e-9), Number("z", np.nan, "m", 1e-9), "same"),
        (Number("z", np.nan, "m", 1e-9), Number("z", 3.0, "m", 1e-9), "moved"),
    ],
)
def test_a_number_has_moved_when_it_left_its_tolerance_or_its_noise(
    then: Number, now: Number, verdict: str
) -> None:
    comparison = compare([record(then)], [record(now)])
    assert [move.verdict for move in comparison.moves] == [verdict]
    assert comparison.passed == (verdict != "moved")


@pytest.mark.parametrize(("now", "verdict"), [(11.4, "within noise"), (11.6, "moved")])
def test_another_seed_may_differ_by_noise(now: float, verdict: str) -> None:
    # 3 sqrt(0.3^2 + 0.4^2) = 1.5
    then, today = Number("e", 10.0, "mm", 0, 0.3), Number("e", now, "mm", 0, 0.4)
    comparison = compare([record(then, seed="1")], [record(today)])
    assert [move.verdict for move in comparison.moves] == [verdict]


def test_new_and_lost_numbers_and_other_versions_are_told() -> None:
    before = record(Number("a", 1.0, "m"), Number("b", 2.0, "m"), mujoco="3.9.0")
    now = record(Number("b", 2.0, "m"), Number("c", 3.0, "m"))
    comparison = compare([before], [now])
    assert {move.number: move.verdict for move in comparison.moves} == {"a": "gone", "b": "same", "c": "new"}
    assert comparison.remarks == ("scene-x: mujoco was 3.9.0, now 4.0.0",)
    assert not comparison.passed


def test_a_scene_is_recorded_the_same_twice_and_a_moved_camera_shows() -> None:
    rig = scene_rig("boards")
    with Simulator("boards") as simulator:
        first, again = (scene_record(simulator, rig, ABOUT) for _ in range(2))
        other = replace(rig, left=replace(rig.left, cx=rig.left.cx + 0.5))
        shifted = scene_record(simulator, other, ABOUT)
        # the middle of the picture, by hand: the rig stands 5 m from the wall, boards before it
        depths = [number.value for number in first.numbers if number.unit == "m"]
    assert compare([first], [again]).count("same") == len(first.numbers)
    assert max(depths) == pytest.approx(5.0, abs=1e-9)
    assert compare([first], [shifted]).count("moved") > 3


def test_files_come_back_as_they_were(tmp_path: Path) -> None:
    cases = list(synthetic_cases("quick", 0))[:12]
    records = [triangulator_record(result, ABOUT) for result in verify(cases, METHODS)]
    write_golden(tmp_path, records)
    read, troubles = read_golden(tmp_path, [record.name for record in records])
    assert troubles == []
    assert compare(read, records).count("same") == sum(len(record.numbers) for record in records)
    assert [dict(record.about) for record in read] == [ABOUT] * len(records)


def test_a_triangulator_that_grew_worse_has_moved_and_another_seed_has_not() -> None:
    def worse(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
        return triangulate(rig, uv_left, uv_right) * (1, 1, 1.01)

    def records(function: TriangulatorFunction, seed: int) -> list[Record]:
        cases = list(synthetic_cases("quick", seed))[:12]
        return [
            triangulator_record(result, {**ABOUT, "seed": str(seed)})
            for result in verify(cases, {"mine": function})
        ]

    golden = records(METHODS["optimal"], 0)
    assert compare(golden, records(METHODS["optimal"], 7)).passed
    moved = [move.number for move in compare(golden, records(worse, 0)).moves if move.verdict == "moved"]
    assert "near noisy, depth RMS" in moved


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (lambda text: text.replace("1.5", "1.6"), "does not fit its checksum"),
        (lambda text: text[: len(text) // 2], "checksum, is missing"),
        (lambda text: "", "checksum, is missing"),
    ],
)
def test_edited_or_cut_files_are_told_in_one_line(
    spoil: Callable[[str], str], says: str, tmp_path: Path
) -> None:
    (path,) = write_golden(tmp_path, [record(Number("a", 1.5, "m"))])
    path.write_text(spoil(path.read_text()))
    read, (trouble,) = read_golden(tmp_path, ["scene-x"])
    assert read == []
    assert says in trouble
    assert "\n" not in trouble


def test_a_missing_folder_is_told(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="does not exist; make it with rigsim verify --update"):
        read_golden(tmp_path / "none", ["scene-x"])


def test_the_repository_s_golden_results_hold(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(session, "gather", lambda *_: quick())
    golden = Path(__file__).resolve().parents[2] / "reports" / "golden"
    code = run(["verify", "--triangulator", "optimal,dlt,midpoint,cv2,rectified", "--golden", str(golden)])
    said = capsys.readouterr().out
    assert code == 0, said
    assert "Without a golden value" not in said


def test_update_writes_what_the_next_run_is_held_to(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(library, "names", lambda: ["bin"])
    folder = str(tmp_path / "golden")
    assert run(["verify", "--update", "--golden", folder]) == 0
    assert "Wrote 2 golden files" in capsys.readouterr().out
    held = ["verify", "--golden", folder, "--cases", "near,bin", "--scene", "bin"]
    assert run([*held, "--json"]) == 0
    golden = valid("verify", capsys.readouterr().out)["golden"]
    assert (golden["folder"], golden["passed"], golden["moves"]) == (folder, True, [])
    assert golden["counts"]["same"] > 5
    path = tmp_path / "golden" / "triangulator-optimal.csv"
    old = Record("triangulator-optimal", ABOUT, (Number("near noisy, depth RMS", 9.9, "mm", 0, 0.01),))
    write_golden(path.parent, [old])
    assert run(held) == 3
    said = capsys.readouterr().out
    assert "seed was" not in said
    assert any(
        line.split()[0] == "triangulator-optimal" and line.endswith("moved") and "9.90 mm" in line
        for line in said.splitlines()
        if line
    )


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--golden", "nowhere"], "golden folder nowhere: does not exist; make it with"),
        (["--update", "--cases", "near"], "golden results hold every case"),
    ],
)
def test_golden_options_that_cannot_be(
    words: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["verify", *words]) in (1, 2)
    assert says in capsys.readouterr().err
