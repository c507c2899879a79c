"""A depth error asked of a sweep: which rows keep it, which to take, and what the report says of it."""

from __future__ import annotations

import base64
import dataclasses
import io
import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from rich.console import Console

from rigsim import Intrinsics, PixelNoise, Plan, RigGrid, StereoRig, sweep
from rigsim.api.kit.cover import LOGO_BYTES, cover
from rigsim.cli.app import run
from rigsim.errors import OutputError
from rigsim.interop.formats.rig_toml import read_rig
from rigsim.present.kit.agreement import reason
from rigsim.present.kit.page import Cover
from rigsim.present.sweep.console import print_sweep
from rigsim.present.sweep.page import report_html
from rigsim.present.sweep.tables import DITTO, all_rows, best_by_depth
from rigsim.present.sweep.words import verdict
from rigsim.study.agreement.agreement import Agreement
from rigsim.study.scene.columns import AXES, DEPTH_COLUMNS, ROW_COLUMNS
from rigsim.study.sweep.requirement import (
    DepthRequirement,
    RowHeld,
    answer_first,
    hold_rows,
    nearest_miss,
    take,
    verdicts,
    would_meet,
)
from rigsim.study.sweep.result import SweepResult
from tests.helpers.documents import valid
from tests.helpers.synthetic_sweeps import make_result

AGREES = Agreement("agrees")
MISSED, UNSHOWN = "✗ Requirement not met", "? Requirement not shown"
SWEEP = [
    *("sweep", "--baseline", "50,200", "--resolution", "320x180", "--points", "150", "--trials", "20"),
    *("--renderer", "rays", "--supersample", "1", "--measure", "none", "--range", "1:4m"),
]


def one_bin(
    rmse_mm: float, half_mm: float, where_m: float = 2.8, n: int = 50, p95_mm: float = 0.0
) -> pd.DataFrame:
    """The bin from 2.5 to 3.2 m of one row, whose error belongs to `where_m`."""
    bin_ = {"depth_near_mm": 2500.0, "depth_far_mm": 3200.0, "n_visible": n, "depth_rmse_mm": rmse_mm}
    bin_ |= {"depth_rmse_ci_low_mm": rmse_mm - half_mm, "depth_rmse_ci_high_mm": rmse_mm + half_mm}
    bin_ |= {"depth_of_rmse_mm": 1e3 * where_m, "depth_median_mm": 2510.0, "depth_abs_p95_mm": p95_mm}
    return pd.DataFrame([dict.fromkeys(AXES, 1.0) | {"scene": "s"} | bin_], columns=list(DEPTH_COLUMNS))


def held(bins: pd.DataFrame, error_mm: float, at_mm: float = 3000.0, p95: bool = False) -> RowHeld:
    row = dict.fromkeys(AXES, 1.0) | {"scene": "s", "n_points": 50, "agreement": AGREES}
    rows = pd.DataFrame([row], columns=list(ROW_COLUMNS))
    ((found,),) = (one.rows for one in hold_rows(rows, bins, [DepthRequirement(at_mm, error_mm, p95)]))
    return found


@pytest.mark.parametrize(
    ("error_mm", "verdict_"),
    # by hand: 10 +- 1 mm at 2.8 m is 11.48 (10.33 to 12.63) mm at 3 m, by the square of the distance
    [(12.7, "met"), (12.6, "not_shown"), (10.4, "not_shown"), (10.3, "not_met")],
)
def test_the_whole_interval_at_the_distance_decides(error_mm: float, verdict_: str) -> None:
    found = held(one_bin(10.0, 1.0), error_mm)
    assert found.verdict == verdict_
    assert found.error_mm == pytest.approx(10 * (3 / 2.8) ** 2)
    assert (found.low_mm, found.high_mm) == pytest.approx((10.332, 12.628), abs=1e-3)


def test_a_percentile_is_held_by_its_own_wider_interval() -> None:
    # by hand: p95 of 19.6 mm is 1.96 RMS; its half width is 1.35 x 1.96 x 1 mm = 2.65 mm; all at 3 m
    found = held(one_bin(10.0, 1.0, where_m=3.0, p95_mm=19.6), 22.3, p95=True)
    assert (found.verdict, found.high_mm) == ("met", pytest.approx(19.6 + 2.646, abs=1e-3))
    assert held(one_bin(10.0, 1.0, where_m=3.0, p95_mm=19.6), 22.2, p95=True).verdict == "not_shown"


@pytest.mark.parametrize(("at_mm", "n"), [(1500.0, 50), (6000.0, 50), (3000.0, 4)])
def test_where_the_scene_has_no_points_nothing_is_shown(at_mm: float, n: int) -> None:
    found = held(one_bin(10.0, 1.0, n=n), 100.0, at_mm)
    assert found.verdict == "not_shown"
    assert math.isnan(found.error_mm)


def test_a_row_that_just_misses_is_rarely_called_met_and_a_good_one_nearly_always() -> None:
    rng = np.random.default_rng(5)
    called = {1.0: 0, 1.1: 0}
    for _ in range(400):
        squares = (10 * rng.normal(size=3000)) ** 2  # as of 30 points and 100 trials
        mean, se = squares.mean(), squares.std() / math.sqrt(3000)
        rms = math.sqrt(mean)
        bins = one_bin(rms, math.sqrt(mean + 1.96 * se) - rms, where_m=3.0)
        for factor in called:
            called[factor] += held(bins, 10 * factor).verdict == "met"
    assert called[1.0] <= 0.05 * 400  # 2.5 to 3 % expected of a rig whose true error is the limit
    assert called[1.1] >= 0.95 * 400


def test_the_interval_holds_the_closed_form_at_the_distance() -> None:
    """Depths in a bin from 2.6 to 3.2 m have a mean fourth power of their own."""
    camera = Intrinsics.from_focal(96, 54, 230.0)
    rigs = RigGrid(StereoRig.rectified(camera, 0.1), baselines_m=(0.1, 0.2, 0.3))
    ratios, inside = [], []
    plan = Plan(noises=(PixelNoise(0.05),), n_points=600, n_trials=60, renderer="rays", measure="none")
    for seed in range(5):
        result = sweep(rigs, dataclasses.replace(plan, range_m=(1.0, 4.5), supersample=1, seed=seed))
        (one,) = hold_rows(result.rows, result.by_depth, [DepthRequirement(3000.0, 1.0)])
        for baseline_mm, row in zip(result.rows["baseline_mm"], one.rows, strict=True):
            # Z^2 sqrt(2) sigma / (f B)
            true_mm = 1e3 * 9.0 * math.sqrt(2) * 0.05 / (camera.fx * baseline_mm / 1e3)
            ratios.append(row.error_mm / true_mm)
            inside.append(row.low_mm <= true_mm <= row.high_mm)
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.007)
    assert np.mean(inside) >= 0.8  # 95 % are expected


def test_the_whole_report_is_about_the_rig_of_the_answer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Not about another one that is best at all distances together, and misses what was asked."""
    monkeypatch.chdir(tmp_path)
    # 150 mm see more of the picture; 9 sqrt(2) 0.15 / (228.5 B) are 55.7 mm with them and 27.9 with 300
    words = [*SWEEP, "--hfov", "70", "--noise", "0.15", "--require"]
    words[words.index("50,200")] = "150,300"
    assert run([*words, "32mm@3m", "--out", "met"]) == 0
    printed = capsys.readouterr().out
    assert printed.startswith("Take 300 mm of baseline: it meets 32 mm at 3 m.")
    rig = read_rig(tmp_path / "met" / "rig.toml")
    assert rig.baseline_m == pytest.approx(0.3)
    assert "that meets what was asked" in (tmp_path / "met" / "rig.toml").read_text()
    html = (tmp_path / "met" / "report.html").read_text()
    assert len(re.findall(r"★ 300", html)) == html.count("★ ") >= 1
    assert run([*words, "20mm@3m", "--out", "none"]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert printed.startswith("No rig of this sweep meets 20 mm at 3 m. Nearest to it comes 300 mm of base")
    focal_px = 160 / math.tan(math.radians(35))
    need_mm = 1e3 * 9 * math.sqrt(2) * 0.15 / (focal_px * 0.020)
    assert f"a baseline of {need_mm:.3g} mm would, all else the same" in printed
    assert read_rig(tmp_path / "none" / "rig.toml").baseline_m == pytest.approx(0.3)
    assert "nearest" in (tmp_path / "none" / "rig.toml").read_text()


@pytest.mark.parametrize("p95", [False, True])
def test_what_would_meet_it_does(p95: bool) -> None:
    rig = StereoRig.rectified(Intrinsics.from_focal(640, 480, 500.0), 0.1)
    # by hand: 9 sqrt(2) 0.25 / (500 x 0.1) = 63.6 mm; for 20 mm 3.18 times as long, or as quiet
    (held,) = hold_rows(*no_rows(), [DepthRequirement(3000.0, 20.0, p95)])
    found = would_meet(rig, PixelNoise(0.25), [held])
    assert found is not None
    times = 3.18198 * (1.959964 if p95 else 1.0)
    assert (found.baseline_m, found.noise_px) == pytest.approx((0.1 * times, 0.25 / times), rel=1e-5)
    toed = StereoRig.verged(Intrinsics.from_focal(640, 480, 500.0), 0.1, 5.0)
    assert would_meet(toed, PixelNoise(0.25), [held]) is None


def test_a_baseline_that_leaves_no_view_in_common_is_not_offered() -> None:
    # 640 px behind 500 px see 1.28 Z; by hand: sqrt(2) 0.25 Z^2 / (500 e) is 0.283 m for 0.1 mm at 0.2 m,
    # more than the 0.256 m that it sees there, and 0.236 m for 0.12 mm, less
    rig = StereoRig.rectified(Intrinsics.from_focal(640, 480, 500.0), 0.1)
    none, some = (
        would_meet(rig, PixelNoise(0.25), hold_rows(*no_rows(), [DepthRequirement(200.0, error_mm)]))
        for error_mm in (0.1, 0.12)
    )
    assert none is not None
    assert some is not None
    assert none.baseline_m is None
    assert none.noise_px == pytest.approx(0.25 * 0.1 / 0.28284, rel=1e-4)
    assert some.baseline_m == pytest.approx(0.23570, rel=1e-4)


@pytest.mark.parametrize("limit_mm", [5.0, 7.03, 12.9])
def test_what_is_said_to_meet_it_does_as_printed(limit_mm: float) -> None:
    """Three digits are rounded to the side that meets it."""
    result = asked(DepthRequirement(3000.0, limit_mm))
    (said,) = [one for one in verdict(result).sentences if one.startswith("By the closed form")]
    found = re.search(r"baseline of (\S+) (m?m) would, all else the same, or pixel noise of (\S+) px;", said)
    assert found is not None
    baseline_m = float(found[1]) * {"mm": 1e-3, "m": 1.0}[found[2]]
    # 900 px
    assert 9e3 * math.sqrt(2) * 0.25 / (900 * baseline_m) <= limit_mm * (1 + 1e-9)
    assert 9e3 * math.sqrt(2) * float(found[3]) / (900 * 0.2) <= limit_mm * (1 + 1e-9)
    assert 9e3 * math.sqrt(2) * 0.25 / (900 * baseline_m) > limit_mm * 0.985


def no_rows() -> tuple[pd.DataFrame, pd.DataFrame]:
    return pd.DataFrame(columns=list(ROW_COLUMNS)), pd.DataFrame(columns=list(DEPTH_COLUMNS))


def asked(
    required: DepthRequirement,
    baselines_mm: tuple[float, ...] = (50, 100, 200),
    n_points: int = 400,
    **made: Any,
) -> SweepResult:
    result = make_result(baselines_mm, n_points=n_points, **made)
    held = hold_rows(result.rows, result.by_depth, [required])
    best = answer_first(result.rows, result.best, held)
    rig = StereoRig.rectified(result.showcase.rig.left, 1e-3 * float(result.rows["baseline_mm"][best[0]]))
    show = dataclasses.replace(result.showcase, row=best[0], rig=rig)
    return dataclasses.replace(result, requirements=held, best=best, showcase=show)


def test_the_shortest_row_that_meets_it_is_taken_and_the_page_begins_with_it() -> None:
    # 900 px: 3 m^2 sqrt(2) 0.25 / (900 B) is 70.7, 35.4 and 17.7 mm
    result = asked(DepthRequirement(3000.0, 45.0))
    assert verdicts(result.requirements) == ("not_met", "met", "met")
    assert take(result.rows, result.best, result.requirements) == 1
    said = verdict(result)
    assert said.headline == "Take 100 mm of baseline: it meets 45 mm at 3 m."
    assert said.sentences[0].startswith("Its depth error, simulated on points of the scene, is 3")
    assert said.sentences[1] == "2 of 3 rows meet it and 1 does not."
    assert said.sentences[2].startswith("100 mm is the shortest baseline of those swept that meets it, ")
    assert re.match(
        r"Of those that meet it, 200 mm of baseline errs least, 17\.\d mm at 3 m", said.sentences[3]
    )
    html = report_html(result)
    assert html.index("✓ Requirement met") < html.index("Take 100 mm") < html.index("Asked for and achieved")
    assert html.count('<tr class="missed">') == 1
    assert 'class="flagged' not in html


def test_the_table_shows_what_meets_it_before_the_rest_with_its_error_at_that_distance() -> None:
    # 17.7, 14.1, 11.8, 8.8, 7.9 and 7.1 mm at 3 m
    result = asked(DepthRequirement(3000.0, 10.0), (200, 250, 300, 400, 450, 500))
    assert [result.rows.loc[i, "baseline_mm"] for i in result.best] == [400, 450, 500, 300, 250]
    out = io.StringIO()
    print_sweep(result, console=Console(file=out, width=100))
    lines = out.getvalue().splitlines()
    (title,) = [
        i for i, line in enumerate(lines) if line.startswith("The rig of the answer, others of the 3 ")
    ]
    assert re.match(r"baseline +at 3 m", lines[title + 1])
    shown = [re.match(r" +(\d+) +([\d.]+)  (met|not met) ", line) for line in lines[title + 4 : title + 9]]
    assert [one and (one[1], one[3]) for one in shown] == [
        *(("400", "met"), ("450", "met"), ("500", "met")),
        *(("300", "not met"), ("250", "not met")),
    ]
    errors = [row.error_mm for row in result.requirements[0].rows]
    assert [float(one[2]) for one in shown if one] == pytest.approx(
        [errors[i] for i in result.best], rel=0.006
    )


def test_where_all_that_meets_it_covers_little_the_remark_on_coverage_says_so() -> None:
    result = asked(DepthRequirement(3000.0, 20.0))
    rows = result.rows.assign(visible_fraction=[0.9, 0.8, 0.6])
    (said,) = [
        one for one in verdict(dataclasses.replace(result, rows=rows)).sentences if "Overlap is" in one
    ]
    assert said.endswith(
        "rows under 80 % of the best coverage are taken only where no other meets what is asked, as here, "
        "with 60 %."
    )


def test_a_shorter_one_that_would_just_do_by_the_closed_form_is_named() -> None:
    # by hand: 9 sqrt(2) 0.25 / (900 0.045) = 78.6 mm, between the 50 mm that miss it and the 100 mm that do
    said = verdict(asked(DepthRequirement(3000.0, 45.0))).sentences
    (just,) = [one for one in said if one.startswith("By the closed form")]
    assert "a baseline of 78.6 mm would just do" in just
    assert "`--baseline 78.6:100/6`" in just
    # 99.4 mm is the 100 mm that were swept
    said = verdict(asked(DepthRequirement(3000.0, 35.55), n_trials=10**6, n_points=4000)).sentences
    assert not [one for one in said if one.startswith("By the closed form")]


def test_a_shorter_one_that_covers_too_little_is_not_taken_and_that_is_said() -> None:
    result = asked(DepthRequirement(3000.0, 45.0))
    rows = result.rows.assign(visible_fraction=[0.9, 0.5, 0.9])
    best = answer_first(rows, result.best, result.requirements)
    assert best == (2, 1, 0)
    said = verdict(dataclasses.replace(result, rows=rows, best=best)).sentences
    assert (
        "The shortest baseline of those swept that meets it is 100 mm, but it covers less than 80 % of the "
        "best coverage; 200 mm is the shortest against which nothing speaks."
    ) in said


def test_of_rows_that_miss_it_the_nearest_stand_first_however_they_are_ranked() -> None:
    # 17.7, 23.6, 35.4 and 70.7 mm
    result = asked(DepthRequirement(3000.0, 20.0), (50, 100, 150, 200))
    assert verdicts(result.requirements) == ("not_met", "not_met", "not_met", "met")
    assert answer_first(result.rows, (1, 3, 0, 2), result.requirements) == (3, 2, 1, 0)


@pytest.mark.parametrize(
    ("required", "headline", "badge", "nearest"),
    [
        (
            DepthRequirement(3000.0, 5.0),
            "No rig of this sweep meets 5 mm at 3 m.",
            MISSED,
            2,
        ),
        (
            DepthRequirement(20e3, 5.0),
            "No rig is shown to meet 5 mm at 20 m.",
            "? Requirement not shown",
            None,
        ),
        (
            DepthRequirement(3000.0, 3.0, pct=0.1, p95=True),
            "No rig of this sweep meets p95 of 0.1 % at 3 m.",
            "✗ Requirement not met",
            2,
        ),
    ],
)
def test_what_no_row_meets_and_what_is_not_shown_are_told_apart(
    required: DepthRequirement, headline: str, badge: str, nearest: int | None
) -> None:
    result = asked(required)
    assert verdict(result).headline == headline
    assert nearest_miss(result.best, result.requirements) == nearest
    assert badge in report_html(result)


def test_a_flagged_row_is_not_recommended() -> None:
    result = asked(DepthRequirement(3000.0, 45.0), flagged=(1,))
    assert take(result.rows, result.best, result.requirements) == 2


def test_numbers_that_do_not_depend_on_an_axis_stand_once() -> None:
    result = make_result((100, 200), (0.1, 0.25), n_points=200, method="corners")
    rows = all_rows(result).rows
    headings = [heading for heading, _ in all_rows(result).headings]
    measured = headings.index("RMS", headings.index("RMS") + 1)
    # each baseline twice, with two noises: pictures have their own
    assert [row.cells[measured] == DITTO for row in rows] == [False, True, False, True]
    assert DITTO not in [row.cells[headings.index("RMS")] for row in rows]


def test_no_row_is_tinted_under_a_green_badge() -> None:
    result = make_result((100, 200), n_points=200)
    bins = result.by_depth.copy()
    bins["agreement"] = [Agreement("flagged", "measured", "worse-than-claimed", "scale", 1.8)] * len(bins)
    result = dataclasses.replace(result, by_depth=bins)
    assert not any(row.flagged for row in best_by_depth(result).rows)
    html = report_html(result)
    assert "badge agrees" in html
    assert 'class="flagged' not in html


@pytest.mark.parametrize(
    ("agreement", "says"),
    [
        (Agreement("flagged", "simulated", "some-failed", ratio=1.0), "100 % of the triangulations failed"),
        (Agreement("flagged", "measured", "outliers", ratio=1.2), "100 % of the measured points are wrong"),
        (Agreement("flagged", "simulated", "spread", "depth spread", 1.996), "100 % above the prediction"),
        (Agreement("flagged", "simulated", "spread", "depth spread", 3.0), "3 times the prediction"),
    ],
)
def test_percentages_are_not_over_100_and_no_powers_of_ten(agreement: Agreement, says: str) -> None:
    assert says in reason(agreement)


def test_the_head_of_one_s_own_report_is_escaped_and_its_logo_stands_in_the_page(tmp_path: Path) -> None:
    logo = tmp_path / "logo.svg"
    logo.write_text('<svg xmlns="http://www.w3.org/2000/svg"><script>alert(1)</script></svg>')
    head = cover("A <b> & C", "for <i>you</i>", logo)
    html = report_html(make_result((100, 200), n_points=60), None, head)
    assert "<title>A &lt;b&gt; &amp; C – rigsim</title>" in html
    assert "for &lt;i&gt;you&lt;/i&gt;" in html
    assert f'src="data:image/svg+xml;base64,{base64.b64encode(logo.read_bytes()).decode()}"' in html
    assert "<script" not in html
    assert "Logo" not in report_html(make_result((100, 200), n_points=60), None, Cover("only a title"))


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"GIF89a", "neither PNG nor SVG"),
        (b"<svg/>" + b" " * LOGO_BYTES, "must be <= 0.5 MB"),
        (
            b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + (100_000).to_bytes(4, "big") * 2 + b"\0" * 20,
            "must be within 8192 px",
        ),
    ],
)
def test_logos_that_cannot_be_are_told_in_one_line(content: bytes, says: str, tmp_path: Path) -> None:
    (tmp_path / "logo").write_bytes(content)
    with pytest.raises(OutputError, match=says) as failed:
        cover(logo=tmp_path / "logo")
    assert "\n" not in str(failed.value)


def test_the_command_marks_rows_in_csv_json_and_console(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [*SWEEP, "--require", "150mm@3m", "--require", "p95:20%@2m"]
    out = tmp_path / "out"
    assert run([*words, "--json", "--out", str(out), "--title", "Ours"]) == 0
    said = valid("sweep", capsys.readouterr().out)
    # at 320 px the focal length is 225 px: 283 mm at 50 mm of baseline, 70.7 mm at 200 mm
    assert [row["requirement"] for row in said["rows"]] == ["not_met", "met"]
    assert said["recommended"] == 1
    assert [(one["statistic"], one["at_mm"], one["required_mm"]) for one in said["requirements"]] == [
        ("rms", 3000.0, 150.0),
        ("p95", 2000.0, pytest.approx(400.0)),
    ]
    assert [row["verdict"] for row in said["requirements"][0]["rows"]] == ["not_met", "met"]
    assert said["requirements"][0]["rows"][1]["depth_error_mm"] == pytest.approx(70.7, rel=0.15)
    assert said["verdict"]["headline"].startswith(
        "Take 200 mm of baseline: it meets 150 mm at 3 m and p95 of"
    )
    assert list(pd.read_csv(out / "sweep.csv")["requirement"]) == ["not_met", "met"]
    assert "rigsim · Ours" in (out / "report.html").read_text()
    assert json.loads((out / "provenance.json").read_text())["points"] == 150


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("10mm", "require 10mm: at which distance? Write it, as in 10mm@3m"),
        ("10@3m", "depth error 10@3m: mm or %?"),
        ("120%@3m", "depth error 120%: must be <= 100 % of the distance"),
    ],
)
def test_requirements_that_cannot_be_read(text: str, says: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run([*SWEEP, "--require", text]) == 2
    assert says in capsys.readouterr().err
