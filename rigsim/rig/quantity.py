"""The quantities that people give: names, units and bounds. How they are typed is the command line's."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from types import MappingProxyType

LENGTHS = MappingProxyType(
    {
        "um": Fraction(1, 1000),
        "µm": Fraction(1, 1000),
        "μm": Fraction(1, 1000),
        "mm": Fraction(1),
        "cm": Fraction(10),
        "m": Fraction(1000),
    }
)
PIXELS = MappingProxyType({"px": Fraction(1)})
ANGLES = MappingProxyType({"deg": Fraction(1), "°": Fraction(1)})
TURNS = MappingProxyType({**ANGLES, "arcmin": Fraction(1, 60)})
TIMES = MappingProxyType({"us": Fraction(1, 1000), "ms": Fraction(1), "s": Fraction(1000)})
SPEEDS = MappingProxyType(
    {"m/s": Fraction(1), "mm/s": Fraction(1, 1000), "cm/s": Fraction(1, 100), "km/h": Fraction(5, 18)}
)
TURN_RATES = MappingProxyType(
    {"deg/s": Fraction(1), "°/s": Fraction(1), "rad/s": Fraction(180) / Fraction(math.pi)}
)
PLAIN: Mapping[str, Fraction] = MappingProxyType({"": Fraction(1)})
"""Of a number without a unit."""


@dataclass(frozen=True, slots=True)
class QuantityKind:
    """What an option measures: its name in messages, its units and its bounds."""

    name: str
    """Name in messages: ``baseline``."""
    plain: str
    """Unit of a number without one."""
    factors: Mapping[str, Fraction]
    """Known units, each as a multiple of the result's."""
    above: float | None = None
    """Values must be greater, in the result's unit."""
    at_least: float | None = None
    """Values must be this or greater, in the result's unit."""
    below: float | None = None
    """Values must be less, in the result's unit."""


# lengths come out in mm, angles in deg, times in ms, speeds in m/s, the rest in px
BASELINE = QuantityKind("baseline", "mm", LENGTHS, above=0)
DEPTH = QuantityKind("depth", "mm", LENGTHS, above=0)
SENSOR_WIDTH = QuantityKind("sensor width", "mm", LENGTHS, above=0)
PIXEL_PITCH = QuantityKind("pixel pitch", "um", LENGTHS, above=0)
FOCAL_MM = QuantityKind("focal length", "mm", LENGTHS, above=0)
FOCAL_PX = QuantityKind("focal length", "px", PIXELS, above=0)
HFOV = QuantityKind("horizontal field of view", "deg", ANGLES, above=0, below=180)
VERGENCE = QuantityKind("vergence", "deg", ANGLES, above=-180, below=180)
YAW = QuantityKind("yaw", "deg", TURNS, above=-180, below=180)
PITCH = QuantityKind("pitch", "deg", TURNS, above=-180, below=180)
ROLL = QuantityKind("roll", "deg", TURNS, above=-180, below=180)
VERTICAL = QuantityKind("vertical shift", "mm", LENGTHS)
FORWARD = QuantityKind("forward shift", "mm", LENGTHS)
NOISE = QuantityKind("noise", "px", PIXELS, at_least=0)
DISPARITY_NOISE = QuantityKind("disparity noise", "px", PIXELS, at_least=0)
DISPARITY = QuantityKind("disparity", "px", PIXELS)
TIME_OFFSET = QuantityKind("time offset", "ms", TIMES)
FORWARD_SPEED = QuantityKind("forward speed", "m/s", SPEEDS)
TURN_RATE = QuantityKind("turn rate", "deg/s", TURN_RATES)

NOISE_PX = 0.25
"""Noise of a pixel coordinate where nobody says it."""
