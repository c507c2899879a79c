"""`rigsim compare` from the shell: what is printed, written, and refused."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import NoReturn

import pytest

from rigsim.cli.app import run
from rigsim.errors import MeasurementFailed
from rigsim.interop.documents.compare import CompareDocument, Row
from rigsim.interop.formats.rig_toml import write_rig
from rigsim.rig.presets import preset
from rigsim.study.compare.columns import COLUMNS

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "reference" / "compare.md").read_text(encoding="utf-8")
FEW = ["compare", "--points", "500", "--noise", "0.5,2", "--geometry", "rectified,verged"]
MINE = """
def breaks(rig, uv_left, uv_right):
    raise ValueError("not today")
"""


def test_the_folder_holds_what_is_said_and_reads_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    out = tmp_path / "new"
    assert run([*FEW, "optimal", "dlt", "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    assert {path.name for path in out.iterdir()} == {
        *("compare.html", "compare.csv", "compare.json", "figure.png", "figure.pdf")
    }
    document = json.loads((out / "compare.json").read_text(encoding="utf-8"))
    assert CompareDocument.model_validate(document).model_dump() == document
    rows = list(csv.DictReader(io.StringIO((out / "compare.csv").read_text(encoding="utf-8"))))
    assert tuple(rows[0]) == tuple(COLUMNS)
    assert len(rows) == len(document["rows"]) == 8
    for row, same in zip(rows, document["rows"], strict=True):
        for name in COLUMNS:
            value = same[name]
            assert (
                row[name] == value
                if isinstance(value, str)
                else float(row[name]) == pytest.approx(value, rel=1e-9)
            )
    page = (out / "compare.html").read_text(encoding="utf-8")
    for sentence in (document["headline"], *document["sentences"]):
        assert sentence in " ".join(printed.split())
        assert sentence in page
    assert "<script" not in page
    assert "https://" not in page.replace("https://www.w3.org", "")
    assert max(map(len, printed.splitlines())) <= 100
    assert "NaN" not in (out / "compare.json").read_text(encoding="utf-8")
    assert run([*FEW, "optimal", "--out", str(out)]) == 1
    assert "already holds compare.csv" in capsys.readouterr().err
    assert run([*FEW, "optimal", "--out", str(out), "--force"]) == 0


def test_json_alone_stands_on_standard_output(capsys: pytest.CaptureFixture[str]) -> None:
    assert run([*FEW, "optimal", "--json"]) == 0
    document = CompareDocument.model_validate_json(capsys.readouterr().out)
    assert document.triangulators == ["optimal"]
    assert [row.noise_px for row in document.rows] == [0.5, 2.0, 0.5, 2.0]
    assert all(row.speed_over_first == 1 for row in document.rows)
    assert document.provenance.numpy
    assert document.provenance.opencv


def test_the_usual_four_unless_others_are_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert run([*FEW, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["triangulators"] == ["optimal", "dlt", "midpoint", "cv2"]


def test_without_opencv_the_others_are_compared(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def missing() -> NoReturn:
        raise MeasurementFailed("OpenCV is not installed: pip install it")

    monkeypatch.setattr("rigsim.pixels.opencv.load_cv2", missing)
    monkeypatch.setattr("rigsim.study.compare.run.load_cv2", missing)
    assert run([*FEW, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["triangulators"] == ["optimal", "dlt", "midpoint"]
    assert document["left_out"] == ["cv2: OpenCV is not installed: pip install it"]
    assert document["provenance"]["opencv"] is None
    assert run([*FEW, "cv2"]) == 2
    assert "method cv2: OpenCV is not installed" in capsys.readouterr().err


def test_functions_and_programs_of_ones_own_and_a_rig(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine_compared.py").write_text(MINE, encoding="utf-8")
    (tmp_path / "rig.toml").write_text(write_rig(preset("oak-d").rig), encoding="utf-8")
    program = f"python3 {Path(__file__).resolve().parents[2] / 'docs/examples/verify/triangulate.py'}"
    words = ["optimal", "mine_compared:breaks", "--exec", program, "--rig", "rig.toml", "--geometry", "none"]
    assert run(["compare", "--points", "500", "--noise", "0.3", *words, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert [(row["geometry"], row["triangulator"]) for row in document["rows"]] == [
        ("your rig", "optimal"),
        ("your rig", program),
    ]
    assert document["rows"][1]["within_noise_of_bound"]
    assert "not today (in your rig)" in document["left_out"][0]


@pytest.mark.parametrize(
    ("words", "code", "line"),
    [
        (["nope"], 1, "unknown triangulator 'nope': choose one of optimal, rectified, dlt, midpoint, cv2"),
        (["optimal", "optimal"], 2, "method 'optimal': given twice"),
        ([""], 2, "method: empty"),
        (["--geometry", "nope"], 2, "geometry 'nope': choose among rectified, doffs"),
        (["--geometry", "none"], 2, "at least one geometry or a --rig"),
        (["--noise", "0"], 2, "noise 0 px: must be > 0"),
        (["--noise", "nan"], 2, "noise nan: must be a finite number"),
        (["--noise", "much"], 2, "noise much: must be a number"),
        (["--points", "0"], 2, "points 0: must be between 100"),
        (["--timeout", "0s"], 2, "timeout 0"),
        (["--exec", "is-not-there-at-all"], 1, "is-not-there-at-all is not there"),
        (["--seed", "-1"], 2, "seed -1"),
    ],
)
def test_bad_words_get_one_line(
    words: list[str], code: int, line: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["compare", *words]) == code
    said = capsys.readouterr()
    assert said.out == ""
    assert len(said.err.splitlines()) == 1
    assert line in said.err


def test_the_page_says_what_every_column_means() -> None:
    table = PAGE.partition("## Columns")[2].partition("\n## ")[0]
    rows = [line.split("|")[1] for line in table.splitlines() if line.startswith("| `")]
    assert [name for row in rows for name in row.replace("`", " ").replace(",", " ").split()] == list(COLUMNS)
    assert set(Row.model_fields) - set(COLUMNS) == {"within_noise_of_bound"}
