"""Mistakes with the digits of pixels and calibrations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.study.saying import saying
from rigsim.study.verify.diagnosis.mistake import SIDES, Before, Mistake, of_pixels
from rigsim.study.verify.diagnosis.reenact import Given, Lenses


def _whole_disparity(step: float) -> Before:
    def change(g: Given) -> Given:
        uv_right = g.uv_right.copy()
        disparity = g.uv_left[:, 0] - uv_right[:, 0]
        uv_right[:, 0] = g.uv_left[:, 0] - np.round(disparity / step) * step
        return replace(g, uv_right=uv_right)

    return change


def _single(array: Array) -> Array:
    with np.errstate(over="ignore"):
        return array.astype(np.float32).astype(np.float64)


def _single_cameras(g: Given) -> Given:
    def lens(camera: Lenses) -> Lenses:
        return replace(camera, f=_single(camera.f), c=_single(camera.c))

    return replace(g, left=lens(g.left), right=lens(g.right))


def _single_rotation(g: Given) -> Given:
    return replace(g, R=_single(g.R))


def _single_translation(g: Given) -> Given:
    return replace(g, t=_single(g.t))


def _single_lenses(g: Given) -> Given:
    def lens(camera: Lenses) -> Lenses:
        return replace(camera, bend=_single(camera.bend))

    return replace(g, left=lens(g.left), right=lens(g.right))


def _single_rig(g: Given) -> Given:
    return _single_lenses(_single_translation(_single_rotation(_single_cameras(g))))


def _rounded(step: float) -> Callable[[Array], Array]:
    return lambda uv: np.round(uv / step) * step


def _rounded_one(side: Literal["left", "right"], step: float) -> Before:
    change = _rounded(step)
    if side == "left":
        return lambda g: replace(g, uv_left=change(g.uv_left))
    return lambda g: replace(g, uv_right=change(g.uv_right))


def _short(values: Array, digits: int, significant: bool) -> Array:
    if not significant:
        return np.asarray(np.round(values, digits))
    scale = 10.0 ** (digits - 1 - np.floor(np.log10(np.where(values == 0, 1.0, np.abs(values)))))
    return np.asarray(np.round(values * scale) / scale)


def _short_rig(digits: int, significant: bool) -> Before:
    def lens(camera: Lenses) -> Lenses:
        f, c, bend = (_short(values, digits, significant) for values in (camera.f, camera.c, camera.bend))
        return replace(camera, f=f, c=c, bend=bend)

    return lambda g: replace(
        g,
        left=lens(g.left),
        right=lens(g.right),
        R=_short(g.R, digits, significant),
        t=_short(g.t, digits, significant),
    )


NUMBERS: tuple[Mistake, ...] = (
    Mistake(saying("rounded-pixels: whole"), of_pixels(np.round)),
    Mistake(saying("rounded-pixels: down"), of_pixels(np.floor)),
    Mistake(saying("rounded-pixels: up"), of_pixels(np.ceil)),
    *(
        Mistake(saying("rounded-pixels: a part", parts=n), of_pixels(_rounded(1 / n)))
        for n in (2, 4, 8, 10, 16, 32, 100, 256, 1000, 10_000)
    ),
    *(
        Mistake(
            saying("rounded-pixels: one image", image=side, step=step),
            _rounded_one(side, size),
            cost=0.002,
        )
        for side in SIDES
        for step, size in (("whole", 1.0), ("1/2", 0.5), ("1/4", 0.25), ("1/8", 0.125), ("1/16", 0.0625))
    ),
    *(
        Mistake(
            saying(form, digits=digits),
            _short_rig(digits, significant),
            cost=0.003,
        )
        for digits in range(2, 9)
        for form, significant in (("rounded-calibration: decimals", False), ("rounded-calibration", True))
    ),
    *(
        Mistake(
            saying("rounded-disparity", parts=parts) if parts > 1 else saying("rounded-disparity: whole"),
            _whole_disparity(1 / parts),
        )
        for parts in (1, 4, 8, 16)
    ),
    Mistake(saying("nan-answered: as 0"), of_pixels(np.nan_to_num)),
    Mistake(saying("single-precision: pixels"), of_pixels(_single)),
    Mistake(saying("single-precision: calibration"), _single_rig),
    *(
        Mistake(saying(f"single-precision: {what}"), change, cost=0.0005)
        for what, change in (
            ("cameras", _single_cameras),
            ("rotation", _single_rotation),
            ("translation", _single_translation),
            ("distortion", _single_lenses),
        )
    ),
    Mistake(
        saying("single-precision: both"),
        lambda g: of_pixels(_single)(_single_rig(g)),
    ),
)
"""How many digits a pixel has."""
