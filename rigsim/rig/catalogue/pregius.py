"""Sony's Pregius sensors: global shutters of machine vision cameras, with pixels of 3.45 um and more.

Image sizes are what a camera delivers by default, where its maker says so: the chip has a few pixels more.
Electrons of one camera measured in dB win over rounded numbers of another.
"""

from __future__ import annotations

from rigsim.rig.catalogue.sensor_preset import SensorPreset
from rigsim.rig.catalogue.sensor_sources import ALVIUM, CA_SF, alvium_emva, basler, flir

_IMX255 = "matrix-vision.com mvBlueFOX3 manual, chapter on the IMX255 (easymanua.ls/matrix/mvbluefox3)"
_IMX265 = f"{basler('acA2040-55uc')}: 2048x1536 by default, 2064x1544 in full"
_IMX267 = f"{basler('acA4096-30uc')}: 4096x2168 by default, 4112x2176 in full"
_IMX273 = f"{basler('acA1440-220uc')}: 1440x1080 by default, 1456x1088 in full"
_IMX392 = f"{basler('daA1920-160um')}: 1920x1200 by default, 1936x1216 in full"

PREGIUS: tuple[SensorPreset, ...] = (
    SensorPreset(
        "imx174",
        "Sony",
        1936,
        1216,
        5.86,
        12,
        32691.0,
        6.83,
        ALVIUM,
        "fhotolab.fherb.de/2016/09/07 on the IMX174, EMVA 1288: saturation 32691 e-, dark noise 6.83 e-",
        "global",
        ALVIUM,
    ),
    SensorPreset(
        "imx252",
        "Sony",
        2048,
        1536,
        3.45,
        12,
        None,
        None,
        flir("BFS-U3-32S4"),
        "",
        "global",
        flir("BFS-U3-32S4"),
    ),
    SensorPreset(
        "imx255",
        "Sony",
        4112,
        2176,
        3.45,
        12,
        10715.0,
        2.37,
        _IMX255,
        f"{_IMX255}, EMVA 1288: SNR 40.3 dB, DR 71.3 dB",
        "global",
        _IMX255,
    ),
    SensorPreset(
        "imx265",
        "Sony",
        2048,
        1536,
        3.45,
        12,
        10400.0,
        2.1,
        f"{_IMX265}; bits: {ALVIUM}",
        alvium_emva("C-319m", "saturation 10400 e-, dark noise 2.1 e-"),
        "global",
        _IMX265,
    ),
    SensorPreset(
        "imx267",
        "Sony",
        4096,
        2168,
        3.45,
        12,
        None,
        None,
        f"{_IMX267}; bits: {ALVIUM}",
        "",
        "global",
        _IMX267,
    ),
    SensorPreset(
        "imx273",
        "Sony",
        1440,
        1080,
        3.45,
        12,
        10471.0,
        2.26,
        f"{_IMX273}; bits: {CA_SF}",
        f"{CA_SF}, mvBlueFOX3-2016, EMVA 1288: SNR_max 40.2 dB, DR 71.4 dB"
        " (Allied Vision gives 10400 e- and 2.1 e-)",
        "global",
        _IMX273,
    ),
    SensorPreset(
        "imx287",
        "Sony",
        720,
        540,
        6.9,
        12,
        None,
        3.2,
        flir("BFS-U3-04S2"),
        f"{alvium_emva('C-040m', 'dark noise 3.2 e-')}; its full well of 208000 e- is left out:"
        " ten times what its own dynamic range of 74 dB allows",
        "global",
        flir("BFS-U3-04S2"),
    ),
    SensorPreset(
        "imx304",
        "Sony",
        4112,
        3008,
        3.45,
        12,
        10400.0,
        2.1,
        ALVIUM,
        alvium_emva("C-1236m", "saturation 10400 e-, dark noise 2.1 e-"),
        "global",
        f"{ALVIUM}; commonlands.com/pages/image-sensors/imx304",
    ),
    SensorPreset(
        "imx392",
        "Sony",
        1920,
        1200,
        3.45,
        12,
        10400.0,
        2.1,
        f"{_IMX392}; bits: {ALVIUM}",
        alvium_emva("C-240m", "saturation 10400 e-, dark noise 2.1 e-"),
        "global",
        _IMX392,
    ),
    SensorPreset(
        "imx430",
        "Sony",
        1616,
        1240,
        4.5,
        12,
        None,
        None,
        flir("BFS-U3-19S4"),
        "",
        "global",
        flir("BFS-U3-19S4"),
    ),
)
"""Of the first three generations."""
