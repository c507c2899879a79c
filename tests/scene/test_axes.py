"""Axes and columns: each said once, and a new axis is one file and its lines in the registry."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

from rigsim import Intrinsics, Plan, Pose, RigGrid, StereoRig, read_rig
from rigsim.errors import InvalidRange
from rigsim.interop.documents.sweep import DepthRow, OverallRow
from rigsim.present.sweep.column_words import COLUMNS as WORDS
from rigsim.study.scene import columns
from rigsim.study.scene.axes import registry

ROOT = Path(__file__).resolve().parents[2]

PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")


def test_a_new_axis_is_one_file_and_its_lines_in_the_registry(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "rigsim", tmp_path / "rigsim")  # what is compiled included: it takes seconds
    (tmp_path / "models").symlink_to(ROOT / "models")
    axes = tmp_path / "rigsim" / "study" / "scene" / "axes"
    example = re.search(r"```python\n(.*?)```", PAGE, re.DOTALL)
    assert example is not None
    (axes / "snr.py").write_text(example.group(1), encoding="utf-8")
    text = (axes / "registry.py").read_text(encoding="utf-8")
    text = text.replace("    sensor,\n", "    sensor,\n    snr,\n", 1)
    text = text.replace("    noise.AXIS,\n", "    noise.AXIS,\n    snr.AXIS,\n", 1)
    (axes / "registry.py").write_text(text, encoding="utf-8")

    def rigsim(*words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "rigsim", "sweep", *words],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(tmp_path)},
            capture_output=True,
            text=True,
            check=False,
        )

    small = ["--resolution", "160x120", "--points", "100", "--trials", "5", "--measure", "none"]
    done = rigsim("--snr", "10:50/3", *small, "--json", "--out", "report")
    assert done.returncode == 0, done.stderr
    document = json.loads(done.stdout)
    assert document["swept"] == ["snr"]
    assert [row["snr"] for row in document["rows"]] == pytest.approx([10, 30, 50])
    assert [row["noise_px"] for row in document["rows"]] == pytest.approx([0.5, 5 / 30, 0.1])
    assert any("From 10 to 50 of signal-to-noise ratio" in one for one in document["verdict"]["sentences"])
    assert pd.read_csv(tmp_path / "report" / "sweep.csv")["snr"].tolist() == pytest.approx([10, 30, 50])
    assert "signal-to-noise" in (tmp_path / "report" / "report.html").read_text(encoding="utf-8")
    for noise in ("0.3", "0.25"):  # the second is what is meant where nothing is typed
        both = rigsim("--snr", "10", "--noise", noise, *small)
        assert both.returncode == 2
        assert (
            both.stderr == "rigsim: error: --noise and --snr both given: they say the same thing, give one\n"
        )
    both = rigsim("--snr", "10", "--disparity-noise", "0.3", *small)
    assert both.returncode == 2
    assert "error: --snr and --disparity-noise both given: they say the same thing" in both.stderr


TOE = """
from dataclasses import replace

from rigsim.rig.quantity import VERGENCE
from rigsim.study.scene.axes.axis import Axis
from rigsim.study.scene.column import Column

AXIS = Axis(
    name="toe",
    columns=(Column("toe_deg", "toe", "deg", "short", "Toe-in of one camera, degrees.", empty=False),),
    word="toe-in",
    read=lambda row: (row.rig.vergence_deg / 2,),
    help="Toe-in of one camera, deg.",
    kind=VERGENCE,
    default="2",
    of_rig=lambda recipe, value_deg: replace(recipe, vergence_deg=2 * value_deg),
    instead_of="vergence",
    loop=9,
)
"""


def test_a_new_axis_of_rigs_reaches_the_commands_on_one_rig(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "rigsim", tmp_path / "rigsim", ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "models").symlink_to(ROOT / "models")
    axes = tmp_path / "rigsim" / "study" / "scene" / "axes"
    (axes / "toe.py").write_text(TOE, encoding="utf-8")
    text = (axes / "registry.py").read_text(encoding="utf-8")
    text = text.replace("    sensor,\n", "    sensor,\n    toe,\n", 1)
    text = text.replace("    noise.AXIS,\n", "    toe.AXIS,\n    noise.AXIS,\n", 1)
    (axes / "registry.py").write_text(text, encoding="utf-8")

    def render(*words: str) -> subprocess.CompletedProcess[str]:
        small = ["--resolution", "64x48", "--renderer", "rays", "--out", "pair", "--force"]
        return subprocess.run(
            [sys.executable, "-m", "rigsim", "render", *small, *words],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(tmp_path)},
            capture_output=True,
            text=True,
            check=False,
        )

    for words, vergence_deg in (((), 4.0), (("--toe", "3"), 6.0), (("--vergence", "1"), 1.0)):
        done = render(*words)
        assert done.returncode == 0, done.stderr
        rig = read_rig(tmp_path / "pair" / "rig.toml")
        assert rig.vergence_deg == pytest.approx(vergence_deg)
    both = render("--toe", "2", "--vergence", "1")
    assert both.returncode == 2
    assert (
        both.stderr == "rigsim: error: --vergence and --toe both given: they say the same thing, give one\n"
    )
    assert "Toe-in of one camera, deg.  [default: 2]" in render("--help").stdout


def test_streams_and_rigs_are_what_they_always_were() -> None:
    lens = Intrinsics(640, 480, 500.0, 510.0, 320.5, 239.0)
    bases = (
        StereoRig.rectified(lens, 0.125),
        StereoRig(lens, lens, Pose([[1, 0, 0], [0, 1, 0], [0, 0, 1]], [-0.25, 0.0, 0.0])),
    )
    said = hashlib.sha256()
    for base in bases:
        for rig in RigGrid(
            base,
            baselines_m=(0.0625, 0.5),
            focals_px=(400, 800),
            resolutions_px=((320, 240), (1280, 960)),
        ):
            said.update(Plan().stream("truth", "boards", rig).random(3).tobytes())
    # of the program before axes had a registry
    assert said.hexdigest() == "3cff7789f2e321b9e3fcbb1632f8fd3259e6b240fa38f6bdaaaa6a6868000fdf"


def test_every_table_of_a_sweep_has_the_same_columns() -> None:
    assert tuple(OverallRow.model_fields) == (
        *columns.ROW_COLUMNS,
        "limited_by",
        "diagnosis",
        "requirement",
    )
    assert set(DepthRow.model_fields) == set(columns.DEPTH_COLUMNS) == set(WORDS)
    for name, field in OverallRow.model_fields.items():
        if name in columns.COLUMNS:
            assert field.description == columns.COLUMNS[name].meaning


def test_axes_have_names_columns_and_options_of_their_own() -> None:
    assert len(registry.BY_NAME) == len(registry.ALL)
    assert len(registry.OF_COLUMN) == sum(len(axis.columns) for axis in registry.ALL)
    assert len({axis.loop for axis in registry.OF_RIG}) == len(registry.OF_RIG)
    for axis in registry.ALL:
        assert axis.instead_of == "" or axis.instead_of in registry.BY_NAME
    with pytest.raises(InvalidRange, match="axis 'snr': must be one of"):
        RigGrid(StereoRig.rectified(Intrinsics.from_hfov(64, 48, 60), 0.1), more={"snr": [1.0]})


def test_a_column_is_named_in_one_file() -> None:
    words = {"scene", "triangulator", "sensor", "agreement", "nees"}  # of the language, too
    names = set(columns.COLUMNS) - words
    found: dict[str, set[str]] = {}
    for room in ("study/scene", "study/sweep", "study/agreement", "present/sweep", "interop/files/tables.py"):
        place = ROOT / "rigsim" / room
        for path in [place] if place.is_file() else place.rglob("*.py"):
            strings = set(re.findall(r'"(\w+)"', path.read_text(encoding="utf-8")))
            for name in strings & names:
                found.setdefault(name, set()).add(path.name)
    typed = {name: sorted(files) for name, files in found.items() if name not in ("n_points", "n_trials")}
    assert {name: files for name, files in typed.items() if len(files) > 1} == {}
    assert set(typed) == names - {"n_points", "n_trials"}
