"""A verification on the console and as a page."""

from __future__ import annotations

import io
import re
from dataclasses import replace

import pytest
from rich.console import Console

from rigsim.present.verify.console import print_cases, print_verify, rerun
from rigsim.present.verify.figures import case_figure
from rigsim.present.verify.page import verify_html
from rigsim.study.verify.result import CaseResult, VerifyResult
from rigsim.study.verify.session import gather
from tests.helpers.verify_results import (
    DIAGNOSES,
    SMALL,
    Function,
    breaks_on_far,
    one_of,
    result_of,
    right,
    swapped,
    too_far,
    wasteful,
)

AGAIN = {"swapped": ["rigsim", "verify", "--triangulator", "mine:swapped"]}


def printed(result: VerifyResult, strict: bool = False, again: dict[str, list[str]] | None = None) -> str:
    said = io.StringIO()
    print_verify(result, strict, again, console=Console(file=said, width=100, color_system=None))
    assert max(map(len, said.getvalue().splitlines())) <= 100
    return said.getvalue()


def case_of(function: Function, name: str) -> CaseResult:
    return next(item for item in one_of(function).results if item.case.name == name)


def test_all_well_is_a_line_a_group() -> None:
    said = printed(result_of(right))
    assert said.startswith("right: all 8 cases passed.\n")
    lines = [line for line in said.splitlines() if line.endswith("passed")]
    assert [line.split()[0] for line in lines] == ["rectified", "far", "verged", "nowhere"]
    assert re.search(r"^verged +2 +< 1 pm +1\.0\d\d +3\.\d\d mm +3\.07 mm +passed$", said, re.MULTILINE)
    assert re.search(r"^nowhere +3 +– +– +– +– +passed$", said, re.MULTILINE)


def test_failing_cases_say_what_was_found_and_allowed() -> None:
    said = printed(result_of(too_far))
    # 1.001 times the farthest point of the case is a millimetre for each metre of its distance
    result = case_of(too_far, "verged exact")
    (exact,) = [check for check in result.checks if check.name == "exact"]
    assert 1e-3 * 0.5 < exact.value < 1e-3 * 4
    assert f"{1e3 * exact.value:.2f} mm off" in said
    assert re.search(r"^verged exact +exact +\d\.\d\d mm off +at most \d\.\d\d nm$", said, re.MULTILINE)
    assert re.search(r"^Passed: .*nowhere\.$", said, re.MULTILINE)


def test_diagnoses_and_how_to_run_it_again() -> None:
    result = result_of(swapped)
    diagnosed = replace(result, triangulators=(replace(result.triangulators[0], diagnoses=DIAGNOSES),))
    said = " ".join(printed(diagnosed, again=AGAIN).split())
    assert "Diagnosis: swapped-images: Answers are what swapped images give" in said
    assert "Less likely: inverse-pose:" in said
    assert "Again: rigsim verify --triangulator mine:swapped" in said


def test_again_names_cases_or_groups() -> None:
    words = ["rigsim", "verify"]
    assert rerun(one_of(wasteful), True, words) == ("rigsim verify --cases 'rectified noisy,verged noisy'")
    assert rerun(one_of(breaks_on_far), False, words) == "rigsim verify --cases 'far exact'"
    assert rerun(one_of(swapped), False, words) == "rigsim verify"
    less = replace(one_of(swapped), results=(*one_of(swapped).results[:5], *one_of(right).results[5:]))
    assert rerun(less, False, words) == "rigsim verify --cases rectified,far,verged"
    # what was chosen stays where all of it failed, and makes room where it did not
    chosen = [*words, "--cases", "[rfvn]*"]
    assert rerun(one_of(swapped), False, chosen) == "rigsim verify --cases '[rfvn]*'"
    assert rerun(less, False, chosen) == "rigsim verify --cases rectified,far,verged"


def test_one_message_for_many_errors() -> None:
    one = one_of(right)
    broken = tuple(
        replace(item, checks=(), error=f"returned shape ({len(item.case)}, 2)") for item in one.results
    )
    said = printed(replace(result_of(right), triangulators=(replace(one, results=broken),)))
    assert "8 of 8 cases failed" in said
    assert said.count("returned shape") == 1
    assert "and 5 more: returned shape (200, 2)" in " ".join(said.split())


def test_many_failures_become_one_a_group() -> None:
    one = one_of(swapped)
    many = tuple(
        replace(item, case=replace(item.case, group=f"random {i}", name=f"random {i} exact"))
        for i in range(1, 30)
        for item in one.results[:1]
    )
    said = printed(replace(result_of(swapped), triangulators=(replace(one, results=many),)))
    assert "29 of 29 cases failed" in said
    assert "The first of each group:" in said
    assert said.count("no point in") == 1


def test_notes_and_what_was_left_out_are_said_once() -> None:
    one = one_of(right)
    noted = tuple(replace(item, notes=("printed 'hello'",)) for item in one.results)
    result = replace(
        result_of(right), triangulators=(replace(one, results=noted),), left_out=("bin: not opened",)
    )
    said = printed(result)
    assert "Note: printed 'hello' (in 8 cases)" in said
    assert "Left out: bin: not opened." in said


def test_strict_turns_inefficient_into_failed() -> None:
    assert re.search(r"^verged .* inefficient$", printed(result_of(wasteful)), re.MULTILINE)
    assert re.search(
        r"^verged noisy +efficient +1\.\d\d × expected", printed(result_of(wasteful), True), re.M
    )


def test_the_list_of_cases() -> None:
    said = io.StringIO()
    print_cases(gather(SMALL).cases, console=Console(file=said, width=100, color_system=None))
    assert re.search(r"^verged +exact, noisy +200, 2000 +Cameras that toe in", said.getvalue(), re.MULTILINE)
    assert re.search(r"^nowhere +behind +200 ", said.getvalue(), re.MULTILINE)


def test_the_page_is_whole() -> None:
    page = verify_html(result_of(right, swapped), False, AGAIN)
    assert "<script" not in page
    assert not re.search(r'(src|href)="(?!data:|#)', page)
    assert "1 of 2 triangulators passed" in page
    assert "⚠ Failed" in page
    assert "rigsim verify --x" in page
    assert "mine:swapped" in page
    # verged is the only group in which points came back at all, so it is shown first, with a figure
    assert page.index("<h3>verged exact</h3>") < page.index("<h3>rectified exact</h3>")
    assert page.count('aria-label="Errors in') == 1
    assert "Cameras that toe in by 20 deg" in page
    for check in ("answered", "nowhere", "exact", "size", "depth", "unbiased", "efficient"):
        assert f"<dt>{check}</dt>" in page
    assert "✓ Passed" in verify_html(result_of(right))


def test_the_page_escapes_what_a_program_says() -> None:
    page = verify_html(result_of(breaks_on_far))
    assert "it broke &lt;" in page


def test_the_page_has_the_worst_rows() -> None:
    result = result_of(too_far)
    page = verify_html(result)
    case = case_of(too_far, "verged exact").case
    rows = re.findall(r"<td class=\"num\">([^<]*)</td>", page[page.index("<h3>verged exact</h3>") :])
    u, v = case.uv_left[int(rows[0])]
    assert rows[1] == f"{u:.2f}, {v:.2f}"
    expected = case.points_left[int(rows[0])]
    assert rows[3] == ", ".join(f"{value:.4f}" for value in expected).replace("-", "−")
    assert rows[4] == ", ".join(f"{1.001 * value:.4f}" for value in expected).replace("-", "−")


@pytest.mark.parametrize(
    ("function", "name", "title"),
    [
        (too_far, "verged exact", "Depth error"),
        (too_far, "verged noisy", "Depth error; noise: orange"),
    ],
)
def test_figures(function: Function, name: str, title: str) -> None:
    figure = case_figure(case_of(function, name))
    image, beside = figure.axes[0], figure.axes[-1]
    assert image.get_xlim() == (-0.5, 1279.5)
    assert image.get_ylim() == (719.5, -0.5)
    assert beside.get_title("left") == title


def test_depths_are_drawn_where_most_points_are_missing() -> None:
    result = case_of(right, "verged exact")
    assert result.found_left is not None
    found = result.found_left.copy()
    found[: len(found) * 3 // 4] *= -1
    figure = case_figure(replace(result, found_left=found))
    assert figure.axes[-1].get_ylabel() == "found depth, m"
    assert figure.axes[-1].get_ylim()[0] < -0.5


def test_a_case_without_any_answer_is_drawn() -> None:
    result = case_of(right, "verged exact")
    assert result.found_left is not None
    figure = case_figure(replace(result, found_left=result.found_left * float("nan")))
    assert figure.axes[-1].get_ylabel() == "found depth, m"
