"""What a sweep says is off: mistakes of every kind are named, with their amount and direction."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from rigsim import BrownConrady, Intrinsics, Perturbation, PixelNoise, StereoRig, triangulate
from rigsim.present.kit.mistakes.faults import fault as in_words
from rigsim.rig.arrays import Array
from rigsim.study.agreement.fault import UNKNOWN
from rigsim.study.sweep.diagnosis import find_fault

LENS = Intrinsics(1280, 960, 1000.0, 1000.0, 639.5, 479.5)
RIG = StereoRig.rectified(LENS, 0.12)
NOISE = PixelNoise(0.25)
RANDOM = np.random.default_rng(3)


def points(rig: StereoRig, n: int = 1500) -> Array:
    """Points that both cameras see, 1 to 6 m away."""
    rng = np.random.default_rng(5)
    uv = rng.uniform((0, 0), (rig.left.width - 1, rig.left.height - 1), (n, 2))
    z = np.exp(rng.uniform(0, np.log(6), n))
    seen = np.column_stack([rig.left.normalize(uv), np.ones(n)]) * z[:, None]
    _, uv_right = rig.project(seen)
    return np.asarray(seen[rig.right.contains(uv_right)])


def answer(change: Callable[[Array, Array], Array]) -> Callable[..., Array]:
    """A triangulator that changes right points; it knows the left pixels."""
    return lambda rig, uv_left, uv_right: change(triangulate(rig, uv_left, uv_right), uv_left)


def believing(change: Callable[[StereoRig], StereoRig]) -> Callable[..., Array]:
    """A triangulator that takes the rig for another."""
    return lambda rig, uv_left, uv_right: triangulate(change(rig), uv_left, uv_right)


def longer(rig: StereoRig, left: float, right: float) -> StereoRig:
    lenses = [
        replace(lens, fx=lens.fx * (1 + by), fy=lens.fy * (1 + by))
        for lens, by in ((rig.left, left), (rig.right, right))
    ]
    return replace(rig, left=lenses[0], right=lenses[1])


def right_fifth(found: Array, uv_left: Array) -> Array:
    return np.where((uv_left[:, 0] > 1024)[:, None], 1.05 * found, found)


def every_fiftieth(found: Array, uv_left: Array) -> Array:
    found[::50] = np.nan
    return found


def noisier(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    # three more times the variance is twice the noise
    extra = RANDOM.normal(0, 0.25 * 3**0.5, (2, *uv_left.shape))
    return triangulate(rig, uv_left + extra[0], uv_right + extra[1])


def left_rows_alone(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return triangulate(rig, uv_left, np.column_stack([uv_right[:, 0], uv_left[:, 1]]))


# what is done, what must be named, how much of it; a triangulator that takes the right camera to look right
# works on a camera that truly looks further left
MISTAKES: dict[str, tuple[Callable[..., Array], str, float]] = {
    "scale": (answer(lambda X, uv: 1.01 * X), "all coordinates come back 1.00 % too large", 1.0),
    "depth": (answer(lambda X, uv: X * (1, 1, 0.99)), "Z comes back 1.00 % too small", -1.0),
    "offset": (
        lambda rig, left, right: triangulate(rig, left, right - (0.02, 0)),
        "disparities are taken 0.0200 px too large",
        0.02,
    ),
    "one fifth": (
        answer(right_fifth),
        r"points with u above 102\d px in the left image are off; there: .* 5.00 % too large",
        5.0,
    ),
    "x negated": (answer(lambda X, uv: X * (-1, 1, 1)), "x has the opposite sign", np.nan),
    "x = y = 0": (answer(lambda X, uv: X * (0, 0, 1)), "X and Y come back as 0", np.nan),
    "u and v swapped": (
        lambda rig, left, right: triangulate(rig, left[:, ::-1], right[:, ::-1]),
        "u and v are exchanged",
        np.nan,
    ),
    "one image twice": (
        lambda rig, left, right: triangulate(rig, left, left),
        "disparities come out as 0",
        np.nan,
    ),
    "rows reversed": (answer(lambda X, uv: X[::-1]), "in reverse order", np.nan),
    "images swapped": (lambda rig, left, right: triangulate(rig, right, left), "swapped images", np.nan),
    "focal": (believing(lambda rig: longer(rig, 0.002, 0.002)), "focal length of both .* shorter", 0.2),
    "right focal": (
        believing(lambda rig: longer(rig, 0, 0.002)),
        "focal length of the right camera: it is 0.200 % shorter",
        -0.2,
    ),
    "yaw": (
        believing(Perturbation(yaw_rad=np.radians(0.02)).apply),
        "yaw: the right camera looks 0.0200 deg further left",
        -0.02,
    ),
    "pitch": (
        believing(Perturbation(pitch_rad=np.radians(-0.02)).apply),
        "pitch: the right camera looks 0.0200 deg further up",
        0.02,
    ),
    "roll": (
        believing(Perturbation(roll_rad=np.radians(0.02)).apply),
        "roll: .* 0.0200 deg anticlockwise",
        -0.02,
    ),
    "baseline": (
        believing(Perturbation(baseline_m=0.0006).apply),
        "baseline: it is 0.49[78] % shorter",
        0.5,
    ),
    "k1": (believing(Perturbation(right_k1=0.001).apply), "k1 of the right camera: .* less", -0.001),
    "half pixel": (
        lambda rig, left, right: triangulate(rig, left + 0.5, right + 0.5),
        "principal point is 0.5 px less than it is in both images",
        np.nan,
    ),
    "rounded": (
        lambda rig, left, right: triangulate(rig, np.round(left), np.round(right)),
        "rounded to whole pixels",
        np.nan,
    ),
    "noise": (noisier, r"scatter (1\.9[5-9]|2\.0[0-5]) times as wide", 2.0),
    "left rows": (left_rows_alone, "Y scatters 1.4[0-3] times .* one image's rows", 2**0.5),
    "lost": (answer(every_fiftieth), "2 % of the points come back as NaN", np.nan),
    "float16": (answer(lambda X, uv: X.astype(np.float16)), "float16", np.nan),
    "ray length": (
        answer(lambda X, uv: np.column_stack([X[:, :2], np.linalg.norm(X, axis=1)])),
        "length of the ray",
        np.nan,
    ),
    "stretched": (
        believing(lambda rig: replace(rig, left=replace(LENS, fx=995.0), right=replace(LENS, fx=995.0))),
        "stretch of the image: fx of both cameras is 0.50[0-9] % longer",
        0.5,
    ),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_named_with_its_amount(name: str):
    method, words, amount = MISTAKES[name]
    fault = find_fault(RIG, RIG, points(RIG), NOISE, method)
    assert fault is not None
    assert re.search(words, in_words(fault)), fault
    if np.isfinite(amount):
        assert fault.amount == pytest.approx(amount, rel=0.03)


def test_doffs_ignored_is_named():
    rig = StereoRig.rectified(LENS, 0.12, right=replace(LENS, cx=645.0))
    fault = find_fault(
        rig,
        rig,
        points(rig),
        NOISE,
        believing(lambda rig: replace(rig, right=replace(rig.right, cx=rig.left.cx))),
    )
    assert fault is not None
    assert "doffs" in in_words(fault)


VERGED = StereoRig.verged(LENS, 0.3, 8.0)
UNEQUAL = StereoRig(
    replace(LENS, lens=BrownConrady(k1=-0.1)),
    replace(LENS, fx=1300.0, fy=1310.0),
    StereoRig.verged(LENS, 0.2, 3.0).right_from_left,
)


@pytest.mark.parametrize(
    ("rig", "method"),
    [
        *((rig, "optimal") for rig in (RIG, VERGED, UNEQUAL)),
        *((rig, method) for rig in (RIG, VERGED) for method in ("dlt", "midpoint")),
    ],
)
def test_nothing_is_off_where_all_is_right(rig: StereoRig, method: str):
    assert find_fault(rig, rig, points(rig), NOISE, method) is None


def test_midpoint_wastes_some_of_the_rows_of_unequal_lenses():
    fault = find_fault(UNEQUAL, UNEQUAL, points(UNEQUAL), NOISE, "midpoint")
    assert fault is not None
    assert fault.name == "rows-wasted"
    assert 1.05 < fault.amount < 1.08
    assert "part of what the rows say" in in_words(fault)


def test_an_answer_of_no_known_kind_is_said_to_be_that():
    fault = find_fault(
        RIG, RIG, points(RIG), NOISE, answer(lambda X, uv: X + 0.1 * np.sin(7 * X) * np.cos(11 * X[:, ::-1]))
    )
    assert fault is not None
    assert fault.name == "unknown"
    assert in_words(fault).startswith(in_words(UNKNOWN))


@pytest.mark.parametrize(
    ("perturbation", "words"),
    [
        (Perturbation(yaw_rad=np.radians(0.02)), "^yaw: the right camera looks 0.0200 deg further right"),
        (Perturbation(pitch_rad=np.radians(0.05)), "^pitch: the right camera looks 0.0500 deg further up"),
        (Perturbation(roll_rad=np.radians(0.1)), "^roll: .* 0.100 deg clockwise"),
        (Perturbation(baseline_m=-0.001), "^baseline: it is 0.833 % shorter"),
        (Perturbation(axial_m=0.002), "^the right camera stands 2.00 mm further forward"),
        (Perturbation(vertical_m=0.002), "^the right camera stands 2.00 mm further down"),
        (Perturbation(right_focal_px=2.0), "^focal length of the right camera: it is 0.200 % longer"),
        (
            Perturbation(right_cx_px=0.3),
            "^principal point of the right camera: it lies 0.300 px further right",
        ),
        (Perturbation(right_k1=0.001), "^lens distortion k1 of the right camera: it is 0.00100 greater"),
    ],
)
def test_a_true_rig_that_is_not_the_assumed_one_is_told_by_what_it_is(perturbation: Perturbation, words: str):
    fault = find_fault(perturbation.apply(RIG), RIG, points(RIG), NOISE, "optimal")
    assert fault is not None
    assert re.search(words, in_words(fault)), fault


def test_a_narrow_lens_cannot_tell_yaw_from_the_principal_point():
    lens = Intrinsics(1280, 960, 8000.0, 8000.0, 639.5, 479.5)
    rig = StereoRig.rectified(lens, 0.12)
    fault = find_fault(
        Perturbation(yaw_rad=np.radians(0.02)).apply(rig), rig, 4 * points(rig), NOISE, "optimal"
    )
    assert fault is not None
    # 8000 px * 0.02 deg = 2.79 px
    assert "yaw" in (fault.name, *fault.also)
    assert "right-cx" in (fault.name, *fault.also)
    assert re.search(r"2.79 px|2.80 px", in_words(fault))


def test_several_differences_are_listed_the_largest_first():
    true = Perturbation(yaw_rad=np.radians(0.02), baseline_m=0.002, right_k1=0.01).apply(RIG)
    fault = find_fault(true, RIG, points(RIG), NOISE, "optimal")
    assert fault is not None
    assert set(fault.also) == {"right-k1", "baseline", "yaw"}
    assert "baseline: it is 1.67 % longer" in in_words(fault)
    assert "0.0200 deg further right" in in_words(fault)
