"""Real sensors by name: pixel pitch, resolution, full well and read noise, each with its source.

A number nobody published in a place that could be checked is None, and has to be given. Where a camera
maker states EMVA 1288 figures in dB, the electrons follow from that standard's definitions:
``SNR_max = sqrt(full well)`` and ``DR = full well / (sqrt(read noise^2 + 1/4) + 1/2)``.
"""

from __future__ import annotations

from dataclasses import dataclass

from rigsim.errors import InvalidRig
from rigsim.rig.sensor import Sensor

_LUXONIS = "Luxonis hardware documentation (docs.luxonis.com/hardware/sensors)"
_ALLSKY = "indi-allsky wiki, Camera Information (github.com/aaronwmorris/indi-allsky/wiki)"
_MATRIX_VISION = "matrix-vision.com mvBlueFOX3 manual"


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


SENSORS: dict[str, SensorPreset] = {
    preset.name: preset
    for preset in (
        SensorPreset("imx219", "Sony", 3280, 2464, 1.12, 10, None, None, _ALLSKY, ""),
        SensorPreset("imx296", "Sony", 1456, 1088, 3.45, 10, None, None, _ALLSKY, ""),
        SensorPreset(
            "imx477",
            "Sony",
            4056,
            3040,
            1.55,
            12,
            8180.0,
            3.0,
            _ALLSKY,
            "photon transfer curve of the Raspberry Pi HQ camera at analogue gain 1, "
            "strollswithmydog.com/pi-hq-cam-sensor-performance",
        ),
        SensorPreset("ar0234", "onsemi", 1920, 1200, 3.0, 10, None, None, _LUXONIS, ""),
        SensorPreset("ov9282", "OmniVision", 1280, 800, 3.0, 10, None, None, _LUXONIS, ""),
        SensorPreset(
            "ov5647",
            "OmniVision",
            2592,
            1944,
            1.4,
            10,
            4300.0,
            None,
            "Raspberry Pi camera module v1 technical specification",
            "Raspberry Pi camera module v1 technical specification (well capacity 4.3 ke-)",
        ),
        SensorPreset(
            "imx264",
            "Sony",
            2448,
            2048,
            3.45,
            12,
            11141.0,
            2.30,
            "github.com/gidobot/UWOpticalSystemsDesignTools, cfg/sensors/imx264C.json",
            "the same file: read noise 2.30 e-, gain 5.882 levels of 16 bits per electron (65535 / 5.882 e-)",
        ),
        SensorPreset(
            "imx250",
            "Sony",
            2464,
            2056,
            3.45,
            12,
            10715.0,
            2.40,
            _MATRIX_VISION,
            f"{_MATRIX_VISION}, mvBlueFOX3-2051, EMVA 1288: SNR_max 40.3 dB, DR 71.2 dB (Teledyne DALSA's "
            "Genie Nano M2450 manual gives 10.7 ke-)",
        ),
        SensorPreset(
            "imx249",
            "Sony",
            1936,
            1216,
            5.86,
            12,
            32359.0,
            6.73,
            _MATRIX_VISION,
            f"{_MATRIX_VISION}, mvBlueFOX3-2024a, EMVA 1288: SNR 45.1 dB, DR 73 dB",
        ),
        SensorPreset(
            "mt9m031",
            "onsemi",
            1280,
            960,
            3.75,
            12,
            5495.0,
            10.08,
            "Balluff BVS CA-SF manual, mvBlueFOX3-1012b",
            "Balluff BVS CA-SF manual, mvBlueFOX3-1012b, EMVA 1288: SNR_max 37.4 dB, DR 54.3 dB",
        ),
    )
}
"""Every sensor by its name."""


def sensor_preset(name: str) -> SensorPreset:
    """The sensor called `name`, in any case.

    Raises:
        InvalidRig: no sensor has that name; the message lists those that exist.
    """
    try:
        return SENSORS[name.lower()]
    except KeyError:
        raise InvalidRig(f"unknown sensor {name!r}: choose one of {', '.join(SENSORS)}") from None
