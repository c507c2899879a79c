from __future__ import annotations

import dataclasses
import io
import re
from html.parser import HTMLParser

import numpy as np
import pytest
from PIL import Image as PillowImage

from rigsim.present.kit import format as fmt
from rigsim.present.sweep.files import sweep_files
from rigsim.present.sweep.page import report_html
from rigsim.present.sweep.rig_table import rig_table, sensor_entries
from rigsim.present.sweep.tables import MOST_ROWS, all_rows, best_by_depth
from rigsim.present.sweep.witness_table import witness_table
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.sensor import Sensor
from rigsim.study.agreement.agreement import Agreement
from rigsim.study.scene.columns import MEASURED_COLUMNS
from rigsim.study.sweep.result import SweepResult
from tests.helpers.synthetic_sweeps import make_result

VOID = {"meta", "img", "br", "hr", "link", "input"}
SECTIONS = ["verdict", "rig", "pair", "plan", "curves", "by-depth", "rows", "reading", "again"]


class Page(HTMLParser):
    """What a test wants to know of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.ids: list[str] = []
        self.addresses: list[str] = []
        self.rows: dict[str, list[list[str]]] = {}
        self.classes: list[str] = []
        self.text = ""
        self.section = ""
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        for name, value in attrs:
            if name == "id" and value:
                self.ids.append(value)
                if tag in ("section", "header"):
                    self.section = value
            if name in ("src", "href", "xlink:href") and value:
                self.addresses.append(value)
            if name == "class" and value:
                self.classes.append(value)
        if tag not in VOID:
            self.open.append(tag)
        if tag == "tr":
            self.rows.setdefault(self.section, []).append([])
        if tag == "td":
            self.rows[self.section][-1].append("")

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data
        if "td" in self.open:
            self.rows[self.section][-1][-1] += data


@pytest.fixture(scope="module")
def result() -> SweepResult:
    return make_result(n_points=500, flagged=(3,))


@pytest.fixture(scope="module")
def page(result: SweepResult) -> Page:
    return Page(report_html(result))


def test_the_sections_stand_in_order(page: Page) -> None:
    assert [name for name in page.ids if name in SECTIONS] == SECTIONS


def test_two_axes_bring_a_heat_map() -> None:
    ids = Page(report_html(make_result((100, 200), (0.1, 0.5), n_points=60))).ids
    assert ids.index("curves") < ids.index("heat") < ids.index("by-depth")


def test_the_page_needs_nothing_but_itself(page: Page) -> None:
    assert page.addresses
    assert all(address.startswith(("#", "data:image/")) for address in page.addresses)
    assert "script" not in page.tags
    assert "link" not in page.tags
    assert page.tags.count("img") == 2
    assert len(page.ids) == len(set(page.ids))


def test_no_style_loads_anything(result: SweepResult) -> None:
    html = report_html(result)
    assert "@import" not in html
    assert not re.search(r"url\((?!#)", html)


def test_the_table_of_all_rows_shows_the_frame(result: SweepResult, page: Page) -> None:
    shown = [row for row in page.rows["rows"] if len(row) > 1]
    assert len(shown) == len(result.rows)
    for (_, row), cells in zip(result.rows.iterrows(), shown, strict=True):
        assert cells[0].removeprefix("★ ") == fmt.plain(row["baseline_mm"])
        error, low, high = fmt.with_interval(
            *(row[f"depth_rmse_{name}mm"] for name in ("", "ci_low_", "ci_high_"))
        )
        assert cells[1] == error
        assert cells[2] == f"{low} – {high}"
        assert cells[3] == fmt.number(row["predicted_depth_rmse_mm"])
        assert cells[4] == fmt.ratio(row["predicted_over_simulated"])
        assert cells[-1] == row["agreement"].kind
    assert [cells[0].startswith("★") for cells in shown].index(True) == result.best[0]


def test_headings_are_for_people_and_carry_units(result: SweepResult) -> None:
    for table in (all_rows(result), best_by_depth(result)):
        assert not any("_" in heading for heading, _ in table.headings)
        assert ("depth error RMS", "mm") in table.headings


def test_a_flagged_row_is_marked_by_text_and_by_colour(page: Page) -> None:
    assert (page.classes.count("flagged told"), page.classes.count("why flagged")) == (1, 1)
    assert "badge flagged" in page.classes
    assert "Flagged: 1 of 10 rows" in page.text
    assert "simulated error 12 % above the prediction" in page.text


def test_the_title_names_what_was_swept() -> None:
    three = make_result((100, 200), (0.1, 0.5), (0.0, 5.0), n_points=30)
    assert "Sweep of baseline, vergence and pixel noise in boards" in Page(report_html(three)).text


def test_agreement_is_said_when_there_is_any() -> None:
    calm = Page(report_html(make_result((100, 200), n_points=60)))
    assert "badge agrees" in calm.classes
    assert "flagged" not in calm.classes


def test_the_depth_table_is_that_of_the_best_row(result: SweepResult) -> None:
    best = result.rows.iloc[result.best[0]]
    expected = result.by_depth[result.by_depth["baseline_mm"] == best["baseline_mm"]]
    table = best_by_depth(result)
    ends = (expected[f"depth_rmse_{name}mm"] for name in ("", "ci_low_", "ci_high_"))
    assert [row.cells[3] for row in table.rows] == [
        fmt.with_interval(*three)[0] for three in zip(*ends, strict=True)
    ]
    assert table.rows[0].cells[0] == fmt.number(expected["depth_near_mm"].iloc[0] / 1e3)


def test_the_rig_is_told_in_its_parameters(result: SweepResult) -> None:
    told = {row.cells[0]: row.cells[1:3] for row in rig_table(result).rows}
    assert told["Baseline"] == ("400", "mm")  # at 500 mm both see under 80 % of what they see at 100 mm
    assert told["Image size"] == ("1280 × 720", "px")
    assert told["Focal length"] == ("900", "px")
    assert told["Pixel noise"] == ("0.25", "px")
    assert told["Disparity noise"] == ("0.354", "px")
    assert told["Nearest overlap"] == ("281", "mm")  # f B / W = 900 * 400 / 1280
    assert "Principal offset" not in told
    verged = {row.cells[0]: row.cells[1] for row in rig_table(make_result((120,), vergences_deg=(6,))).rows}
    assert verged["Vergence"] == "6"
    assert "Depth of one pixel" not in verged


@pytest.fixture(scope="module")
def measured() -> SweepResult:
    return make_result(n_points=600, method="corners")


def test_the_three_witnesses_stand_side_by_side_after_the_verdict(measured: SweepResult) -> None:
    page = Page(report_html(measured))
    ids = [name for name in page.ids if name in (*SECTIONS, "witnesses")]
    assert ids[:3] == ["verdict", "witnesses", "rig"]
    best = measured.rows.iloc[measured.best[0]]
    cells = {row[0]: row[1:] for row in page.rows["witnesses"] if row}
    assert cells["Depth error RMS"] == [
        fmt.length_mm(best["predicted_depth_rmse_mm"]),
        fmt.length_mm(best["depth_rmse_mm"]),
        fmt.length_mm(best["measured_depth_rmse_mm"]),
    ]
    assert cells["Its prediction"][2] == fmt.length_mm(best["predicted_from_measured_rmse_mm"])
    assert cells["Ratio"][2].startswith(fmt.ratio(best["measured_over_predicted"]))
    assert cells["Pixel noise"] == ["0.25 px, given", "0.25 px, given", "0.0050 px, found"]
    assert cells["Points"][2] == f"{best['measured_n']}, 1.2 % outliers"
    assert cells["Verdict"] == ["–", "✓ agrees", "✓ agrees"]
    assert "Three witnesses agree" in page.text
    assert "corresponds to --noise 0.005." in page.text


def test_the_measured_columns_have_a_heading_of_their_own_and_show_the_frame(measured: SweepResult) -> None:
    for table, rows in (
        (all_rows(measured), measured.rows),
        (best_by_depth(measured), measured.by_depth[measured.by_depth["baseline_mm"] == 400]),
    ):
        assert sum(span for _, span in table.groups) == len(table.headings)
        heading, span = next(group for group in table.groups if "measured" in group[0])
        start = sum(n for _, n in table.groups[: table.groups.index((heading, span))])
        assert [head for head, _ in table.headings[start : start + span]] == [
            "RMS",
            "predicted",
            "ratio",
            "points",
            "outliers",
        ]
        for row, (_, record) in zip(table.rows, rows.iterrows(), strict=True):
            assert row.cells[start : start + span] == (
                fmt.number(record["measured_depth_rmse_mm"]),
                fmt.number(record["predicted_from_measured_rmse_mm"]),
                fmt.ratio(record["measured_over_predicted"]),
                fmt.count(record["measured_n"]),
                fmt.percent(record["measured_outlier_fraction"]),
            )


def test_without_a_measurement_nothing_speaks_of_one(page: Page, result: SweepResult) -> None:
    assert "witnesses" not in page.ids
    assert "Equivalent noise" not in page.text
    for table in (all_rows(result), best_by_depth(result)):
        assert table.groups == ()
        assert not any("measured" in heading for heading, _ in table.headings)


def test_a_flagged_measurement_is_named_beside_its_witness() -> None:
    result = make_result((100,), n_points=400, method="patches", measured_flagged=(0,))
    page = Page(report_html(result))
    verdict = next(row for row in page.rows["witnesses"] if row and row[0] == "Verdict")
    assert verdict[2] == "✓ agrees"
    assert verdict[3] == "⚠ flagged: measured errors are 1.8 times their own estimate"
    assert "Three witnesses agree" not in page.text


def test_where_the_best_rig_found_nothing_its_witness_says_so(measured: SweepResult) -> None:
    rows = measured.rows.copy()
    best = measured.best[0]
    rows.loc[best, "measured_n"] = 0
    names = [name for name in MEASURED_COLUMNS if name not in ("measured_method", "measured_n")]
    rows.loc[best, names] = np.nan
    table = witness_table(dataclasses.replace(measured, rows=rows))
    cells = {row.cells[0]: row.cells[3] for row in table.rows}
    assert (cells["Points"], cells["Pixel noise"], cells["Depth error RMS"]) == ("none found", "–", "–")
    assert (cells["Ratio"], cells["Verdict"]) == ("–", "nothing found")
    Page(report_html(dataclasses.replace(measured, rows=rows)))


def test_the_sensor_is_told_in_its_numbers(result: SweepResult) -> None:
    assert [entry[:3] for entry in sensor_entries(Sensor(), "ideal")] == [
        ("Sensor", "ideal pinhole, 8 bit", "")
    ]
    real = Sensor(
        blur_px=0.5,
        distortion=BrownConrady(k1=-0.1, p1=0.001),
        full_well_e=10500,
        read_noise_e=2.4,
        grey_noise=1.5,
        gain=2,
        bits=10,
        right_gain=1.03,
        right_offset=-0.01,
        vignetting=0.2,
    )
    told = {name: (value, unit) for name, value, unit, _ in sensor_entries(real, "imx219")}
    assert told == {
        "Sensor": ("imx219, 10 bit", ""),
        "Lens blur": ("0.5", "px"),
        "Lens distortion": ("k1 −0.1, p1 0.001", ""),
        "Full well": ("10,500", "e⁻"),
        "Read noise": ("2.4", "e⁻"),
        "Gain": ("2", "×"),
        "Image noise": ("1.5", "grey"),
        "Vignetting": ("20.0", "%"),
        "Right picture": ("× 1.03 − 1 %", ""),
    }
    assert "ideal pinhole, 8 bit" in [row.cells[1] for row in rig_table(result).rows]


def test_of_many_rows_the_best_are_shown_and_it_is_said() -> None:
    many = make_result(np.linspace(50, 500, 70).tolist(), (0.1, 0.25, 0.5), n_points=20)
    table = all_rows(many)
    assert len(table.rows) == MOST_ROWS
    assert table.note == "The best 200 of 210 rows, best first. All are limited by noise."
    assert table.rows[0].best
    assert "The best 200 of 210 rows" in Page(report_html(many)).text


def test_one_row_is_a_report_too() -> None:
    page = Page(report_html(make_result((120,), n_points=60)))
    assert [name for name in page.ids if name in SECTIONS] == SECTIONS
    assert "The rig that was simulated." in page.text


def test_what_a_scene_is_called_cannot_become_markup() -> None:
    evil = '<script>alert(1)</script>"><img src=http://x.y/>'
    result = make_result((100, 200), scene=evil, n_points=30)
    result = dataclasses.replace(
        result,
        provenance={"command": f"rigsim sweep --scene '{evil}'", "note": evil},
    )
    html = report_html(result)
    page = Page(html)
    assert "<script" not in html
    assert page.tags.count("img") == 2
    assert page.text.count(evil) >= 4


def test_words_between_backticks_are_code(page: Page) -> None:
    assert "code" in page.tags
    assert "`" not in page.text


def test_the_command_and_the_versions_are_there(page: Page) -> None:
    assert "rigsim sweep --baseline 50:500 --scene boards --seed 0" in page.text
    assert ["EGL, llvmpipe (LLVM 15.0.6, 256 bits)"] in page.rows["again"]
    assert "versions mujoco" in page.text


def test_an_interrupted_run_says_so(result: SweepResult) -> None:
    assert "interrupted" in Page(report_html(dataclasses.replace(result, complete=False))).text
    assert "interrupted" not in Page(report_html(result)).text


def test_no_number_has_more_digits_than_it_can_mean(page: Page) -> None:
    for rows in (page.rows["rig"], page.rows["rows"], page.rows["by-depth"]):
        for row in rows:
            for cell in row:
                assert not re.search(r"\d{7,}|\.\d{7,}", cell)


def test_sweep_files_are_all_there_valid_and_small(result: SweepResult) -> None:
    files = sweep_files(result)
    assert list(files) == ["report.html", "topdown.png", "depth_error.png", "left.png", "right.png"]
    assert len(files["report.html"]) < 5_000_000
    Page(files["report.html"].decode("utf-8"))
    for name, data in files.items():
        if name.endswith(".png"):
            with PillowImage.open(io.BytesIO(data)) as picture:
                picture.load()
                assert min(picture.size) >= 300
    with PillowImage.open(io.BytesIO(files["left.png"])) as left:
        np.testing.assert_array_equal(np.asarray(left), result.showcase.image_left)
    with PillowImage.open(io.BytesIO(files["right.png"])) as right:
        np.testing.assert_array_equal(np.asarray(right), result.showcase.image_right)


def test_the_witnesses_have_a_picture_once_there_are_three() -> None:
    files = sweep_files(make_result((100, 200), n_points=300, method="corners"))
    assert list(files)[-1] == "witnesses.png"
    with PillowImage.open(io.BytesIO(files["witnesses.png"])) as picture:
        picture.load()
        assert picture.width > picture.height > 300


def test_the_report_stays_small_however_loud_the_pictures() -> None:
    result = make_result((100, 200), n_points=5000)
    rng = np.random.default_rng(0)
    noise = rng.integers(0, 256, (1500, 2000, 3), dtype=np.uint8)
    loud = dataclasses.replace(result.showcase, image_left=noise, image_right=noise)
    assert len(report_html(dataclasses.replace(result, showcase=loud)).encode()) < 5_000_000


def test_the_same_result_gives_the_same_page(result: SweepResult) -> None:
    assert report_html(result) == report_html(result)


def test_on_paper_short_tables_stay_whole_and_long_ones_leave_no_row_alone() -> None:
    html = report_html(make_result((100, 200), n_points=60))
    on_paper = html[html.index("@media print") : html.index("</style>")]
    for rule in (
        "table:not(:has(tbody tr:nth-child(16))) { break-inside: avoid; }",
        "tbody tr:nth-last-child(-n+2), tr.why { break-before: avoid; }",
        "tbody tr:nth-child(-n+2), tr.told { break-after: avoid; }",
        "figure, .pair, pre, tr, dd { break-inside: avoid; }",
        "thead { display: table-header-group; }",
    ):
        assert rule in on_paper
    assert not re.search(r"break-(before|after): *(page|always|left|right)|page-break", on_paper)
    assert "#rig" not in on_paper  # a section may break: it left pages half empty


CLEAR, OPEN = Agreement("agrees"), Agreement("untold", "measured", "unclear", ratio=0.8, interval=(0.7, 0.9))
DUMB = Agreement("untold", "simulated", "too-few-trials", count=(3, 30))


@pytest.mark.parametrize(
    ("method", "found", "badge", "says"),
    [  # the rig on show is the last
        ("corners", [CLEAR, CLEAR, CLEAR], "agrees", "✓ Three witnesses agree"),
        (
            "corners",
            [OPEN, OPEN, CLEAR],
            "agrees",
            "✓ Three witnesses agree; not enough to tell in 2 of 3 rows",
        ),
        (
            "corners",
            [OPEN, CLEAR, OPEN],
            "untold",
            "? Not enough to tell whether the pictures agree; in 1 of 3 rows they do",
        ),
        ("none", [DUMB] * 3, "untold", "? Not enough to tell whether prediction and simulation agree"),
    ],
)
def test_the_badge_is_first_about_the_rig_on_show(
    method: str, found: list[Agreement], badge: str, says: str
) -> None:
    result = make_result((50, 100, 200), n_points=60, method=method)
    rows = result.rows.copy()
    rows["agreement"] = found
    html = report_html(dataclasses.replace(result, rows=rows))
    assert result.showcase.row == 2
    assert f'<span class="badge {badge}">{says}</span>' in html
