"""Mistakes with pixels, principal points, focal lengths, distortion and number formats."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.study.saying import saying
from rigsim.study.verify.diagnosis.mistake import Before, Mistake, of_both, sides
from rigsim.study.verify.diagnosis.reenact import Given, Lenses


def _centre_moved(*by_px: float) -> Callable[[Lenses], Lenses]:
    return lambda lens: replace(lens, c=lens.c + by_px)


def _half_pixel() -> tuple[Mistake, ...]:
    made: list[Mistake] = []
    for px, name in ((0.5, "half-pixel"), (1.0, "pixels-from-one")):
        for sign, more in ((1, "more"), (-1, "less")):
            made += sides(name, _centre_moved(sign * px, sign * px), px=px, way=more)
            for axis, du, dv in (("u", sign * px, 0.0), ("v", 0.0, sign * px)):
                moved = _centre_moved(du, dv)
                made += sides(f"{name}: along an axis", moved, cost=0.002, px=px, way=more, axis=axis)
    return tuple(made)


def _middle(shift: float) -> Callable[[Lenses], Lenses]:
    return lambda lens: replace(lens, c=(lens.size - shift) / 2)


def _doffs(scale: float, only_parallel: bool) -> Before:
    """The right principal point as it would have to be for `scale` times doffs to be added."""

    def change(g: Given) -> Given:
        doffs = g.right.c[:, 0] - g.left.c[:, 0]
        if only_parallel:
            straight = np.abs(g.R - np.eye(3)).max(axis=(1, 2)) < 1e-9
            doffs = np.where(straight, doffs, doffs / scale if scale else doffs)
        else:
            straight = np.ones(len(doffs), dtype=bool)
        c = g.right.c.copy()
        c[:, 0] = np.where(straight, g.left.c[:, 0] + scale * doffs, c[:, 0])
        return replace(g, right=replace(g.right, c=c))

    return change


_SIDES: tuple[Literal["left", "right"], ...] = ("left", "right")


def _flipped(axis: int, only: Literal["left", "right", ""] = "") -> Before:
    def flip(uv: Array, lens: Lenses) -> Array:
        flipped = uv.copy()
        flipped[:, axis] = lens.size[:, axis] - 1 - uv[:, axis]
        return flipped

    return lambda g: replace(
        g,
        uv_left=g.uv_left if only == "right" else flip(g.uv_left, g.left),
        uv_right=g.uv_right if only == "left" else flip(g.uv_right, g.right),
    )


def _mirrored(axis: int) -> Before:
    def mirror(uv: Array, lens: Lenses) -> Array:
        mirrored = uv.copy()
        mirrored[:, axis] = 2 * lens.c[:, axis] - uv[:, axis]
        return mirrored

    return lambda g: replace(g, uv_left=mirror(g.uv_left, g.left), uv_right=mirror(g.uv_right, g.right))


def _times(scale: float) -> Callable[[Array], Array]:
    return lambda uv: uv * scale


def _pixels(change: Callable[[Array], Array]) -> Before:
    return lambda g: replace(g, uv_left=change(g.uv_left), uv_right=change(g.uv_right))


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


def _normalised_twice(g: Given) -> Given:
    """Rays taken for pixels: K is applied to what it was taken from already."""

    def lens(camera: Lenses) -> Lenses:
        return replace(camera, bend=np.zeros_like(camera.bend))

    return replace(
        g,
        uv_left=g.left.normalize(g.uv_left),
        uv_right=g.right.normalize(g.uv_right),
        left=lens(g.left),
        right=lens(g.right),
    )


PIXELS: tuple[Mistake, ...] = (
    *_half_pixel(),
    *sides(
        "image-centre-for-principal-point",
        _middle(1.0),
        cost=0.001,
    ),
    *sides(
        "image-centre-for-principal-point: W/2",
        _middle(0.0),
        cost=0.001,
    ),
    *sides(
        "principal-point-missing",
        lambda lens: replace(lens, c=0 * lens.c),
    ),
    *sides(
        "intrinsics-missing",
        lambda lens: replace(lens, c=0 * lens.c, f=0 * lens.f + 1),
        cost=0.001,
    ),
    *(
        Mistake(
            saying(form),
            _doffs(scale, only_parallel),
            cost=0.001 * only_parallel,
        )
        for form, scale in (("doffs-ignored", 0.0), ("doffs-sign", -1.0), ("doffs-twice", 2.0))
        for only_parallel in (False, True)
    ),
    Mistake(
        saying("flipped-v"),
        _flipped(1),
    ),
    Mistake(saying("flipped-v: axis"), _mirrored(1)),
    Mistake(saying("flipped-u"), _flipped(0)),
    Mistake(saying("flipped-u: axis"), _mirrored(0)),
    *(
        Mistake(
            saying("flipped-v: one image", image=side),
            _flipped(1, side),
            cost=0.002,
        )
        for side in _SIDES
    ),
    Mistake(
        saying("row-column-exchanged"),
        _pixels(lambda uv: uv[:, ::-1]),
    ),
    Mistake(
        saying("row-column-exchanged: cx and cy"),
        of_both(lambda lens: replace(lens, c=lens.c[:, ::-1])),
        cost=0.001,
    ),
    *sides(
        "fx-fy-exchanged",
        lambda lens: replace(lens, f=lens.f[:, ::-1]),
        cost=0.001,
    ),
    *sides(
        "fx-for-fy",
        lambda lens: replace(lens, f=lens.f[:, [0, 0]]),
    ),
    Mistake(
        saying("normalised-twice"),
        _normalised_twice,
        cost=0.001,
    ),
    *sides("fy-for-fx", lambda lens: replace(lens, f=lens.f[:, [1, 1]])),
    *(
        Mistake(
            saying("image-scale", scale=scale),
            _pixels(_times(scale)),
            cost=0.002,
        )
        for scale in (2.0, 0.5)
    ),
)
"""Where a pixel is."""


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
    Mistake(saying("rounded-pixels: whole"), _pixels(np.round)),
    Mistake(saying("rounded-pixels: down"), _pixels(np.floor)),
    Mistake(saying("rounded-pixels: up"), _pixels(np.ceil)),
    *(
        Mistake(saying("rounded-pixels: a part", parts=n), _pixels(_rounded(1 / n)))
        for n in (2, 4, 8, 10, 16, 32, 100, 256, 1000, 10_000)
    ),
    *(
        Mistake(
            saying("rounded-pixels: one image", image=side, step=step),
            _rounded_one(side, size),
            cost=0.002,
        )
        for side in _SIDES
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
    Mistake(saying("nan-answered: as 0"), _pixels(np.nan_to_num)),
    Mistake(saying("single-precision: pixels"), _pixels(_single)),
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
        lambda g: _pixels(_single)(_single_rig(g)),
    ),
)
"""How many digits a pixel has."""
