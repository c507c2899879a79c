"""What is known of each pixel while one drags."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from rigsim import BrownConrady, Intrinsics, Simulator, StereoRig, predict_depth_std
from rigsim.errors import InvalidNoise
from rigsim.rig.perturbation import Perturbation
from rigsim.study.glance import Glimpse, glance, picture_size
from tests.helpers.scenes import SLANTED, write

LENS = Intrinsics.from_focal(1280, 720, 900.0)
RIG = StereoRig.rectified(LENS, 0.12)
BENT = replace(LENS, lens=BrownConrady(-0.2, 0.05))


@pytest.fixture(scope="module")
def simulator(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Simulator]:
    with Simulator(write(tmp_path_factory.mktemp("scene"), SLANTED)) as opened:
        yield opened


def test_disparity_and_error_are_those_of_the_rigs_own_pictures(simulator: Simulator) -> None:
    seen = glance(simulator, Glimpse(RIG, None, True, 0.25))
    assert seen.left.shape == seen.right.shape == (180, 320, 3)
    both = np.isfinite(seen.disparity_px)
    assert both.mean() > 0.7
    depth = seen.depth_m[both]
    np.testing.assert_allclose(seen.disparity_px[both], 900 * 0.12 / depth, rtol=1e-5)
    std_m = depth**2 / (900 * 0.12) * 0.25 * np.sqrt(2)
    np.testing.assert_allclose(seen.depth_std_m[both], std_m, rtol=1e-5)
    assert np.isnan(seen.depth_std_m[~both]).all()


@pytest.mark.parametrize(
    ("rig", "within"),
    [
        (RIG, 1e-6),
        (StereoRig.verged(LENS, 0.2, 8.0), 5e-3),
        (StereoRig.rectified(BENT, 0.12), 5e-3),
    ],
    ids=["rectified", "verged", "bent"],
)
def test_a_large_pictures_error_is_predicted_at_each_pixel(
    simulator: Simulator, rig: StereoRig, within: float
) -> None:
    seen = glance(simulator, Glimpse(rig, None, False, 0.5))
    v, u = np.nonzero(np.isfinite(seen.depth_std_m))
    chosen = np.random.default_rng(3).choice(len(v), 4000, replace=False)
    v, u = v[chosen], u[chosen]
    rays = np.column_stack([rig.left.normalize(np.column_stack([u, v]).astype(float)), np.ones(len(u))])
    exact = predict_depth_std(rig, rays * seen.depth_m[v, u][:, None], 0.5)
    np.testing.assert_allclose(seen.depth_std_m[v, u], exact, rtol=within)
    assert len(np.unique(np.round(exact, 3))) > 20


def test_the_built_rig_takes_the_pictures_and_the_assumed_one_says_the_depth(simulator: Simulator) -> None:
    built = Perturbation(pitch_rad=math.radians(2.0)).apply(RIG)
    plain = glance(simulator, Glimpse(RIG, None, True, 0.25))
    seen = glance(simulator, Glimpse(RIG, None, True, 0.25, built=built))
    np.testing.assert_array_equal(seen.depth_m, plain.depth_m)
    np.testing.assert_array_equal(seen.depth_std_m, plain.depth_std_m)
    np.testing.assert_array_equal(seen.left, plain.left)
    # the right camera looks 2 deg further up: what it sees lies 225 tan(2 deg) = 7.9 px further down
    shifted = {rows: np.roll(plain.right.astype(float), rows, axis=0) for rows in (-8, 0, 6, 8, 10)}
    apart = {rows: np.abs(picture - seen.right)[20:-20].mean() for rows, picture in shifted.items()}
    assert min(apart, key=lambda rows: apart[rows]) == 8


def test_sizes_keep_the_shape_and_bound_the_work() -> None:
    assert picture_size(RIG, coarse=True) == (320, 180)
    assert picture_size(RIG, coarse=False) == (1280, 720)
    tall = StereoRig.rectified(Intrinsics.from_focal(4056, 3040, 3000.0), 0.1)
    width, height = picture_size(tall, coarse=False)
    assert width * height <= 1_310_000
    assert width / height == pytest.approx(4056 / 3040, rel=2e-3)
    tiny = StereoRig.rectified(Intrinsics.from_focal(64, 48, 50.0), 0.1)
    assert picture_size(tiny, coarse=True) == (64, 48)


def test_whoever_no_longer_waits_ends_the_work(simulator: Simulator) -> None:
    calls = []

    def between() -> None:
        calls.append(len(calls))
        if len(calls) == 2:
            raise KeyError("enough")

    with pytest.raises(KeyError):
        glance(simulator, Glimpse(RIG, None, True, 0.25), between)
    assert calls == [0, 1]


def test_a_noise_that_cannot_be_is_refused(simulator: Simulator) -> None:
    with pytest.raises(InvalidNoise, match="-1"):
        glance(simulator, Glimpse(RIG, None, True, -1.0))
