"""The table in a text of OpenCV's FileStorage: YAML, XML or JSON, told by its first letter."""

from __future__ import annotations

import functools
import json
import re
from collections.abc import Mapping
from xml.etree import ElementTree

from rigsim.errors import InvalidRig
from rigsim.interop.formats.values import clipped
from rigsim.interop.formats.yaml_text import TWICE, opencv_matrix, yaml_table

_DEEPEST = 40
_MOST_LETTERS = 400_000
_ENTITIES = re.compile(r"<!\s*(?:DOCTYPE|ENTITY)", re.IGNORECASE)
_A_KEY = re.compile(r"^[ \t]*[\w.\"-]+[ \t]*:", re.MULTILINE)


def is_storage(text: str) -> bool:
    """Whether a text may hold a table: it is XML of FileStorage's, JSON, or has YAML's keys."""
    start = text.lstrip()
    if start.startswith("<"):
        return "<opencv_storage" in text
    return start.startswith("{") or _A_KEY.search(text) is not None


@functools.lru_cache(maxsize=64)
def storage_table(text: str) -> Mapping[str, object]:
    """The table that a text holds; matrices are lists of rows.

    Raises:
        InvalidRig: it cannot be read, or is no table.
    """
    start = text.lstrip()[:1]
    if start in ("<", "{") and len(text) > _MOST_LETTERS:
        raise InvalidRig(f"{len(text) / 1e6:.3g} MB: a calibration has less than 0.4 MB")
    if start == "<":
        return _xml_table(text)
    return _json_table(text) if start == "{" else yaml_table(text)


def xml_root(text: str) -> ElementTree.Element:
    """The root of an XML text that defines no entities: nothing is looked up, and nothing unfolds.

    Raises:
        InvalidRig: it is no XML, or defines some.
    """
    if _ENTITIES.search(text):
        raise InvalidRig("is XML with a DOCTYPE or entities, which are not read: remove them")
    try:
        return ElementTree.fromstring(text.lstrip())
    except (ElementTree.ParseError, ValueError) as error:
        raise InvalidRig(f"is not XML: {clipped(str(error))}") from None


def _xml_table(text: str) -> Mapping[str, object]:
    root = xml_root(text)
    if root.tag != "opencv_storage":
        raise InvalidRig(f"XML with the root {clipped(root.tag)}: must be opencv_storage")
    found = _value(root, 0)
    if not isinstance(found, dict):
        raise InvalidRig("opencv_storage is empty: must be a table of names and values")
    return found


def _value(element: ElementTree.Element, depth: int) -> object:
    """What an element says: a table, a list, a matrix, a number or a word."""
    if depth > _DEEPEST:
        raise InvalidRig("is nested too deep for a calibration")
    parts = list(element)
    if not parts:
        return _plain(element.text or "")
    if all(part.tag == "_" for part in parts):
        return [_value(part, depth + 1) for part in parts]
    table: dict[str, object] = {}
    for part in parts:
        value = _value(part, depth + 1)
        table[part.tag] = TWICE if part.tag in table and repr(table[part.tag]) != repr(value) else value
    if "matrix" in (element.get("type_id") or "") and "data" in table:
        data = table["data"]
        table["data"] = data if isinstance(data, list) else [] if data == "" else [data]
        sizes = table.get("sizes")
        if sizes is not None and not isinstance(sizes, list):
            table["sizes"] = [sizes]
        return opencv_matrix(dict(table), element.tag)
    return table


def _plain(text: str) -> object:
    words = text.split()
    try:
        values = [_number(word) for word in words]
    except ValueError:
        return text.strip().strip('"')
    return values[0] if len(values) == 1 else values or ""


def _number(word: str) -> int | float:
    return int(word) if word.lstrip("+-").isdigit() and len(word) < 20 else float(word)


def _json_table(text: str) -> Mapping[str, object]:
    try:
        found = json.loads(text, object_pairs_hook=_json_pairs)
    except ValueError as error:
        if isinstance(error, InvalidRig):
            raise
        raise InvalidRig(f"is not JSON: {clipped(str(error))}") from None
    except RecursionError:
        raise InvalidRig("is not JSON: brackets are nested too deep") from None
    if not isinstance(found, dict):
        raise InvalidRig("is no calibration: must be a table of names and values")
    return found


def _json_pairs(pairs: list[tuple[str, object]]) -> object:
    table: dict[str, object] = {}
    for key, value in pairs:
        table[key] = TWICE if key in table and repr(table[key]) != repr(value) else value
    if "opencv" in str(table.get("type_id", "")) and "data" in table:
        return opencv_matrix(dict(table), "matrix")
    return table
