from __future__ import annotations

import io
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from rigsim.present.kit.console import make_console, print_table
from rigsim.present.sweep.console import print_sweep
from rigsim.present.sweep.same import at_same_distances
from rigsim.study.sweep.result import SweepResult
from tests.helpers.synthetic_sweeps import make_result

WIDTH = 80


def console(width: int = WIDTH, *, terminal: bool = False) -> Console:
    return Console(
        file=io.StringIO(),
        width=width,
        force_terminal=terminal,
        color_system="standard" if terminal else None,
    )


def printed(result: SweepResult, width: int = WIDTH, folder: Path | None = Path("reports/x")) -> str:
    target = console(width)
    print_sweep(result, folder, console=target)
    assert isinstance(target.file, io.StringIO)
    return target.file.getvalue()


MANY: dict[str, Any] = {
    "baselines_mm": (100, 150),
    "noises_px": (0.1, 0.25),
    "vergences_deg": (0.0, 5.0),
    "triangulators": ("optimal", "package.module:function"),
    "sizes": ((640, 360), (1280, 720)),
    "n_points": 60,
}


def test_the_best_rows_stand_beside_their_prediction() -> None:
    result = make_result(n_points=200)
    lines = printed(result).splitlines()
    head = next(i for i, line in enumerate(lines) if line.startswith("Best 5 of 10"))
    assert lines[head + 1].split() == ["baseline", "simulated", "predicted", "predicted/", "seen", "by"]
    best = at_same_distances(result).iloc[result.best[0]]
    cells = lines[head + 4].split()
    assert cells[0] == f"{best['baseline_mm']:g}"
    assert float(cells[1]) == pytest.approx(best["depth_rmse_mm"], rel=6e-3)
    assert float(cells[2]) == pytest.approx(best["predicted_depth_rmse_mm"], rel=6e-3)
    assert float(cells[3]) == pytest.approx(best["predicted_over_simulated"], abs=6e-4)
    assert cells[5:] == [result.limits[result.best[0]], "agrees"]
    assert lines[-1] == "Report: reports/x/report.html"


@pytest.mark.parametrize("width", [60, 80, 100])
def test_nothing_is_broken_or_runs_over_the_edge(width: int) -> None:
    text = printed(make_result(**MANY, flagged=(3, 4, 5, 7)), width)
    lines = text.splitlines()
    assert max(map(len, lines)) <= width
    assert all(line == line.rstrip() for line in lines)
    words = ["simulated", "agreement", "baseline", "vergence", "triangulator", "optimal", "flagged"]
    for word in words:
        assert word in text.lower()


def test_what_the_best_rows_share_is_said_once() -> None:
    five = make_result((100, 150, 200, 250, 300, 350), (0.1, 0.5), n_points=60)
    title = next(line for line in printed(five).splitlines() if line.startswith("Best"))
    assert title == "Best 5 of 12, with pixel noise 0.1 px"


def test_the_measured_columns_come_before_the_less_important_ones() -> None:
    result = make_result(n_points=300, method="corners")
    lines = printed(result).splitlines()
    head = next(i for i, line in enumerate(lines) if line.startswith("Best 5 of 10"))
    assert max(map(len, lines)) <= WIDTH
    assert lines[head + 1].split() == ["baseline", "simulated", "predicted", "measured", "measured/"]
    best = result.rows.iloc[result.best[0]]
    cells = lines[head + 4].split()
    assert float(cells[4]) == pytest.approx(best["measured_depth_rmse_mm"], rel=6e-3)
    assert float(cells[5]) == pytest.approx(best["measured_over_predicted"], abs=6e-4)
    noise_px = best["measured_disparity_std_px"] / 2**0.5
    assert f"corresponds to --noise {noise_px:.2g}." in " ".join(" ".join(lines).split())
    narrow = printed(result, 50).splitlines()
    assert any("measured" in line for line in narrow)
    assert not any("limited by" in line for line in narrow)


def test_the_corresponding_noise_is_said_once() -> None:
    result = make_result((100, 200), n_points=300, method="corners")
    assert printed(result).count("--noise") == 1


def test_without_a_measurement_no_column_speaks_of_one() -> None:
    assert "measured" not in printed(make_result(n_points=60), 200)


def test_flagged_rows_are_named_with_their_reason_and_the_rest_are_counted() -> None:
    text = printed(make_result(flagged=(0, 1, 2, 3, 4), n_points=100), 120)
    assert "Flagged: 5 of 10" in text
    assert "baseline 50 mm: simulated error 12 % above the prediction" in text
    assert "and 2 more" in text


def test_code_marks_and_markup_are_not_for_terminals() -> None:
    text = printed(make_result(scene="[red]odd[/red]", n_points=50))
    assert "`" not in text
    assert "[red]odd[/red]" in text


def test_one_row_and_no_report() -> None:
    text = printed(make_result((120,), n_points=50), folder=None)
    assert "Result" in text
    assert "Report" not in text


def test_plain_without_a_terminal_and_dressed_on_one() -> None:
    plain, dressed = console(), console(terminal=True)
    for target in (plain, dressed):
        print_table("Scenes", ["name", "what"], [["bin", "parts in a bin"]], console=target)
    assert isinstance(plain.file, io.StringIO)
    assert isinstance(dressed.file, io.StringIO)
    assert plain.file.getvalue() == "Scenes\nname  what\n--------------------\nbin   parts in a bin\n\n"
    assert "\x1b[1m" in dressed.file.getvalue()
    assert "─" in dressed.file.getvalue()


def test_numbers_beside_a_word_too_long_for_its_column_stay_in_line() -> None:
    target = console(30)
    print_table(
        "", ["rig", "name", "n"], [["a", "x", 1], ["b", "unbreakable_name:function", 22]], console=target
    )
    assert isinstance(target.file, io.StringIO)
    lines = target.file.getvalue().splitlines()
    assert lines[2] == f"a{'x':>5}{'1':>28}"
    assert lines[3] == "b    unbreakable_name:function  22"


def test_only_the_last_words_wrap_and_only_between_words() -> None:
    target = console(40)
    about = "checker boards at half a metre to five metres, tilted in all directions"
    print_table(
        "", ["name", "baseline, mm", "shows"], [["boards", 120, about], ["bin", 60, "parts"]], console=target
    )
    assert isinstance(target.file, io.StringIO)
    lines = target.file.getvalue().splitlines()
    assert max(map(len, lines)) <= 40
    assert lines[2].startswith("boards           120  checker")
    assert " ".join(line[22:].strip() for line in lines[2:-2]) == about
    assert lines[-2] == "bin               60  parts"


def test_numbers_stand_right_even_when_they_are_text() -> None:
    target = console()
    print_table("", ["a", "f, px"], [["x", "900"], ["y", "1200.5"], ["z", "–"]], console=target)
    assert isinstance(target.file, io.StringIO)
    assert target.file.getvalue().splitlines()[2:5] == ["x     900", "y  1200.5", "z       –"]


def test_an_empty_table_is_just_its_heads() -> None:
    target = console()
    print_table("Nothing", ["a", "b"], [], console=target)
    assert isinstance(target.file, io.StringIO)
    assert target.file.getvalue() == "Nothing\na  b\n----\n\n"


@pytest.mark.parametrize("width", [3, WIDTH])
def test_a_column_may_be_empty_head_and_all(width: int) -> None:
    target = console(width)
    print_table("", ["quantity", ""], [["yaw", ""], ["pitch", ""]], console=target)
    print_table("", [""], [[""]], console=target)
    assert isinstance(target.file, io.StringIO)
    words = [line for line in target.file.getvalue().splitlines() if line.strip("-")]
    assert words == ["quantity", "yaw", "pitch"]


def test_make_console_prints_brackets_as_they_are(capsys: pytest.CaptureFixture[str]) -> None:
    make_console(width=80).print("[bold]x[/bold] :smile:")
    assert capsys.readouterr().out == "[bold]x[/bold] :smile:\n"


def test_the_console_loads_neither_matplotlib_nor_pandas() -> None:
    code = (
        "import sys, rigsim.present, rigsim.present.kit.console as c; c.print_table('t', ['a'], [[1]]);"
        "print([m for m in ('matplotlib', 'pandas', 'mujoco', 'PIL') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"
