"""What `rigsim scenes --json`, `rigsim doctor --json` and `rigsim presets --json` print."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Literal

from rigsim.interop.documents.base import Part, SeenRig, seen_rig
from rigsim.rig.catalogue.sensor_preset import Shutter

if TYPE_CHECKING:
    from rigsim.rig.catalogue.sensors import SensorPreset
    from rigsim.rig.presets import Preset
    from rigsim.sim.backend import Probe


class Scene(Part):
    """A bundled scene."""

    name: str
    """What --scene takes."""
    about: str
    """What it shows."""


class Named(Part):
    """What is known by name."""

    name: str
    """What --preset takes."""
    about: str
    """Maker and model, or what it is for."""


class SceneRig(SeenRig, Named):
    """A rig made for a scene."""


class PublishedSensor(Part):
    """What is published of a sensor."""

    name: str
    """What --sensor takes."""
    maker: str
    """Who makes it."""
    pitch_um: float
    """Pixel pitch, micrometres."""
    width_px: int
    """Pixels across."""
    height_px: int
    """Pixels down."""
    bits: int
    """Bits of the converter."""
    full_well_e: float | None
    """Electrons at full scale; null where no source was found: --full-well gives it."""
    read_noise_e: float | None
    """Read noise, electrons; null where no source was found: --read-noise gives it."""
    geometry_source: str
    """Where pitch and size come from."""
    noise_source: str | None
    """Where full well and read noise come from; null when there is no source."""
    shutter: Shutter | None
    """Whether all rows are exposed at once or one after the other; null where no source was found."""
    shutter_source: str
    """Where the shutter comes from; why there is none, where it is null."""
    body_width_mm: float | None
    """How wide the body of a usual camera is, mm; null where no source was found."""
    body_width_source: str | None
    """Which camera, and where that is published."""


class ScenesDocument(Part):
    """The bundled scenes, the rigs made for them, and the sensors known by name."""

    scenes: list[Scene]
    """What --scene takes."""
    presets: list[SceneRig]
    """What --preset takes; rigsim presets lists commercial cameras as well."""
    sensors: list[PublishedSensor]
    """What --sensor takes."""


class Renderer(Part):
    """A way to draw pictures."""

    name: Literal["egl", "osmesa", "rays"]
    """What --renderer takes."""
    works: bool
    """Whether it works here."""
    detail: str
    """How, or why not."""
    install: str | None
    """The command that installs what is missing; null when nothing is."""


class DoctorDocument(Part):
    """Which renderers work here."""

    renderers: list[Renderer]
    """All of them, the best first."""
    auto: Literal["egl", "osmesa", "rays"]
    """What --renderer auto takes."""


class PublishedFigure(Part):
    """One published number."""

    quantity: Literal[
        "baseline_mm",
        "focal_px",
        "hfov_deg",
        "vfov_deg",
        "width_px",
        "height_px",
        "min_depth_mm",
        "max_disparity_px",
        "accuracy_pct",
    ]
    """What it is, with its unit."""
    value: float
    """The number, in that unit."""
    at_mm: float | None
    """Distance that an accuracy is claimed for, mm; null for anything else."""
    note: str
    """In which mode, or what is odd about it; may be empty."""
    source: str
    """Page and address."""


class PresetDocument(SeenRig, Named):
    """A rig by name, and where each of its numbers comes from."""

    source: str
    """Where the numbers come from."""
    min_depth_mm: float | None
    """Published least depth, mm; null where there is none."""
    max_disparity_px: float | None
    """Published number of disparities searched, px; null where there is none."""
    figures: list[PublishedFigure]
    """Every published number, the one used first; empty for a scene's rig."""


class PresetsDocument(Part):
    """The rigs that --preset takes."""

    presets: list[PresetDocument]
    """All of them."""


def scenes_document(
    scenes: Iterable[tuple[str, str]], presets: Iterable[Preset], sensors: Iterable[SensorPreset]
) -> dict[str, Any]:
    """The lists of `rigsim scenes`: scenes as name and what they show."""
    document = ScenesDocument(
        scenes=[Scene(name=name, about=about) for name, about in scenes],
        presets=[
            SceneRig(name=preset.name, about=preset.about, **dict(seen_rig(preset.rig))) for preset in presets
        ],
        sensors=[
            PublishedSensor(
                name=sensor.name,
                maker=sensor.maker,
                pitch_um=sensor.pitch_um,
                width_px=sensor.width,
                height_px=sensor.height,
                bits=sensor.bits,
                full_well_e=sensor.full_well_e,
                read_noise_e=sensor.read_noise_e,
                geometry_source=sensor.geometry_source,
                noise_source=sensor.noise_source or None,
                shutter=sensor.shutter,
                shutter_source=sensor.shutter_source,
                body_width_mm=None if sensor.housing is None else sensor.housing.width_mm,
                body_width_source=None
                if sensor.housing is None
                else f"{sensor.housing.camera}: {sensor.housing.source}",
            )
            for sensor in sensors
        ],
    )
    return document.model_dump()


def preset_document(preset: Preset) -> dict[str, Any]:
    """A rig by name, with every published number."""
    return _preset(preset).model_dump()


def presets_document(presets: Iterable[Preset]) -> dict[str, Any]:
    """Rigs by name, as `preset_document` says each."""
    return PresetsDocument(presets=[_preset(preset) for preset in presets]).model_dump()


def _preset(preset: Preset) -> PresetDocument:
    return PresetDocument.model_validate(
        {
            "name": preset.name,
            "about": preset.about,
            "source": preset.source,
            **dict(seen_rig(preset.rig)),
            "min_depth_mm": preset.first("min_depth_mm"),
            "max_disparity_px": preset.first("max_disparity_px"),
            "figures": [asdict(figure) for figure in preset.figures],
        }
    )


def doctor_document(probes: Sequence[Probe]) -> dict[str, Any]:
    """Which of the renderers tried works, best first."""
    return DoctorDocument.model_validate(
        {
            "renderers": [
                {
                    "name": probe.name,
                    "works": probe.works,
                    "detail": probe.detail,
                    "install": probe.install or None,
                }
                for probe in probes
            ],
            "auto": next(probe.name for probe in probes if probe.works),
        }
    ).model_dump()
