"""The frame of every page: name, ways between pages, undo, the link, dark and light."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.resources import files

from nicegui import ui

from rigsim.studio.kit.clipboard import copy
from rigsim.studio.kit.session import Session

PAGES = ("point", "rig", "design", "tolerance", "compare")
"""Pages, in the order of the way through them."""

_NAME_PICTURES = """<script>
new MutationObserver(() => document.querySelectorAll('[data-alt] img:not([alt])').forEach(
  picture => { picture.alt = picture.closest('[data-alt]').dataset.alt; }
)).observe(document.documentElement, {childList: true, subtree: true});
</script>"""
"""Says in words what a picture shows: the toolkit's own pictures take no such words."""


@contextmanager
def frame(session: Session) -> Iterator[None]:
    """The page around what is built inside."""
    ui.add_css(files("rigsim.studio.kit").joinpath("studio.css").read_text())
    ui.add_body_html(_NAME_PICTURES)
    ui.colors(primary="#0072B2", positive="#00624A", negative="#9A3D00", warning="#9A3D00")
    ui.page_title(f"{session.page.capitalize()} · rigsim studio")
    dark = ui.dark_mode(None)
    with ui.header().classes("rig-header"):
        ui.label("rigsim studio").classes("rig-name")
        with ui.element("nav").props('aria-label="Pages"').classes("rig-nav"):
            links = [_link(session, page) for page in PAGES]
        ui.space()
        undo = _icon("undo", "Undo", session.undo)
        redo = _icon("redo", "Redo", session.redo)
        _icon("link", "Copy link", lambda: _copy_link(session))
        _icon("contrast", "Dark or light", lambda: dark.set_value(not dark.value))

    def follow() -> None:
        for page, link in links:
            link.props(f'href="{session.state.address(page)}"')
        undo.set_enabled(session.can_undo)
        redo.set_enabled(session.can_redo)

    session.watch(follow)
    ui.keyboard(on_key=lambda event: _pressed(session, event), ignore=["input", "textarea"])
    with ui.element("div").classes("rig-main"):
        yield


def _link(session: Session, page: str) -> tuple[str, ui.element]:
    with ui.element("a").classes("rig-tab") as link:
        ui.label(page.capitalize())
    if page == session.page:
        link.props('aria-current="page"')
    return page, link


def _icon(icon: str, says: str, do: Callable[[], object]) -> ui.button:
    button = ui.button(icon=icon, on_click=do).props(f'flat round dense aria-label="{says}"')
    button.tooltip(says)
    return button


async def _copy_link(session: Session) -> None:
    origin = await ui.run_javascript("return location.origin", timeout=5.0)
    await copy(f"{origin}{session.state.address(session.page)}", "Link")


def _pressed(session: Session, event: object) -> None:
    from nicegui.events import KeyEventArguments

    assert isinstance(event, KeyEventArguments)
    if not event.action.keydown or not (event.modifiers.ctrl or event.modifiers.meta):
        return
    if event.key == "z":
        if event.modifiers.shift:
            session.redo()
        else:
            session.undo()
    elif event.key == "y":
        session.redo()
