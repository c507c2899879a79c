"""Pages that are made from the program itself: a line ``<!-- generated: NAME -->`` becomes Markdown.

So a command, a public name or a key that is added stands in the reference without anybody writing it there.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import fields, is_dataclass

import command_line
import documents
import python_names
from sphinx.application import Sphinx

MAKERS: dict[str, Callable[[], str]] = {
    "commands": command_line.as_markdown,
    "documents": documents.as_markdown,
    "python": python_names.as_markdown,
}


def _fill(app: Sphinx, page: str, source: list[str]) -> None:
    source[0] = re.sub(r"<!-- generated: (\w+) -->", lambda found: MAKERS[found[1]](), source[0])


def _name_fields(
    app: Sphinx, what: str, name: str, obj: object, options: object, args: str | None, returns: str | None
) -> tuple[str, str | None] | None:
    """A dataclass is called with its fields, which have entries of their own below: names are enough."""
    if what == "class" and isinstance(obj, type) and is_dataclass(obj):
        return f"({', '.join(field.name for field in fields(obj) if field.init)})", returns
    return None


def setup(app: Sphinx) -> dict[str, bool]:
    """What Sphinx calls."""
    app.setup_extension("sphinx.ext.autodoc")
    app.connect("source-read", _fill)
    app.connect("autodoc-process-signature", _name_fields)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
