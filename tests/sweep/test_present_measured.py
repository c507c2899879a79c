"""The third witness in plots: marks, dashed line, ratio strip."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure

from rigsim.present.kit import style
from rigsim.present.sweep import measured_words as words
from rigsim.present.sweep.plots.curves import depth_error_figure, panel_figure, panels
from rigsim.present.sweep.same import at_same_distances
from rigsim.study.agreement.agreement import Agreement, blamed
from rigsim.study.sweep.result import SweepResult
from tests.helpers.synthetic_sweeps import make_result


def figure_of(result: SweepResult, name: str) -> Figure:
    (panel,) = [panel for panel in panels(result) if panel.name == name]
    return panel_figure(result, panel)


def diamonds(axes: Axes) -> list[PathCollection]:
    """The measured marks, one collection a line."""
    return [
        mark
        for mark in axes.collections
        if isinstance(mark, PathCollection) and mark.get_label() == "_measured"
    ]


def at(marks: PathCollection) -> np.ndarray:
    return np.asarray(marks.get_offsets())


def dashed(axes: Axes) -> list[np.ndarray]:
    """Vertices of the lines predicted from what was measured."""
    return [np.asarray(line.get_xydata()) for line in axes.lines if line.get_linestyle() == "--"]


def arrows(axes: Axes) -> list[tuple[float, str]]:
    """Place along the page and mark of every ratio beyond the strip."""
    return [
        (float(np.asarray(line.get_xdata())[0]), str(line.get_marker()))
        for line in axes.lines
        if line.get_label() == "_beyond"
    ]


def legend_texts(figure: Figure) -> list[str]:
    return [text.get_text().replace("\n", " ") for legend in figure.legends for text in legend.get_texts()]


def with_ratio(result: SweepResult, place: int, ratio: float, **axes: tuple[float, ...]) -> SweepResult:
    """The sweep with one row that measures `ratio` times what it predicts for itself."""
    rows = result.rows.copy()
    rows.loc[place, "measured_depth_rmse_mm"] = ratio * rows.loc[place, "predicted_from_measured_rmse_mm"]
    rows.loc[place, "measured_over_predicted"] = ratio
    return make_result(n_points=300, method="corners", rows=rows)


@pytest.fixture(scope="module")
def result() -> SweepResult:
    return make_result(n_points=300, method="corners")


def test_the_diamonds_are_the_measured_rows_and_the_dashes_pass_their_own_prediction(result):
    axes, _, strip = figure_of(result, "axis-baseline-mm").axes
    (marks,) = diamonds(axes)
    np.testing.assert_allclose(at(marks), result.rows[["baseline_mm", "measured_depth_rmse_mm"]])
    assert len(marks.get_facecolor()) == 0  # hollow
    (curve,) = dashed(axes)
    at_rows = np.exp(np.interp(np.log(result.rows["baseline_mm"]), *np.log(curve).T))
    np.testing.assert_allclose(at_rows, result.rows["predicted_from_measured_rmse_mm"], rtol=1e-6)
    (ratios,) = diamonds(strip)
    np.testing.assert_allclose(at(ratios)[:, 1], result.rows["measured_over_predicted"])
    low, high = strip.get_ylim()
    assert low < at(ratios)[:, 1].min() < at(ratios)[:, 1].max() < high
    assert arrows(strip) == []
    figure = figure_of(result, "axis-baseline-mm")
    assert "measured in renderings" in legend_texts(figure)
    assert "predicted from the measured noise" in legend_texts(figure)


def test_everything_measured_lies_within_the_axes(result):
    for name in ("axis-baseline-mm", "depth"):
        axes = figure_of(result, name).axes[0]
        (x_low, x_high), (y_low, y_high) = axes.get_xlim(), axes.get_ylim()
        for marks in diamonds(axes):
            x, y = at(marks).T
            assert x_low < x.min() < x.max() < x_high
            assert y_low < y.min() < y.max() < y_high


def test_without_a_measurement_the_chart_is_as_it_was():
    figure = figure_of(make_result(n_points=60), "axis-baseline-mm")
    assert len(figure.axes) == 2
    assert diamonds(figure.axes[0]) == []
    assert not any("measured" in text for text in legend_texts(figure))
    assert figure.get_size_inches()[1] == pytest.approx(4.35)


def test_noise_levels_share_one_measurement():
    result = make_result((100, 200, 300), (0.1, 0.25, 0.5), n_points=300, method="corners")
    axes = figure_of(result, "axis-baseline-mm").axes[0]
    (marks,) = diamonds(axes)
    assert len(at(marks)) == 3
    np.testing.assert_allclose(marks.get_edgecolor()[0][:3], np.full(3, 0x22 / 255), atol=1e-9)


def test_a_geometry_that_one_noise_level_cannot_simulate_is_still_measured():
    result = make_result((100, 200, 300), (0.1, 0.5), n_points=300, method="corners")
    rows = result.rows.copy()
    lost = (rows["noise_px"] == 0.1) & (rows["baseline_mm"] == 200)
    rows.loc[lost, ["depth_rmse_mm", "predicted_depth_rmse_mm"]] = np.nan
    again = make_result((100, 200, 300), (0.1, 0.5), n_points=300, method="corners", rows=rows)
    (marks,) = diamonds(figure_of(again, "axis-baseline-mm").axes[0])
    assert at(marks)[:, 0].tolist() == [100, 200, 300]


def test_along_a_noise_axis_a_diamond_stands_at_the_noise_it_corresponds_to():
    result = make_result((100, 200), (0.1, 0.25, 0.5), n_points=300, method="corners", measured_px=0.01)
    figure = figure_of(result, "axis-noise-px")
    found = sorted(at(marks).tolist() for marks in diamonds(figure.axes[0]))
    rows = result.rows.drop_duplicates("baseline_mm")
    expected = rows["measured_disparity_std_px"].to_numpy() / math.sqrt(2)
    assert expected.tolist() == pytest.approx([0.01 * 1.06, 0.01 * 1.12])
    np.testing.assert_allclose([place for (place,) in found], np.c_[expected, rows["measured_depth_rmse_mm"]])
    assert figure.axes[0].get_xlim()[0] < 0.01
    notes = " ".join(text.get_text() for text in figure.texts).replace("\n", " ")
    assert "iamonds stand at the noise they correspond to" in notes


def test_lines_that_differ_in_the_pictures_keep_their_colours():
    result = make_result((100, 200), vergences_deg=(0.0, 5.0), n_points=300, method="patches")
    first, second = diamonds(figure_of(result, "axis-baseline-mm").axes[0])
    assert not np.allclose(first.get_edgecolor(), second.get_edgecolor())


def test_triangulators_with_the_same_measurement_share_its_marks():
    result = make_result((100, 200), triangulators=("optimal", "midpoint"), n_points=300, method="corners")
    assert len(diamonds(figure_of(result, "axis-baseline-mm").axes[0])) == 1
    (marks,) = diamonds(figure_of(result, "axis-triangulator").axes[0])[:1]
    assert at(marks)[:, 0].tolist() == [0, 1]


@pytest.mark.parametrize(("ratio", "mark"), [(9.0, "^"), (0.01, "v")])
def test_a_ratio_beyond_the_strip_is_an_arrow_with_its_number(result, ratio, mark):
    strip = figure_of(with_ratio(result, 4, ratio), "axis-baseline-mm").axes[2]
    low, high = strip.get_ylim()
    others = np.delete(result.rows["measured_over_predicted"].to_numpy(), 4)
    assert low < others.min() < others.max() < high
    assert not low < ratio < high
    assert arrows(strip) == [(250.0, mark)]
    assert strip.texts[0].get_text() == ("9.0" if ratio > 1 else "0.010")


def test_when_all_ratios_are_far_from_one_the_strip_reaches_them(result):
    rows = result.rows.copy()
    rows["measured_depth_rmse_mm"] *= 8
    strip = figure_of(make_result(n_points=300, method="corners", rows=rows), "axis-baseline-mm").axes[2]
    low, high = strip.get_ylim()
    (marks,) = diamonds(strip)
    assert strip.get_yscale() == "log"
    assert low < 1 < at(marks)[:, 1].max() < high
    assert low * high == pytest.approx(1)
    assert arrows(strip) == []


def test_the_simulations_strip_marks_what_lies_beyond_it_too():
    bins = make_result(n_points=100).by_depth.copy()
    names = ["depth_rmse_mm", "depth_rmse_ci_low_mm", "depth_rmse_ci_high_mm"]
    bins.loc[bins["baseline_mm"] == 150, names] /= 30
    strip = figure_of(make_result(n_points=100, by_depth=bins), "axis-baseline-mm").axes[1]
    assert arrows(strip) == [(150.0, "^")]


def test_the_ring_is_around_the_witness_that_is_flagged():
    result = make_result((100, 200, 300), n_points=300, method="corners", flagged=(0,), measured_flagged=(2,))
    axes = figure_of(result, "axis-baseline-mm").axes[0]
    circles = [mark for mark in axes.collections if isinstance(mark, PathCollection)]
    rings = [at(mark) for mark in circles if np.allclose(mark.get_sizes(), 120)]
    places = np.concatenate([ring for ring in rings if len(ring)])
    rows = at_same_distances(result)
    np.testing.assert_allclose(
        places, [(100, rows["depth_rmse_mm"][0]), (300, rows["measured_depth_rmse_mm"][2])]
    )


def test_measured_without_simulated_noise_is_drawn_alone():
    rows = make_result((100, 200), n_points=300, method="corners").rows.copy()
    rows[["depth_rmse_mm", "depth_rmse_ci_low_mm", "depth_rmse_ci_high_mm"]] = 0.0
    exact = make_result((100, 200), n_points=300, method="corners", rows=rows)
    axes = figure_of(exact, "axis-baseline-mm").axes[0]
    assert len(at(diamonds(axes)[0])) == 2
    assert [text.get_text() for text in axes.texts] == []


def test_depth_bins_that_only_the_pictures_reach_stand_in_their_middle():
    result = make_result((100,), n_points=600, method="corners")
    table = result.by_depth.copy()
    table.loc[3, ["depth_median_mm", "depth_rmse_mm", "predicted_depth_rmse_mm"]] = np.nan
    figure = figure_of(make_result((100,), n_points=600, method="corners", by_depth=table), "depth")
    near, far, measured = table.loc[3, ["depth_near_mm", "depth_far_mm", "measured_depth_rmse_mm"]]
    (found,) = [place for place in at(diamonds(figure.axes[0])[0]) if place[1] == measured]
    assert found[0] == pytest.approx(math.sqrt(near * far) / 1e3)


def test_a_sensor_is_an_axis_of_names():
    result = make_result((100, 200), n_points=300, method="corners")
    other = result.rows.assign(sensor="imx219")
    other["measured_depth_rmse_mm"] *= 3
    rows = pd.concat([result.rows, other], ignore_index=True)
    both = make_result(
        (100, 200),
        n_points=300,
        method="corners",
        rows=rows,
        swept=("baseline_mm", "sensor"),
        limits=("noise",) * 4,
    )
    against_baseline = figure_of(both, "axis-baseline-mm")
    assert legend_texts(against_baseline)[-2:] == ["ideal", "imx219"]
    assert len(diamonds(against_baseline.axes[0])) == 2
    against_sensor = figure_of(both, "axis-sensor").axes[-1]
    assert [label.get_text() for label in against_sensor.get_xticklabels()] == ["ideal", "imx219"]


def test_the_page_of_panels_holds_the_third_strip_for_each(result):
    figure = depth_error_figure(result)
    strips = [axes for axes in figure.axes if axes.get_ylabel() == "measured /\npredicted"]
    assert len(strips) == 2
    assert all(len(diamonds(strip)) for strip in strips)
    style.to_png(figure, dpi=50)


def test_who_is_flagged():
    # the witness is told by the value, whatever words the reason or the scene has
    found = [
        Agreement("agrees"),
        Agreement("flagged", "simulated", "not-exact", size_px=0.1),
        Agreement("flagged", "measured", "worse-than-claimed", ratio=1.8),
        Agreement("untold", "measured", "nothing-measured", cause="no board; none in left"),
        Agreement("untold", "simulated", "nothing-shared"),
        Agreement("flagged", "simulated", "all-failed", cause="scene measured: fell over"),
    ]
    rows = pd.DataFrame({"agreement": found})
    assert blamed(rows, "simulated").tolist() == [False, True, False, False, False, True]
    assert blamed(rows, "measured").tolist() == [False, False, True, False, False, False]


def test_the_noise_to_type_is_the_disparitys_over_root_two():
    row = {"measured_disparity_std_px": 0.1, "measured_method": "corners"}
    assert words.noise_value(row) == "0.071"
    assert "`--noise 0.071`" in words.equivalent_noise_words(row)
    assert "board corners" in words.equivalent_noise_words(row)
    for unknown in (math.nan, 0.0):
        assert words.equivalent_noise_words({**row, "measured_disparity_std_px": unknown}) == ""
