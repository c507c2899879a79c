"""Rigs by name: the one each bundled scene is made for."""

from __future__ import annotations

from dataclasses import dataclass

from rigsim.errors import InvalidScene
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig


@dataclass(frozen=True, slots=True)
class Preset:
    """A named rig and where its numbers come from."""

    name: str
    """Name on the command line."""
    rig: StereoRig
    """The rig."""
    about: str
    """What it is for, one line."""
    source: str
    """Where the numbers come from."""


def _preset(
    name: str, width: int, height: int, focal_px: float, baseline_m: float, about: str, source: str = "rigsim"
) -> Preset:
    rig = StereoRig.rectified(Intrinsics.from_focal(width, height, focal_px), baseline_m)
    return Preset(name, rig, about, source)


PRESETS: dict[str, Preset] = {
    preset.name: preset
    for preset in (
        _preset("boards", 1280, 720, 900.0, 0.120, "general indoor rig, 71 deg wide"),
        _preset(
            "branch",
            1280,
            960,
            1200.0,
            0.150,
            "drone that keeps clear of a branch at 2.57 m",
            "Multiview Calculator, first worked example",
        ),
        _preset(
            "artifact",
            1600,
            1200,
            2000.0,
            0.080,
            "desktop scan of an object at 1.07 m",
            "Multiview Calculator, second worked example",
        ),
        _preset("corridor", 1280, 720, 1000.0, 0.300, "mobile robot looking down a corridor"),
        _preset("bin", 1280, 960, 1100.0, 0.060, "bin picking from above"),
    )
}
"""Every preset by its name."""


def preset(name: str) -> Preset:
    """The preset called `name`.

    Raises:
        InvalidScene: no preset has that name; the message lists those that exist.
    """
    try:
        return PRESETS[name]
    except KeyError:
        raise InvalidScene(f"unknown preset {name!r}: choose one of {', '.join(PRESETS)}") from None
