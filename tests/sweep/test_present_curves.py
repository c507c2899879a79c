from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rigsim.present.kit import style
from rigsim.present.sweep.plots.axes import representative, slice_along, swept_axes
from rigsim.present.sweep.plots.curves import depth_error_figure, panel_figure, panels
from rigsim.present.sweep.plots.heatmap import heat_map_values
from rigsim.present.sweep.same import at_same_distances
from rigsim.study.sweep.result import SweepResult
from tests.helpers.synthetic_sweeps import make_result


def figure_of(result: SweepResult, name: str) -> Figure:
    (panel,) = [panel for panel in panels(result) if panel.name == name]
    return panel_figure(result, panel)


def marks(axes: Axes) -> list[np.ndarray]:
    """Positions of the simulated marks, one array a curve."""
    return [np.asarray(bars.lines[0].get_xydata()) for bars in axes.containers]


def test_the_marks_are_the_simulated_rows_and_the_curve_passes_the_predicted_ones() -> None:
    result = make_result(n_points=300)
    axes = figure_of(result, "axis-baseline-mm").axes[0]
    rows = at_same_distances(result)
    (simulated,) = marks(axes)
    np.testing.assert_allclose(simulated, rows[["baseline_mm", "depth_rmse_mm"]].to_numpy())
    curve = np.asarray(axes.lines[0].get_xydata())
    at_rows = np.interp(rows["baseline_mm"], curve[:, 0], curve[:, 1])
    np.testing.assert_allclose(at_rows, rows["predicted_depth_rmse_mm"], rtol=1e-9)


def test_between_the_rigs_the_curve_follows_a_power_law() -> None:
    result = make_result(baselines_mm=(100, 400), n_points=50)
    bins = result.by_depth.copy()
    bins["predicted_depth_rmse_mm"] = 4000 / bins["baseline_mm"]
    bins["depth_of_rmse_mm"] = bins["depth_near_mm"]  # the same depth within a bin
    same = make_result(baselines_mm=(100, 400), n_points=50, by_depth=bins)
    axes = figure_of(same, "axis-baseline-mm").axes[0]
    curve = np.asarray(axes.lines[0].get_xydata())
    np.testing.assert_allclose(curve[:, 1], 4000 / curve[:, 0], rtol=1e-9)


def test_the_strip_shows_predicted_over_simulated() -> None:
    result = make_result(n_points=300, flagged=(3,))
    strip = figure_of(result, "axis-baseline-mm").axes[1]
    (ratios,) = marks(strip)
    np.testing.assert_allclose(ratios[:, 1], at_same_distances(result)["predicted_over_simulated"], rtol=1e-9)
    low, high = strip.get_ylim()
    assert low < ratios[:, 1].min()
    assert high > ratios[:, 1].max()


def legend_texts(figure: Figure) -> list[str]:
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def test_one_line_a_value_of_the_other_axis_and_at_most_six() -> None:
    result = make_result(noises_px=(0.1, 0.5), n_points=60)
    against_baseline = figure_of(result, "axis-baseline-mm")
    assert len(marks(against_baseline.axes[0])) == 2
    assert against_baseline.legends[1].get_title().get_text() == "pixel noise, px"
    assert legend_texts(against_baseline)[-2:] == ["0.1", "0.5"]
    against_noise = figure_of(result, "axis-noise-px")
    assert len(marks(against_noise.axes[0])) == 6
    (panel,) = [panel for panel in panels(result) if panel.name == "axis-noise-px"]
    assert panel.note == "at 0.889 to 5 m, per pixel; 6 of 10 values of baseline shown"


def test_further_axes_are_held_at_the_best_row_and_said_so() -> None:
    result = make_result((100, 200, 300), (0.1, 0.5), (0.0, 5.0), n_points=60)
    axes = swept_axes(result)
    cut = slice_along(result, axes[0], axes)
    best = result.rows.iloc[result.best[0]]
    assert cut.lines is not None
    assert cut.lines.column == "vergence_deg"
    assert cut.held == {"noise_px": best["noise_px"]}
    assert cut.note == f"pixel noise held at {best['noise_px']:g}\u00a0px"
    assert sum(len(part) for _, part in cut.parts(result.rows)) == 6


@pytest.mark.parametrize(("n", "wanted"), [(3, 1), (10, 4), (40, 39), (40, 0), (7, 3)])
def test_representative_values_hold_both_ends_and_the_wanted_one(n: int, wanted: int) -> None:
    values = tuple(range(n))
    picked = representative(values, wanted)
    assert len(picked) == min(n, 6)
    assert {0, n - 1, wanted} <= set(picked)
    assert list(picked) == sorted(picked)


def test_width_and_height_that_go_together_are_one_resolution() -> None:
    result = make_result((100, 200), sizes=((640, 360), (1280, 720)), n_points=50)
    axes = swept_axes(result)
    assert [axis.heading for axis in axes] == ["baseline", "resolution"]
    assert [axes[1].show(value) for value in axes[1].values] == ["640 × 360", "1280 × 720"]
    apart = make_result((100,), sizes=((640, 360), (640, 480), (1280, 720)), n_points=50)
    assert [axis.heading for axis in swept_axes(apart)] == ["image width", "image height"]


def test_against_depth_the_guide_grows_with_the_square() -> None:
    figure = figure_of(make_result((120,), n_points=500), "depth")
    axes = figure.axes[0]
    guide = np.asarray(axes.lines[-1].get_xydata())
    slope = np.polyfit(np.log(guide[:, 0]), np.log(guide[:, 1]), 1)[0]
    assert slope == pytest.approx(2.0, abs=1e-9)
    (simulated,) = marks(axes)
    assert np.polyfit(*np.log(simulated).T, 1)[0] == pytest.approx(2.0, abs=0.05)
    assert 0.5 < simulated[:, 0].min() < simulated[:, 0].max() < 5.0  # metres, not millimetres
    assert "slope of Z²" in legend_texts(figure)


@pytest.mark.parametrize("kind", ["axis", "depth", "heat"])
def test_axes_carry_units_and_plain_numbers(kind: str) -> None:
    result = make_result(noises_px=(0.1, 0.25, 0.5), n_points=100)
    for panel in panels(result):
        if panel.kind != kind:
            continue
        figure = panel_figure(result, panel)
        style.to_png(figure, dpi=50)
        bottom = figure.axes[1] if kind != "heat" else figure.axes[0]
        assert re.search(r", (mm|px|m)$", bottom.get_xlabel())
        assert re.search(r", (mm|px)$", figure.axes[0].get_ylabel())
        for axes in figure.axes:
            for label in (*axes.get_xticklabels(), *axes.get_yticklabels()):
                assert re.fullmatch(r"[−\d.,]{0,8}", label.get_text())


def test_the_heat_map_puts_each_row_in_its_cell() -> None:
    result = make_result((100, 200, 300), (0.1, 0.5), n_points=60, flagged=(3,))
    across, up = swept_axes(result)
    values, flagged = heat_map_values(result, across, up)
    assert values.shape == (2, 3)
    for _, row in at_same_distances(result).iterrows():
        i, j = up.values.index(row["noise_px"]), across.values.index(row["baseline_mm"])
        assert values[i, j] == row["depth_rmse_mm"]
        assert flagged[i, j] == (row["agreement"].kind != "agrees")
    mesh = figure_of(result, "heat").axes[0].collections[0]
    np.testing.assert_array_equal(np.asarray(mesh.get_array()).reshape(2, 3), values)


@pytest.mark.parametrize(
    ("axes", "count"),
    [
        ({"baselines_mm": (120,)}, 1),
        ({"baselines_mm": (100, 200)}, 2),
        ({"baselines_mm": (120,), "triangulators": ("optimal", "midpoint")}, 2),
        ({"baselines_mm": (100, 200), "noises_px": (0.1, 0.5)}, 4),
        ({"baselines_mm": (100, 200), "triangulators": ("optimal", "a.b:c")}, 2),
    ],
)
def test_the_combined_figure_holds_what_suits(axes: dict[str, Any], count: int) -> None:
    result = make_result(**axes, n_points=60)
    figure = depth_error_figure(result)
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert len([title for title in titles if title]) == count


def test_rows_without_numbers_or_without_error_do_not_stop_the_drawing() -> None:
    result = make_result((100, 200, 300), n_points=60)
    rows = result.rows.copy()
    numbers = [name for name in rows.columns if name.startswith(("depth_", "predicted_"))]
    rows.loc[1, numbers] = np.nan
    broken = make_result((100, 200, 300), n_points=60, rows=rows)
    assert len(marks(figure_of(broken, "axis-baseline-mm").axes[0])[0]) == 2
    bins = result.by_depth.copy()
    for table in (rows, bins):
        table[["depth_rmse_mm", "depth_rmse_ci_low_mm", "depth_rmse_ci_high_mm"]] = 1e-12
    exact = make_result((100, 200, 300), n_points=60, rows=rows, by_depth=bins)
    axes = figure_of(exact, "axis-baseline-mm").axes[0]
    assert "no depth error to draw" in [text.get_text() for text in axes.texts]


def test_svg_of_several_figures_share_no_id_and_name_no_address() -> None:
    result = make_result(noises_px=(0.1, 0.5), n_points=60)
    svgs = [style.to_svg(panel_figure(result, panel), panel.name, panel.title) for panel in panels(result)]
    ids = [re.findall(r'\bid="([^"]+)"', svg) for svg in svgs]
    flat = [name for names in ids for name in names]
    assert len(flat) == len(set(flat))
    for svg, names in zip(svgs, ids, strict=True):
        used = set(re.findall(r'href="#([^"]+)"', svg)) | set(re.findall(r"url\(#([^)]+)\)", svg))
        assert used <= set(names)
        assert "<title>" in svg
        assert 'role="img"' in svg
        assert not re.search(r'href="(?!#|data:)', svg)


def test_drawing_leaves_the_users_matplotlib_as_it_was() -> None:
    import matplotlib

    before = dict(matplotlib.rcParams)
    style.to_png(depth_error_figure(make_result((100, 200), n_points=30)), dpi=50)
    assert dict(matplotlib.rcParams) == before
