"""Words for what `rigsim.study` has to say: a table of sentences, and how one is filled."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeAlias

from rigsim.study.saying import Saying, Value

Sentences: TypeAlias = Mapping[str, str | Callable[..., str]]
"""The sentence of every form: a text with the values' names in braces, or a function of the values."""


def spoken(said: Saying, sentences: Sentences) -> str:
    """A saying in words; those that stand in it are put into words of the same table first."""
    sentence = sentences[said.form]
    values = {name: _worded(value, sentences) for name, value in said.values}
    return sentence.format(**values) if isinstance(sentence, str) else sentence(**values)


def _worded(value: Value, sentences: Sentences) -> object:
    if isinstance(value, Saying):
        return spoken(value, sentences)
    if isinstance(value, tuple):
        return tuple(_worded(one, sentences) for one in value)
    return value
