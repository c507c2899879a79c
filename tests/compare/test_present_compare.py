"""The figure and the page of a comparison: fit for print, every label legible, the same bytes again."""

from __future__ import annotations

import itertools
import re
from io import BytesIO
from typing import Any

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox
from PIL import Image

from rigsim.present.compare.console import HEADS, table_rows
from rigsim.present.compare.figure import comparison_figure, figure_pdf, figure_png
from rigsim.present.compare.page import comparison_html
from rigsim.study.compare.run import (
    DEFAULT_GEOMETRIES,
    GEOMETRY_NAMES,
    ComparisonPlan,
    ComparisonResult,
    compare,
)
from rigsim.study.triangulators.registry import KNOWN
from rigsim.theory.custom import TriangulatorFunction

FOUR = {name: KNOWN[name] for name in ("optimal", "dlt", "midpoint", "cv2")}
MANY: dict[str, TriangulatorFunction] = {
    **FOUR,
    "rectified": KNOWN["rectified"],
    "my_package.geometry.triangulation:linear_least_squares": KNOWN["dlt"],
    "python3 docs/examples/verify/triangulate.py --fast": KNOWN["optimal"],
}


@pytest.fixture(autouse=True)
def _quick_stopwatch(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rigsim.study.compare.run._SPEED_POINTS", 200)  # what is drawn is the same


def result(
    geometries: tuple[str, ...], noises_px: tuple[float, ...], methods: dict[str, TriangulatorFunction]
) -> ComparisonResult:
    return compare(ComparisonPlan(geometries, noises_px, 100), methods)


def legible(figure: Figure) -> list[tuple[str, Bbox]]:
    """Every text that is drawn, with its place in pixels."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    renderer = canvas.get_renderer()
    texts: list[Any] = [text for legend in figure.legends for text in legend.get_texts()]
    for axes in figure.axes:
        texts += [axes.title, axes._left_title, axes.xaxis.label, axes.yaxis.label]
        for axis, limits in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
            low, high = sorted(limits)
            texts += [
                tick.label1
                for tick in axis.get_major_ticks()
                if tick.label1.get_visible() and low <= tick.get_loc() <= high
            ]
    return [
        (text.get_text(), text.get_window_extent(renderer))
        for text in texts
        if text.get_visible() and text.get_text()
    ]


@pytest.mark.parametrize(
    ("geometries", "noises_px", "methods"),
    [
        (DEFAULT_GEOMETRIES, (0.1, 0.25, 0.5, 1.0, 2.0), FOUR),
        (GEOMETRY_NAMES, (0.1, 0.125, 0.15), MANY),
        (("verged",), (0.5,), {"optimal": KNOWN["optimal"]}),
        (("far", "off-centre"), (0.001, 0.3, 30.0), FOUR),
    ],
    ids=["usual", "everything", "one", "extreme"],
)
def test_labels_neither_overlap_nor_leave_the_page(
    geometries: tuple[str, ...], noises_px: tuple[float, ...], methods: dict[str, TriangulatorFunction]
) -> None:
    figure = comparison_figure(result(geometries, noises_px, methods))
    texts = legible(figure)
    assert {"noise, px", "depth bias, σ", *geometries} <= {text for text, _ in texts}
    width, height = figure.bbox.width, figure.bbox.height
    for text, box in texts:
        assert 0 <= box.x0 < box.x1 <= width, text
        assert 0 <= box.y0 < box.y1 <= height, text
    for (one, first), (other, second) in itertools.combinations(texts, 2):
        assert not first.overlaps(second), (one, other)


def test_the_figure_is_180_mm_wide_and_the_same_again() -> None:
    figure = comparison_figure(result(("verged", "far"), (0.2, 1.0), FOUR))
    png = figure_png(figure)
    with Image.open(BytesIO(png)) as picture:
        assert picture.width == pytest.approx(180 / 25.4 * 300, abs=1)
    pdf = figure_pdf(figure)
    assert pdf.startswith(b"%PDF")
    assert pdf == figure_pdf(figure)
    box = re.search(rb"/MediaBox \[ 0 0 ([\d.]+) ", pdf)
    assert box is not None
    assert float(box[1]) == pytest.approx(180 / 25.4 * 72, abs=0.1)


def test_methods_differ_without_colour() -> None:
    figure = comparison_figure(result(("verged",), (0.2, 1.0), MANY))
    handles = figure.legends[0].legend_handles[: len(MANY)]
    looks = {
        (line.get_marker(), line.get_markerfacecolor() == "white") for line in handles if line is not None
    }
    assert len(looks) == len(MANY)


def test_the_table_in_words() -> None:
    found = result(("verged", "far"), (0.2, 1.0), FOUR)
    rows = table_rows(found, 1.0)
    assert [row[:2] for row in rows[:2]] == [("verged", "optimal"), ("verged", "dlt")]
    assert all(len(row) == len(HEADS) for row in rows)
    assert re.fullmatch(r"\d\.\d{3,4} ± 0\.0\d{2,3}", rows[0][2])
    assert rows[0][3] == "1.000"
    assert rows[0][5:7] == ("0", "0")


def test_a_page_escapes_names() -> None:
    found = result(("verged",), (0.5,), {"optimal": KNOWN["optimal"], "<b>mine</b>": KNOWN["dlt"]})
    page = comparison_html(found, comparison_figure(found))
    assert "<b>mine" not in page
    assert "&lt;b&gt;mine" in page
