"""Whatever terminal there is, and however a run ends."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

from rigsim.cli.app import run
from rigsim.interop.files.tables import csv_bytes

DEPTH = ["calc", "depth", "--z", "3m", "--hfov", "70", "--resolution", "1280x720", "--baseline", "120"]


def rigsim(words: list[str], **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "rigsim", *words],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("columns", ["0", "", "-3", "wide", "20"])
def test_a_terminal_of_any_width_gets_the_numbers(columns: str) -> None:
    done = rigsim(DEPTH, COLUMNS=columns)
    assert done.returncode == 0
    assert "depth std" in done.stdout
    assert "29.0" in done.stdout


def test_ascii_gets_ascii_signs() -> None:
    words = ["tolerance", "--preset", "oak-d", "--depth-error", "20mm@3m", "--rigs", "200"]
    done = rigsim(words, PYTHONIOENCODING="ascii")
    assert done.returncode == 0, done.stderr
    assert done.stdout.isascii()
    assert "std or +-" in done.stdout


def test_a_foreign_drawing_backend_is_not_asked(tmp_path: Path) -> None:
    picture = tmp_path / "point.png"
    words = ["calc", "point", "--focal", "1200", "--baseline", "150", "--resolution", "1280x720"]
    pixels = ["--left", "980,500", "--right", "910,500", "--plot", str(picture)]
    done = rigsim([*words, *pixels], MPLBACKEND="garbage")
    assert done.returncode == 0, done.stderr
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_closed_output_is_told_before_the_work_where_a_document_is_wanted() -> None:
    words = [sys.executable, "-m", "rigsim", *DEPTH]
    silent = subprocess.run(
        ["sh", "-c", '"$@" >&-', "sh", *words], capture_output=True, text=True, check=False
    )
    assert (silent.returncode, silent.stderr) == (0, "")
    refused = subprocess.run(
        ["sh", "-c", '"$@" >&-', "sh", *words, "--json"], capture_output=True, text=True, check=False
    )
    assert refused.returncode == 1
    assert refused.stderr == "rigsim: error: standard output is closed: leave it open, --json prints there\n"


@pytest.mark.parametrize("words", [["--out", ""], ["--out="], ["--rig", ""]])
def test_an_empty_value_is_refused(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["sweep", *words]) == 2
    assert capsys.readouterr().err.startswith(f"rigsim: error: {words[0].rstrip('=')}: its value is empty")


def test_a_dangling_link_is_no_output_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    link = tmp_path / "link"
    link.symlink_to(tmp_path / "nowhere")
    assert run(["render", "--out", str(link)]) == 1
    assert "is a link that leads nowhere" in capsys.readouterr().err


def test_a_fault_is_one_line_and_a_file(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("RIGSIM_NO_NET")
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))

    def broken(*_: object) -> None:
        raise ZeroDivisionError("first line\nsecond line")

    monkeypatch.setattr("rigsim.theory.uncertainty.predict_depth_std", broken)
    assert run(DEPTH) == 1
    told = capfd.readouterr().err
    (file,) = tmp_path.glob("rigsim-fault-*.txt")
    assert told.startswith("rigsim: error: an internal error of rigsim in `rigsim calc depth")
    assert str(file) in told
    assert told.count("\n") == 1
    written = file.read_text(encoding="utf-8")
    assert "Traceback" in written
    assert "second line" in written


def test_no_cell_is_a_formula() -> None:
    table = pd.DataFrame({"scene": ["=cmd|' /C calc'!A0", "-1+2", "boards"], "depth": [-1.5, 2.0, 3.0]})
    assert csv_bytes(table).decode().splitlines() == [
        "scene,depth",
        "'=cmd|' /C calc'!A0,-1.5",
        "'-1+2,2",
        "boards,3",
    ]
