"""From words about lens and sensor to numbers.

A rig's own sensor is the file's; ``--sensor NAME`` stands in for all of it, and the other options change
single numbers of whichever it is. Without any of these it is the ideal pinhole at 8 bits.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rigsim.typed import quantity

if TYPE_CHECKING:
    from pathlib import Path

    from rigsim.interop.formats.kit.reading import RigFiles
    from rigsim.rig.sensor import Sensor

SensorName = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="Sensor by name, as IMX477; see rigsim scenes. By default the rig's."),
]
Blur = Annotated[
    str | None, typer.Option(metavar="PX", help="Lens blur: standard deviation of its point spread, px.")
]
ImageNoise = Annotated[
    str | None,
    typer.Option(metavar="GREY", help="White noise of the pictures, grey levels of 255; 0,1,2 for several."),
]
FullWell = Annotated[
    str | None, typer.Option(metavar="E", help="Electrons that make full scale, for the photon noise.")
]
ReadNoise = Annotated[str | None, typer.Option(metavar="E", help="Read noise, electrons.")]

_ELECTRONS = {"e": Fraction(1)}
_BLUR = quantity.QuantityKind("lens blur", "px", {"px": Fraction(1)}, at_least=0)
_IMAGE_NOISE = quantity.QuantityKind("image noise", "grey", {"grey": Fraction(1)}, at_least=0)
_FULL_WELL = quantity.QuantityKind("full well", "e", _ELECTRONS, at_least=0)
_READ_NOISE = quantity.QuantityKind("read noise", "e", _ELECTRONS, at_least=0)


def sensor_words(
    name: str | None = None,
    rig: RigFiles | Path | None = None,
    *,
    blur: str | None = None,
    image_noise: str | None = None,
    full_well: str | None = None,
    read_noise: str | None = None,
) -> dict[str, Any]:
    """The words about lens and sensor, as the functions of `rigsim.api` take them.

    Args:
        name: A preset's name, in any case; stands in for the rig file's sensor.
        rig: A rig.toml, or another calibration, which has no sensor.
        blur: ``PX``.
        image_noise: ``GREY``, a list or a range of it.
        full_well: ``E``, electrons.
        read_noise: ``E``, electrons.

    Raises:
        InvalidRange: a value cannot be read or is out of bounds.
        OutputError: the rig file cannot be read.
    """
    return {
        "sensor": name if name is not None else sensor_of(rig),
        "blur_px": None if blur is None else quantity.value(blur, _BLUR),
        "image_noise_grey": () if image_noise is None else quantity.values(image_noise, _IMAGE_NOISE),
        "full_well_e": None if full_well is None else quantity.value(full_well, _FULL_WELL),
        "read_noise_e": None if read_noise is None else quantity.value(read_noise, _READ_NOISE),
    }


def sensor_of(rig: RigFiles | Path | None) -> Sensor | None:
    """The sensor that a rig's file says it has; None where there is no file, or none in it."""
    if rig is None:
        return None
    from rigsim.interop.formats.calibration import calibration_sensor, paths_of

    return calibration_sensor(paths_of(rig))
