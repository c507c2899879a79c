"""The cameras that a design tries: each image size or sensor with each lens."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from rigsim.api.rigs import Several, Sizes
from rigsim.errors import InvalidRange
from rigsim.rig import extent, given
from rigsim.rig.catalogue.sensors import sensor_preset
from rigsim.study.design.solve import HFOVS_DEG, LENSES_MM, RESOLUTIONS
from rigsim.study.scene.plan import sizes
from rigsim.theory.inverse import Camera

if TYPE_CHECKING:
    from rigsim.api.kit.requirements import DesignOptions


@dataclass(frozen=True, slots=True)
class _Chip:
    """What a lens draws on."""

    width: int
    height: int
    pitch_um: float | None = None
    sensor: str = ""
    merged: float = 1.0
    body_mm: float = 0.0

    def behind(self, focal_px: float) -> Camera:
        """Behind a lens."""
        mm = None if self.pitch_um is None else focal_px * self.pitch_um / 1e3
        lens = "" if mm is None else f"{mm:.3g} mm"
        name = f"{self.sensor.upper()} with {lens}" if self.sensor else f"{lens} lens" if lens else ""
        return Camera(
            self.width,
            self.height,
            focal_px,
            name,
            self.sensor,
            mm,
            self.pitch_um,
            self.merged,
            self.body_mm / 1e3,
        )

    def cropped(self, width: int, height: int) -> _Chip:
        """Its middle, as large as that."""
        if width > self.width or height > self.height:
            raise InvalidRange(
                f"crop {width}x{height}: {self.sensor} has {self.width}x{self.height} px; take a part of them"
            )
        return replace(self, width=width, height=height)

    def binned(self, by: int) -> _Chip:
        """With `by` x `by` pixels made one."""
        pitch_um = None if self.pitch_um is None else self.pitch_um * by
        return replace(
            self, width=self.width // by, height=self.height // by, pitch_um=pitch_um, merged=self.merged * by
        )

    def scaled(self, width: int, height: int) -> _Chip:
        """The largest part of its middle with the shape of that image, scaled down to it."""
        ratio = min(self.width / width, self.height / height)
        if ratio < 1:
            raise InvalidRange(
                f"resolution {width}x{height}: {self.sensor} has only {self.width}x{self.height} px"
            )
        pitch_um = None if self.pitch_um is None else self.pitch_um * ratio
        return replace(self, width=width, height=height, pitch_um=pitch_um, merged=self.merged * ratio)


@dataclass(frozen=True, slots=True)
class CameraOptions:
    """What cameras there are to choose from; usual ones where nothing is said."""

    resolutions_px: Sizes = ()
    """(width, height), px; what `sensors` are scaled to where both are given."""
    sensors: tuple[str, ...] = ()
    """Names of sensors."""
    lenses_mm: Several = ()
    """Focal lengths, mm; they need `sensors`, `pixel_pitch_um` or `sensor_width_mm`."""
    lenses_px: Several = ()
    """Focal lengths, px."""
    lenses_deg: Several = ()
    """Horizontal fields of view, deg."""
    pixel_pitch_um: float | None = None
    """Pixel pitch, micrometres; excludes `sensors`."""
    sensor_width_mm: float | None = None
    """Width of the pixels used, mm, instead."""
    crop_px: tuple[int, int] | None = None
    """Part of the sensor that is read, (width, height), px."""
    binning: int = 1
    """Pixels across, and down, that are read as one."""
    housed: bool = True
    """Whether the sensors stand in their usual housings, where those are known."""

    def all(self, fov_deg: float | None) -> list[Camera]:
        """Every camera to try; `fov_deg` is the field of view asked for, deg.

        Raises:
            InvalidRange: two things say the same, or something is missing.
            InvalidRig: no such sensor.
        """
        unit, lenses = self._lenses()
        extent.CAMERAS.check(max(1, len(lenses)))
        chips = self._chips()
        return [chip.behind(focal) for chip in chips for focal in _focals_px(chip, unit, lenses, fov_deg)]

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

    def _chips(self) -> list[_Chip]:
        pitched = [
            name
            for name, value in (
                ("--sensor", self.sensors or None),
                ("--pixel-pitch", self.pixel_pitch_um),
                ("--sensor-width", self.sensor_width_mm),
            )
            if value is not None
        ]
        if len(pitched) > 1:
            raise InvalidRange(f"{' and '.join(pitched)} given: each says how large a pixel is, give one")
        wanted = sizes(self.resolutions_px)
        if self.sensors:
            read = [self._read(chip) for chip in _named(self.sensors, self.housed)]
            return [chip.scaled(*size) for chip in read for size in wanted] or read
        if self.crop_px is not None or self.binning != 1:
            raise InvalidRange("--crop and --binning say how a sensor is read: name it by --sensor")
        return [_Chip(w, h, self._pitch_um(w)) for w, h in wanted or RESOLUTIONS]

    def _pitch_um(self, width_px: int) -> float | None:
        for name, value in (("pixel pitch", self.pixel_pitch_um), ("sensor width", self.sensor_width_mm)):
            if value is not None and not (math.isfinite(value) and value > 0):
                raise InvalidRange(f"{name} {value:g}: must be > 0")
        if self.sensor_width_mm is not None:
            return self.sensor_width_mm * 1e3 / width_px
        return self.pixel_pitch_um

    def _read(self, chip: _Chip) -> _Chip:
        if self.crop_px is not None:
            chip = chip.cropped(*self.crop_px)
        if not (float(self.binning).is_integer() and 1 <= self.binning <= 16):
            raise InvalidRange(f"binning {self.binning:g}: must be a whole number from 1 to 16")
        return chip.binned(int(self.binning)) if self.binning != 1 else chip


def cameras_tried(options: DesignOptions) -> list[Camera]:
    """Every camera that a design tries."""
    return CameraOptions(
        options.resolutions_px,
        tuple(str(name) for name in given.several(options.sensors)),
        options.lenses_mm,
        options.lenses_px,
        options.lenses_deg,
        options.pixel_pitch_um,
        options.sensor_width_mm,
        options.crop_px,
        options.binning,
        options.min_baseline_mm is None and options.body_width_mm is None,
    ).all(options.fov_deg)


def _focals_px(chip: _Chip, unit: str, lenses: tuple[float, ...], fov_deg: float | None) -> tuple[float, ...]:
    if unit == "px":
        return lenses
    if unit == "deg" or (not unit and chip.pitch_um is None):
        asked = () if fov_deg is None else (fov_deg,)
        angles = lenses or tuple(sorted({*HFOVS_DEG, *asked}))
        return tuple(chip.width / 2 / math.tan(math.radians(deg) / 2) for deg in angles)
    if chip.pitch_um is None:
        said = ",".join(f"{mm:g}" for mm in lenses)
        raise InvalidRange(
            f"lens {said}mm: how large is a pixel? Give --pixel-pitch, --sensor-width or --sensor; or lenses "
            "in px or deg"
        )
    return tuple(mm * 1e3 / chip.pitch_um for mm in lenses or LENSES_MM)


def _named(names: Sequence[str], housed: bool) -> list[_Chip]:
    chips: list[_Chip] = []
    for name in names:
        preset = sensor_preset(str(name))
        body_mm = preset.housing.width_mm if housed and preset.housing is not None else 0.0
        chip = _Chip(preset.width, preset.height, preset.pitch_um, preset.name, body_mm=body_mm)
        if chip in chips:
            raise InvalidRange(f"sensor {','.join(names)}: {preset.name} is given twice; remove one")
        chips.append(chip)
    return chips
