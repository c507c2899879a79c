"""Commands that are loaded when they are called: help and one command need not pay for all."""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Mapping, MutableMapping
from typing import Any, NamedTuple, cast

import typer
from typer.core import TyperCommand, TyperGroup


class Command(NamedTuple):
    """Where a command is, and the first line of its help."""

    place: str
    """``module:name`` of a function, or of a typer app."""

    says: str


class _Commands(Mapping[str, Any]):
    """Typer's commands by name, each loaded when it is asked for."""

    def __init__(self, places: Mapping[str, Command]) -> None:
        self._places = places
        self._loaded: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._loaded:
            self._loaded[name] = _load(name, self._places[name].place)
        return self._loaded[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)


def group(places: Mapping[str, Command]) -> type[TyperGroup]:
    """The class of a `typer.Typer` whose commands are `places`, by name, in the order of its help."""

    class LazyGroup(TyperGroup):
        def __init__(self, **attrs: Any) -> None:
            super().__init__(**attrs)
            self.commands = cast(MutableMapping[str, Any], _Commands(places))

        def format_commands(self, ctx: Any, formatter: Any) -> None:
            shown = [TyperCommand(name, help=command.says) for name, command in places.items()]
            TyperGroup(commands=shown).format_commands(ctx, formatter)

    return LazyGroup


def _load(name: str, place: str) -> Any:
    module, _, attribute = place.partition(":")
    command = getattr(importlib.import_module(module), attribute)
    holder = typer.Typer(rich_markup_mode=None)
    if isinstance(command, typer.Typer):
        holder.add_typer(command)
    else:
        holder.command(name)(command)
    return typer.main.get_group(holder).commands[name]
