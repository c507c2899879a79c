"""What a page shows, as the words that are typed: in the address, one step back, and one forward."""

from __future__ import annotations

import base64
import binascii
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from urllib.parse import urlencode

from rigsim.studio.words import ALL, BY_OPTION

VERSION = "1"
"""Of the address: its words and what they mean."""
_MOST_RIG_BYTES = 200_000
_MOST_STEPS = 200


@dataclass(frozen=True, slots=True)
class State:
    """The words of a page, by name; what was not typed is not there."""

    words: Mapping[str, str] = field(default_factory=dict)

    def __getitem__(self, name: str) -> str:
        return self.words.get(name, "")

    def with_words(self, **typed: str) -> State:
        """The same with other words; an empty one is taken out."""
        merged = {**self.words, **typed}
        return State({name: text for name, text in merged.items() if text.strip()})

    def query(self) -> str:
        """The words as an address holds them, in a fixed order, with the version of the address."""
        said = [(word.option, self.words[word.name]) for word in ALL if word.name in self.words]
        return urlencode([*said, ("v", VERSION)], safe=",:@/")

    def address(self, page: str) -> str:
        """Path and query of a page that shows this."""
        return f"/{page}?{self.query()}"


def read_state(query: Mapping[str, str]) -> tuple[State, list[str]]:
    """The state that an address holds, and what of it was not taken and why."""
    words: dict[str, str] = {}
    remarks = []
    if query.get("v", VERSION) != VERSION:
        remarks.append(
            f"This address is of version {query['v'][:20]}, and this page knows {VERSION}: some of it may be "
            "missing."
        )
    for option, text in query.items():
        word = BY_OPTION.get(option)
        if word is None:
            continue
        if len(text) > word.most_chars or not text.isprintable():
            remarks.append(f"{option} of the address is no value that can be read, and was left out.")
        elif text.strip():
            words[word.name] = text.strip()
    return State(words), remarks


@dataclass(slots=True)
class History:
    """States one can go back to."""

    state: State
    """What is shown."""
    _past: list[State] = field(default_factory=list)
    _future: list[State] = field(default_factory=list)
    _of: str = ""

    @property
    def can_undo(self) -> bool:
        """Whether there is a step back."""
        return bool(self._past)

    @property
    def can_redo(self) -> bool:
        """Whether there is a step forward."""
        return bool(self._future)

    def change(self, state: State, of: str = "") -> None:
        """Show another state.

        Args:
            state: what to show.
            of: the control that was moved: one that is dragged makes one step, however often it is read.
        """
        if state == self.state:
            return
        if not of or of != self._of:
            self._past = [*self._past, self.state][-_MOST_STEPS:]
        self.state, self._of, self._future = state, of, []

    def rest(self) -> None:
        """The hand rests: what comes is a new step, of the same control too."""
        self._of = ""

    def undo(self) -> None:
        """One step back, if there is one."""
        if self._past:
            self._future.append(self.state)
            self.state, self._of = self._past.pop(), ""

    def redo(self) -> None:
        """One step forward, if there is one."""
        if self._future:
            self._past.append(self.state)
            self.state, self._of = self._future.pop(), ""


def pack(text: str) -> str:
    """A file's text as a word of the address."""
    return base64.urlsafe_b64encode(zlib.compress(text.encode(), 9)).decode().rstrip("=")


def unpack(word: str) -> str:
    """The text again; empty where `word` holds none."""
    try:
        packed = base64.urlsafe_b64decode(word + "=" * (-len(word) % 4))
        reader = zlib.decompressobj()
        text = reader.decompress(packed, _MOST_RIG_BYTES)
        return "" if reader.unconsumed_tail or not reader.eof else text.decode()
    except (binascii.Error, zlib.error, ValueError):
        return ""
