"""Sobol indices: closed forms, a real interaction, and what the first order says of small errors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.special import ndtri

from rigsim.present.tolerance.words import interactions_sentence, recalibration_sentence
from rigsim.rig.arrays import Array
from rigsim.rig.presets import PRESETS
from rigsim.study.tolerance.run import Build, Recalibration, ToleranceResult, run_tolerance
from rigsim.study.tolerance.sensitivities import (
    CLASSES,
    BuildRequirement,
    Tolerances,
    causes,
    sensitivities,
    shared_points,
)
from rigsim.study.tolerance.sobol import SHIFTS, SobolIndices, combine, estimate, interactions
from tests.helpers.sampling import close

RIG = PRESETS["boards"].rig


def indices(model: Callable[[Array], Array], quantities: int, seed: int = 0) -> SobolIndices:
    read = estimate(model, ndtri, quantities, np.random.default_rng(seed))
    assert read is not None
    found = combine(*read)
    assert found is not None
    return found


def test_a_sum_shares_the_variance_by_its_weights() -> None:
    # 3 a + 4 b + 0 c: 9/25, 16/25 and nothing, alone and in all
    found = indices(lambda x: x @ np.array([[3.0], [4.0], [0.0]]), 3)
    close(found.first, [0.36, 0.64, 0.0], rtol=0, atol=0.02)
    close(found.total, [0.36, 0.64, 0.0], rtol=0, atol=0.02)
    assert found.noticed == ()
    # the standard errors are those of the estimates: within four of the truth, and small
    truth = np.array([0.36, 0.64, 0.0])
    assert (np.abs(found.first - truth) <= 4 * found.first_se + 1e-12).all()
    assert (np.abs(found.total - truth) <= 4 * found.total_se + 1e-12).all()
    assert max(found.first_se.max(), found.total_se.max()) < 0.01


def test_a_product_of_two_acts_together_alone() -> None:
    # a b of standard normals: E(ab | a) = 0, so nothing alone and all of it together
    found = indices(lambda x: (x[:, 0] * x[:, 1])[:, None], 2)
    close(found.first, [0.0, 0.0], rtol=0, atol=0.06)
    close(found.total, [1.0, 1.0], rtol=0, atol=0.06)
    assert found.noticed == (0, 1)
    # a + b + ab has variance 3: 1/3 alone each, 2/3 in all each
    found = indices(lambda x: (x[:, 0] + x[:, 1] + x[:, 0] * x[:, 1])[:, None], 2)
    close(found.first, [1 / 3, 1 / 3], rtol=0, atol=0.04)
    close(found.total, [2 / 3, 2 / 3], rtol=0, atol=0.04)


def test_outputs_weigh_as_much_as_they_vary() -> None:
    # outputs 3 a and b: nine tenths of all variance are a's
    found = indices(lambda x: x * np.array([3.0, 1.0]), 2)
    close(found.first, [0.9, 0.1], rtol=0, atol=0.01)
    close(found.total, [0.9, 0.1], rtol=0, atol=0.01)


def test_what_is_not_finite_or_does_not_vary_has_none() -> None:
    rng = np.random.default_rng(0)
    assert estimate(lambda x: np.where(x > 2, np.nan, x), ndtri, 1, rng) is None
    flat = estimate(lambda x: np.zeros((len(x), 2)), ndtri, 1, rng)
    assert flat is not None
    assert flat[0].shape == (2, 1, SHIFTS, 2)
    assert combine(*flat) is None


def test_small_errors_share_the_variance_as_the_first_order_says() -> None:
    off = causes(RIG, CLASSES["calibrated"].tolerances(RIG))
    points = shared_points(RIG, 3.0, 60)
    found = interactions(RIG, off, points, np.random.default_rng(0))
    assert found is not None
    shares = {
        item.key: item.share for item in sensitivities(RIG, off, {3.0: points}, BuildRequirement(0.04, 3.0))
    }
    expected = np.array([shares[key] for key in found.keys])
    close(found.error.first, expected, rtol=0, atol=0.03)
    close(found.error.total, expected, rtol=0, atol=0.03)
    assert found.error.noticed == ()
    # a principal point moves every depth alike, a roll none on average
    assert found.bias is not None
    assert found.bias.first[[found.place("left_cx_px"), found.place("right_cx_px")]].sum() > 0.7
    assert abs(found.bias.first[found.place("roll_deg")]) < 1e-3


def test_a_real_rigs_interaction_against_its_closed_form() -> None:
    # every depth of 5 m is read as f B / ((f + df) B / 5 - dc), whatever its place in the image
    bounds = frozenset({"right_cx_px", "both_focal_px"})
    off = causes(RIG, Tolerances(right_cx_px=9.0, both_focal_px=270.0, bounds=bounds))
    found = interactions(RIG, off, shared_points(RIG, 5.0, 5), np.random.default_rng(0))
    assert found is not None
    # witness: f's share alone and in all by plain integrals over both, which are even within their bounds
    df, dc = (bound * np.linspace(-1, 1, 2001)[1::2] for bound in (270.0, 9.0))
    read_m = 900 * 0.12 / ((900 + df[:, None]) * 0.12 / 5 - dc)
    variance = read_m.var()
    alone = np.array([read_m.mean(axis=1).var(), read_m.mean(axis=0).var()]) / variance
    assert found.keys == ("both_focal_px", "right_cx_px")
    close(found.error.first, alone, rtol=0, atol=0.03)
    close(found.error.total, 1 - alone[::-1], rtol=0, atol=0.03)
    assert found.error.noticed == (0, 1)


def run(tolerances: Tolerances, depth_m: float) -> ToleranceResult:
    return run_tolerance(
        Build(RIG, tolerances, recalibration=Recalibration()),
        BuildRequirement(0.04, depth_m),
        (0.9, 5.0),
        n_rigs=50,
        n_points=120,
    )


def test_what_is_said() -> None:
    quiet = run(CLASSES["calibrated"].tolerances(RIG), 3.0)
    assert interactions_sentence(quiet).startswith("Each quantity acts on its own")
    # 2.05 m across half of what both see at 2.95 m, and half of the range along the depth
    assert recalibration_sentence(quiet).startswith(
        "Recalibration at its best: 60 features in 10 pictures, 0.25 px each, averaged to 0.079 px; lengths"
        " of 1.31, 2.05 and 2.77 m across and 2.05 m along the depth known to 0.5 mm"
    )
    assert interactions_sentence(replace(quiet, interactions=None)) == ""
    lost = run(CLASSES["printed"].tolerances(RIG), 5.0)
    assert lost.interactions is None
    assert interactions_sentence(lost).startswith("No Sobol indices at 5 m: some rigs have no depth at all")
    bounds = frozenset({"right_cx_px", "both_focal_px"})
    loud = run(Tolerances(right_cx_px=9.0, both_focal_px=270.0, bounds=bounds), 5.0)
    assert interactions_sentence(loud).startswith("Quantities act on one another: ")
    assert "% with others, " in interactions_sentence(loud)


def test_the_same_seed_gives_the_same_indices() -> None:
    off = causes(RIG, CLASSES["calibrated"].tolerances(RIG))
    points = shared_points(RIG, 3.0, 10)
    found = [interactions(RIG, off, points, np.random.default_rng(seed)) for seed in (1, 1, 2)]
    assert found[0] is not None
    assert found[1] is not None
    assert found[2] is not None
    assert np.array_equal(found[0].error.total, found[1].error.total)
    assert not np.array_equal(found[0].error.total, found[2].error.total)


def test_many_quantities_need_more_to_be_noticed() -> None:
    # Student's t with 7 degrees of freedom exceeds 4.785 once in a thousand, 7.272 once in twelve thousand
    def seen(quantities: int, errors: float) -> tuple[int, ...]:
        together = np.zeros(quantities)
        together[0] = 0.1
        se = np.full(quantities, 0.1 / errors)
        return SobolIndices(together, se, together, se, together, se).noticed

    assert (seen(1, 4.7), seen(1, 4.9)) == ((), (0,))
    assert (seen(12, 7.2), seen(12, 7.35)) == ((), (0,))
