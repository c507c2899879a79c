"""What a person passes to the public API: taken where it is clear, else one line of what is wanted."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rigsim
from rigsim import (
    PRESETS,
    BrownConrady,
    Intrinsics,
    Perturbation,
    PixelNoise,
    Pose,
    RigsimError,
    Simulator,
    StereoRig,
    read_rig,
    write_rig,
)
from rigsim.interop.formats.opencv_yaml import opencv_yaml

Grid: Any = rigsim.RigGrid  # a person's script is checked by nothing
Plan: Any = rigsim.Plan
RIG = StereoRig.rectified(Intrinsics.from_focal(640, 480, 500.0), 0.1)
POINT = [[0.0, 0.0, 2.0]]
WRONG = ["word", None, (), {}, object(), "", b"0.1", [None], 1j]
"""What no number, rig, path or point is."""

PREDICTIONS = [
    rigsim.predict_covariance,
    rigsim.predict_depth_std,
    rigsim.predict_depth_bias,
    rigsim.predict_depth_rmse,
    rigsim.depth_in_sigmas,
]


@pytest.mark.parametrize("predict", PREDICTIONS)
@pytest.mark.parametrize("noise", [0.25, np.float32(0.25), np.float64(0.25), np.array(0.25), Fraction(1, 4)])
def test_a_number_is_a_noise(predict: Any, noise: Any) -> None:
    expected = predict(RIG, np.array(POINT), PixelNoise(0.25))
    np.testing.assert_array_equal(predict(RIG, POINT, noise), expected)


def test_a_number_is_a_noise_by_hand() -> None:
    # Z^2 / (f B) sqrt(2) sigma = 4 / 50 * .25 * sqrt(2) = 28.2843 mm
    assert rigsim.predict_depth_std(RIG, POINT, 0.25)[0] == pytest.approx(0.0282842712)
    assert rigsim.predict_depth_std(RIG, tuple(map(tuple, POINT)), 1)[0] == pytest.approx(4 * 0.0282842712)


def test_one_value_is_an_axis() -> None:
    for one in (0.2, [0.2], (0.2,), np.array([0.2]), np.array(0.2), np.float64(0.2), range(1, 2)):
        grid = Grid(RIG, baselines_m=one)
        assert len(grid) == 1
        assert next(iter(grid)).baseline_m == pytest.approx(1.0 if isinstance(one, range) else 0.2)
    assert len(Grid(RIG, baselines_m=np.linspace(0.1, 0.3, 3), hfovs_deg=60)) == 3
    grid = Grid(RIG, resolutions_px=(320, 240))
    assert [(rig.left.width, rig.left.height) for rig in grid] == [(320, 240)]
    assert len(Grid(RIG, resolutions_px=np.array([[320, 240], [640, 480]]))) == 2


def test_a_plan_takes_one_for_several() -> None:
    plan = Plan(noises=0.5, triangulators="dlt", range_m=[1, 3], n_points=np.int64(10), scene=Path("bin"))
    assert plan == Plan(
        noises=(PixelNoise(0.5),), triangulators=("dlt",), range_m=(1.0, 3.0), n_points=10, scene="bin"
    )
    assert Plan(noises=[0.1, PixelNoise(0.2)]).noises == (PixelNoise(0.1), PixelNoise(0.2))
    assert Plan(noises=np.array([0.1, 0.2])).noises == (PixelNoise(0.1), PixelNoise(0.2))


def test_rigs_are_read_from_text_and_paths_of_any_format(tmp_path: Path) -> None:
    toml, yaml = tmp_path / "rig.toml", tmp_path / "stereo.yml"
    toml.write_text(write_rig(RIG))
    yaml.write_text(opencv_yaml(RIG))
    for path in (str(toml), toml, str(yaml), yaml):
        assert read_rig(path).left.fx == pytest.approx(500.0)
        assert read_rig(path).baseline_m == pytest.approx(0.1)
    toml.rename(tmp_path / "other.toml")
    assert read_rig(str(tmp_path)).baseline_m == pytest.approx(0.1)


def test_numpy_numbers_make_cameras() -> None:
    sizes: Any = (np.int32(640), np.int64(480), np.float32(500))
    lens = Intrinsics.from_focal(*sizes)
    assert lens == RIG.left
    assert isinstance(lens.width, int)
    assert BrownConrady(np.float64(0.1)) == BrownConrady(0.1)


@pytest.mark.parametrize("wrong", WRONG, ids=lambda value: "object" if type(value) is object else repr(value))
@pytest.mark.parametrize(
    "call",
    [
        read_rig,
        write_rig,
        rigsim.preset,
        BrownConrady,
        PixelNoise,
        Perturbation,
        lambda value: Pose(t=value),
        lambda value: Pose(R=value),
        Pose.from_rotvec,
        lambda value: Intrinsics(value, 480, 500, 500, 1, 1),
        lambda value: Intrinsics(640, 480, value, 500, 1, 1),
        lambda value: Intrinsics(640, 480, 500, 500, value, 1),
        lambda value: Intrinsics.from_focal(value, 480, 500),
        lambda value: Intrinsics.from_hfov(640, 480, value),
        lambda value: Intrinsics.from_lens(640, 480, value, 5),
        lambda value: StereoRig(value, RIG.right, RIG.right_from_left),
        lambda value: StereoRig(RIG.left, RIG.right, value),
        lambda value: StereoRig.rectified(value, 0.1),
        lambda value: StereoRig.rectified(RIG.left, value),
        lambda value: StereoRig.verged(RIG.left, 0.1, value),
        Grid,
        lambda value: Plan(noises=value),
        lambda value: Plan(n_points=value),
        lambda value: Plan(seed=value),
        lambda value: Plan(sensors=value),
        lambda value: Plan(scene=value) if not isinstance(value, str) or not value else Simulator(value),
        lambda value: rigsim.sweep(value, Plan()),
        lambda value: rigsim.sweep(RIG, value) if value else rigsim.sweep(value),
        lambda value: rigsim.triangulate(value, [[1, 1]], [[0, 1]]),
        lambda value: rigsim.triangulate(RIG, value, [[0, 1]]),
        lambda value: rigsim.triangulate(RIG, [[1, 1]], [[0, 1]], value),
        lambda value: rigsim.depth_sensitivity(value, POINT),
        lambda value: rigsim.depth_sensitivity(RIG, value),
        lambda value: rigsim.row_sensitivity(value, POINT),
        lambda value: rigsim.row_sensitivity(RIG, value),
        lambda value: rigsim.parallax_px(RIG, value),
        lambda value: rigsim.depth_bounds(RIG, value, 1.0),
        *(lambda value, predict=predict: predict(value, POINT, 0.25) for predict in PREDICTIONS),
        *(lambda value, predict=predict: predict(RIG, value, 0.25) for predict in PREDICTIONS),
        *(lambda value, predict=predict: predict(RIG, POINT, value) for predict in PREDICTIONS),
    ],
)
def test_anything_else_is_one_line(
    call: Any, wrong: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(RigsimError) as told:
        call(wrong)
    assert "\n" not in str(told.value)
    assert str(told.value)


def test_presets_are_as_many_rigs() -> None:
    assert all(isinstance(preset.rig, StereoRig) for preset in PRESETS.values())
