"""Golden results of sweep, design, tolerance and calc: what moved is named, and noise is not."""

from __future__ import annotations

import csv
import hashlib
import math
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

import rigsim
from rigsim.cli import app
from rigsim.cli.app import run
from rigsim.errors import OutputError
from rigsim.interop.files.golden import read_one, write_one
from rigsim.study.golden.compare import Record, compare
from rigsim.study.golden.errors import standard_error
from rigsim.study.golden.kinds import kind_of
from rigsim.study.golden.record import document_record, table_record
from rigsim.study.scene import columns
from rigsim.testing import assert_matches_golden
from tests.helpers.documents import valid

DEPTH = ["calc", "depth", "--focal", "1000px", "--baseline", "100", "--z", "2m"]
DESIGN = ["design", "--range", "1:2m", "--depth-error", "20mm"]
SWEEP = [
    *("sweep", "--baseline", "50,150", "--resolution", "160x90", "--points", "150", "--trials", "10"),
    *("--renderer", "rays", "--supersample", "1", "--measure", "none"),
]


def document(**changed: Any) -> dict[str, Any]:
    """A sweep's document with one row: an RMS of 10 mm within 9 to 11 mm, of 400 points."""
    row: dict[str, Any] = {
        "baseline_mm": 50.0,
        "n_visible": 400,
        "depth_rmse_mm": 10.0,
        "depth_rmse_ci_low_mm": 9.0,
        "depth_rmse_ci_high_mm": 11.0,
        "predicted_depth_rmse_mm": 9.8,
        "far_inverse_depth_rmse_per_m": None,
        "agreement": "agrees",
    }
    made_by = {"rigsim": "0.1.0", "mujoco": "4.0.0", "renderer": "rays", "seed": 0}
    about = {key: value for key, value in changed.items() if key in made_by}
    row |= {key: value for key, value in changed.items() if key not in made_by}
    return {"rows": [row], "by_depth": [], "swept": [], "best": [0], "provenance": made_by | about}


def moved(before: Mapping[str, Any], now: Mapping[str, Any], looser: float = 0.0) -> dict[str, str]:
    old, new = (document_record("sweep", one, {}) for one in (before, now))
    return {
        move.number: move.verdict
        for move in compare([old], [new], looser=looser).moves
        if move.verdict not in ("same", "within noise", "within tolerance")
    }


@pytest.mark.parametrize(
    ("changed", "names"),
    [
        ({"depth_rmse_mm": 10.00001}, []),  # a millionth is rounding
        ({"depth_rmse_mm": 10.0001}, ["depth_rmse_mm"]),  # the same seed gives the same noise
        ({"predicted_depth_rmse_mm": 9.8 * (1 + 5e-8)}, []),
        ({"predicted_depth_rmse_mm": 9.8 * (1 + 3e-7)}, ["predicted_depth_rmse_mm"]),
        ({"far_inverse_depth_rmse_per_m": 0.1}, ["far_inverse_depth_rmse_per_m"]),
        ({"agreement": "flagged: predicted 20 % under"}, ["agreement"]),
        # another version draws the same noise or nearly: by noise may an RMS differ, no closed form
        ({"rigsim": "0.2.0", "depth_rmse_mm": 11.0}, []),
        ({"rigsim": "0.2.0", "predicted_depth_rmse_mm": 9.8001}, ["predicted_depth_rmse_mm"]),
        ({"seed": 1, "predicted_depth_rmse_mm": 10.5}, []),  # another seed draws other points
        ({"seed": 1, "predicted_depth_rmse_mm": 15.0}, ["predicted_depth_rmse_mm"]),
    ],
)
def test_what_moved_beyond_its_noise_is_named(changed: dict[str, Any], names: list[str]) -> None:
    assert moved(document(), document(**changed)) == {f"rows {name}": "moved" for name in names}


@pytest.mark.parametrize(
    ("changed", "names"),
    [
        # another noise is another draw: simulated numbers are held to the noise of both, closed forms are not
        ({"noise_px": 0.252, "depth_rmse_mm": 12.5}, ["noise_px"]),
        ({"noise_px": 0.252, "depth_rmse_mm": 14.0}, ["depth_rmse_mm", "noise_px"]),
        (
            {"noise_px": 0.252, "predicted_depth_rmse_mm": 9.9},
            ["noise_px", "predicted_depth_rmse_mm"],
        ),
        # another rig draws other points too
        (
            {"baseline_mm": 51.0, "depth_rmse_mm": 12.5, "predicted_depth_rmse_mm": 9.9},
            ["baseline_mm"],
        ),
        ({"baseline_mm": 51.0, "depth_rmse_mm": 14.0}, ["baseline_mm", "depth_rmse_mm"]),
        # a triangulator sees the same noise
        ({"triangulator": "dlt", "depth_rmse_mm": 10.0001}, ["depth_rmse_mm", "triangulator"]),
    ],
)
def test_another_noise_or_rig_draws_other_noise_whatever_the_seed(
    changed: dict[str, Any], names: list[str]
) -> None:
    before = document(noise_px=0.25, triangulator="optimal")
    now = document(**{"noise_px": 0.25, "triangulator": "optimal"} | changed)
    assert sorted(moved(before, now)) == [f"rows {name}" for name in names]


def test_the_noise_of_a_row_is_its_own_interval() -> None:
    # by hand: (11 - 9) / (2 x 1.96) / 10 = 5.1 % of noise, 1 / sqrt(400) = 5 % of other points
    row = document()["rows"][0]
    error = standard_error("simulated", "depth_rmse_mm", 10.0, row)
    assert error == pytest.approx(10 * math.hypot(0.0510214, 0.05), rel=1e-6)
    # of a difference to 13 mm: 3.1 x sqrt(0.71^2 + 0.83^2) = 3.4 mm, and to 14 mm 3.5 mm
    for now, names in ((13.0, []), (14.0, ["rows depth_rmse_mm"])):
        assert list(moved(document(), document(seed=1, depth_rmse_mm=now))) == names


def test_a_looser_tolerance_counts_of_the_golden_value() -> None:
    now = document(depth_rmse_mm=10.09)
    assert moved(document(), now, looser=0.01) == {}
    assert moved(document(), now, looser=0.008) == {"rows depth_rmse_mm": "moved"}


def test_a_column_that_vanished_is_gone_and_nothing_is_nothing() -> None:
    now = document()
    del now["rows"][0]["depth_rmse_mm"]
    assert moved(document(), now) == {"rows depth_rmse_mm": "gone"}
    nothing = document(depth_rmse_mm=None, depth_rmse_ci_low_mm=math.nan)
    assert moved(nothing, nothing) == {}


def test_rows_are_told_apart_by_what_they_are_about_not_by_their_place() -> None:
    first, second = ({"baseline_mm": b, "width_px": 640, "depth_error_mm": e} for b, e in ((50, 8), (150, 3)))
    before = table_record([first, second], ["baseline_mm", "width_px"], {})
    swapped = table_record([second, first], ["baseline_mm", "width_px"], {})
    assert {n.name for n in before.numbers} >= {"rows[baseline_mm=50] depth_error_mm"}
    assert compare([before], [swapped]).count("same") == len(before.numbers) == 4


def test_rigs_side_by_side_are_told_apart_by_name_and_distance() -> None:
    cells = [{"rig": rig, "z_mm": z, "depth_std_mm": z / 100} for rig in ("a", "b") for z in (1000.0, 3000.0)]
    before = document_record("calc depth", {"rows": cells}, {})
    assert {number.name for number in before.numbers} == {
        f"rows[rig={rig}, z_mm={z}] depth_std_mm" for rig in ("a", "b") for z in (1000, 3000)
    }
    assert compare([before], [document_record("calc depth", {"rows": cells[::-1]}, {})]).passed


def test_the_rows_of_built_rigs_are_statistics() -> None:
    # another version builds the same rigs, or nearly: 2000 of them scatter by 1 / sqrt(2000), 2.2 %
    def built(px: float, version: str) -> Record:
        depth = {"distance_mm": 3000.0, "per_rig_row_p95_px": px, "first_order_row_px": 0.4}
        return document_record("tolerance", {"rigs": 2000, "depths": [depth]}, {"rigsim": version})

    assert compare([built(0.8, "1")], [built(0.82, "2")]).passed
    assert not compare([built(0.8, "1")], [built(0.82, "1")]).passed
    assert not compare([built(0.8, "1")], [built(0.95, "2")]).passed


def test_every_column_of_a_sweep_has_its_tolerance() -> None:
    axes = {*columns.AXES, "scene", "n_points", "n_trials", "measured_method"}
    plain = [
        name
        for name in columns.ROW_COLUMNS
        if kind_of("sweep", name, name, is_word=False) == "exact" and name not in axes
    ]
    assert plain == []


def test_another_seed_is_within_noise_and_a_worse_rig_is_not(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def sweep(seed: int, noise_px: float = 0.25) -> rigsim.SweepResult:
        return rigsim.sweep(
            rig="oak-d", baselines_mm=[50, 150], resolutions_px=(160, 100), points=120, trials=20,
            renderer="rays", supersample=1, measure="none", seed=seed, noises_px=noise_px,
        )  # fmt: skip

    golden = tmp_path / "mine.csv"
    assert_matches_golden(sweep(0), golden, update=True)
    for seed in (0, 1):
        assert_matches_golden(sweep(seed), golden)
    with pytest.raises(AssertionError) as failed:
        assert_matches_golden(sweep(0, noise_px=0.3), golden)
    told = str(failed.value)
    # other noise, not the same one scaled: what was simulated is not held to a millionth
    assert "sweep: another noise draws other noise, so what is simulated is held to the noise of both" in told
    assert "moved: rows[baseline_mm=50] depth_bias_mm" not in told
    assert "moved: rows[baseline_mm=50] predicted_depth_rmse_mm: was " in told
    assert "moved: rows[baseline_mm=50] noise_px: was 0.250 px, now 0.300 px, off by 0.0500 px" in told


def test_another_question_is_told_and_each_number_stands_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def run(words: list[str]) -> int:
        monkeypatch.setattr(sys, "argv", ["rigsim", *words])
        return app.run()

    file = tmp_path / "depth.csv"
    assert run([*DEPTH, "--golden", str(file), "--update"]) == 0
    numbers = [line.partition(",")[0] for line in file.read_text().splitlines()]
    assert len([name for name in numbers if name.endswith(("depth_std", "depth_std_mm"))]) == 1
    capsys.readouterr()
    # the same in other words is the same question
    other = [{"100": "10cm", "2m": "2000mm"}.get(word, word) for word in DEPTH]
    assert run([*other, "--golden", str(file)]) == 0
    assert "asked was" not in capsys.readouterr().out
    assert run([*DEPTH[:-1], "1m", "--golden", str(file)]) == 3
    said = " ".join(capsys.readouterr().out.split())
    words = " ".join(DEPTH)
    assert f"asked was {words}, now {words[:-2]}1m." in said


def test_a_missing_golden_file_is_one_line_for_pytest_too(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="make it with --update, or in Python with") as raised:
        assert_matches_golden([{"error_mm": 2.0}], tmp_path / "none.csv")
    assert "RIGSIM_UPDATE_GOLDEN=1" in str(raised.value)
    assert [entry.name for entry in raised.traceback][-1] == "assert_matches_golden"


def test_calc_is_held_to_a_billionth_and_exits_with_3(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = str(tmp_path / "golden")
    assert run([*DEPTH, "--update", "--golden", folder]) == 0
    assert "Wrote golden file" in capsys.readouterr().out
    assert run([*DEPTH, "--golden", folder, "--json"]) == 0
    told = valid("calc-depth", capsys.readouterr().out)["golden"]
    assert (told["passed"], told["moves"], told["counts"]["moved"]) == (True, [], 0)
    file = tmp_path / "golden" / "calc-depth.csv"
    # by hand: disparity = 1000 px x 100 mm / 2 m = 50 px
    assert "disparity_px,50,px," in file.read_text()
    edit(file, "\ndisparity_px,50,px", "\ndisparity_px,50.001,px")
    assert run([*DEPTH, "--golden", str(file), "--json"]) == 3
    (move,) = valid("calc-depth", capsys.readouterr().out)["golden"]["moves"]
    assert (move["number"], move["before"], move["now"]) == ("disparity_px", 50.001, 50.0)
    assert run([*DEPTH, "--golden", str(file), "--golden-tolerance", "0.01%"]) == 0
    capsys.readouterr()
    assert run([*DEPTH, "--golden", str(file), "--csv"]) == 3
    answer = capsys.readouterr()
    assert len(list(csv.reader(answer.out.splitlines()))) == 2
    assert "disparity_px  50.00100 px  50.00000 px  -0.00100 px" in answer.err


def edit(file: Path, old: str, new: str) -> None:
    """Change a golden file, and its checksum with it."""
    body = file.read_text().rpartition("# sha256 ")[0]
    assert body.count(old) == 1
    body = body.replace(old, new)
    file.write_text(f"{body}# sha256 {hashlib.sha256(body.encode()).hexdigest()[:16]}\n")


@pytest.mark.parametrize(
    ("words", "schema"),
    [
        (SWEEP, "sweep"),
        (["tolerance", "--preset", "oak-d", "--rigs", "200", "--points", "60"], "tolerance"),
        (
            [*DESIGN, "--resolution", "640x480", "--lens", "60deg", "--no-proof"],
            "design",
        ),
        (["calc", "limits", "--preset", "oak-d", "--z", "1,3m"], "calc-limits"),
        (
            ["calc", "point", *("--focal", "1200", "--baseline", "150", "--left", "80,0", "--right", "10,0")],
            "calc-point",
        ),
    ],
)
def test_each_command_writes_what_it_is_held_to(
    words: list[str], schema: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    held = [*words, "--json", "--golden", str(tmp_path)]
    assert run([*held, "--update"]) == 0
    written = valid(schema, capsys.readouterr().out)["golden"]
    assert (written["passed"], written["moves"]) == (True, [])
    (file,) = tmp_path.iterdir()
    assert file.stem == schema
    # a hundredth more of any one number is found and named
    record = read_one(tmp_path, record_command(file))
    chosen = next(n for n in reversed(record.numbers) if isinstance(n.value, float) and abs(n.value) > 0.1)
    assert isinstance(chosen.value, float)
    numbers = tuple(
        n if n is not chosen else type(n)(n.name, 1.01 * chosen.value, n.unit, n.allowed, n.standard_error)
        for n in record.numbers
    )
    write_one(tmp_path, Record(record.name, record.about, numbers))
    assert run(held) == 3
    told = valid(schema, capsys.readouterr().out)["golden"]
    (move,) = told["moves"]
    assert (move["number"], move["verdict"]) == (chosen.name, "moved")
    assert (told["counts"]["same"], told["folder"]) == (len(numbers) - 1, str(file))
    assert len(numbers) > 8


def record_command(file: Path) -> str:
    return file.read_text().partition("# command: ")[2].splitlines()[0]


@pytest.mark.parametrize(
    ("prepare", "words", "says"),
    [
        (lambda _: None, [], "golden.csv: does not exist; make it with --update"),
        (
            lambda file: run(["calc", "limits", "--preset", "oak-d", "--golden", str(file), "--update"]),
            [],
            "golden.csv: is of rigsim calc limits, not of rigsim calc depth; give another file",
        ),
        (
            lambda file: run(["calc", "limits", "--preset", "oak-d", "--golden", str(file), "--update"]),
            ["--update"],
            "golden.csv: is of rigsim calc limits, not of rigsim calc depth; give another file",
        ),
        (
            lambda file: file.write_text("baseline_mm,depth\n50,3\n"),
            ["--update"],
            "golden.csv: is there, and no golden file; choose another one",
        ),
        (
            lambda _: None,
            ["--golden-tolerance", "120%"],
            "golden tolerance 120%: must be a share under 100 %",
        ),
    ],
)
def test_golden_files_that_cannot_be_are_refused_in_one_line(
    prepare: Callable[[Path], object],
    words: list[str],
    says: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    file = tmp_path / "golden.csv"
    prepare(file)
    before = file.read_bytes() if file.exists() else None
    capsys.readouterr()
    assert run([*DEPTH, "--golden", str(file), *words]) in (1, 2)
    answer = capsys.readouterr()
    assert answer.out == ""
    assert says in answer.err
    assert answer.err.count("\n") == 1
    assert (file.read_bytes() if file.exists() else None) == before


def test_a_file_that_was_edited_by_hand_is_told_before_it_is_written_over(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "golden.csv"
    assert run([*DEPTH, "--golden", str(file), "--update"]) == 0
    whole = file.read_text()
    assert "written over" not in " ".join(capsys.readouterr().out.split())
    file.write_text(whole.replace("50,", "51,", 1))
    assert file.read_text() != whole
    assert run([*DEPTH, "--golden", str(file), "--update"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "does not fit its checksum: edited or cut off since it was written; it was written over" in said
    assert "write it again" not in said
    assert file.read_text() == whole


def test_a_table_of_one_s_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [
        {"camera": "a", "error_mm": 2.0, "error_mm_se": 0.1},
        {"camera": "b", "error_mm": 3.0, "error_mm_se": 0.1},
    ]
    monkeypatch.setenv("RIGSIM_UPDATE_GOLDEN", "1")
    assert_matches_golden(rows, tmp_path, keys="camera")
    monkeypatch.delenv("RIGSIM_UPDATE_GOLDEN")
    near = [rows[0] | {"error_mm": 2.4}, rows[1]]  # 3 sqrt(2) 0.1 = 0.42
    assert_matches_golden(near, tmp_path, keys="camera")
    far = [rows[0] | {"error_mm": 2.5}, rows[1]]
    with pytest.raises(AssertionError, match=r"moved: rows\[camera=a\] error_mm: was 2.00 mm, now 2.50 mm"):
        assert_matches_golden(far, tmp_path, keys="camera")
    assert_matches_golden(far, tmp_path, keys="camera", tolerance=0.26)
    with pytest.raises(AssertionError, match=r"gone: rows\[camera=b\] error_mm"):
        assert_matches_golden(rows[:1], tmp_path, keys="camera")
