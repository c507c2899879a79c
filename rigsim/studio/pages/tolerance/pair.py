"""The pair that the built rig takes: how far rows lie apart."""

from __future__ import annotations

import uuid
from html import escape

from nicegui import background_tasks, events, ui

from rigsim.studio.draw.request import Failed, PairRequest
from rigsim.studio.kit.latest import Latest
from rigsim.studio.kit.renderer import renderer
from rigsim.studio.kit.session import Session
from rigsim.studio.logic import scenes
from rigsim.studio.logic.pictures import source
from rigsim.studio.logic.tolerance import built
from rigsim.studio.logic.tolerance.rows import guide, guide_words, pair_wanted

_BLANK = "data:image/svg+xml,%3Csvg xmlns='http://www.w3.org/2000/svg' width='16' height='9'/%3E"
_MOUSE_S = 0.06


class RowsPair:
    """The two pictures of one tab, with a row marked in both."""

    def __init__(self, session: Session, found: Latest[built.BuiltFound]) -> None:
        """Draw nothing yet; `found` is what the words say."""
        self._session, self._found = session, found
        self._key = uuid.uuid4().hex
        self._share = 0.5
        self._wanted: PairRequest | None = None
        self._drawn: tuple[int, int] | None = None
        self._gone = False
        client = ui.context.client
        client.on_disconnect(lambda: renderer().release(self._key))
        client.on_delete(self._leave)

    def place(self) -> None:
        """Lay it out."""
        with ui.element("section").classes("rig-panel w-full").props('aria-label="Pair of the built rig"'):
            ui.html("<h2>What the built rig sees</h2>", sanitize=False)
            self._said = ui.html("", sanitize=False).props('aria-live="polite"')
            with ui.element("div").classes("rig-pair"):
                self._left = self._picture("Left", "var(--rig-left)")
                self._right = self._picture("Right", "var(--rig-right-text)")
            for image in (self._left, self._right):
                image.on("mouse", self._look, throttle=_MOUSE_S)
            self._under = ui.label().classes("rig-soft").props("data-testid=rows-apart")

    @staticmethod
    def _picture(name: str, color: str) -> ui.interactive_image:
        with ui.element("figure").classes("rig-figure"):
            image = ui.interactive_image(_BLANK, events=["mousemove"])
            image.props(
                f'data-alt="{name} picture of the built rig" data-testid=built-{name.lower()}'
            ).classes("w-full")
            ui.html(f"<figcaption style='color:{color}'>{name}</figcaption>", sanitize=False)
        return image

    def moved(self) -> None:
        """Draw coarsely what changed."""
        self._ask(coarse=True)
        self._guide()

    def rested(self) -> None:
        """Draw better what is shown."""
        self._ask(coarse=False)

    def _ask(self, *, coarse: bool) -> None:
        scene = scenes.chosen(self._session.state, self._session.own_scene)
        request = pair_wanted(self._found(), scene, coarse=coarse)
        if request is None or request == self._wanted:
            return
        self._wanted = request
        background_tasks.create(self._draw(request), name="a pair of a built rig")

    async def _draw(self, request: PairRequest) -> None:
        answer = await renderer().draw(self._key, request)
        if self._gone or answer is None:
            return
        if isinstance(answer, Failed):
            self._wanted = None
            self._said.set_content(f'<div class="rig-fault" role="alert">{escape(answer.text)}</div>')
            return
        self._said.set_content("")
        self._drawn = answer.width, answer.height
        self._left.set_source(source(answer.left))
        self._right.set_source(source(answer.right))
        self._left.props(f"data-drawn={answer.width}x{answer.height}")
        self._guide()

    def _look(self, event: events.GenericEventArguments) -> None:
        if self._drawn is not None:
            self._share = min(max(float(event.args.get("image_y", 0)) / self._drawn[1], 0.0), 1.0)
            self._guide()

    def _guide(self) -> None:
        found = self._found()
        self._under.set_text(guide_words(found, self._share))
        if self._drawn is None:
            return
        self._left.set_content(guide(found, self._share, self._drawn, right=False))
        self._right.set_content(guide(found, self._share, self._drawn, right=True))

    def _leave(self) -> None:
        self._gone = True
        renderer().release(self._key)
