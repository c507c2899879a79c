"""The rig from above as SVG, quick enough to follow a slider.

Colours are CSS variables of the page, so that one drawing serves light and dark: ``--rig-left``,
``--rig-right``, ``--rig-both``, ``--rig-ink``, ``--rig-soft``, ``--rig-paper``.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from rigsim.present.kit.footprint import CameraView, Footprint, footprint
from rigsim.present.kit.format import length, length_mm
from rigsim.present.live import ink
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig

WIDTH, HEIGHT = 640, 460
"""Size of the drawing, in its own units."""
_LEFT, _RIGHT, _TOP, _BOTTOM = 62, 12, 12, 40
_TICKS = 6


@dataclass(frozen=True, slots=True)
class PlanPoint:
    """A point of the plan with its uncertainty along the depth."""

    xyz_left: tuple[float, float, float]
    """Where it is, in the left camera's frame, m."""
    near_m: float = math.nan
    """Nearest depth it may have, m."""
    far_m: float = math.nan
    """Farthest depth it may have, m; infinite without bound."""
    std_mm: float = math.nan
    """Standard deviation of its depth, mm."""


@dataclass(frozen=True, slots=True)
class _Paper:
    """From metres of the plan to units of the drawing; a metre is as long across as along."""

    x_m: float
    """Middle of the drawing, m."""
    z_m: float
    """Lower edge, m."""
    scale: float
    """Units a metre."""

    def at(self, xz: Array | Sequence[float]) -> tuple[float, float]:
        """A point (x, z), m."""
        middle = (_LEFT + WIDTH - _RIGHT) / 2
        return middle + (float(xz[0]) - self.x_m) * self.scale, self.down(float(xz[1]))

    def down(self, z_m: float) -> float:
        """Height of a depth in the drawing."""
        return HEIGHT - _BOTTOM - (z_m - self.z_m) * self.scale

    @property
    def corners(self) -> Array:
        """The window (4, 2), m."""
        half = (WIDTH - _LEFT - _RIGHT) / 2 / self.scale
        top = self.z_m + (HEIGHT - _TOP - _BOTTOM) / self.scale
        x_low, x_high = self.x_m - half, self.x_m + half
        return np.array([[x_low, self.z_m], [x_high, self.z_m], [x_high, top], [x_low, top]])


def plan_svg(
    rig: StereoRig, points: Sequence[PlanPoint] = (), *, sized: bool = True, reach_m: float = 0.0
) -> str:
    """Draw the rig and points from above: x to the right and forward up the page.

    Args:
        rig: the rig.
        points: points to show, with the rays of both cameras to each.
        sized: whether the images have an edge that is known: without one no field of view is drawn.
        reach_m: distance to show at least, m.

    Returns:
        An ``<svg>`` element.
    """
    view = footprint(rig)
    at = [rig.rig_from_left.apply(np.array([point.xyz_left]))[0][[0, 2]] for point in points]
    paper = _paper(rig, view, at, reach_m)
    parts = [
        *_axes(paper),
        *(_views(paper, view) if sized else ()),
        *(part for xz, point in zip(at, points, strict=True) for part in _point(paper, view, xz, point)),
        *_cameras(paper, view, rig),
    ]
    says = f"The rig from above: two cameras {length(rig.baseline_m)} apart"
    if points:
        says += f", a point at a depth of {length(points[0].xyz_left[2])}"
    return (
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(says)}" class="rig-plan">'
        f"<title>{escape(says)}</title>"
        '<defs><clipPath id="plan-window">'
        f'<rect x="{_LEFT}" y="{_TOP}" width="{WIDTH - _LEFT - _RIGHT}" height="{HEIGHT - _TOP - _BOTTOM}"/>'
        f"</clipPath></defs>{''.join(parts)}</svg>"
    )


def _paper(rig: StereoRig, view: Footprint, at: Sequence[Array], reach_m: float) -> _Paper:
    centers = np.stack([view.left.center, view.right.center, *at])
    near = float(view.nearest[1]) if view.nearest is not None and np.isfinite(view.nearest[1]) else 0.0
    deepest = float(centers[:, 1].max())
    # without anything to show farther off, some baselines
    reach = max(deepest, reach_m, 2.5 * rig.baseline_m, min(1.5 * near, 20 * rig.baseline_m))
    low = min(float(centers[:, 1].min()), 0.0) - max(0.09 * reach, 0.3 * rig.baseline_m)
    span = 1.08 * reach - low
    x_low, x_high = float(centers[:, 0].min()), float(centers[:, 0].max())
    half = max(0.62 * (x_high - x_low), 0.1 * span)
    scale = min((HEIGHT - _TOP - _BOTTOM) / span, (WIDTH - _LEFT - _RIGHT) / 2 / half)
    return _Paper((x_low + x_high) / 2, low, scale)


def _polygon(paper: _Paper, corners: Array, style: str) -> str:
    return ink.polygon([paper.at(corner) for corner in corners], style)


def _views(paper: _Paper, view: Footprint) -> Iterable[str]:
    window = paper.corners
    yield '<g clip-path="url(#plan-window)">'
    for camera, color in ((view.left, "left"), (view.right, "right")):
        yield _polygon(paper, camera.clip(window), f"fill:var(--rig-{color});fill-opacity:.09")
    yield _polygon(paper, view.overlap(window), "fill:var(--rig-both);fill-opacity:.22")
    if view.blind is not None:
        yield _polygon(paper, view.blind, "fill:none;stroke:var(--rig-soft);stroke-dasharray:3 3")
    reach = 4 * float(np.ptp(window, axis=0).max())
    for camera, color in ((view.left, "left"), (view.right, "right")):
        for edge in (camera.left_edge, camera.right_edge):
            ends = paper.at(camera.center), paper.at(camera.center + reach * edge)
            yield ink.line(*ends, f"stroke:var(--rig-{color});stroke-opacity:.55")
    yield "</g>"


def _point(paper: _Paper, view: Footprint, xz: Array, point: PlanPoint) -> Iterable[str]:
    yield '<g clip-path="url(#plan-window)">'
    for camera, color in ((view.left, "left"), (view.right, "right")):
        yield ink.line(paper.at(camera.center), paper.at(xz), f"stroke:var(--rig-{color});stroke-width:1.8")
    if point.near_m > 0:
        shift = xz[1] - point.xyz_left[2]
        far = point.far_m if math.isfinite(point.far_m) else 1e3 * point.xyz_left[2]
        x, _ = paper.at(xz)
        high, low = paper.down(max(far + shift, xz[1])), paper.down(point.near_m + shift)
        yield ink.line(
            (x, low), (x, max(high, -1e4)), "stroke:var(--rig-ink);stroke-width:5;stroke-opacity:.35"
        )
    yield "</g>"
    x, y = paper.at(xz)
    yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5.5" style="fill:var(--rig-ink);stroke:var(--rig-paper)"/>'
    words = f"Z = {length(point.xyz_left[2])}"
    if math.isfinite(point.std_mm):
        words += f" ± {length_mm(point.std_mm)}"
    left_half = x < WIDTH / 2
    at = x + (12 if left_half else -12), min(max(y + 5, _TOP + 14), HEIGHT - _BOTTOM - 8)
    yield ink.text(
        at, words, "font-size:15px;font-weight:600;fill:var(--rig-ink)", "start" if left_half else "end"
    )


def _cameras(paper: _Paper, view: Footprint, rig: StereoRig) -> Iterable[str]:
    size = max(0.18 * rig.baseline_m * paper.scale, 9.0) / paper.scale
    for camera, color in ((view.left, "left"), (view.right, "right")):
        style = f"fill:var(--rig-{color});stroke:var(--rig-paper)"
        yield _polygon(paper, _body(camera, size), style)
    left, right = paper.at(view.left.center), paper.at(view.right.center)
    below = min(max(left[1], right[1]) + size * paper.scale + 15, HEIGHT - _BOTTOM - 3)
    words = f"B = {length(rig.baseline_m)}"
    yield ink.text(
        ((left[0] + right[0]) / 2, below), words, "font-size:14px;font-weight:600;fill:var(--rig-ink)"
    )


def _body(camera: CameraView, size_m: float) -> Array:
    across = np.array([camera.axis[1], -camera.axis[0]])
    shape = np.array([[-0.3, 0.1], [0.3, 0.1], [0.5, -0.3], [0.5, -1.0], [-0.5, -1.0], [-0.5, -0.3]]) * size_m
    return np.asarray(camera.center + shape[:, :1] * across + shape[:, 1:] * camera.axis)


def _axes(paper: _Paper) -> Iterable[str]:
    (x_low, z_low), (x_high, _), (_, z_high), _ = paper.corners
    step = ink.round_step(max(x_high - x_low, z_high - z_low) / _TICKS)
    unit, per_m = ("mm", 1e3) if z_high < 1.0 else ("m", 1.0)
    soft = "stroke:var(--rig-rule)"
    small = "font-size:12.5px;fill:var(--rig-soft)"
    for z in ink.ticks(z_low, z_high, step):
        y = paper.down(z)
        yield ink.line((_LEFT, y), (WIDTH - _RIGHT, y), soft)
        yield ink.text((_LEFT - 7, y + 4), f"{z * per_m:g}", small, "end")
    for x in ink.ticks(x_low, x_high, step):
        at, _ = paper.at((x, 0.0))
        yield ink.line((at, _TOP), (at, HEIGHT - _BOTTOM), soft)
        yield ink.text((at, HEIGHT - _BOTTOM + 16), f"{x * per_m:g}", small)
    yield ink.text(((_LEFT + WIDTH - _RIGHT) / 2, HEIGHT - 5), f"to the right, {unit}", small)
    yield (
        f'<text transform="translate(14 {HEIGHT / 2}) rotate(-90)" text-anchor="middle" style="{small}">'
        f"forward, {unit}</text>"
    )
