"""JSON documents as programs see them: parsed strictly and held to the schemas of docs/schema."""

from __future__ import annotations

import json
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


def _refuse(word: str) -> NoReturn:
    raise AssertionError(f"{word} is no JSON")
