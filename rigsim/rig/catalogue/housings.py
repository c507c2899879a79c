"""How wide the cameras are that sensors are sold in: two do not stand closer than their bodies are wide.

A sensor is sold in many housings. What stands here is one of them, usual and published: an assumption.
"""

from __future__ import annotations

from dataclasses import dataclass

from rigsim.rig.catalogue.sensor_sources import CA_SF, RASPBERRY_PI, basler


@dataclass(frozen=True, slots=True)
class Housing:
    """A camera's body."""

    width_mm: float
    """Its width, along the rows of the image, mm."""
    camera: str
    """Whose: ``a Basler acA2040-55uc``."""
    source: str
    """Where that is published."""


def basler_housing(camera: str, width_mm: float = 29.0) -> Housing:
    """The body of a Basler camera."""
    return Housing(width_mm, f"a Basler {camera}", basler(camera))


PI_MODULE = Housing(25.0, "a Raspberry Pi camera module", f"{RASPBERRY_PI}, hardware specification")
PI_HQ = Housing(38.0, "a Raspberry Pi HQ or Global Shutter camera", f"{RASPBERRY_PI}, hardware specification")
CA_SF1 = Housing(39.0, "a Balluff BVS CA-SF1 (mvBlueFOX3-1)", f"{CA_SF}, mvBC_page_tech.html")
UP_TO_ONE_INCH = Housing(
    29.0,
    "a C-mount camera whose sensor is as large or larger, Basler's acA2500-60uc",
    basler("acA2500-60uc"),
)
"""Of a sensor with a diagonal up to that camera's 15.9 mm, where no camera with itself was found."""
