"""Sensors as people name them, and what each is called in tables.

A rig's own sensor is the file's; a named one stands in for all of it, and the other numbers change whichever
it is. Without any of these it is the ideal pinhole at 8 bits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from rigsim.errors import InvalidRange, InvalidRig
from rigsim.rig import given
from rigsim.rig.catalogue.sensors import SENSORS, SensorPreset, sensor_preset
from rigsim.rig.sensor import Sensor

TYPICAL_NOISE_GREY = 2.0
"""Image noise of an ordinary 8-bit camera in good light, grey levels."""


@dataclass(frozen=True, slots=True)
class SensorOptions:
    """A sensor, and single numbers of it; None where nothing was said."""

    sensor: str | Sensor | None = None
    """A preset's name in any case, or a sensor; stands in for the rig file's."""
    blur_px: float | None = None
    """Standard deviation of the lens's point spread, px."""
    image_noise_grey: tuple[float, ...] = ()
    """White noise of the pictures, grey levels of 255."""
    full_well_e: float | None = None
    """Electrons that make full scale."""
    read_noise_e: float | None = None
    """Read noise, electrons."""

    @property
    def name(self) -> str | None:
        """The preset's name; None where none was named."""
        return self.sensor if isinstance(self.sensor, str) else None

    def all(self, own: Sensor | None = None) -> tuple[Sensor, ...]:
        """The sensors asked for, one for each level of image noise; they share their optics.

        Args:
            own: the rig file's sensor.

        Raises:
            InvalidRig: no such sensor, a number that nobody published and that is not given, or a sensor
                that cannot be.
        """
        changes: dict[str, Any] = {
            key: given.real(value, key)
            for key, value in (
                ("blur_px", self.blur_px),
                ("full_well_e", self.full_well_e),
                ("read_noise_e", self.read_noise_e),
            )
            if value is not None
        }
        if isinstance(self.sensor, str):
            base = _named(self.sensor, changes.pop("full_well_e", None), changes.pop("read_noise_e", None))
        elif self.sensor is not None:
            base = given.a(Sensor, self.sensor, "a sensor's name, or a Sensor")
        else:
            base = own or Sensor()
        sensor = replace(base, **changes)
        return tuple(replace(sensor, grey_noise=level) for level in self.image_noise_grey) or (sensor,)

    def one(self, own: Sensor | None = None) -> Sensor:
        """The one sensor asked for.

        Raises:
            InvalidRange: several levels of image noise; else as `all`.
        """
        sensors = self.all(own)
        if len(sensors) != 1:
            levels = ",".join(f"{level:g}" for level in self.image_noise_grey)
            raise InvalidRange(f"image noise {levels}: {len(sensors)} levels; this command takes one")
        return sensors[0]


def sensor_labels(sensors: Sequence[Sensor], name: str | None = None) -> tuple[str, ...]:
    """What each of `sensors` is called in a table: ``IMX477``, ``ideal``, ``ideal, 2 grey``.

    Args:
        sensors: What `SensorOptions.all` returned.
        name: The preset they come from; None recognises it by electrons that no other preset has.

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


def _label(sensor: Sensor, name: str | None, grey: str) -> str:
    preset = sensor_preset(name) if name is not None else _recognised(sensor)
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


def _recognised(sensor: Sensor) -> SensorPreset | None:
    """The one preset with its electrons: siblings with the same pixels cannot be told apart."""
    alike = [preset for preset in SENSORS.values() if _is_made_by(sensor, preset)]
    return alike[0] if len(alike) == 1 else None


def _is_made_by(sensor: Sensor, preset: SensorPreset) -> bool:
    return preset.full_well_e == sensor.full_well_e and preset.read_noise_e in (None, sensor.read_noise_e)
