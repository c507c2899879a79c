"""The rig in the lens model that its calibration uses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import rigsim
from rigsim.errors import InvalidRange
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.rational import Rational
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.plan.free import estimated
from rigsim.study.calibrate.plan.models import in_model, lens_model, own_model, seldom_estimated
from tests.helpers.calibrate.board_rigs import RIG
from tests.helpers.sampling import RIGS

BENT = BrownConrady(-0.12, 0.03, 0.001, -0.0015, -0.004)


@pytest.mark.parametrize(
    ("lens", "model"),
    [
        (None, BrownConrady),
        (None, Rational),
        (BENT, Rational),
        (Rational(-0.12, 0.03, 0.001, -0.0015, -0.004), BrownConrady),
        (BENT, BrownConrady),
    ],
)
def test_a_model_that_holds_a_lens_holds_it_exactly(lens: Lens | None, model: type[Lens]) -> None:
    rig = StereoRig(replace(RIG.left, lens=lens), replace(RIG.right, lens=None), RIG.right_from_left)
    made, remarks = in_model(rig, model)
    # a lens of no effect is none
    assert all(camera.lens is None or type(camera.lens) is model for camera in (made.left, made.right))
    assert not remarks
    points = np.random.default_rng(0).uniform((-0.3, -0.2, 0.8), (0.3, 0.2, 2), (50, 3))
    np.testing.assert_allclose(made.left.project(points), rig.left.project(points), atol=1e-9)
    np.testing.assert_allclose(made.right.project(points), rig.right.project(points), atol=1e-9)


def test_another_model_is_fitted_and_says_how_far_off() -> None:
    made, (remark,) = in_model(RIGS["distorted"], KannalaBrandt)
    assert isinstance(made.left.lens, KannalaBrandt)
    assert remark.code == "lens_model"
    assert " px rms" in remark.text
    points = np.random.default_rng(0).uniform((-0.5, -0.3, 1), (0.5, 0.3, 1), (200, 3))
    off = made.left.project(points) - RIGS["distorted"].left.project(points)
    rms = float(remark.text.split(" px rms")[0].split()[-1])
    # it was judged over the whole picture, these points are in its inner part
    assert np.sqrt(np.mean(np.sum(off**2, axis=1))) < 2 * rms


def test_a_model_too_narrow_for_the_rig_is_refused() -> None:
    wide = rigsim.Intrinsics(800, 800, 200.0, 200.0, 400.0, 400.0, KannalaBrandt())
    with pytest.raises(InvalidRange, match=r"shows no picture as wide .*: --model kannala_brandt holds"):
        in_model(StereoRig.rectified(wide, 0.1), BrownConrady)


def test_a_model_that_fits_too_far_names_one_that_does_better() -> None:
    strong = rigsim.Intrinsics(800, 800, 400.0, 400.0, 399.5, 399.5, KannalaBrandt(0.08, -0.01))
    rig = StereoRig.rectified(strong, 0.1)
    _, (remark,) = in_model(rig, BrownConrady)
    assert remark.text.endswith("trustworthy plan: --model kannala_brandt holds them exactly")
    # of two lenses of two kinds no model need hold both, but one is the nearest
    mixed = StereoRig(strong, replace(strong, lens=BrownConrady(-0.3, 0.1)), rig.right_from_left)
    _, (remark,) = in_model(mixed, rigsim.FieldOfView)
    _, (nearest,) = in_model(mixed, Rational)
    rms = nearest.text.split(" px rms")[0].split()[-1]
    assert float(rms) < 0.01
    assert remark.text.endswith(f"--model rational fits them with {rms} px rms")


def test_names_of_models() -> None:
    assert lens_model("fisheye") is KannalaBrandt
    assert lens_model("brown") is BrownConrady
    with pytest.raises(InvalidRange, match="lens model 'pinhole': must be one of brown, rational"):
        lens_model("pinhole")


def test_a_rig_is_calibrated_as_what_it_is() -> None:
    plain = StereoRig.rectified(rigsim.Intrinsics.from_focal(640, 480, 500.0), 0.1)
    assert own_model(plain) is BrownConrady
    assert own_model(RIG) is BrownConrady
    assert seldom_estimated(RIG, BrownConrady) == ()
    assert seldom_estimated(RIG, Rational) == ("s1", "s2", "s3", "s4", "tau_x", "tau_y")
    prism = replace(RIG.left, lens=Rational(s1=0.01))
    assert seldom_estimated(StereoRig(prism, prism, RIG.right_from_left), Rational) == ()


def test_what_does_nothing_of_its_own_is_held() -> None:
    """Around a pinhole a rational lens's k4 undoes its k1; a field of view of 0 has no slope at all."""
    plain = StereoRig.rectified(rigsim.Intrinsics.from_focal(640, 480, 500.0), 0.1)
    parameters, (remark,) = estimated(plain, Rational, fix=("p1",))
    free = set(parameters.free_names(plain))
    assert {"left.k1", "right.k3", "left.p2"} <= free
    assert not free & {"left.k4", "right.k5", "right.k6", "left.p1", "left.s1", "right.tau_x"}
    assert remark.code == "held"
    assert remark.text.startswith("k4, k5, k6 of the rational model are held")
    parameters, _ = estimated(plain, rigsim.FieldOfView)
    assert not any(name.endswith(".w") for name in parameters.free_names(plain))


def test_what_does_something_of_its_own_is_estimated() -> None:
    bent = replace(RIG.left, lens=Rational(-0.2, 0.06, 0.001, -0.001, 0.004, 0.1, 0.01, 0.003))
    rig = StereoRig(bent, bent, RIG.right_from_left)
    parameters, remarks = estimated(rig, Rational)
    assert not remarks
    assert parameters.free.sum() == 2 * 12 + 6
    parameters, remarks = estimated(RIG, BrownConrady, warped=True)
    assert not remarks
    assert parameters.free.all()
    assert parameters.warped
