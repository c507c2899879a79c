"""The keys of every JSON document, from the schemas that the documents are held to."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parents[1] / "schema"


def as_markdown() -> str:
    """A section a document, a table of the document's keys and one for each object in it."""
    return "\n".join(line for path in sorted(FOLDER.glob("*.schema.json")) for line in _document(path))


def _document(path: Path) -> Iterator[str]:
    schema = json.loads(path.read_text(encoding="utf-8"))
    yield f"## {path.name.removesuffix('.schema.json')}\n"
    yield f"`{schema['title']}`: [{path.name}](../schema/{path.name})\n"
    yield from _table(schema)
    for name, part in schema.get("$defs", {}).items():
        if "properties" in part:
            yield f"**{name}**. {part.get('description', '')}\n"
            yield from _table(part)


def _table(part: dict[str, Any]) -> Iterator[str]:
    yield "| key | holds | meaning |\n|---|---|---|"
    for key, value in part.get("properties", {}).items():
        yield f"| `{key}` | {_kind(value)} | {_cell(value.get('description', ''))} |"
    yield ""


def _kind(value: dict[str, Any]) -> str:
    """What a key may hold, in a few words."""
    if "$ref" in value:
        return value["$ref"].rpartition("/")[2]
    if "enum" in value:
        return " \\| ".join(f"`{choice}`" for choice in value["enum"])
    if "const" in value:
        return f"`{value['const']}`"
    for joined in ("anyOf", "oneOf", "allOf"):
        if joined in value:
            return " or ".join(_kind(choice) for choice in value[joined])
    kinds = value.get("type", "anything")
    if kinds == "array":
        return f"list of {_kind(value['items'])}" if value.get("items") else "list"
    return " or ".join(kinds) if isinstance(kinds, list) else kinds


def _cell(text: str) -> str:
    return " ".join(text.replace("|", "\\|").split())
