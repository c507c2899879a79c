"""The region plot: names along their lines, clear of one another."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from rigsim.present.design.figures import pareto_figure, region_figure
from rigsim.present.kit import style
from rigsim.present.kit.lines.line_labels import Named, label_lines
from rigsim.study.design.solve import Design, solve, specify
from rigsim.theory.inverse import Camera, Requirement
from rigsim.theory.inverse_error import P95_OVER_STD
from tests.helpers.sampling import close

CAMERAS = [
    Camera(w, h, w / 2 / math.tan(math.radians(fov) / 2))
    for w, h in ((640, 480), (1600, 1200))
    for fov in (45, 60, 80)
]
CASES = {
    "two": [Requirement("depth_error", 0.010, 3.0), Requirement("fov", math.radians(60))],
    "many": [
        Requirement("depth_error", 0.060, 3.0),
        Requirement("depth_error", 0.020, 1.0),
        Requirement("fov", math.radians(45)),
        Requirement("cover", 1.0, 2.0),
        Requirement("max_baseline", 0.2),
        Requirement("max_disparity", 300, 0.5),
        Requirement("overlap", 0.6, 1.0),
        Requirement("pixels", 2e6),
    ],
    "p95": [Requirement("depth_error", 0.050, 3.0, P95_OVER_STD), Requirement("cover", 2.0, 3.0)],
}


def design(case: str) -> Design:
    return solve(specify(0.5, 3.0, CASES[case]), CAMERAS)


@pytest.mark.parametrize("case", CASES)
def test_names_stand_in_the_plot_and_never_on_one_another(case: str) -> None:
    found = design(case)
    figure = region_figure(found, found.candidates[0])
    renderer = FigureCanvasAgg(figure).get_renderer()
    axes = figure.axes[0]
    names = [text for text in axes.texts if "≤" in text.get_text() or "≥" in text.get_text()]
    lines = [line for line in axes.lines if np.size(line.get_xdata()) > 1]  # not the star
    assert len(names) == len(lines)
    assert figure.legends == []
    frame = axes.get_window_extent(renderer)
    corners = []
    for text in names:
        box = text.get_window_extent(renderer)
        assert frame.x0 - 2 <= box.x0 < box.x1 <= frame.x1 + 2
        assert frame.y0 - 2 <= box.y0 < box.y1 <= frame.y1 + 2
        # the turned text itself, as points along its middle
        angle = math.radians(text.get_rotation())
        half = math.hypot(box.width, box.height) / 2
        middle = np.array([(box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2])
        corners.append(
            middle + np.linspace(-0.9, 0.9, 40)[:, None] * half * [math.cos(angle), math.sin(angle)]
        )
    for one, other in combinations(corners, 2):
        assert np.linalg.norm(one[:, None] - other[None], axis=2).min() > 8


def test_a_name_follows_its_line() -> None:
    with style.styled():
        figure = style.new_figure(4.0, 4.0)
        axes = style.place(figure, 0.5, 0.5, 3.0, 3.0)
        style.plain_axis(axes, "x", 1.0, 100.0, "log")
        style.plain_axis(axes, "y", 1.0, 100.0, "log")
        x = np.geomspace(1, 100, 50)
        falling = Named(x, 100 / x, "falls", style.BLUE)
        beyond = Named(x, 1000 * x, "out of sight", style.GREEN)
        written = label_lines(axes, [falling, beyond])
    assert [text.get_text() for text in written] == ["falls"]
    close(written[0].get_rotation(), 315.0 if written[0].get_rotation() > 0 else -45.0, atol=0.5)
    product = math.prod(written[0].get_position())
    assert 60 < product < 170  # beside the line x y = 100, not on it
    assert abs(product - 100) > 3


def test_pareto_figure_holds_every_candidate() -> None:
    found = design("two")
    figure = pareto_figure(found, found.candidates[0])
    marks = sum(len(c.get_offsets()) for c in figure.axes[0].collections)
    assert marks == len(found.candidates)
