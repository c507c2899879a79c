"""One browser tab: its state, its history, and what is drawn anew when it changes."""

from __future__ import annotations

import time
from collections.abc import Callable

from nicegui import ui

from rigsim.studio.state import History, State

_REST_S, _LOOK_S = 0.6, 0.1
_ADDRESS_S = 0.15


class Session:
    """The state that a page shows. Two tabs have two."""

    def __init__(self, page: str, state: State, own_scene: str = "") -> None:
        """Begin with a state; to be called where the page is built.

        Args:
            page: its name.
            state: what is shown first.
            own_scene: the scene that the command line named: a path comes from nowhere else.
        """
        self.page = page
        self.own_scene = own_scene
        self._history = History(state)
        self._watchers: list[Callable[[], None]] = []
        self._restored: list[Callable[[], None]] = []
        self._rest = ui.timer(_LOOK_S, self._rested, active=False)
        self._moved_s = 0.0
        self._address = ui.timer(_ADDRESS_S, self._tell_address, active=False)
        self._at_rest: list[Callable[[], None]] = []

    @property
    def state(self) -> State:
        """What is shown."""
        return self._history.state

    @property
    def can_undo(self) -> bool:
        """Whether there is a step back."""
        return self._history.can_undo

    @property
    def can_redo(self) -> bool:
        """Whether there is a step forward."""
        return self._history.can_redo

    def watch(self, refresh: Callable[[], None], *, now: bool = True) -> None:
        """Call `refresh` whenever the state has changed, and once now."""
        self._watchers.append(refresh)
        if now:
            refresh()

    def when_restored(self, fill: Callable[[], None]) -> None:
        """Call `fill` when controls have to show another state than what was typed in them."""
        self._restored.append(fill)

    def when_resting(self, do: Callable[[], None]) -> None:
        """Call `do` when the state has not changed for a moment."""
        self._at_rest.append(do)

    def type(self, **typed: str) -> None:
        """Take words as they are typed or dragged."""
        self._show(self.state.with_words(**typed), ",".join(typed))

    def show(self, state: State) -> None:
        """Show a whole state at once, as one step."""
        self._show(state, "")
        self._fill()

    def undo(self) -> None:
        """One step back."""
        self._history.undo()
        self._fill()
        self._changed()

    def redo(self) -> None:
        """One step forward."""
        self._history.redo()
        self._fill()
        self._changed()

    def _show(self, state: State, of: str) -> None:
        if state != self.state:
            self._history.change(state, of)
            self._changed()

    def _changed(self) -> None:
        for refresh in self._watchers:
            refresh()
        self._moved_s = time.monotonic()
        for timer in (self._rest, self._address):
            timer.activate()

    def _fill(self) -> None:
        for fill in self._restored:
            fill()

    def _rested(self) -> None:
        if time.monotonic() - self._moved_s < _REST_S:
            return
        self._rest.deactivate()
        self._history.rest()
        for do in self._at_rest:
            do()

    def _tell_address(self) -> None:
        self._address.deactivate()
        ui.navigate.history.replace(self.state.address(self.page))
