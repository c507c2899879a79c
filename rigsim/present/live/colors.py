"""Colours of values, told apart by the colour-blind, for pictures on dark ground."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from rigsim.present.kit.format import number
from rigsim.rig.arrays import Array

# viridis from a quarter on: its dark end is lost on dark ground
_STOPS = ("#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725")
_RGB = np.array([[int(stop[at : at + 2], 16) for at in (1, 3, 5)] for stop in _STOPS], dtype=np.float64)
_LOG_FROM = 8.0


class ColorScale(NamedTuple):
    """What colours mean."""

    low: float
    """Value at the dark end."""
    high: float
    """Value at the bright end."""
    log: bool
    """Whether equal steps of colour are equal ratios."""

    def shares(self, values: Array) -> Array:
        """Where values lie between the ends, 0 to 1; NaN stays."""
        if self.log:
            values, low, high = np.log(np.maximum(values, self.low)), math.log(self.low), math.log(self.high)
        else:
            low, high = self.low, self.high
        return np.asarray(np.clip((values - low) / max(high - low, 1e-30), 0.0, 1.0))

    @property
    def middle(self) -> float:
        """Value of the middle colour."""
        return math.sqrt(self.low * self.high) if self.log else (self.low + self.high) / 2


def scale_for(values: Array) -> ColorScale | None:
    """Colours for values; None where there is none that is finite."""
    known = values[np.isfinite(values)]
    if not len(known):
        return None
    low, high = float(known.min()), float(known.max())
    return ColorScale(low, high, low > 0 and high >= _LOG_FROM * low)


def colors(values: Array, scale: ColorScale) -> list[str]:
    """Colours (N) as ``#rrggbb``; grey where there is no value."""
    found = []
    for share in scale.shares(values).tolist():
        if math.isnan(share):
            found.append("#8a8a8a")
            continue
        at = share * (len(_STOPS) - 1)
        below = min(int(at), len(_STOPS) - 2)
        rgb = _RGB[below] + (at - below) * (_RGB[below + 1] - _RGB[below])
        found.append("#" + "".join(f"{round(part):02x}" for part in rgb))
    return found


def legend_html(scale: ColorScale | None, words: str, unit: str) -> str:
    """A strip of the colours with numbers under it; empty for no values."""
    if scale is None:
        return ""
    marks = "".join(f"<span>{number(value)}</span>" for value in (scale.low, scale.middle, scale.high))
    strip = f"<div class=rig-strip style='background:linear-gradient(90deg,{','.join(_STOPS)})'></div>"
    return f"<div class=rig-legend><div>{words}, {unit}</div>{strip}<div class=rig-marks>{marks}</div></div>"
