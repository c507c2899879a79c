"""The sweep: witnesses agree where they should, and broken ones are flagged."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import pytest

from rigsim import Intrinsics, PixelNoise, Plan, RigGrid, Simulator, StereoRig, sweep, triangulate
from rigsim.errors import InvalidRange, InvalidScene, TriangulatorError
from rigsim.present.kit.agreement import spelled, text
from rigsim.present.sweep.words import verdict
from rigsim.study.agreement.agreement import kinds
from rigsim.study.scene.columns import AXES, DEPTH_COLUMNS, ROW_COLUMNS
from rigsim.theory.uncertainty import predict_depth_std
from tests.helpers.scenes import SLANTED, write

LENS = Intrinsics(320, 240, 300.0, 300.0, 150.0, 110.0)
RIG = StereoRig.rectified(LENS, 0.2, right=replace(LENS, cx=170.0))


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> str:
    return write(tmp_path_factory.mktemp("scene"), SLANTED)


def plan(scene: str, **changes: object) -> Plan:
    defaults = {"scene": scene, "renderer": "rays", "n_points": 300, "n_trials": 60, "measure": "none"}
    return Plan(**(defaults | changes))


RIGS = {
    "doffs": RIG,
    "verged": StereoRig.verged(LENS, 0.3, 10.0),
    "tall pixels": StereoRig.rectified(replace(LENS, fy=360.0), 0.2),
    "unequal": StereoRig(
        LENS, replace(LENS, fx=350.0, fy=352.0, cy=120.0), StereoRig.verged(LENS, 0.25, 4).right_from_left
    ),
}


@pytest.mark.parametrize("name", RIGS)
def test_prediction_and_simulation_agree(scene: str, name: str):
    result = sweep([RIGS[name]], plan(scene, noises=(PixelNoise(0.1), PixelNoise(0.3, correlation=0.5))))
    assert list(kinds(result.rows)) == ["agrees"] * 2
    assert (result.rows["predicted_over_simulated"] - 1).abs().max() < 0.05
    assert (result.rows["nees"] - 3).abs().max() < 0.15
    seen = result.by_depth[result.by_depth["visible_fraction"] > 0]
    assert (kinds(seen) == "agrees").all()
    assert result.agrees


def broken_swapped(rig, uv_left, uv_right):
    return triangulate(rig, uv_right, uv_left)


def broken_half_pixel(rig, uv_left, uv_right):
    return triangulate(rig, uv_left + np.array([0.5, 0.0]), uv_right)


def broken_millimetres(rig, uv_left, uv_right):
    return 1e3 * triangulate(rig, uv_left, uv_right)


def broken_doffs(rig, uv_left, uv_right):
    return triangulate(replace(rig, right=rig.left), uv_left, uv_right)


def broken_y(rig, uv_left, uv_right):
    return triangulate(rig, uv_left, uv_right) * (1, -1, 1)


def broken_principal_sign(rig, uv_left, uv_right):
    def mirror(lens: Intrinsics) -> Intrinsics:
        return replace(lens, cx=lens.width - 1 - lens.cx)

    return triangulate(replace(rig, left=mirror(rig.left), right=mirror(rig.right)), uv_left, uv_right)


@pytest.mark.parametrize(
    "broken",
    [broken_half_pixel, broken_millimetres, broken_doffs, broken_principal_sign],
)
def test_wrong_depth_is_flagged(scene: str, broken):
    result = sweep([RIG], plan(scene, triangulators=("optimal", broken)))
    assert result.rows["agreement"][0].kind == "agrees"
    assert text(result.rows["agreement"][1]).startswith("flagged: ")
    assert not result.agrees
    assert "1 of 2 rows is flagged" in " ".join(verdict(result).sentences)
    assert result.best[0] == 0


def test_swapped_cameras_find_nothing(scene: str):
    with pytest.raises(InvalidScene, match="every triangulation failed"):
        sweep([StereoRig.rectified(LENS, 0.2)], plan(scene, triangulators=(broken_swapped,)))


def test_flipped_rows_are_flagged_by_position(scene: str):
    row = sweep([RIG], plan(scene, triangulators=(broken_y,))).rows.loc[0]
    assert text(row["agreement"]).startswith("flagged: simulated position error")
    assert row["agreement_witness"] == "simulated"
    assert row["nees"] > 100
    assert row["point_rmse_mm"] > 3 * row["depth_rmse_mm"]


def test_rows_do_not_depend_on_what_else_is_swept(scene: str):
    alone = sweep([RIG], plan(scene, noises=(PixelNoise(0.2),)))
    grid = RigGrid(RIG, baselines_m=(0.1, 0.2, 0.3))
    among = sweep(
        grid, plan(scene, noises=(PixelNoise(0.5), PixelNoise(0.2)), triangulators=("dlt", "optimal"))
    )
    rows = among.rows[
        (among.rows["baseline_mm"] == 200)
        & (among.rows["noise_px"] == 0.2)
        & (among.rows["triangulator"] == "optimal")
    ]
    pd.testing.assert_frame_equal(rows.reset_index(drop=True), alone.rows, check_exact=True)


def test_noise_and_triangulators_draw_nothing_again(scene: str, monkeypatch: pytest.MonkeyPatch):
    drawn: list[StereoRig | None] = []
    for name in ("render", "check"):
        original = getattr(Simulator, name)

        def counted(self: Simulator, supersample: int, original: Any = original):
            drawn.append(self.scene.rig)
            return original(self, supersample)

        monkeypatch.setattr(Simulator, name, counted)
    grid = RigGrid(RIG, baselines_m=(0.1, 0.2))
    noises = tuple(PixelNoise(s) for s in (0.1, 0.2, 0.3))
    result = sweep(grid, plan(scene, noises=noises, triangulators=("optimal", "dlt")))
    assert len(result.rows) == 12
    assert len(drawn) == 2 + 1  # each rig once, and the best one again for its pictures


def test_columns_and_axes(scene: str):
    result = sweep(
        RigGrid(RIG, baselines_m=(0.1, 0.2), vergences_deg=(0.0, 4.0)),
        plan(scene, triangulators=("dlt", "midpoint")),
    )
    assert tuple(result.rows.columns) == ROW_COLUMNS
    assert tuple(result.by_depth.columns) == DEPTH_COLUMNS
    assert result.swept == ("baseline_mm", "vergence_deg", "triangulator")
    assert set(result.swept) <= set(AXES)


def test_resolution_behind_a_fixed_lens_is_one_axis(scene: str):
    grid = RigGrid(RIG, resolutions_px=((160, 120), (320, 240)))
    result = sweep(grid, plan(scene))
    assert result.swept == ("width_px",)
    assert "lens is fixed" in " ".join(verdict(result).sentences)


def test_depth_rows_hold_their_own_points(scene: str):
    result = sweep([RIG], plan(scene))
    by_depth = result.by_depth
    assert by_depth["n_points"].sum() == result.rows["n_points"][0] == 300
    inside = (by_depth["depth_median_mm"] >= by_depth["depth_near_mm"]) & (
        by_depth["depth_median_mm"] <= by_depth["depth_far_mm"]
    )
    assert inside.all()
    weight = by_depth["n_visible"]
    pooled = np.sqrt((by_depth["depth_rmse_mm"] ** 2 * weight).sum() / weight.sum())
    assert pooled == pytest.approx(result.rows["depth_rmse_mm"][0], rel=1e-9)


def test_no_noise_leaves_arithmetic_alone_and_tells_nothing_of_noise(scene: str):
    result = sweep([RIG], plan(scene, noises=(PixelNoise(0.0),)))
    row = result.rows.loc[0]
    assert text(row["agreement"]).startswith("untold: without noise there is no error to compare")
    assert "In 1 of 1 row there is not enough to tell" in " ".join(verdict(result).sentences)
    assert np.isnan(row["nees"])
    assert row["depth_rmse_mm"] < 1e-9 * row["depth_median_mm"]
    assert row["predicted_depth_rmse_mm"] == 0


def test_low_disparity_is_counted_and_kept_out(scene: str):
    noise = PixelNoise(2.5)  # sigma_d 3.54 px, so points beyond f b / (4 sigma_d) = 4.24 m are out
    result = sweep([RIG], plan(scene, noises=(noise,)))
    row = result.rows.loc[0]
    assert 0.1 < row["low_disparity_fraction"] < 0.9
    far = result.by_depth[result.by_depth["depth_near_mm"] > 4243]
    assert (far["low_disparity_fraction"] == 1).all()
    assert far["depth_rmse_mm"].isna().all()
    assert (spelled(far)["agreement"] == "untold: every depth is below 4 of its standard deviations").all()
    assert row["agreement"].kind == "agrees"
    assert row["depth_median_mm"] < 4243
    # the sentence speaks of it
    assert "under 4 of its own standard deviations" in " ".join(verdict(result).sentences)


def test_rigs_without_overlap_are_untold_among_others(scene: str):
    result = sweep(RigGrid(RIG, baselines_m=(0.2, 7.0, 40.0)), plan(scene))
    agreement = spelled(result.rows)["agreement"]
    assert agreement[0] == "agrees"
    assert agreement[1] == "untold: left and right see nothing in common"
    assert agreement[2].startswith("untold: ")
    assert "sees nothing" in agreement[2]  # its left camera stands 20 m aside
    assert result.agrees
    assert "In 2 of 3 rows there is not enough to tell" in " ".join(verdict(result).sentences)
    assert list(result.rows["visible_fraction"][1:]) == [0, 0]
    assert result.limits[1:] == ("no result", "no result")


def test_no_overlap_anywhere_is_an_error(scene: str):
    with pytest.raises(
        InvalidScene, match=r"no rig has a result \(left and right see nothing in common\).*--baseline"
    ):
        sweep([StereoRig.rectified(LENS, 7.0)], plan(scene))


def test_showcase_repeats_its_row(scene: str):
    result = sweep(RigGrid(RIG, baselines_m=(0.1, 0.2)), plan(scene, triangulators=("dlt", "optimal")))
    shown = result.showcase
    assert shown.row == result.best[0]
    row = result.rows.loc[shown.row]
    assert shown.rig.baseline_m * 1e3 == pytest.approx(row["baseline_mm"])
    assert np.sqrt(np.nanmean(shown.depth_rmse_m**2)) * 1e3 == pytest.approx(row["depth_rmse_mm"], rel=1e-12)
    np.testing.assert_array_equal(np.isfinite(shown.depth_rmse_m), shown.visible)
    predicted = predict_depth_std(shown.rig, shown.points_left[shown.visible], shown.noise)
    assert np.corrcoef(predicted, shown.depth_rmse_m[shown.visible])[0, 1] > 0.9


def test_headline_has_the_numbers_of_its_bin(scene: str):
    result = sweep([RIG], plan(scene))
    row = result.rows.loc[0]
    middle = result.by_depth[result.by_depth["depth_far_mm"] >= row["depth_median_mm"]].iloc[0]
    assert f"{middle['depth_rmse_mm']:.3g} mm RMS" in verdict(result).headline
    assert "200 mm of baseline" in verdict(result).headline


def test_interrupted_sweep_keeps_what_is_done(scene: str):
    def stop(done: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    result = sweep(RigGrid(RIG, baselines_m=(0.1, 0.2, 0.3)), plan(scene), progress=stop)
    assert not result.complete
    assert list(result.rows["baseline_mm"]) == [100, 200]
    assert "interrupted" in verdict(result).sentences[0]


@pytest.mark.parametrize("method", ["magic", "nowhere:f", "json:dumps"])
def test_unusable_triangulators(scene: str, method: str):
    with pytest.raises(TriangulatorError):
        sweep([RIG], plan(scene, triangulators=(method,)))


def test_nothing_to_sweep():
    with pytest.raises(InvalidRange, match="at least one"):
        sweep([])
    with pytest.raises(InvalidRange, match="jobs 0"):
        sweep([RIG], jobs=0)


def test_a_study_leaves_mujoco_to_the_simulator():
    # mujoco must not be imported before a working GL library was chosen for it
    code = "import sys, rigsim.study.sweep.run, rigsim.study.scene.snapshot; print('mujoco' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
