"""Serves the page: routes, who may look, and how it begins and ends."""

from __future__ import annotations

import errno
import secrets
import socket
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module

from nicegui import app, run, ui
from starlette.requests import Request

from rigsim.errors import InvalidRange
from rigsim.studio.gate import LOOPBACK, stand_before
from rigsim.studio.kit.session import Session
from rigsim.studio.kit.shell import PAGES
from rigsim.studio.state import State, read_state


@dataclass(frozen=True, slots=True)
class Served:
    """What the command line says of the page."""

    state: State
    """What an address begins with that says nothing."""
    page: str = "point"
    """Where it opens."""
    host: str = "127.0.0.1"
    """Address to listen at."""
    port: int = 8080
    """Port to listen at."""
    show: bool = True
    """Whether a browser is opened."""


def serve(served: Served, ready: Callable[[str], None]) -> None:
    """Serve the page until it is interrupted.

    Args:
        served: what, and where.
        ready: is called with the address once the page can be opened.

    Raises:
        InvalidRange: the port cannot be had.
    """
    check_port(served.host, served.port)
    token = "" if served.host in LOOPBACK else secrets.token_urlsafe(16)
    for name in PAGES:
        _route(name, served)
    ui.page("/")(lambda: ui.navigate.to(served.state.address(served.page)))
    stand_before(app, token)
    app.on_startup(lambda: ready(address_of(served, token)))
    run.process_pool_start_method = "spawn"  # a fork would copy the page's threads and their locks
    ui.run(
        host=served.host,
        port=served.port,
        title="rigsim studio",
        dark=None,
        language="en-GB",
        show=served.state.address(served.page) if served.show else False,
        reload=False,
        show_welcome_message=False,
        reconnect_timeout=20.0,  # a busy machine may be late; a tab that is gone is let go of after it
        uvicorn_logging_level="error",
        ws_per_message_deflate=False,  # packing takes longer than a way of no length saves
    )


def address_of(served: Served, token: str) -> str:
    """The link that opens the page."""
    host = socket.gethostname() if served.host in ("0.0.0.0", "::") else served.host
    host = f"[{host}]" if ":" in host else host
    link = f"http://{host}:{served.port}{served.state.address(served.page)}"
    return f"{link}&token={token}" if token else link


def check_port(host: str, port: int) -> None:
    """Fail before anything is loaded when a port cannot be had.

    Raises:
        InvalidRange: it is in use, or not allowed.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as tried:
        tried.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            tried.bind((host, port))
        except OSError as error:
            if error.errno == errno.EADDRINUSE:
                raise InvalidRange(
                    f"port {port}: in use; choose another one, as in --port {port + 1}"
                ) from None
            raise InvalidRange(f"host {host}, port {port}: {error.strerror}; choose others") from None


def _route(name: str, served: Served) -> None:
    def page(request: Request) -> None:
        module = import_module(f"rigsim.studio.pages.{name}")
        state, remarks = read_state(dict(request.query_params))
        session = Session(name, module.begin(state if state.words else served.state), served.state["scene"])
        module.build(session)
        for remark in remarks:
            ui.notify(remark, type="warning", timeout=0, close_button="OK")

    ui.page(f"/{name}")(page)
