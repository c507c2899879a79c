"""`rigsim presets`: the rigs known by name, and where each number of a commercial one comes from."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from rigsim.cli.kit.answer import print_document
from rigsim.cli.kit.options import Json

if TYPE_CHECKING:
    from rigsim.rig.catalogue.commercial import Figure
    from rigsim.rig.presets import Preset

_NAMES = {
    "baseline_mm": ("baseline", "mm"),
    "focal_px": ("focal length", "px"),
    "hfov_deg": ("horizontal FOV", "deg"),
    "vfov_deg": ("vertical FOV", "deg"),
    "width_px": ("image width", "px"),
    "height_px": ("image height", "px"),
    "min_depth_mm": ("least depth", "mm"),
    "max_disparity_px": ("disparity search", "px"),
    "accuracy_pct": ("claimed accuracy", "%"),
}

_HEADS = ("preset", "baseline\nmm", "focal\npx", "image\npx", "HFOV\ndeg")
_RIGHT = (False, True, True, False, True, False)
_LIMITS = ("min_depth_mm", "max_disparity_px")


def presets(
    name: Annotated[
        str | None, typer.Argument(metavar="[NAME]", help="Show one, number by number, with sources.")
    ] = None,
    as_json: Json = False,
) -> None:
    """List the rigs that --preset takes; with NAME, the sources of each number."""
    from rigsim.rig.presets import PRESETS, preset

    if as_json:
        from rigsim.interop.documents.listings import preset_document, presets_document

        print_document(presets_document(PRESETS.values()) if name is None else preset_document(preset(name)))
        return
    if name is not None:
        _show(preset(name))
    else:
        _list(list(PRESETS.values()))


def _list(items: Sequence[Preset]) -> None:
    from rigsim.present.kit.console import print_table

    rigs = [(*_cells(item), item.about) for item in items if not item.figures]
    cameras = [
        (*_cells(item), *(_or_dash(item.first(key)) for key in _LIMITS), _claims(item))
        for item in items
        if item.figures
    ]
    print_table("Rigs made for a scene (--preset)", (*_HEADS, "what it is for"), rigs, numeric=_RIGHT)
    print_table(
        "Commercial cameras (--preset)",
        (*_HEADS, "min Z\nmm", "search\npx", "claimed\naccuracy"),
        cameras,
        numeric=(*_RIGHT[:-1], True, True, False),
    )
    typer.echo("? unconfirmed user report")
    typer.echo("Sources, and figures that contradict these: rigsim presets NAME")


def _cells(item: Preset) -> tuple[str, str, str, str, str]:
    lens = item.rig.left
    return (
        item.name,
        f"{item.rig.baseline_m * 1e3:g}" + _doubt(item, "baseline_mm"),
        f"{lens.fx:.4g}",
        f"{lens.width}x{lens.height}",
        f"{lens.hfov_deg:.0f}",
    )


def _show(item: Preset) -> None:
    from rigsim.present.kit.console import print_table

    rig = item.rig
    print_table(
        f"{item.name}: {item.about}",
        ("rig", "value", "unit"),
        [
            ("baseline", f"{rig.baseline_m * 1e3:g}", "mm"),
            ("focal length", f"{rig.left.fx:.5g}", "px"),
            ("image", f"{rig.left.width}x{rig.left.height}", "px"),
            ("horizontal FOV", f"{rig.left.hfov_deg:.4g}", "deg"),
        ],
        numeric=(False, True, False),
    )
    if not item.figures:
        typer.echo(f"Source: {item.source}")
        return
    sources = list(dict.fromkeys(figure.source for figure in item.figures))
    print_table(
        "Published; the first of a kind is used",
        ("quantity", "value", "unit", "source", "note"),
        [
            (
                _NAMES[figure.quantity][0],
                f"{figure.value:g}",
                _NAMES[figure.quantity][1],
                str(sources.index(figure.source) + 1),
                _note(figure),
            )
            for figure in item.figures
        ],
        numeric=(False, True, False, True, False),
    )
    print_table(
        "Sources",
        ("", "page and address"),
        [(str(place), source) for place, source in enumerate(sources, 1)],
        numeric=(True, False),
    )


def _note(figure: Figure) -> str:
    at = "" if figure.at_mm is None else f"at {figure.at_mm / 1e3:g} m"
    return ", ".join(text for text in (at, figure.note) if text)


def _claims(item: Preset) -> str:
    claims = [figure for figure in item.figures if figure.quantity == "accuracy_pct"]
    said = (f"{figure.value:g}%@{(figure.at_mm or 0) / 1e3:g}m" + "?" * figure.hearsay for figure in claims)
    return ", ".join(said) or "–"


def _doubt(item: Preset, quantity: str) -> str:
    """A question mark where the figure that counts is hearsay."""
    used = next((figure for figure in item.figures if figure.quantity == quantity), None)
    return "?" if used is not None and used.hearsay else ""


def _or_dash(value: float | None) -> str:
    return "–" if value is None else f"{value:g}"
