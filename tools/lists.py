"""The lists that help texts and docs show, made from the registries; cog writes them.

After a change of a registry: ``.venv/bin/cog -r -I tools rigsim/cli/kit/lists.py docs/reference/columns.md
docs/reference/sensors.md``.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from dataclasses import replace

from rigsim.interop.formats import registry as formats
from rigsim.interop.layouts import registry as layouts
from rigsim.rig.catalogue.sensors import SENSORS
from rigsim.rig.presets import PRESETS
from rigsim.sim.scenes import library
from rigsim.study.compare import columns as compare
from rigsim.study.measure import columns as measure
from rigsim.study.scene import columns as sweep
from rigsim.study.scene.axes import registry as axes
from rigsim.study.scene.column import Column
from rigsim.study.tolerance import columns as tolerance
from rigsim.study.triangulators import registry as triangulators
from rigsim.study.verify.geometries import GEOMETRIES


def for_help() -> str:
    """The lists of names that help texts show, as a module's lines."""
    lists: dict[str, Iterable[str]] = {
        "TRIANGULATORS": triangulators.BY_NAME,
        "GEOMETRIES": (geometry.name for geometry in GEOMETRIES),
        "RIG_FORMATS": formats.RIG_FORMATS,
        "DATASET_FORMATS": layouts.BY_NAME,
    }
    return "\n".join(_assigned(name, ", ".join(words)) for name, words in lists.items())


def columns() -> str:
    """The columns of sweep.csv, and of sweep_by_depth.csv."""
    return _columns(sweep.COLUMNS.values())


def compare_columns() -> str:
    """The columns of compare.csv."""
    return _columns(compare.COLUMNS.values())


def tolerance_columns() -> str:
    """The columns of tolerance.csv."""
    each = replace(tolerance.at_distance(1000), name="depth_error_at_..._mm", heading="at a distance")
    return _columns((*tolerance.HEAD, each, *tolerance.REST))


def measure_columns() -> str:
    """The columns of matches.csv."""
    return _columns(measure.COLUMNS.values())


def axes_table() -> str:
    """What a sweep can vary."""
    rows = (
        (f"`--{axis.name}`", ", ".join(f"`{column.name}`" for column in axis.columns), axis.help)
        for axis in axes.ALL
    )
    return _table(("option", "columns", "what"), rows)


def triangulators_table() -> str:
    """Every triangulator with a name."""
    return _table(("name", "what"), ((f"`{one.name}`", one.says) for one in triangulators.ALL))


def formats_table() -> str:
    """Every calibration format."""
    rows = (
        (
            f"`{one.name}`",
            one.says,
            f"`{one.in_folder}`",
            "yes" if one.write else "",
            "yes" if one.name in layouts.BY_NAME else "",
        )
        for one in formats.ALL
    )
    return _table(("name", "what", "known by", "rigs written", "data sets written"), rows)


def layouts_table() -> str:
    """Every layout of data sets."""
    return _table(("name", "what"), ((f"`{one.name}`", one.says.replace("``", "`")) for one in layouts.ALL))


def others_table() -> str:
    """Names of scenes, presets and sensors."""
    rows = (
        ("scenes", _names(library.names())),
        ("presets", _names(PRESETS)),
        ("sensors", _names(SENSORS)),
    )
    return _table(("of", "names"), rows)


def sensors_table() -> str:
    """Every sensor with a name, each figure with its source."""
    heads = (
        *("sensor", "maker", "pixel µm", "image px", "shutter", "bits", "full well e⁻", "read noise e⁻"),
        *("source of pixel and image", "source of electrons", "source of shutter"),
        "body of a camera",
    )
    rows = (
        (
            one.name.upper(),
            one.maker,
            f"{one.pitch_um:g}",
            f"{one.width}x{one.height}",
            one.shutter or "–",
            str(one.bits),
            _known(one.full_well_e),
            _known(one.read_noise_e),
            one.geometry_source,
            one.noise_source or "–",
            "that of pixel and image" if one.shutter_source == one.geometry_source else one.shutter_source,
            "–"
            if one.housing is None
            else f"{one.housing.width_mm:g} mm, {one.housing.camera} ({one.housing.source})",
        )
        for one in SENSORS.values()
    )
    return _table(heads, rows)


def _known(value: float | None) -> str:
    return "–" if value is None else f"{value:g}"


def _columns(found: Iterable[Column]) -> str:
    rows = (
        (
            f"`{one.name}`",
            " ".join(one.heading.split()),
            one.unit,
            " ".join(one.meaning.split()).replace("|", "\\|"),
        )
        for one in found
    )
    return _table(("column", "heading", "unit", "meaning"), rows)


def _names(found: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in found)


def _table(heads: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = (f"| {' | '.join(cells)} |" for cells in rows)
    return "\n".join([f"| {' | '.join(heads)} |", "|" + "---|" * len(heads), *lines])


def _assigned(name: str, text: str) -> str:
    """An assignment as the formatter leaves it."""
    line = f'{name} = "{text}"'
    if len(line) <= 110:
        return line
    parts = textwrap.wrap(text, 98)
    said = "\n".join(f'    "{part} "' for part in parts[:-1])
    return f'{name} = (\n{said}\n    "{parts[-1]}"\n)'
