"""Real sensors by name: pixel pitch, resolution, shutter, full well and read noise, each with its source.

Sony's global shutters of machine vision have modules of their own, `pregius` and `pregius_s`.
"""

from __future__ import annotations

from rigsim.errors import InvalidRig
from rigsim.rig.catalogue.housings import CA_SF1, PI_HQ, PI_MODULE, UP_TO_ONE_INCH, basler_housing
from rigsim.rig.catalogue.pregius import PREGIUS
from rigsim.rig.catalogue.pregius_s import PREGIUS_S
from rigsim.rig.catalogue.sensor_preset import SensorPreset
from rigsim.rig.catalogue.sensor_sources import (
    ALLSKY,
    ALVIUM,
    CA_SF,
    CA_UB,
    LIBCAMERA,
    LUXONIS,
    MATRIX_VISION,
    RASPBERRY_PI,
    basler,
    flir,
)

__all__ = ["SENSORS", "SensorPreset", "sensor_preset"]

_IMX178 = (
    "Hikrobot MV-CB060-10GM data sheet (cdn.shopify.com/s/files/1/0630/8950/8583/files/MV-CB060-10GM-S_2.pdf)"
)
_IMX226 = basler("acA4024-29uc")
_MT9M034 = f"{CA_SF}, mvBlueFOX3-1012d"

SENSORS: dict[str, SensorPreset] = {
    preset.name: preset
    for preset in (
        SensorPreset(
            "imx219",
            "Sony",
            3280,
            2464,
            1.12,
            10,
            None,
            None,
            ALLSKY,
            "",
            "rolling",
            RASPBERRY_PI,
            PI_MODULE,
        ),
        SensorPreset(
            "imx296",
            "Sony",
            1456,
            1088,
            3.45,
            10,
            None,
            None,
            ALLSKY,
            "",
            "global",
            RASPBERRY_PI,
            PI_HQ,
        ),
        SensorPreset(
            "imx477",
            "Sony",
            4056,
            3040,
            1.55,
            12,
            8180.0,
            3.0,
            ALLSKY,
            "photon transfer curve of the Raspberry Pi HQ camera at analogue gain 1, "
            "strollswithmydog.com/pi-hq-cam-sensor-performance",
            "rolling",
            RASPBERRY_PI,
            PI_HQ,
        ),
        SensorPreset("ar0234", "onsemi", 1920, 1200, 3.0, 10, None, None, LUXONIS, "", "global", LUXONIS),
        SensorPreset("ov9282", "OmniVision", 1280, 800, 3.0, 10, None, None, LUXONIS, "", "global", LUXONIS),
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
            "rolling",
            "Raspberry Pi camera module v1 technical specification",
            PI_MODULE,
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
            "global",
            ALVIUM,
            UP_TO_ONE_INCH,
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
            MATRIX_VISION,
            f"{MATRIX_VISION}, mvBlueFOX3-2051, EMVA 1288: SNR_max 40.3 dB, DR 71.2 dB (Teledyne DALSA's "
            "Genie Nano M2450 manual gives 10.7 ke-)",
            "global",
            MATRIX_VISION,
            UP_TO_ONE_INCH,
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
            MATRIX_VISION,
            f"{MATRIX_VISION}, mvBlueFOX3-2024a, EMVA 1288: SNR 45.1 dB, DR 73 dB",
            "global",
            MATRIX_VISION,
            UP_TO_ONE_INCH,
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
            "global",
            "Balluff BVS CA-SF manual, mvBlueFOX3-1012b",
            CA_SF1,
        ),
        SensorPreset(
            "imx178",
            "Sony",
            3072,
            2048,
            2.4,
            12,
            None,
            None,
            f"{_IMX178}; bits: {ALLSKY}, which has 3096x2080",
            "",
            "rolling",
            _IMX178,
            UP_TO_ONE_INCH,
        ),
        SensorPreset(
            "imx226",
            "Sony",
            4024,
            3036,
            1.85,
            12,
            None,
            None,
            f"{_IMX226}; bits: {flir('BFS-U3-120S4')}",
            "",
            "rolling",
            f"{_IMX226}; {flir('BFS-U3-120S4')} adds a global reset",
            basler_housing("acA4024-29uc"),
        ),
        SensorPreset(
            "imx290",
            "Sony",
            1920,
            1080,
            2.9,
            12,
            None,
            None,
            "Sony IMX290LQR-C data sheet (scribd.com/document/798857954): 1920x1080 recommended, 12 bit;"
            f" pitch: {LIBCAMERA}; {ALLSKY} has 1936x1096",
            "",
            None,
            "none found: Sony's data sheet and Linux do not say; the later IMX462 has a rolling one",
        ),
        SensorPreset(
            "imx335",
            "Sony",
            2592,
            1944,
            2.0,
            10,
            None,
            None,
            f"{CA_UB}; pitch: {LIBCAMERA}",
            "",
            "rolling",
            CA_UB,
        ),
        SensorPreset(
            "imx378",
            "Sony",
            4056,
            3040,
            1.55,
            12,
            None,
            None,
            ALLSKY,
            "",
            "rolling",
            "Luxonis OAK-FFC IMX378 (docs.luxonis.com/hardware/products/OAK-FFC-IMX378)",
        ),
        SensorPreset(
            "imx462",
            "Sony",
            1920,
            1080,
            2.9,
            12,
            None,
            None,
            f"{LUXONIS}; bits: Linux, drivers/media/i2c/imx290.c",
            "",
            "rolling",
            LUXONIS,
        ),
        SensorPreset(
            "ar0144",
            "onsemi",
            1280,
            800,
            3.0,
            12,
            None,
            None,
            "Linux, drivers/media/i2c/ar0144.c (linux-media, 30 June 2024): 1280x800 by default, 1288x808"
            f" active, 12 bit; pitch: {LIBCAMERA}",
            "",
            "global",
            "PnPCAM wiki, Sensors (github.com/angusgbishop/PnPCAM/wiki/Sensors)",
        ),
        SensorPreset(
            "ov9281",
            "OmniVision",
            1280,
            800,
            3.0,
            10,
            None,
            None,
            f"{LUXONIS}, OV9282, from which it differs in the chief ray angle (Linux, ovti,ov9282.yaml);"
            f" bits: Linux, drivers/media/i2c/ov9282.c; pitch as well: {LIBCAMERA}",
            "",
            "global",
            f"{LUXONIS}, OV9282",
        ),
        SensorPreset(
            "mt9m034",
            "onsemi",
            1280,
            960,
            3.75,
            12,
            5888.0,
            3.44,
            _MT9M034,
            f"{_MT9M034}, EMVA 1288: SNR_max 37.7 dB, DR 63.4 dB",
            "rolling",
            _MT9M034,
            CA_SF1,
        ),
        *PREGIUS,
        *PREGIUS_S,
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
