"""The verdict on many calibrations: how often it is wrong of right ones, and what it sees of wrong ones."""

from __future__ import annotations

import numpy as np
import pytest

from rigsim.study.agreement.agreement import Agreement
from rigsim.study.calibrate.witness.judge import FALSE_ALARMS, SIMULATED, JudgedErrors, Slack, judge

STRICT = Slack(0.0, 0.0, 0.0)


def found(
    rng: np.random.Generator, count: int, scale: float = 1.0, shift: float = 0.0, misfit: float = 1.0
) -> JudgedErrors:
    """Calibrations of 30 parameters, of which depths at three distances are mixtures."""
    errors = scale * rng.standard_normal((count, 30))
    mixed = np.array([[0.8, 0.6], [0.6, 0.8], [0.5, 0.866]]) @ errors[:, :2].T
    degrees = 1000 * count
    noise = np.sqrt(rng.chisquare(degrees) / degrees)
    return JudgedErrors(
        count, mixed.T + shift, float((errors**2).sum()), errors.size, misfit * noise, degrees
    )


def kinds(count: int, slack: Slack = STRICT, trials: int = 300, **wrong: float) -> list[Agreement]:
    rng = np.random.default_rng(7)
    return [judge("simulated", found(rng, count, **wrong), slack) for _ in range(trials)]


def test_false_alarms_are_as_rare_as_promised() -> None:
    """Two in 3000, with room for chance: as many as 9 come up once in a thousand such tests."""
    flagged = sum(one.kind == "flagged" for one in kinds(20, trials=3000))
    assert flagged <= 9
    assert FALSE_ALARMS == 1e-3


@pytest.mark.parametrize(
    ("wrong", "reason", "quantity"),
    [
        ({"scale": 2.0}, "spread", "parameter spread"),
        ({"scale": 0.5}, "spread", "parameter spread"),
        ({"shift": 3.0}, "mean", "mean depth"),
        ({"shift": -3.0}, "mean", "mean depth"),
        ({"misfit": 1.3}, "spread", "residuals"),
    ],
)
def test_what_is_wrong_is_seen_and_named(wrong: dict[str, float], reason: str, quantity: str) -> None:
    for one in kinds(20, SIMULATED, 50, **wrong):
        assert (one.kind, one.reason, one.quantity) == ("flagged", reason, quantity)


def test_slack_excuses_no_more_than_it_says() -> None:
    assert not any(one.kind == "flagged" for one in kinds(300, SIMULATED, 50, scale=1.03))
    assert all(one.kind == "flagged" for one in kinds(300, SIMULATED, 50, scale=1.12))


def test_too_few_are_untold() -> None:
    (one,) = kinds(7, trials=1)
    assert (one.kind, one.reason, one.count) == ("untold", "too-few-trials", (7, 8))


def test_failures_are_flagged() -> None:
    rng = np.random.default_rng(0)
    whole = found(rng, 20)
    none = JudgedErrors(20, np.empty((0, 3)), 0.0, 0, float("nan"), 0)
    some = JudgedErrors(30, whole.depth_z, whole.parameter_square, whole.parameter_degrees, 1.0, 0)
    assert judge("measured", none, STRICT).reason == "all-failed"
    assert judge("measured", some, STRICT).reason == "some-failed"


def test_enough_agree_with_an_interval_round_the_ratio() -> None:
    (one,) = kinds(60, trials=1)
    assert one.kind == "agrees"
    assert one.interval is not None
    assert one.ratio is not None
    assert one.interval[0] < one.ratio < one.interval[1]
