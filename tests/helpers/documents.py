"""JSON documents as programs see them: parsed strictly and held to the schemas of docs/schema."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NoReturn

from jsonschema import Draft202012Validator

SCHEMAS = Path(__file__).resolve().parents[2] / "docs" / "schema"


def schema(name: str) -> dict[str, Any]:
    return dict(json.loads((SCHEMAS / f"{name}.schema.json").read_text(encoding="utf-8")))


def validator(name: str) -> Draft202012Validator:
    return Draft202012Validator(schema(name))


def valid(name: str, text: str) -> dict[str, Any]:
    """The one document that `text` is, after docs/schema has agreed."""
    document = json.loads(text, parse_constant=_refuse)
    validator(name).validate(document)
    return dict(document)


def misplaced(name: str, document: dict[str, Any]) -> list[str]:
    """Objects in `document` whose keys do not stand in the order of their model's, which the schema has."""
    whole = schema(name)
    return list(_misplaced(document, whole, whole["$defs"], name))


def _misplaced(value: Any, node: dict[str, Any], parts: dict[str, Any], path: str) -> Iterator[str]:
    options = [parts[one["$ref"].rpartition("/")[2]] if "$ref" in one else one for one in _options(node)]
    if isinstance(value, list):
        items = [one["items"] for one in options if "items" in one]
        for place, item in enumerate(value):
            for one in items:
                yield from _misplaced(item, one, parts, f"{path}[{place}]")
    if isinstance(value, dict):
        for one in options:
            keys = one.get("properties", {})
            if keys and list(value) != list(keys):
                yield f"{path}: {list(value)}"
            for key, item in value.items():
                if key in keys:
                    yield from _misplaced(item, keys[key], parts, f"{path}.{key}")


def _options(node: dict[str, Any]) -> list[dict[str, Any]]:
    return list(node.get("anyOf", [node]))


def _refuse(word: str) -> NoReturn:
    raise AssertionError(f"{word} is no JSON")
