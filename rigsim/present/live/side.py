"""The rig from its side as SVG: how high its cameras see, over the working range.

Drawn like the plan beside it: the same CSS variables, and a metre as long up as along.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from html import escape

import numpy as np

from rigsim.present.kit.format import length
from rigsim.present.live import ink
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.theory.frusta import outline

WIDTH, HEIGHT = 640, 460
"""Size of the drawing, in its own units."""
_LEFT, _RIGHT, _TOP, _BOTTOM = 62, 12, 12, 40
_SMALL = "font-size:12.5px;fill:var(--rig-soft)"


@dataclass(frozen=True, slots=True)
class _Sheet:
    """From metres forward and up to units of the drawing."""

    z_m: float
    """Left edge, m."""
    scale: float
    """Units a metre."""

    def at(self, z_m: float, up_m: float) -> tuple[float, float]:
        """A point."""
        return _LEFT + (z_m - self.z_m) * self.scale, (_TOP + HEIGHT - _BOTTOM) / 2 - up_m * self.scale

    @property
    def half_m(self) -> float:
        """Half its height, m."""
        return (HEIGHT - _TOP - _BOTTOM) / 2 / self.scale

    @property
    def end_m(self) -> float:
        """Right edge, m."""
        return self.z_m + (WIDTH - _LEFT - _RIGHT) / self.scale


@dataclass(frozen=True, slots=True)
class _Wedge:
    """What one camera sees, from the side."""

    center: tuple[float, float]
    """Camera centre (forward, up), m."""
    low: tuple[float, float]
    """Direction (forward, up) of its lowest ray."""
    high: tuple[float, float]
    """Direction of its highest."""

    def to(self, z_m: float) -> list[tuple[float, float]]:
        """Its outline up to a distance, m."""
        ends = [self.center]
        for forward, up in (self.low, self.high):
            along = (z_m - self.center[0]) / max(forward, 1e-3)
            ends.append((z_m, self.center[1] + up * along))
        return ends


def side_svg(rig: StereoRig, near_m: float, far_m: float) -> str:
    """Draw the rig from its right side: forward to the right, up the page.

    Args:
        rig: the rig.
        near_m: near end of the working range, m.
        far_m: far end, m.

    Returns:
        An ``<svg>`` element.
    """
    rig_from_left = rig.rig_from_left
    left = _wedge(outline(rig.left) @ rig_from_left.R.T, rig_from_left.t)
    rig_from_right = rig_from_left @ rig.right_from_left.inverse
    right = _wedge(outline(rig.right) @ rig_from_right.R.T, rig_from_right.t)
    start = min(left.center[0], right.center[0], 0.0) - 0.07 * far_m
    sheet = _Sheet(start, (WIDTH - _LEFT - _RIGHT) / (1.04 * far_m - start))
    says = f"The rig from its side: working range {length(near_m)} to {length(far_m)}"
    parts = [
        *_grid(sheet),
        '<g clip-path="url(#side-window)">',
        *_range(sheet, near_m, far_m),
        *(_seen(sheet, wedge, color) for wedge, color in ((left, "left"), (right, "right"))),
        "</g>",
        *_bodies(sheet, (left, right)),
        *_ends(sheet, near_m, far_m),
    ]
    return (
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(says)}" class="rig-plan">'
        f'<title>{escape(says)}</title><defs><clipPath id="side-window">'
        f'<rect x="{_LEFT}" y="{_TOP}" width="{WIDTH - _LEFT - _RIGHT}" height="{HEIGHT - _TOP - _BOTTOM}"/>'
        f"</clipPath></defs>{''.join(parts)}</svg>"
    )


def _wedge(rays: Array, center: Array) -> _Wedge:
    """Of rays (K, 3) and the camera's centre (3,), in the rig's frame."""
    up = np.arctan2(-rays[:, 1], np.maximum(rays[:, 2], 1e-9))
    low, high = (ink.unit(np.array([rays[i, 2], -rays[i, 1]])) for i in (int(up.argmin()), int(up.argmax())))
    return _Wedge((float(center[2]), -float(center[1])), low, high)


def _seen(sheet: _Sheet, wedge: _Wedge, color: str) -> str:
    corners = [sheet.at(*corner) for corner in wedge.to(sheet.end_m)]
    style = f"stroke:var(--rig-{color});stroke-opacity:.55"
    edges = "".join(ink.line(corners[0], corner, style) for corner in corners[1:])
    return ink.polygon(corners, f"fill:var(--rig-{color});fill-opacity:.1") + edges


def _range(sheet: _Sheet, near_m: float, far_m: float) -> Iterable[str]:
    (left, top), (right, bottom) = sheet.at(near_m, sheet.half_m), sheet.at(far_m, -sheet.half_m)
    yield ink.polygon(
        [(left, top), (right, top), (right, bottom), (left, bottom)], "fill:var(--rig-both);fill-opacity:.16"
    )


def _ends(sheet: _Sheet, near_m: float, far_m: float) -> Iterable[str]:
    for z, says, anchor in ((near_m, "near", "start"), (far_m, "far", "end")):
        x, _ = sheet.at(z, 0.0)
        yield ink.line((x, _TOP), (x, HEIGHT - _BOTTOM), "stroke:var(--rig-soft);stroke-dasharray:4 3")
        words = f"{says} {length(z)}"
        yield ink.text((x + (5 if anchor == "start" else -5), _TOP + 14), words, _SMALL, anchor)


def _bodies(sheet: _Sheet, wedges: Iterable[_Wedge]) -> Iterable[str]:
    for wedge, color in zip(wedges, ("left", "right"), strict=True):
        x, y = sheet.at(*wedge.center)
        shape = [
            (x + 3, y - 4),
            (x - 4, y - 6),
            (x - 14, y - 6),
            (x - 14, y + 6),
            (x - 4, y + 6),
            (x + 3, y + 4),
        ]
        yield ink.polygon(shape, f"fill:var(--rig-{color});fill-opacity:.85;stroke:var(--rig-paper)")


def _grid(sheet: _Sheet) -> Iterable[str]:
    step = ink.round_step((sheet.end_m - sheet.z_m) / 7)
    unit, per_m = ("mm", 1e3) if sheet.end_m < 1.0 else ("m", 1.0)
    soft = "stroke:var(--rig-rule)"
    for z in ink.ticks(sheet.z_m, sheet.end_m, step):
        x, _ = sheet.at(z, 0.0)
        yield ink.line((x, _TOP), (x, HEIGHT - _BOTTOM), soft)
        yield ink.text((x, HEIGHT - _BOTTOM + 16), f"{z * per_m:g}", _SMALL)
    for up in ink.ticks(-sheet.half_m, sheet.half_m, step):
        _, y = sheet.at(0.0, up)
        yield ink.line((_LEFT, y), (WIDTH - _RIGHT, y), soft)
        yield ink.text((_LEFT - 7, y + 4), f"{up * per_m:g}", _SMALL, "end")
    yield ink.text(((_LEFT + WIDTH - _RIGHT) / 2, HEIGHT - 5), f"forward, {unit}", _SMALL)
    yield (
        f'<text transform="translate(14 {(_TOP + HEIGHT - _BOTTOM) / 2}) rotate(-90)" text-anchor="middle" '
        f'style="{_SMALL}">up, {unit}</text>'
    )
