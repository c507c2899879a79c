"""`--json` on every command: one document on standard output, as docs/schema says, and nothing else."""

from __future__ import annotations

import json
import math
import os
import shlex
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from rigsim.cli.app import run
from rigsim.interop.documents.text import json_text
from rigsim.study.scene.columns import DEPTH_COLUMNS, ROW_COLUMNS
from tests.helpers.documents import valid

pytestmark = pytest.mark.usefixtures("few_built_rigs")
RIG = "--focal 1200 --baseline 150 --resolution 1280x960"
SMALL = "--points 100 --trials 5 --resolution 160x120 --renderer rays"
SWEEP = f"sweep --baseline 60,120 --noise 0.02 --measure none {SMALL}"


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)


def answer(capsys: pytest.CaptureFixture[str], name: str, words: str, code: int = 0) -> dict[str, Any]:
    capsys.readouterr()
    assert run([*shlex.split(words), "--json"]) == code, capsys.readouterr().err
    return valid(name, capsys.readouterr().out)


# --- what the commands print ---


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("calc-point", f"calc point {RIG} --left 980,500 --right 910,500"),
        ("calc-depth", f"calc depth {RIG} --z 3m"),
        ("calc-depth", "calc depth --z 100m --focal 500 --baseline 100 --disparity-error 1"),
        ("calc-depth", "calc depth --z 2m --preset branch --vergence 5"),
        ("calc-depth", "calc depth --preset oak-d,zed-2i --z 0.1,3m"),
        ("calc-limits", f"calc limits {RIG}"),
        ("calc-motion", f"calc motion {RIG} --z 3m --time-offset 2ms --turn-rate 30"),
        ("calc-motion", f"calc motion {RIG} --z 50mm --time-offset 2ms --speed 1 --moving rig"),
        ("calc-limits", f"calc limits {RIG} --disparities 0:64"),
        ("calc-limits", f"calc limits {RIG} --vergence 5"),
        ("calc-limits", f"calc limits {RIG} --vergence -60"),
        ("calc-limits", f"calc limits {RIG} --z 100mm"),
        ("scenes", "scenes"),
        ("presets", "presets"),
        ("preset", "presets oak-d"),
        ("preset", "presets boards"),
        ("doctor", "doctor"),
    ],
)
def test_listings_and_closed_forms(capsys: pytest.CaptureFixture[str], name: str, words: str) -> None:
    assert answer(capsys, name, words)


DESIGN = "design --range 0.5:3m --depth-error 60mm@3m"
BUILT = "tolerance --rigs 200 --points 40"


@pytest.mark.parametrize(
    ("name", "words", "code"),
    [
        ("design", f"{DESIGN} --no-proof", 0),
        (
            "design",
            f"{DESIGN} --no-proof --fov 60deg --cover 1m@2m --depth-error p95:5% --max-disparity 200",
            0,
        ),
        ("design", f"{DESIGN} --no-proof --sensor imx264,OV9282 --lens 4,8mm --prefer smallest", 0),
        ("design", f"{DESIGN} --resolution 640x480 --lens 70deg --out out", 0),
        (
            "design",
            "design --range 50:90m --depth-error 5m --scene boards --resolution 640x480 --lens 70deg",
            3,
        ),
        ("tolerance", f"{BUILT} --out out", 0),
        ("tolerance", f"{BUILT} --no-recalibrate --class none --tolerance baseline=0.2mm", 0),
        ("tolerance", f"{BUILT} --class printed --depth-error 1mm@1m --distribution uniform", 0),
        ("infer", "infer --claim 2%@4m,4%@7m,6%@10.5m --preset oak-d --to d455 --at 1m,200m", 0),
        ("infer", "infer --claim 2%@4m --preset oak-d", 0),
        ("infer", "infer --claim 1%@1m,1%@2m,1%@4m --preset oak-d", 0),
        ("infer", "infer --data wall.csv --preset d455", 0),
    ],
)
def test_answers_of_whole_studies(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, name: str, words: str, code: int
) -> None:
    (tmp_path / "wall.csv").write_text(
        "distance_mm,depth_std_mm,depth_bias_mm,n\n1000,2,1,50\n2000,8.5,-2,50\n4000,31,-9,50\n"
    )
    said = answer(capsys, name, words, code)
    if "--out" in words:
        assert json.loads((tmp_path / "out" / f"{name}.json").read_text()) == said


def test_doctor_says_what_auto_takes(capsys: pytest.CaptureFixture[str]) -> None:
    said = answer(capsys, "doctor", "doctor")
    works = {item["name"]: item["works"] for item in said["renderers"]}
    assert list(works) == ["egl", "osmesa", "rays"]
    assert works["rays"] is works[said["auto"]] is True
    assert [item["install"] is None for item in said["renderers"]] == list(works.values())


def test_scenes_leave_out_what_nobody_published(capsys: pytest.CaptureFixture[str]) -> None:
    said = answer(capsys, "scenes", "scenes")
    assert {"boards", "corridor"} <= {item["name"] for item in said["scenes"]}
    sensors = {item["name"]: item for item in said["sensors"]}
    assert (sensors["imx477"]["full_well_e"], sensors["imx477"]["pitch_um"]) == (8180, 1.55)
    assert sensors["imx219"]["full_well_e"] is sensors["imx219"]["noise_source"] is None
    shutters = {name: sensors[name]["shutter"] for name in ("imx273", "imx477", "imx290")}
    assert shutters == {"imx273": "global", "imx477": "rolling", "imx290": None}
    assert sensors["imx290"]["shutter_source"].startswith("none found: ")
    rigs = {item["name"]: item for item in said["presets"]}
    assert (rigs["boards"]["baseline_mm"], rigs["boards"]["focal_px"]) == (120, 900)


def test_a_sweep_says_what_its_tables_say(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    said = answer(capsys, "sweep", f"{SWEEP} --out out")
    words, empty = {"agreement_witness": object}, {"agreement_witness": ""}
    table = pd.read_csv(tmp_path / "out" / "sweep.csv", dtype=words).fillna(empty)
    rows = pd.DataFrame(said["rows"])[list(ROW_COLUMNS)].fillna(math.nan)
    pd.testing.assert_frame_equal(rows, table, check_dtype=False, rtol=1e-9)
    by_depth = pd.DataFrame(said["by_depth"])[list(DEPTH_COLUMNS)].fillna(math.nan)
    written = pd.read_csv(tmp_path / "out" / "sweep_by_depth.csv", dtype=words).fillna(empty)
    pd.testing.assert_frame_equal(by_depth, written, check_dtype=False, rtol=1e-9)
    assert said["written"]["folder"] == "out"
    assert said["written"]["files"] == sorted(path.name for path in (tmp_path / "out").iterdir())
    provenance = json.loads((tmp_path / "out" / "provenance.json").read_text())
    assert {**said["provenance"], "command": said["command"]} == provenance
    assert said["rows"][said["best"][0]]["baseline_mm"] == 120
    assert (said["swept"], said["complete"], said["verdict"]["agrees"]) == (["baseline_mm"], True, True)
    assert "`" not in json.dumps(said)


def test_a_sweep_writes_files_only_when_asked(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert answer(capsys, "sweep", SWEEP)["written"] is None
    assert list(tmp_path.iterdir()) == []


def test_a_sweep_that_measures_nothing_is_null_and_untold(capsys: pytest.CaptureFixture[str]) -> None:
    said = answer(capsys, "sweep", f"sweep --baseline 60 --measure corners {SMALL.replace('rays', 'auto')}")
    (row,) = said["rows"]
    assert (row["measured_n"], row["measured_depth_rmse_mm"]) == (0, None)
    assert row["agreement"].startswith("untold: nothing was measured")
    assert row["agreement_witness"] == "measured"
    assert "not enough to judge the measurement" in " ".join(said["verdict"]["sentences"])


def test_a_rig_without_result_is_a_row_of_nulls(capsys: pytest.CaptureFixture[str]) -> None:
    said = answer(capsys, "sweep", f"sweep --baseline 0.06m,60m --range 0.5:2m --measure none {SMALL}")
    good, bad = said["rows"]
    assert good["depth_rmse_mm"] > 0
    assert bad["depth_rmse_mm"] is bad["nees"] is bad["predicted_over_simulated"] is None
    assert (bad["baseline_mm"], bad["limited_by"]) == (60000, "no result")


def test_render_says_what_it_wrote(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    said = answer(capsys, "render", "render --resolution 160x120 --renderer rays --out pair")
    assert said["rig"]["baseline_mm"] == 120
    assert said["written"]["files"] == sorted(path.name for path in (tmp_path / "pair").iterdir())
    # d = f b / Z
    near = said["rig"]["focal_px"] * 120 / said["depth_left_mm"]["smallest"]
    assert said["disparity_px"]["largest"] == pytest.approx(near, rel=1e-5)
    assert 0.5 < said["visible_fraction"] < 1


# --- nothing else on standard output ---


NOISY = """
import os, sys, rigsim
print("imported")
def f(rig, uv_left, uv_right):
    print("called")
    os.system("echo a program speaks")
    return rigsim.triangulate(rig, uv_left, uv_right)
"""


def typed(*words: str, **environment: str) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(
        [sys.executable, "-m", "rigsim", *words],
        env={**os.environ, **environment},
        capture_output=True,
        check=False,
    )


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_what_the_user_s_code_prints_goes_elsewhere(tmp_path: Path, jobs: str) -> None:
    (tmp_path / "loud.py").write_text(NOISY)
    done = typed(*SWEEP.split(), "--triangulator", "loud:f", "--in-process", "--jobs", jobs, "--json")
    assert done.returncode == 0, done.stderr
    assert valid("sweep", done.stdout.decode())["rows"][0]["triangulator"] == "loud:f"
    for said in (b"imported", b"called", b"a program speaks"):
        assert said in done.stderr


def test_an_interrupted_sweep_is_a_document_too(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(
        "import os, signal, rigsim\ncalls = []\n"
        "def f(rig, uv_left, uv_right):\n"
        "    calls.append(1)\n"
        "    if len(calls) == 6:\n"
        "        os.kill(os.getpid(), signal.SIGINT)\n"
        "    return rigsim.triangulate(rig, uv_left, uv_right)\n"
    )
    words = SWEEP.replace("60,120", "50:500/20").replace("--trials 5", "--trials 1")
    done = typed(*words.split(), "--triangulator", "mine:f", "--in-process", "--json")
    assert done.returncode == 128 + signal.SIGINT, done.stderr
    said = valid("sweep", done.stdout.decode())
    assert said["complete"] is False
    assert 0 < len(said["rows"]) < 20


@pytest.mark.parametrize(
    ("words", "code"),
    [
        ("sweep --baseline 0", 2),
        ("sweep --scene atlantis", 1),
        ("sweep --mount body:tail --renderer rays", 1),
        ("render --scene atlantis --out out", 1),
        ("render", 2),
        ("presets atlantis", 1),
        (f"calc point {RIG} --left 9,1 --right 10,1", 1),
        ("measure nowhere.png nowhere.png --preset boards", 1),
        ("scenes --bogus", 2),
        ("design --range 0.5:3m --depth-error 1um --no-proof", 1),
        ("tolerance --class loose", 2),
        ("infer --claim 2%@4 --preset oak-d", 2),
    ],
)
def test_a_fault_prints_no_document(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, words: str, code: int
) -> None:
    assert run([*words.split(), "--json"]) == code
    said = capsys.readouterr()
    assert said.out == ""
    assert len(said.err.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


def test_any_terminal_and_any_file_name(tmp_path: Path) -> None:
    name = os.fsdecode(b"caf\xc3\xa9-\xff")  # e acute, and a byte that is no text
    render = ("render", "--resolution", "64x48", "--renderer", "rays", "--json", "--out", name)
    for coding in ("utf-8", "ascii", "latin-1"):
        done = typed(*render, "--force", PYTHONIOENCODING=coding)
        assert done.returncode == 0, done.stderr
        said = valid("render", done.stdout.decode(coding))
        assert said["written"]["folder"] == name
        assert (tmp_path / name / "left.png").exists()


def test_a_standard_output_that_takes_nothing_is_one_line() -> None:
    words = f"{sys.executable} -m rigsim calc depth {RIG} --z 3m --json"
    for where, says in ((">/dev/full", b"No space left"), (">&-", b"closed")):
        done = subprocess.run(["sh", "-c", f"{words} {where}"], capture_output=True, check=False)
        assert done.returncode == 1
        assert done.stderr.startswith(b"rigsim: error: standard output")
        assert says in done.stderr
        assert done.stderr.count(b"\n") == 1


def test_a_full_disk_under_a_table_is_one_line() -> None:
    words = f"{sys.executable} -m rigsim scenes >/dev/full"
    done = subprocess.run(["sh", "-c", words], capture_output=True, check=False)
    assert done.returncode == 1
    assert (
        done.stderr
        == b"rigsim: error: output: No space left on device; send it elsewhere, or free some space\n"
    )


def test_text_is_strict() -> None:
    nan, inf = float("nan"), float("inf")
    said = json_text({"a": nan, "b": [inf, (1, -inf)], "c": {"d": nan}, "e": 0.1 + 0.2, "f": "é", "g": None})
    assert json.loads(said) == {
        "a": None,
        "b": [None, [1, None]],
        "c": {"d": None},
        "e": 0.3,
        "f": "é",
        "g": None,
    }
    assert "é" in said
    assert "é" not in json_text({"f": "é"}, "ascii")


def test_text_takes_numpy_s_numbers() -> None:
    row = pd.DataFrame({"n": [3], "x": [0.5], "flag": [True]}).iloc[0]
    values = {"row": row, "n": pd.Series([3]).iloc[0], "x": pd.Series([float("nan")]).iloc[0]}
    assert json.loads(json_text(values)) == {"row": [3, 0.5, True], "n": 3, "x": None}
