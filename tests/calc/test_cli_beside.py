"""`rigsim calc depth` of several rigs or distances: one table, beside what the makers claim."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import pytest

import rigsim
from rigsim.cli.app import run
from rigsim.interop.formats.rig_toml import write_rig


def printed(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    assert run(["calc", "depth", *words]) == 0
    return capsys.readouterr().out


def document(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(printed(capsys, *words, "--json"))
    return found


def test_presets_side_by_side(capsys: pytest.CaptureFixture[str]) -> None:
    found = document(capsys, "--preset", "oak-d,ZED 2i", "--z", "1,4,8m")
    rows = found["rows"]
    assert [(row["rig"], row["z_mm"]) for row in rows] == [
        (name, z) for name in ("oak-d", "zed-2i") for z in (1000, 4000, 8000)
    ]
    for row, (focal_px, baseline_mm) in zip(rows, [(882.5, 75)] * 3 + [(609.53, 120)] * 3, strict=True):
        # sigma_Z = Z^2 sqrt(2) 0.25 / (f B), and 3 (sigma_Z / Z)^2 more in the variance
        first_mm = row["z_mm"] ** 2 * 2**0.5 * 0.25 / (focal_px * baseline_mm)
        assert row["depth_std_mm"] == pytest.approx(first_mm, rel=2e-3)
        assert (row["baseline_mm"], row["focal_px"]) == (baseline_mm, pytest.approx(focal_px, abs=0.1))
    # 2 % of 4 m are 80 mm, 5 mm at 1 m by the square; at 8 m the claim at 7 m is nearer: 280 x (8/7)^2
    assert [row["claimed_mm"] for row in rows[:3]] == pytest.approx([5, 80, 280 * (8 / 7) ** 2])
    assert [row["claimed_at_mm"] for row in rows[:3]] == [4000, 4000, 7000]
    assert "Luxonis" in rows[0]["claim_source"]
    assert [row["claimed_mm"] for row in rows[3:]] == [None] * 3
    assert {found[key] for key in ("z", "depth_std", "seen_by", "focal_px")} == {None}


def test_one_rig_at_one_distance_is_told_flat_and_as_a_row(capsys: pytest.CaptureFixture[str]) -> None:
    found = document(capsys, "--preset", "oak-d", "--z", "4m")
    (row,) = found["rows"]
    for key in ("depth_std", "depth_near", "depth_far", "depth_bias"):
        assert row[f"{key}_mm"] == found[key] is not None
    assert (row["rig"], row["z_mm"], row["disparity_px"]) == ("oak-d", found["z"], found["disparity_px"])
    typed = document(capsys, "--baseline", "100", "--focal", "1000", "--z", "1,2m")
    assert [(row["rig"], row["claimed_mm"], row["claim_source"]) for row in typed["rows"]] == [
        ("rig", None, "")
    ] * 2


def test_files_side_by_side(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.toml").write_text(write_rig(rigsim.preset("oak-d").rig))
    Path("b.toml").write_text(write_rig(rigsim.preset("bin").rig))
    rows = document(capsys, "--rig", "a.toml,b.toml", "--z", "1m")["rows"]
    assert [(row["rig"], row["baseline_mm"]) for row in rows] == [("a.toml", 75), ("b.toml", 60)]
    assert rows[0]["claimed_mm"] is None  # a file is no preset
    Path("a.toml,b.toml").write_text(write_rig(rigsim.preset("boards").rig))
    (row,) = document(capsys, "--rig", "a.toml,b.toml", "--z", "1m")["rows"]
    assert row["baseline_mm"] == 120


def test_people_and_tables_get_the_claim_beside_it(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    lines = printed(capsys, "--preset", "oak-d,zed-2i", "--z", "3,4m").partition("\n\n")[0].splitlines()[-4:]
    ends = ["45.0  Z² from 2 % at 4 m", "80.0  2 % at 4 m", "not known", "not known"]
    for line, name, end in zip(lines, ["oak-d", "oak-d", "zed-2i", "zed-2i"], ends, strict=True):
        assert line.startswith(name)
        assert line.rstrip().endswith(end)
    assert "claim" not in printed(capsys, "--preset", "boards", "--z", "3,4m")
    text = printed(capsys, "--preset", "oak-d,zed-2i", "--z", "3m", "--csv")
    rows = list(csv.DictReader(io.StringIO(text)))
    assert [row["rig"] for row in rows] == ["oak-d", "zed-2i"]
    assert float(rows[0]["claimed"]) == pytest.approx(45)
    table = printed(capsys, "--preset", "oak-d,zed-2i", "--z", "3m", "--markdown").splitlines()
    assert {line.count("|") for line in table[:4]} == {9}
    assert table[4] == ""
    assert table[5].startswith("At 3 m zed-2i is the more accurate")


def test_a_sentence_says_which_is_more_accurate(capsys: pytest.CaptureFixture[str]) -> None:
    # f B = 882.5 x 75 and 609.53 x 120: 66187.5 / 73143.6 = .9049
    says = document(capsys, "--preset", "oak-d,zed-2i", "--z", "1,3,6m")["says"]
    assert says == (
        "At 1, 3 and 6 m zed-2i is the more accurate: its depth std is 9.5 % smaller than that of oak-d. "
        "The same noise is assumed for both, 0.25 px per coordinate, and these modes: oak-d at 1280x800 px "
        "and zed-2i at 1280x720 px (HD720)."
    )
    text = printed(capsys, "--preset", "oak-d,zed-2i", "--z", "1,3,6m")
    assert " ".join(text.split()).endswith(says)
    swapped = document(capsys, "--preset", "zed-2i,oak-d", "--z", "1,3,6m", "--noise", "0.1")["says"]
    assert "zed-2i is the more accurate: its depth std is 9.5 % smaller than that of oak-d" in swapped
    assert "0.1 px per coordinate" in swapped
    says = document(capsys, "--preset", "boards,corridor,bin", "--z", "250mm,3m")["says"]
    # f B = 108, 300 and 66 px m
    assert "at 3 m corridor is the most accurate: its depth std is 64 % smaller than that of boards" in says
    assert says.startswith("At 0.25 m boards is the most accurate")
    assert says.endswith("The same noise is assumed for all, 0.25 px per coordinate.")
    near = document(capsys, "--preset", "boards,corridor", "--z", "100,300mm")["says"]
    assert "At 0.1 m none sees the point with both cameras; at 0.3 m only boards sees the point" in near
    same = document(capsys, "--preset", "boards,bin", "--baseline", "100", "--focal", "900", "--z", "1m")[
        "says"
    ]
    assert same.startswith("At 1 m boards and bin are equally accurate.")
    for alone in (["--preset", "oak-d", "--z", "1m"], ["--preset", "oak-d", "--z", "1,2m"]):
        assert document(capsys, *alone)["says"] == ""


def test_a_claim_that_nobody_knows(capsys: pytest.CaptureFixture[str]) -> None:
    lines = printed(capsys, "--preset", "zed-mini,boards", "--z", "1m").splitlines()
    assert next(line for line in lines if line.startswith("zed-mini")).rstrip().endswith("not known")
    assert next(line for line in lines if line.startswith("boards")).rstrip().endswith("–")  # nobody sells it


def test_nearest_and_farthest_are_told_from_the_distance(capsys: pytest.CaptureFixture[str]) -> None:
    # 0.5^2 m sqrt(2) 0.25 px / (1000 px x 200 mm) = 0.442 mm
    table = printed(capsys, "--focal", "1000px", "--baseline", "200", "--z", "0.5,1m", "--markdown")
    (near,) = [line for line in table.splitlines() if line.startswith("| rig | 0.5 ")]
    assert [cell.strip() for cell in near.split("|")[4:7]] == ["0.442", "499.56", "500.44"]


def test_rows_apart_have_a_column_where_there_are_any(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--preset", "boards,bin", "--z", "1m")
    table = printed(capsys, *words, "--vertical=-1mm", "--markdown").splitlines()
    assert "| rows apart, px |" in table[0]
    assert [line.split("|")[7].strip() for line in table[2:4]] == ["0.900", "1.10"]  # f x 1 mm / 1 m
    assert "rows apart" not in printed(capsys, *words)


def test_what_is_odd_names_its_rig(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--preset", "oak-d,d435", "--z", "0.1,1m", "--resolution", "640x400")
    said = [remark["text"] for remark in document(capsys, *words)["remarks"]]
    assert sum("does the camera have such a mode" in text for text in said) == 2
    assert not [text for text in said if text.count("oak-d:") > 1 or text.count("d435:") > 1]
    assert any(
        text.startswith("oak-d: the right camera does not see the point at Z = 100 mm") for text in said
    )


def test_a_claim_is_spoken_of_where_one_is_known(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--preset", "oak-d,zed-2i", "--z", "1m", "--resolution", "640x400")
    said = [remark["text"] for remark in document(capsys, *words)["remarks"]]
    modes = {text.split(":")[0]: text for text in said if "does the camera have such a mode" in text}
    assert ["What its maker claims" in modes[name] for name in ("oak-d", "zed-2i")] == [True, False]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--preset", "oak-d,"], "--preset oak-d,: a name is missing"),
        (["--preset", "oak-d,oak-d"], "--preset oak-d,oak-d: oak-d is given twice; remove one"),
        (["--preset", "oak-d,nothing"], "unknown preset 'nothing'"),
    ],
)
def test_names_that_are_none(words: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["calc", "depth", *words, "--z", "1m"]) in (1, 2)
    assert told in capsys.readouterr().err
