"""The rig that is shown as files: they hold what the page shows."""

from __future__ import annotations

import csv
import io

import pytest

from rigsim import read_rig
from rigsim.studio.logic import take_away
from rigsim.studio.logic.numbers import numbers_of
from rigsim.studio.state import State

SHOWN = State({"preset": "oak-d", "baseline": "90mm", "range": "0.5:4m", "z": "2m", "noise": "0.1"})


def test_the_rig_s_file_is_that_rig() -> None:
    found = numbers_of(SHOWN)
    assert found.shown is not None
    assert read_rig(take_away.rig_toml(found).decode()) == found.shown.rig
    assert found.shown.rig.baseline_m == pytest.approx(0.09)


def test_the_table_holds_every_number_at_full_precision() -> None:
    found = numbers_of(SHOWN)
    rows = list(csv.DictReader(io.StringIO(take_away.numbers_csv(found).decode())))
    assert [(row["place"], row["z"], row["unit"]) for row in rows] == [
        ("near", "500.0", "mm"),
        ("at", "2000.0", "mm"),
        ("far", "4000.0", "mm"),
    ]
    for row in rows:
        std = found.places[row["place"]]["depth_std"].value
        assert float(row["depth_std"]) == pytest.approx(float(std), rel=1e-11)
        # Z^2 sqrt(2) sigma / (f B)
        by_hand = float(row["z"]) ** 2 * 2**0.5 * 0.1 / (float(row["focal_px"]) * 90.0)
        assert float(row["depth_std"]) == pytest.approx(by_hand, rel=1e-6)


def test_the_picture_is_a_png_and_nothing_is_taken_of_no_rig() -> None:
    found = numbers_of(SHOWN)
    assert found.shown is not None
    assert take_away.plan_png(found.shown.rig, 2.0, 0.1).startswith(b"\x89PNG")
    none = numbers_of(SHOWN.with_words(baseline="0"))
    assert take_away.rig_toml(none) == take_away.numbers_csv(none) == b""
