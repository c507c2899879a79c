"""An answer that several parts of a page show, found once for each state."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

from rigsim.studio.kit.session import Session
from rigsim.studio.state import State

Answer = TypeVar("Answer")


class Latest(Generic[Answer]):
    """The answer to what is shown; asked for again, it is the same one until something changes."""

    def __init__(self, session: Session, find: Callable[[State], Answer]) -> None:
        """Ask nothing yet."""
        self._session, self._find = session, find
        self._of: State | None = None
        self._answer: Answer | None = None

    def __call__(self) -> Answer:
        """The answer to the state that is shown now."""
        state = self._session.state
        if self._answer is None or self._of is not state:
            self._answer, self._of = self._find(state), state
        return self._answer
