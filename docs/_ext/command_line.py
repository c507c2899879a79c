"""The command line as Markdown, read off the very commands that run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import typer

from rigsim.cli.app import app


def as_markdown() -> str:
    """A section a command: what it does, how it is called, its arguments and options."""
    return "\n".join(_sections(typer.main.get_command(app), "rigsim"))


def _sections(command: Any, path: str) -> Iterator[str]:
    below = getattr(command, "commands", {})
    if path != "rigsim":
        yield f"## {path}\n"
        yield _text(command.help)
    if below:
        for name, child in below.items():
            yield from _sections(child, f"{path} {name}")
        return
    context = typer.Context(command, info_name=path)
    yield f"```text\n{' '.join([path, *command.collect_usage_pieces(context)])}\n```\n"
    rows = [row for parameter in command.params for row in _row(parameter, context)]
    if rows:
        yield "| option | what | default |\n|---|---|---|"
        yield from rows
        yield ""


def _row(parameter: Any, context: typer.Context) -> Iterator[str]:
    record = parameter.get_help_record(context)
    if record is None or "--help" in parameter.opts:
        return
    names, says = record
    says, default = _without_default(says)
    yield f"| `{_cell(names)}` | {_cell(says)} | {_cell(default)} |"


def _without_default(says: str) -> tuple[str, str]:
    """The text, and what typer has put in brackets behind it."""
    head, bracket, tail = says.rpartition("[")
    if not bracket or not tail.endswith("]"):
        return says, ""
    for part in tail[:-1].split("; "):
        if part.startswith("default: "):
            return head.strip(), part.removeprefix("default: ").strip("()")
        if part == "required":
            return head.strip(), "required"
    return says, ""


def _text(paragraphs: str) -> str:
    return "\n\n".join(" ".join(part.split()) for part in paragraphs.split("\n\n")) + "\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("*", "\\*").strip()
