"""The rendered pair: a coarse one while the hand moves, the full one when it rests."""

from __future__ import annotations

import uuid
from collections.abc import Callable
from dataclasses import replace
from html import escape

from nicegui import background_tasks, events, ui

from rigsim.present.kit.format import number
from rigsim.rig.arrays import Array
from rigsim.studio.draw.request import Failed, Overlay, Pair, PairRequest
from rigsim.studio.kit.latest import Latest
from rigsim.studio.kit.renderer import renderer
from rigsim.studio.kit.session import Session
from rigsim.studio.logic import scenes
from rigsim.studio.logic.numbers import RigNumbers
from rigsim.studio.logic.pictures import OVERLAYS, at_pixel, pair_wanted, points_seen, source

Taken = Callable[[Array | None], None]
"""Is given points of the scene in the left camera's frame, or None where there are none."""
_BLANK = "data:image/svg+xml,%3Csvg xmlns='http://www.w3.org/2000/svg' width='16' height='9'/%3E"
_MOUSE_S = 0.06


class PairView:
    """The two pictures of one tab."""

    def __init__(self, session: Session, numbers: Latest[RigNumbers], taken: Taken) -> None:
        """Place them."""
        self._session, self._numbers, self._taken = session, numbers, taken
        self._key = uuid.uuid4().hex
        self._overlay: Overlay = "none"
        self._wanted: PairRequest | None = None
        self._shown: tuple[PairRequest, Pair] | None = None
        self._gone = False
        client = ui.context.client
        client.on_disconnect(lambda: renderer().release(self._key))
        client.on_delete(self._leave)
        self._place()

    def _place(self) -> None:
        with ui.element("section").classes("rig-panel w-full").props('aria-label="Rendered pair"'):
            with ui.element("div").classes("rig-titled"):
                ui.html("<h2>What the cameras see</h2>", sanitize=False)
                select = ui.select(dict(OVERLAYS), label="Overlay", value="none").classes("rig-overlay")
                select.props("dense outlined options-dense").on_value_change(
                    lambda event: self._lay(event.value)
                )
            self._said = ui.html("", sanitize=False).props('aria-live="polite" data-testid=pair-said')
            with ui.element("div").classes("rig-pair"):
                self._left = self._picture("Left", "var(--rig-left)")
                self._right = self._picture("Right", "var(--rig-right)")
            self._left.on("mouse", self._look, throttle=_MOUSE_S)
            with ui.element("div").classes("rig-titled").style("margin:8px 0 0"):
                self._under = ui.label("Point at the left picture for depth, disparity and std.")
                self._under.classes("rig-soft").props("data-testid=pixel")
                self._legend = ui.html("", sanitize=False)

    @staticmethod
    def _picture(name: str, color: str) -> ui.interactive_image:
        testid = f"pair-{name.lower()}"
        with ui.element("figure").classes("rig-figure"):
            image = ui.interactive_image(_BLANK, events=["mousemove"], cross=name == "Left")
            image.props(f"data-testid={testid}").classes("w-full")
            dot = f"<span class=rig-side style='background:{color}'></span>"
            ui.html(f"<figcaption>{dot}{name}</figcaption>", sanitize=False)
        # the picture inside has no alternative text of its own
        says = f"img => img.alt = '{name} picture'"
        image.on(
            "loaded",
            js_handler=f"() => document.querySelectorAll('[data-testid={testid}] img').forEach({says})",
        )
        return image

    def moved(self) -> None:
        """Draw coarsely what changed."""
        self._ask(coarse=True)

    def rested(self) -> None:
        """Draw in full what is shown."""
        self._ask(coarse=False)

    def _ask(self, *, coarse: bool) -> None:
        scene = scenes.chosen(self._session.state, self._session.own_scene)
        request = pair_wanted(self._numbers(), scene, self._overlay, coarse=coarse)
        same = request is not None and request == self._wanted
        finer = self._wanted is not None and not self._wanted.coarse and coarse
        if request is None or same or (finer and _as_full(request) == self._wanted):
            return
        self._wanted = request
        background_tasks.create(self._draw(request), name="a pair")

    async def _draw(self, request: PairRequest) -> None:
        answer = await renderer().draw(self._key, request)
        if self._gone or answer is None:
            return
        if isinstance(answer, Failed):
            self._wanted = None
            self._said.set_content(f'<div class="rig-fault" role="alert">{escape(answer.text)}</div>')
            self._taken(None)
            return
        self._show(request, answer)

    def _show(self, request: PairRequest, pair: Pair) -> None:
        self._shown = (request, pair)
        notes = "".join(f"<div class=rig-note>{escape(text)}</div>" for text in pair.remarks)
        self._said.set_content("" if pair.coarse else notes)
        self._left.set_source(source(pair.overlay_image or pair.left))
        self._right.set_source(source(pair.right))
        self._left.props(f"data-drawn={pair.width}x{pair.height}")
        self._legend.set_content(_legend(pair))
        if not pair.coarse:
            self._taken(points_seen(pair, request))

    def _lay(self, overlay: Overlay) -> None:
        self._overlay = overlay
        self._ask(coarse=False)

    def _look(self, event: events.GenericEventArguments) -> None:
        if self._shown is not None:
            x, y = float(event.args.get("image_x", -1)), float(event.args.get("image_y", -1))
            self._under.set_text(at_pixel(self._shown[1], x, y))

    def _leave(self) -> None:
        self._gone = True
        renderer().release(self._key)


def _as_full(request: PairRequest) -> PairRequest:
    return replace(request, coarse=False)


def _legend(pair: Pair) -> str:
    legend = pair.legend
    if legend is None:
        return ""
    ends = " to ".join(
        f"{number(value)} {legend.unit} ({shade})"
        for value, shade in ((legend.low, "dark"), (legend.high, "bright"))
    )
    return f"<span class=rig-soft data-testid=pair-legend>{escape(legend.words)}: {escape(ends)}</span>"


def pair(session: Session, numbers: Latest[RigNumbers], taken: Taken) -> None:
    """Place the pair; `taken` is given points of the scene once they are known."""
    view = PairView(session, numbers, taken)
    session.watch(view.moved, now=False)
    session.when_resting(view.rested)
    ui.timer(0.1, view.rested, once=True)
