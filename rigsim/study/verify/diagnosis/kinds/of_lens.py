"""Mistakes with pixels, principal points and focal lengths."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.study.saying import saying
from rigsim.study.verify.diagnosis.mistake import SIDES, Before, Mistake, of_both, of_pixels, sides
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
        for side in SIDES
    ),
    Mistake(
        saying("row-column-exchanged"),
        of_pixels(lambda uv: uv[:, ::-1]),
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
            of_pixels(_times(scale)),
            cost=0.002,
        )
        for scale in (2.0, 0.5)
    ),
)
"""Where a pixel is."""
