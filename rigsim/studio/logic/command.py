"""The command lines that give what a page shows."""

from __future__ import annotations

import shlex
from collections.abc import Iterable

from rigsim.studio.state import State
from rigsim.studio.words import ALL, OF_RIG

RIG_FILE = "rig.toml"
"""What a rig is called that the address carries: the page hands it out under that name."""


def command(words: Iterable[str], state: State, names: Iterable[str]) -> str:
    """A command line.

    Args:
        words: the command, as ``calc``, ``point``.
        state: what is shown.
        names: the words of the state that are its options.
    """
    wanted = set(names)
    # option and value in one word, as a value may begin with a minus
    options = [
        f"--{word.flag or word.option}={RIG_FILE if word.name == 'rig' else text}"
        for word in ALL
        if word.name in wanted
        for text in (parts(state[word.name]) if word.several else [state[word.name]])
        if text
    ]
    return shlex.join(["rigsim", *words, *options])


def parts(text: str) -> list[str]:
    """The values of a word that holds several."""
    return [part.strip() for part in text.split(",") if part.strip()]


def of_point(state: State) -> str:
    """``rigsim calc point``."""
    return command(("calc", "point"), state, (*OF_RIG, "noise", "left", "right"))


def of_depth(state: State) -> str:
    """``rigsim calc depth``."""
    return command(("calc", "depth"), state, (*(OF_RIG - {"principal"}), "noise", "z"))


def of_limits(state: State) -> str:
    """``rigsim calc limits``."""
    return command(("calc", "limits"), state, (*OF_RIG, "z"))


def of_rig(state: State, distances: str) -> tuple[str, ...]:
    """The lines that give the numbers of a rig at some distances."""
    at = state.with_words(z=distances)
    return of_depth(at), of_limits(at.with_words(principal=""))
