"""Which rigs bring a mistake out, and what is said when none fits, in words."""

from __future__ import annotations

from collections.abc import Sequence

from rigsim.present.kit.mistakes.of_symptoms import numbers
from rigsim.present.kit.sayings import Sentences


def _off(which: str, scatter_px: float, off_px: Sequence[float], times: float) -> str:
    return (
        f"{which} Points project about {scatter_px:.2g} px from their pixels (typically {numbers(off_px)} px "
        f"in u, v of the left and of the right image), and depths are {times:.4g} times the true ones."
    )


def _only_with(feature: str, at: float, worse: str, better: str, passing: float, unit: str) -> str:
    at_words, passing_words = (f"{value:.3g} {unit}".rstrip() for value in (at, passing))
    return f"only with {feature} of {at_words} {worse} ({better} {passing_words} passes)"


def _only_in(names: Sequence[str]) -> str:
    more = f" and {len(names) - 4} others" if len(names) > 4 else ""
    return f"only in {', '.join(names[:4])}{more}"


UNKNOWN: Sentences = {
    "failing: all": "All exact cases fail.",
    "failing: none": "",
    "failing: those": "All rigs with {rigs} fail, and no others.",
    "failing: only": "Only rigs with {rigs} fail.",
    "failing: some": "{failing} of {of} cases fail.",
    "unknown": "{which} No known mistake explains it.",
    "unknown: behind": "{which} No point that comes back is in front of both cameras.",
    "lost-digits": "{which} Errors look like noise, about {scatter_px:.1g} px: numbers that were rounded or "
    "written with few digits, a step for numerical derivatives, or an iteration that stops early.",
    "lost-digits: single": "{which} Errors look like noise, about {scatter_px:.1g} px: numbers that were "
    "rounded or written with few digits, a step for numerical derivatives, or an iteration that stops early, "
    "or single precision (float32).",
    "random-errors": "{which} Errors look like noise: about {scatter_px:.2g} px either way, without a "
    "direction, and depths {spread:.2g} of themselves; look for random numbers, wrong matches or an "
    "iteration that stops early.",
    "rigs: doffs": "unequal principal points (doffs)",
    "rigs: distortion": "lens distortion",
    "rigs: turn": "a turned right camera",
    "rigs: non-square": "pixels that are not square",
    "rigs: two-lenses": "two different lenses",
    "rigs: off-x": "a baseline that is not along x",
    "rigs: unrectified": "no rectification",
    "rigs: far": "points beyond 50 m",
    "unknown: off": _off,
}
"""Which rigs fail, and how the errors look, where no mistake fits."""

CONDITIONS: Sentences = {
    "only-with: or more": lambda **values: _only_with(**values, worse="or more", better="up to"),
    "only-with: or less": lambda **values: _only_with(**values, worse="or less", better="from"),
    "only-in": _only_in,
    "feature: turn": "a turn between the cameras",
    "feature: roll": "a roll between the cameras",
    "feature: turn-outwards": "a turn outwards",
    "feature: baseline": "a baseline",
    "feature: share-of-x": "a share of x in the way to the right camera",
    "feature: share-of-y": "a share of y in the way to the right camera",
    "feature: share-of-z": "a share of z in the way to the right camera",
    "feature: k1": "a k1",
    "feature: focal-difference": "a difference of the focal lengths",
    "feature: principal-point-difference": "a difference of the principal points",
    "feature: height-to-width": "a ratio of height to width",
    "feature: fx-fy-difference": "a difference of fx and fy",
    "feature: off-axis": "rays off the axis",
    "feature: farthest-point": "a farthest point",
    "feature: nearest-point": "a nearest point",
    "feature: rows": "a number of rows",
}
"""What sets the rigs that bring a mistake out apart."""
