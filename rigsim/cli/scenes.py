"""`rigsim scenes`: the bundled scenes, the rigs made for them, and the sensors known by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from rigsim.cli.kit.answer import print_document
from rigsim.cli.kit.options import Json

if TYPE_CHECKING:
    from rigsim.rig.catalogue.sensors import SensorPreset


def scenes(as_json: Json = False) -> None:
    """List the bundled scenes, the preset rigs and the sensors."""
    from rigsim.rig.catalogue.sensors import SENSORS
    from rigsim.rig.presets import PRESETS
    from rigsim.sim.scenes import library

    bundled = [(name, library.about(name)) for name in library.names()]
    presets = [preset for preset in PRESETS.values() if not preset.figures]
    if as_json:
        from rigsim.interop.documents.listings import scenes_document

        print_document(scenes_document(bundled, presets, SENSORS.values()))
        return

    from rigsim.present.kit.console import print_table

    print_table(
        "Scenes (--scene)",
        ("scene", "what it shows"),
        bundled,
    )
    rows = [
        (
            preset.name,
            f"{preset.rig.baseline_m * 1e3:g}",
            f"{preset.rig.left.fx:g}",
            f"{preset.rig.left.width}x{preset.rig.left.height}",
            f"{preset.rig.left.hfov_deg:.1f}",
            preset.about,
        )
        for preset in presets
    ]
    print_table(
        "Rigs (--preset)",
        ("preset", "baseline mm", "focal px", "image px", "HFOV deg", "what it is for"),
        rows,
    )
    print_table(
        "Sensors (--sensor), full well and read noise in electrons",
        ("sensor", "maker", "pixel um", "image px", "shutter", "bits", "full well", "read noise"),
        [
            (
                sensor.name,
                sensor.maker,
                f"{sensor.pitch_um:g}",
                f"{sensor.width}x{sensor.height}",
                sensor.shutter or "–",
                sensor.bits,
                _electrons(sensor.full_well_e),
                _electrons(sensor.read_noise_e),
            )
            for sensor in SENSORS.values()
        ],
    )
    typer.echo(
        "A number without a source (–) has to be given: --full-well and --read-noise, or\n"
        "[sensor] full_well_e and read_noise_e in rig.toml; 0 leaves that noise out.\n"
    )
    print_table(
        "Sources", ("sensor", "source"), [(sensor.name, _source(sensor)) for sensor in SENSORS.values()]
    )


def _electrons(value: float | None) -> str:
    return "–" if value is None else f"{value:g}"


def _source(sensor: SensorPreset) -> str:
    """Where its numbers and its shutter come from; one source in two words is named once."""
    geometry, noise, shutter = sensor.geometry_source, sensor.noise_source, sensor.shutter_source
    texts = [noise if noise.startswith(geometry) else "; ".join(text for text in (geometry, noise) if text)]
    if not texts[0].startswith(shutter):
        texts.append(f"shutter: {shutter}")
    return "; ".join(texts)
