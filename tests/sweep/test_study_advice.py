"""Every advice that a sweep without a result gives is followed, and succeeds."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from rigsim import Intrinsics, PixelNoise, Plan, RigGrid, StereoRig, sweep
from rigsim.errors import InvalidScene, RenderUnavailable
from rigsim.sim.render import check_size
from rigsim.typed import quantity
from tests.helpers.scenes import SLANTED, write

LENS = Intrinsics(160, 120, 150.0, 150.0, 79.5, 59.5)
BLIND = SLANTED.replace('<site name="rig" pos="0 0 1"/>', '<site name="rig" pos="0 0 1" euler="0 0 180"/>')


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> str:
    return write(tmp_path_factory.mktemp("scene"), SLANTED)


def plan(scene: str, **changes: object) -> Plan:
    defaults = {"scene": scene, "renderer": "rays", "n_points": 100, "n_trials": 5, "measure": "none"}
    return Plan(**(defaults | changes))


def rig(length_m: float) -> RigGrid:
    return RigGrid(StereoRig.rectified(LENS, length_m))


def advice(rigs: RigGrid, asked: Plan) -> str:
    with pytest.raises(InvalidScene, match="no rig has a result") as refused:
        sweep(rigs, asked)
    return str(refused.value).rpartition("): ")[2]


def option(text: str, name: str) -> list[str]:
    """What is to be typed after an option."""
    return re.findall(rf"--{name}(?:: (?:from|up to))? (?:of )?([\w.:]+)", text)


def has_result(rigs: RigGrid, asked: Plan) -> bool:
    return bool(sweep(rigs, asked).rows["depth_rmse_mm"].notna().all())


@pytest.mark.parametrize(
    ("typed_m", "question", "verb"),
    [
        (0.00006, "0.06 mm of baseline: 60 mm meant", "longer"),
        (60.0, "60 m of baseline: 60 mm meant", "shorter"),
    ],
)
def test_a_baseline_is_longer_or_shorter_as_it_must_be(scene: str, typed_m: float, question: str, verb: str):
    said = advice(rig(typed_m), plan(scene))
    assert question in said
    assert f"a {verb} --baseline" in said
    lengths = option(said, "baseline")
    assert len(lengths) == 2
    for text in lengths:
        assert has_result(rig(quantity.value(text, quantity.BASELINE) / 1e3), plan(scene)), text


def test_the_least_baseline_is_where_half_of_the_points_pass(scene: str):
    # the wall's middle is 4 m away: Z / sigma = f B / (Z sqrt(2) 0.25 px) = 4 at B = 37.7 mm
    said = advice(rig(0.0004), plan(scene))
    (least,) = [
        float(text) for text in option(said.partition("longer")[2], "baseline") or option(said, "baseline")
    ][-1:]
    assert 30 < least < 60


def test_a_range_without_points_is_told_one_that_has_some(scene: str):
    asked = plan(scene, range_m=(0.5, 1.0))
    (text,) = option(advice(rig(0.2), asked), "range")
    near_mm, far_mm = quantity.span(text, quantity.DEPTH)
    assert has_result(rig(0.2), replace(asked, range_m=(near_mm / 1e3, far_mm / 1e3)))


def test_noise_that_drowns_all_depths_is_told_how_much_will_do(scene: str):
    asked = plan(scene, noises=(PixelNoise(90.0),), range_m=(3.0, 3.5))
    said = advice(rig(0.2), asked)
    for text in option(said, "noise"):
        assert has_result(rig(0.2), replace(asked, noises=(PixelNoise(float(text)),)))
    assert option(said, "noise") or option(said, "baseline")


def test_a_mount_that_sees_nothing_is_told_one_that_does(tmp_path_factory: pytest.TempPathFactory):
    blind = write(tmp_path_factory.mktemp("blind"), BLIND)
    said = advice(rig(0.2), plan(blind))
    (mount,) = re.findall(r"--mount (camera:\w+)", said)
    assert mount == "camera:front"
    assert has_result(rig(0.2), plan(blind, mount=mount))


def test_a_picture_that_is_too_large_is_told_the_largest():
    # the renderer's own limit is 16,384 px
    with pytest.raises(RenderUnavailable) as refused:
        check_size(replace(LENS, width=20_000), 2)
    (largest,) = re.findall(r"--resolution of at most (\d+) px", str(refused.value))
    assert largest == "8192"
    check_size(replace(LENS, width=int(largest)), 2)


def test_where_nothing_helps_nothing_is_advised(tmp_path_factory: pytest.TempPathFactory):
    empty = write(
        tmp_path_factory.mktemp("empty"),
        '<mujoco><worldbody><site name="rig" pos="0 0 1"/><geom type="sphere" pos="-5 0 1" size=".1"/>'
        "</worldbody></mujoco>",
    )
    assert advice(rig(0.2), plan(empty)).startswith("no baseline, --range, --noise or named --mount")
