"""What is published of one sensor.

A number nobody published in a place that could be checked is None, and has to be given. Where a camera
maker states EMVA 1288 figures in dB, the electrons follow from that standard's definitions:
``SNR_max = sqrt(full well)`` and ``DR = full well / (sqrt(read noise^2 + 1/4) + 1/2)``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from rigsim.errors import InvalidRig
from rigsim.rig.catalogue.housings import Housing
from rigsim.rig.sensor import Sensor

Shutter = Literal["global", "rolling"]


@dataclass(frozen=True, slots=True)
class SensorPreset:
    """What is published of one sensor."""

    name: str
    """Name on the command line."""
    maker: str
    """Who makes it."""
    width: int
    """Pixels across."""
    height: int
    """Pixels down."""
    pitch_um: float
    """Pixel pitch, micrometres."""
    bits: int
    """Bits of the converter used here, at most those the source names."""
    full_well_e: float | None
    """Electrons at full scale and lowest gain; None when no source was found."""
    read_noise_e: float | None
    """Read noise at lowest gain, electrons; None when no source was found."""
    geometry_source: str
    """Where pitch and resolution come from."""
    noise_source: str
    """Where full well and read noise come from; empty when there is none."""
    shutter: Shutter | None
    """Whether all rows are exposed at once or one after the other; None when no source was found."""
    shutter_source: str
    """Where the shutter comes from; why there is none, where there is none."""
    housing: Housing | None = None
    """A usual camera's body; None when no source was found."""

    @property
    def sensor_width_mm(self) -> float:
        """Width of the active area, mm."""
        return self.width * self.pitch_um * 1e-3

    def sensor(
        self,
        *,
        full_well_e: float | None = None,
        read_noise_e: float | None = None,
        gain: float = 1.0,
        bits: int = 0,
    ) -> Sensor:
        """The sensor behind an ideal lens; numbers given here win over published ones.

        Args:
            full_well_e: Electrons at full scale; needed when none is published.
            read_noise_e: Electrons; needed when none is published.
            gain: Analogue gain.
            bits: Bits of the converter; 0 takes the preset's.

        Raises:
            InvalidRig: a number is neither published nor given, or cannot be.
        """
        well = self.full_well_e if full_well_e is None else full_well_e
        noise = self.read_noise_e if read_noise_e is None else read_noise_e
        missing = [name for name, value in (("full_well_e", well), ("read_noise_e", noise)) if value is None]
        if well is None or noise is None:
            raise InvalidRig(f"sensor {self.name}: no published {' and '.join(missing)}: give it")
        return Sensor(full_well_e=well, read_noise_e=noise, gain=gain, bits=bits or self.bits)
