"""The one small figure of the three witnesses."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.container import ErrorbarContainer

from rigsim.present.kit import style
from rigsim.present.sweep.plots.witnesses import witnesses_figure
from tests.helpers.synthetic_sweeps import make_result


def marks(axes: Axes) -> list[np.ndarray]:
    """Positions of the simulated, then of the measured marks."""
    bars = [held for held in axes.containers if isinstance(held, ErrorbarContainer)]
    return [np.asarray(held.lines[0].get_xydata()) for held in bars]


def test_both_witnesses_stand_beside_their_predictions_and_over_them() -> None:
    result = make_result(n_points=400, method="corners")
    rows = result.rows
    axes, strip, by_depth, _ = witnesses_figure(result).axes
    simulated, measured = marks(axes)
    np.testing.assert_allclose(simulated, rows[["baseline_mm", "depth_rmse_mm"]])
    np.testing.assert_allclose(measured, rows[["baseline_mm", "measured_depth_rmse_mm"]])
    for line, column in zip(
        axes.lines[:3:2], ("predicted_depth_rmse_mm", "predicted_from_measured_rmse_mm"), strict=True
    ):
        curve = np.log(np.asarray(line.get_xydata()).T)
        np.testing.assert_allclose(np.exp(np.interp(np.log(rows["baseline_mm"]), *curve)), rows[column])
    over, measured_over = marks(strip)
    np.testing.assert_allclose(over[:, 1], 1 / rows["predicted_over_simulated"])  # both errors on top
    np.testing.assert_allclose(measured_over[:, 1], rows["measured_over_predicted"])
    best = result.by_depth[result.by_depth["baseline_mm"] == rows.loc[result.best[0], "baseline_mm"]]
    np.testing.assert_allclose(marks(by_depth)[1][:, 1], best["measured_depth_rmse_mm"].dropna())


def test_the_legend_names_both_noises() -> None:
    figure = witnesses_figure(make_result((100, 200), n_points=400, method="patches"))
    texts = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "predicted from 0.25 px of noise" in texts
    assert "predicted from the accuracy they claim" in texts
    assert "measured: matched patches, 0.0045 px of noise" in texts


@pytest.mark.parametrize(
    ("axes", "panels"),
    [
        ({"baselines_mm": (120,)}, 1),
        ({"baselines_mm": (100, 200)}, 2),
        ({"baselines_mm": (120,), "noises_px": (0.1, 0.5)}, 2),
        ({"baselines_mm": (120,), "triangulators": ("optimal", "midpoint")}, 1),
        ({"baselines_mm": (100, 200), "noises_px": (0.1, 0.5), "vergences_deg": (0.0, 5.0)}, 2),
    ],
)
def test_every_sweep_has_one_with_one_curve_a_witness(axes: dict[str, Any], panels: int) -> None:
    figure = witnesses_figure(make_result(**axes, n_points=300, method="corners"))
    assert len(figure.axes) == 2 * panels
    assert all(len(marks(main)) == 2 for main in figure.axes[::2])
    style.to_png(figure, dpi=50)
    for main in figure.axes[::2]:
        box = main.title.get_window_extent()
        assert box.x1 < figure.bbox.x1
        assert box.y1 < figure.legends[0].get_window_extent().y0
