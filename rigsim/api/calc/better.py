"""Which of several rigs is the more accurate, in a sentence."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from rigsim.rig.stereo import StereoRig

_EQUAL_PCT = 0.05


class Rated(NamedTuple):
    """A rig's depth error at a distance."""

    name: str
    depth_mm: float
    std_mm: float
    """NaN where not both of its cameras see the point."""


def better(rated: Sequence[Rated], noise_px: float, modes: Mapping[str, str]) -> str:
    """The sentence; empty for one rig.

    Args:
        rated: every rig at every distance.
        noise_px: noise of a pixel coordinate, px, that was taken for all.
        modes: what each camera one can buy was taken to run as.
    """
    names = list(dict.fromkeys(one.name for one in rated))
    if len(names) < 2:
        return ""
    where: dict[str, list[str]] = {}
    for depth_mm in dict.fromkeys(one.depth_mm for one in rated):
        here = [one for one in rated if one.depth_mm == depth_mm]
        where.setdefault(_verdict(here), []).append(f"{depth_mm / 1e3:g}")
    parts = [f"at {_and(depths)} m {says}" for says, depths in where.items()]
    says = f"{'; '.join(parts)}. The same noise is assumed for {'both' if len(names) == 2 else 'all'}, "
    says += f"{noise_px:g} px per coordinate"
    told = [f"{name} at {mode}" for name, mode in modes.items()]
    if told:
        says += f", and {'this mode' if len(told) == 1 else 'these modes'}: {_and(told)}"
    return f"{says[0].upper()}{says[1:]}."


def modes_of(rigs: Mapping[str, tuple[str | None, StereoRig]]) -> dict[str, str]:
    """In which mode each camera one can buy is, by name; `rigs` are presets' names with their rigs."""
    from rigsim.rig.presets import preset

    named = {name: (preset(own), rig) for name, (own, rig) in rigs.items() if own is not None}
    return {name: of.mode(rig) for name, (of, rig) in named.items() if of.figures}


def _verdict(here: Sequence[Rated]) -> str:
    seen = sorted((one for one in here if not math.isnan(one.std_mm)), key=lambda one: one.std_mm)
    if not seen:
        return "none sees the point with both cameras"
    if len(seen) == 1:
        return f"only {seen[0].name} sees the point with both cameras"
    best, next_best = seen[:2]
    gain_pct = 100 * (1 - best.std_mm / next_best.std_mm) if next_best.std_mm else 0.0
    if gain_pct < _EQUAL_PCT:
        return f"{best.name} and {next_best.name} are equally accurate"
    most = "more" if len(here) == 2 else "most"
    return (
        f"{best.name} is the {most} accurate: its depth std is {gain_pct:.3g} % smaller than "
        f"that of {next_best.name}"
    )


def _and(words: Sequence[str]) -> str:
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)
