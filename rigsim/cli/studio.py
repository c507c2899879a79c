"""`rigsim studio`: the live page."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from rigsim.errors import InvalidRange, RigsimError

_PORTS = (1, 65535)


def studio(
    rig: Annotated[
        Path | None,
        typer.Argument(metavar="RIG", help="A calibration to begin with.", show_default=False),
    ] = None,
    preset: Annotated[
        str | None, typer.Option(metavar="NAME", help="Begin with a rig by name; see rigsim presets.")
    ] = None,
    scene: Annotated[
        str | None, typer.Option(metavar="NAME|PATH", help="Scene that is rendered; see rigsim scenes.")
    ] = None,
    port: Annotated[int, typer.Option(metavar="PORT", help="Port of the page.")] = 8080,
    host: Annotated[
        str,
        typer.Option(
            metavar="HOST",
            help="Address to listen at; any but this machine's own asks for the token that is printed.",
        ),
    ] = "127.0.0.1",
    browser: Annotated[bool, typer.Option(help="Open the page in a browser.")] = True,
) -> None:
    """Open the live page: numbers, pictures and a rendered scene that follow while you drag."""
    if not _PORTS[0] <= port <= _PORTS[1]:
        raise InvalidRange(f"port {port}: must be between {_PORTS[0]} and {_PORTS[1]}")
    if rig is not None and preset is not None:
        raise InvalidRange("a rig's file and --preset both given: give one")
    if find_spec("nicegui") is None:
        raise RigsimError("the page needs NiceGUI: pip install 'rigsim[studio]', or ./run studio")

    from rigsim.studio.begin import state_of
    from rigsim.studio.serve import Served, serve

    state = state_of(rig, preset, scene)
    page = "rig" if state.words else "point"
    serve(Served(state, page, host, port, browser), lambda address: typer.echo(f"rigsim studio: {address}"))
