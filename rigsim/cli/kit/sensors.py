"""From words about lens and sensor to sensors, and what each is called in tables.

A rig's own sensor is the file's; ``--sensor NAME`` stands in for all of it, and the other options change
single numbers of whichever it is. Without any of these it is the ideal pinhole at 8 bits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rigsim.cli.kit import quantity
from rigsim.errors import InvalidRange, InvalidRig

if TYPE_CHECKING:
    from rigsim.rig.catalogue.sensors import SensorPreset
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


def sensors_from(
    name: str | None = None,
    rig_path: Path | None = None,
    *,
    blur: str | None = None,
    image_noise: str | None = None,
    full_well: str | None = None,
    read_noise: str | None = None,
) -> tuple[Sensor, ...]:
    """The sensors asked for, one for each level of image noise; they share their optics, so one render does.

    Args:
        name: A preset's name, in any case; stands in for the rig file's sensor.
        rig_path: A rig.toml, or another calibration, which has no sensor.
        blur: ``PX``.
        image_noise: ``GREY``, a list or a range of it.
        full_well: ``E``, electrons.
        read_noise: ``E``, electrons.

    Raises:
        InvalidRange: a value cannot be read or is out of bounds.
        InvalidRig: no such sensor, a number that nobody published and that is not given, or a sensor that
            cannot be.
        OutputError: the rig file cannot be read.
    """
    from rigsim.rig.sensor import Sensor

    changes: dict[str, Any] = {
        key: quantity.value(text, kind)
        for key, text, kind in (
            ("blur_px", blur, _BLUR),
            ("full_well_e", full_well, _FULL_WELL),
            ("read_noise_e", read_noise, _READ_NOISE),
        )
        if text is not None
    }
    levels = () if image_noise is None else quantity.values(image_noise, _IMAGE_NOISE)
    if name is not None:
        base = _named(name, changes.pop("full_well_e", None), changes.pop("read_noise_e", None))
    else:
        base = sensor_of(rig_path) or Sensor()
    sensor = replace(base, **changes)
    return tuple(replace(sensor, grey_noise=level) for level in levels) or (sensor,)


def sensor_from(
    name: str | None = None,
    rig_path: Path | None = None,
    *,
    blur: str | None = None,
    image_noise: str | None = None,
    full_well: str | None = None,
    read_noise: str | None = None,
) -> Sensor:
    """The one sensor asked for; arguments as `sensors_from`.

    Raises:
        InvalidRange: several levels of image noise; else as `sensors_from`.
    """
    sensors = sensors_from(
        name, rig_path, blur=blur, image_noise=image_noise, full_well=full_well, read_noise=read_noise
    )
    if len(sensors) != 1:
        raise InvalidRange(f"image noise {image_noise}: {len(sensors)} levels; this command takes one")
    return sensors[0]


def sensor_labels(sensors: Sequence[Sensor], name: str | None = None) -> tuple[str, ...]:
    """What each of `sensors` is called in a table: ``IMX477``, ``ideal``, ``ideal, 2 grey``.

    Args:
        sensors: What `sensors_from` returned.
        name: The preset they come from; None recognises those with published noise by their electrons.

    Returns:
        One label each; those of different levels of image noise differ.
    """
    levels = [sensor.grey_noise for sensor in sensors]
    digits = next(
        digits
        for digits in range(4, 18)
        if len({f"{level:.{digits}g}" for level in levels}) == len(set(levels))
    )
    return tuple(_label(sensor, name, f"{sensor.grey_noise:.{digits}g} grey") for sensor in sensors)


def _named(name: str, full_well_e: float | None, read_noise_e: float | None) -> Sensor:
    from rigsim.rig.catalogue.sensors import sensor_preset

    preset = sensor_preset(name)
    missing = [
        number
        for number, published, given in (
            ("full well", preset.full_well_e, full_well_e),
            ("read noise", preset.read_noise_e, read_noise_e),
        )
        if published is None and given is None
    ]
    if missing:
        options = " and ".join(f"--{number.replace(' ', '-')}" for number in missing)
        raise InvalidRig(
            f"sensor {preset.name}: no source was found for its {' and '.join(missing)}; add {options} in"
            " electrons (0 leaves that noise out)"
        )
    return preset.sensor(full_well_e=full_well_e, read_noise_e=read_noise_e)


def sensor_of(rig_path: Path | None) -> Sensor | None:
    """The sensor that a rig's file says it has; None where there is no file, or none in it."""
    if rig_path is None:
        return None
    from rigsim.interop.formats.calibration import calibration_sensor

    return calibration_sensor(rig_path)


def _label(sensor: Sensor, name: str | None, grey: str) -> str:
    from rigsim.rig.catalogue.sensors import SENSORS, sensor_preset
    from rigsim.rig.sensor import Sensor

    preset = (
        sensor_preset(name)
        if name is not None
        else next((preset for preset in SENSORS.values() if _is_made_by(sensor, preset)), None)
    )
    plain = Sensor()
    bits, full_well_e, read_noise_e = plain.bits, plain.full_well_e, plain.read_noise_e
    words = "ideal"
    if preset is not None:
        words, bits = preset.name.upper(), preset.bits
        full_well_e, read_noise_e = preset.full_well_e or 0.0, preset.read_noise_e or 0.0
    changed = (
        (sensor.bits != bits, f"{sensor.bits} bit" if sensor.bits else "no rounding"),
        (sensor.full_well_e != full_well_e, f"full well {sensor.full_well_e:.6g} e-"),
        (sensor.read_noise_e != read_noise_e, f"read noise {sensor.read_noise_e:.6g} e-"),
        (sensor.gain != plain.gain, f"gain {sensor.gain:.6g}"),
        (sensor.black_level != plain.black_level, f"black level {sensor.black_level:.6g}"),
        (sensor.prnu_pct != plain.prnu_pct, f"PRNU {sensor.prnu_pct:.6g} %"),
        (sensor.dsnu_e != plain.dsnu_e, f"DSNU {sensor.dsnu_e:.6g} e-"),
        (sensor.blur_px != plain.blur_px, f"blur {sensor.blur_px:.6g} px"),
        (sensor.distortion is not None, "distorted"),
        (sensor.vignetting != plain.vignetting, f"vignetting {sensor.vignetting:.6g}"),
        (sensor.right_gain != plain.right_gain, f"right gain {sensor.right_gain:.6g}"),
        (sensor.right_offset != plain.right_offset, f"right offset {sensor.right_offset:.6g}"),
        (sensor.grey_noise != plain.grey_noise, grey),
    )
    differences = [text for differs, text in changed if differs]
    if preset is None and sensor.full_well_e:
        return ", ".join(differences)
    return ", ".join([words, *differences])


def _is_made_by(sensor: Sensor, preset: SensorPreset) -> bool:
    return preset.full_well_e == sensor.full_well_e and preset.read_noise_e in (None, sensor.read_noise_e)
