"""The renderer that all tabs share."""

from __future__ import annotations

from functools import cache

from nicegui import app

from rigsim.studio.draw.process import RenderProcess


@cache
def renderer() -> RenderProcess:
    """The server's one renderer: without a process until somebody wants a picture, ended with the server."""
    shared = RenderProcess()
    app.on_shutdown(shared.close)
    return shared
