"""What one row of a sweep is about."""

from __future__ import annotations

from dataclasses import dataclass

from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig


@dataclass(frozen=True, slots=True)
class Configuration:
    """What one row is about."""

    rig: StereoRig
    """The rig that is assumed."""
    noise: PixelNoise
    """Noise of the simulated pixel positions."""
    triangulator: str
    """Name of the method under test."""
    sensor: str
    """Name of the lens and sensor of the pictures."""
