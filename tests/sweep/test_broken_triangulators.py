"""A triangulator that breaks on one rig leaves the other rows of a sweep as they are."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

ROOT = Path(__file__).resolve().parents[2]

MINE = """
import rigsim

def good(rig, uv_left, uv_right):
    return rigsim.triangulate(rig, uv_left, uv_right)

def bad(rig, uv_left, uv_right):
    if rig.baseline_m > 0.15:
        raise RuntimeError("too long")
    return rigsim.triangulate(rig, uv_left, uv_right)

def flat(rig, uv_left, uv_right):
    return uv_left
"""


def _sweep(place: Path, triangulators: str, *more: str) -> subprocess.CompletedProcess[str]:
    (place / "mine.py").write_text(MINE, encoding="utf-8")
    small = ["--resolution", "160x120", "--points", "60", "--trials", "5", "--measure", "none"]
    words = ["--renderer", "rays", "--baseline", "100,200", "--triangulator", triangulators]
    return subprocess.run(
        [sys.executable, "-m", "rigsim", "sweep", *small, *words, "--in-process", "--json", *more],
        cwd=place,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )


def test_rows_of_the_others_are_kept(tmp_path: Path) -> None:
    done = _sweep(tmp_path, "mine:good,mine:bad", "--out", "report")
    assert done.returncode == 1
    says = "triangulator 'mine:bad' raised RuntimeError: too long"
    notes = [line for line in done.stderr.splitlines() if line.startswith("rigsim: note: ")]
    assert f"rigsim: note: 1 of 4 rows has no result: {says}" in notes
    assert "Traceback" not in done.stderr
    document = json.loads(done.stdout)
    rows = {(row["baseline_mm"], row["triangulator"]): row for row in document["rows"]}
    assert len(rows) == 4
    broken = rows.pop((200.0, "mine:bad"))
    assert broken["depth_rmse_mm"] is None
    assert broken["agreement"] == f"untold: {says}"
    assert broken["limited_by"] == "no result"
    assert broken["n_visible"] == rows[200.0, "mine:good"]["n_visible"] > 0
    assert broken["visible_fraction"] == rows[200.0, "mine:good"]["visible_fraction"]
    # the same pixels for all: a function that does the same has the same numbers
    assert rows[100.0, "mine:bad"]["depth_rmse_mm"] == rows[100.0, "mine:good"]["depth_rmse_mm"]
    alone = json.loads(_sweep(tmp_path, "mine:good").stdout)["rows"]
    kept = [row["depth_rmse_mm"] for key, row in rows.items() if key[1] == "mine:good"]
    assert kept == [row["depth_rmse_mm"] for row in alone]
    assert any(one["code"] == "triangulator-failed" for one in document["remarks"])
    table = pd.read_csv(tmp_path / "report" / "sweep.csv")
    assert table["depth_rmse_mm"].isna().tolist() == [False, False, False, True]


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_a_sweep_in_which_all_break_is_one_line(tmp_path: Path, jobs: str) -> None:
    done = _sweep(tmp_path, "mine:flat", "--jobs", jobs)
    assert done.returncode == 1
    assert done.stdout == ""
    assert done.stderr.splitlines()[-1].startswith("rigsim: error: triangulator 'mine:flat' returned shape (")
    assert len([line for line in done.stderr.splitlines() if line.startswith("rigsim: ")]) == 1
