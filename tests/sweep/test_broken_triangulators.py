"""A triangulator that breaks on one rig leaves the other rows of a sweep as they are."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import pandas as pd
import pytest

from tests.helpers.cli import Done, rigsim

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


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    (tmp_path / "mine.py").write_text(MINE, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    yield tmp_path
    sys.modules.pop("mine", None)


def _sweep(place: Path, triangulators: str, *more: str) -> Done:
    small = ["--resolution", "160x120", "--points", "60", "--trials", "5", "--measure", "none"]
    words = ["--renderer", "rays", "--baseline", "100,200", "--triangulator", triangulators]
    return rigsim("sweep", *small, *words, "--in-process", "--json", *more, cwd=place)


def test_rows_of_the_others_are_kept(place: Path) -> None:
    done = _sweep(place, "mine:good,mine:bad", "--out", "report")
    assert done.returncode == 1
    says = "triangulator 'mine:bad' raised RuntimeError: too long"
    errors = [line for line in done.stderr.splitlines() if not line.startswith("rigsim: note: ")]
    assert errors == [f"rigsim: error: 1 of 4 rows has no result: {says}"]
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
    alone = json.loads(_sweep(place, "mine:good").stdout)["rows"]
    kept = [row["depth_rmse_mm"] for key, row in rows.items() if key[1] == "mine:good"]
    assert kept == [row["depth_rmse_mm"] for row in alone]
    table = pd.read_csv(place / "report" / "sweep.csv")
    assert table["depth_rmse_mm"].isna().tolist() == [False, False, False, True]


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_a_sweep_in_which_all_break_is_one_line(place: Path, jobs: str) -> None:
    done = _sweep(place, "mine:flat", "--jobs", jobs)
    assert done.returncode == 1
    assert done.stdout == ""
    assert done.stderr.splitlines()[-1].startswith("rigsim: error: triangulator 'mine:flat' returned shape (")
    assert len([line for line in done.stderr.splitlines() if line.startswith("rigsim: ")]) == 1
