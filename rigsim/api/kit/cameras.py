"""The cameras that a design tries: each image size or sensor with each lens."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rigsim.api.rigs import Several, Sizes
from rigsim.errors import InvalidRange
from rigsim.rig import extent, given
from rigsim.rig.catalogue.sensors import SensorPreset, sensor_preset
from rigsim.study.design.solve import HFOVS_DEG, LENSES_MM, RESOLUTIONS
from rigsim.study.scene.plan import sizes
from rigsim.theory.inverse import Camera


@dataclass(frozen=True, slots=True)
class CameraOptions:
    """What cameras there are to choose from; usual ones where nothing is said."""

    resolutions_px: Sizes = ()
    """(width, height), px; excludes `sensors`."""
    sensors: tuple[str, ...] = ()
    """Names of sensors, each with its own resolution."""
    lenses_mm: Several = ()
    """Focal lengths, mm; they need `sensors`."""
    lenses_px: Several = ()
    """Focal lengths, px."""
    lenses_deg: Several = ()
    """Horizontal fields of view, deg."""

    def all(self, fov_deg: float | None) -> list[Camera]:
        """Every camera to try; `fov_deg` is the field of view asked for, deg.

        Raises:
            InvalidRange: two things say the same, or something is missing.
            InvalidRig: no such sensor.
        """
        given_sizes = sizes(self.resolutions_px)
        if given_sizes and self.sensors:
            raise InvalidRange(
                "--resolution and --sensor both given: a sensor has its own resolution, give one"
            )
        unit, lenses = self._lenses()
        extent.CAMERAS.check(max(1, len(lenses)))
        if self.sensors and unit in ("", "mm"):
            return [
                _behind(chip, mm * 1e3 / chip.pitch_um)
                for chip in self._chips()
                for mm in (lenses or LENSES_MM)
            ]
        if unit == "mm":
            said = ",".join(f"{mm:g}" for mm in lenses)
            raise InvalidRange(f"lens {said}mm: mm need a --sensor with its pixel pitch; or give px or deg")
        wanted = () if fov_deg is None else (fov_deg,)
        angles = lenses or tuple(sorted({*HFOVS_DEG, *wanted}))

        def focals_px(width_px: int) -> tuple[float, ...]:
            if unit == "px":
                return lenses
            return tuple(width_px / 2 / math.tan(math.radians(deg) / 2) for deg in angles)

        if self.sensors:
            return [_behind(chip, focal) for chip in self._chips() for focal in focals_px(chip.width)]
        return [Camera(w, h, focal) for w, h in given_sizes or RESOLUTIONS for focal in focals_px(w)]

    def _lenses(self) -> tuple[str, tuple[float, ...]]:
        """The unit of the lenses, and their values in it; nothing when none are given."""
        found = [
            (unit, values)
            for unit in ("mm", "px", "deg")
            if (values := given.reals(getattr(self, f"lenses_{unit}"), f"lenses_{unit}"))
        ]
        if len(found) > 1:
            names = " and ".join(f"lenses_{unit}" for unit, _ in found)
            raise InvalidRange(f"{names} both given: they say the same thing, give one")
        return found[0] if found else ("", ())

    def _chips(self) -> list[SensorPreset]:
        chips: list[SensorPreset] = []
        for name in self.sensors:
            chip = sensor_preset(str(name))
            if chip in chips:
                names = ",".join(self.sensors)
                raise InvalidRange(f"sensor {names}: {chip.name} is given twice; remove one")
            chips.append(chip)
        return chips


def _behind(chip: SensorPreset, focal_px: float) -> Camera:
    mm = focal_px * chip.pitch_um / 1e3
    name = f"{chip.name.upper()} with {mm:.3g} mm"
    return Camera(chip.width, chip.height, focal_px, name, chip.name, mm, chip.pitch_um)
