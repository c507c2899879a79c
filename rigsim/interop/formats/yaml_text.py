"""YAML as calibration programs write it, OpenCV's dialect included."""

from __future__ import annotations

import functools
import re
from collections.abc import Hashable, Mapping
from typing import TYPE_CHECKING, Any

import yaml

from rigsim.errors import InvalidRig
from rigsim.interop.formats.values import pixels, shown

if TYPE_CHECKING:
    from yaml import SafeLoader as Base
else:
    Base = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

_DIRECTIVE = re.compile(r"\A\s*%YAML[^\n]*$", re.MULTILINE)  # OpenCV's `%YAML:1.0` is no YAML
_CLOSE = re.compile(r"^([ \t]*(?:- )?[A-Za-z_][\w.]*):(?=[\[{\d.+-])", re.MULTILINE)  # OpenCV takes `data:[1`
_BRACKET = re.compile(r"[\[\]{}]")
_DEEP = re.compile(r"^ {300}|(?:[-?:]\s){50}", re.MULTILINE)
_MERGE = "tag:yaml.org,2002:merge"
_OPENCV = "tag:yaml.org,2002:opencv-"
_OPENCV_MATRIX = _OPENCV + "matrix"

_MOST_VALUES = 200_000
_MOST_LETTERS = 400_000
_MOST_BRACKETS = 50


class _Twice:
    """Stands for what a key says that is given twice, differently: no number, no list, no table."""

    def __repr__(self) -> str:
        return "given twice, differently"


TWICE = _Twice()


class _Loader(Base):
    """Plain values and OpenCV's matrices; nothing that runs, and no tables taken into others."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, object]:
        """A table. A key that is given twice keeps what both say; where they differ nobody knows which holds.

        Raises:
            InvalidRig: a table takes in another one.
        """
        if not isinstance(node, yaml.MappingNode):
            raise InvalidRig(f"line {node.start_mark.line + 1}: must be a table of names and values")
        table: dict[Hashable, object] = {}
        for key_node, value_node in node.value:
            if key_node.tag == _MERGE:
                raise InvalidRig(f"line {key_node.start_mark.line + 1}: << is not read: write the values out")
            key = self.construct_object(key_node, deep=True)
            if not isinstance(key, Hashable):
                raise InvalidRig(f"line {key_node.start_mark.line + 1}: a key must be a word")
            value = self.construct_object(value_node, deep=True)
            table[key] = TWICE if key in table and repr(table[key]) != repr(value) else value
        return table


def _map(loader: yaml.SafeLoader, node: yaml.Node) -> object:
    assert isinstance(node, yaml.MappingNode)
    return loader.construct_mapping(node, deep=True)


def _opencv_matrix(loader: yaml.SafeLoader, node: yaml.Node) -> object:
    if not isinstance(node, yaml.MappingNode):
        raise InvalidRig(f"line {node.start_mark.line + 1}: an opencv-matrix must have rows, cols and data")
    return opencv_matrix(
        loader.construct_mapping(node, deep=True), f"matrix in line {node.start_mark.line + 1}"
    )


def opencv_matrix(table: Mapping[Any, object], where: str) -> list[object]:
    """One of OpenCV's matrices: its rows, or a list where it has one axis, or several numbers a place.

    Its values are as they stand there: they may be no numbers.

    Raises:
        InvalidRig: it lacks its size or its data, or they contradict each other.
    """
    data, sizes = table.get("data"), table.get("sizes")  # of any number of axes, or of rows and columns
    if isinstance(sizes, list) and len(sizes) == 1:
        table = {**table, "rows": sizes[0], "cols": 1}
    elif isinstance(sizes, list) and len(sizes) == 2:
        table = {**table, "rows": sizes[0], "cols": sizes[1]}
    elif isinstance(sizes, list):
        return []
    for key in ("rows", "cols", "data"):
        if key not in table:
            raise InvalidRig(f"{where}: {key} is missing: an opencv-matrix has rows, cols and data")
    if 0 in (table["rows"], table["cols"]):
        return []
    rows, columns = pixels(table["rows"], f"{where}, rows"), pixels(table["cols"], f"{where}, cols")
    if not isinstance(data, list):
        raise InvalidRig(f"{where}, data {shown(data)}: must be a list of {rows * columns}")
    if (isinstance(sizes, list) and len(sizes) == 1) or str(table.get("dt", "d"))[:1] in "23456789":
        return list(data)
    if len(data) != rows * columns:
        raise InvalidRig(f"{where}: holds {len(data)} values, must be {rows * columns}")
    return [data[start : start + columns] for start in range(0, len(data), columns)]


def _opencv_other(loader: yaml.SafeLoader, suffix: str, node: yaml.Node) -> object:
    """Arrays of any number of axes; of anything else, no calibration needs it."""
    return _opencv_matrix(loader, node) if suffix == "nd-matrix" else None


_Loader.add_constructor("tag:yaml.org,2002:map", _map)
_Loader.add_constructor(_OPENCV_MATRIX, _opencv_matrix)
_Loader.add_multi_constructor(_OPENCV, _opencv_other)


@functools.lru_cache(maxsize=64)
def yaml_table(text: str) -> Mapping[str, object]:
    """The table that a YAML text holds; OpenCV's matrices as lists of rows.

    Raises:
        InvalidRig: it is no YAML, no table, or longer or deeper than a calibration is.
    """
    try:
        found = yaml.load(_plain(text), Loader=_Loader)  # a SafeLoader
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        line = f"line {mark.line + 1}: " if mark is not None else ""
        raise InvalidRig(f"is not YAML: {line}{error.problem or error.context}") from None
    except (yaml.YAMLError, ValueError, RecursionError, AttributeError, TypeError, LookupError) as error:
        if isinstance(error, InvalidRig):
            raise
        raise InvalidRig(f"is not YAML: {' '.join(str(error).split())[:200]}") from None
    if not isinstance(found, dict):
        raise InvalidRig("is no calibration: must be a table of names and values")
    if _size(found, {}) > _MOST_VALUES:
        raise InvalidRig(f"its aliases make more than {_MOST_VALUES} values of it: write them out, or fewer")
    return {str(key): value for key, value in found.items()}


def _plain(text: str) -> str:
    """The text without what OpenCV's dialect adds to YAML.

    Raises:
        InvalidRig: it is longer, or nested deeper, than a calibration is.
    """
    if len(text) > _MOST_LETTERS:
        raise InvalidRig(f"{len(text) / 1e6:.3g} MB of YAML: a calibration has less than 0.4 MB")
    depth = 0
    for bracket in _BRACKET.finditer(text):
        depth = max(0, depth + (1 if bracket[0] in "[{" else -1))
        if depth > _MOST_BRACKETS:
            raise InvalidRig("is not YAML: brackets are nested too deep")
    text = text.expandtabs(4)  # YAML forbids tabs where it counts columns
    if _DEEP.search(text):
        raise InvalidRig("is not YAML: nested too deep")
    return _CLOSE.sub(r"\1: ", _DIRECTIVE.sub("", text, count=1))


def _size(value: object, known: dict[int, int]) -> int:
    """How many values there are once every alias is written out; `known` are those of earlier containers."""
    if not isinstance(value, dict | list):
        return 1
    if id(value) not in known:
        known[id(value)] = _MOST_VALUES  # one that holds itself has no end
        parts = value.values() if isinstance(value, dict) else value
        known[id(value)] = 1 + sum(_size(part, known) for part in parts)
    return known[id(value)]
