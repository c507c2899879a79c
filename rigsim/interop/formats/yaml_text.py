"""YAML as calibration programs write it, OpenCV's dialect included."""

from __future__ import annotations

import re
from collections.abc import Hashable, Mapping

import yaml

from rigsim.errors import InvalidRig
from rigsim.interop.formats.values import matrix, pixels, shown

_DIRECTIVE = re.compile(r"\A\s*%YAML[: ]\s*1\.\d\s*$", re.MULTILINE)  # OpenCV's is no YAML
_MERGE = "tag:yaml.org,2002:merge"
_OPENCV_MATRIX = "tag:yaml.org,2002:opencv-matrix"


_MOST_VALUES = 200_000


class _Loader(yaml.SafeLoader):
    """Plain values and OpenCV's matrices; nothing that runs, and no key twice."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, object]:
        """A table; a key that is given twice is an error, as in TOML.

        Raises:
            InvalidRig: it does.
        """
        seen: set[str] = set()
        for key, _ in node.value:
            if isinstance(key, yaml.ScalarNode) and key.tag != _MERGE:
                if key.value in seen:
                    raise InvalidRig(f"line {key.start_mark.line + 1}: {shown(key.value)} is given twice")
                seen.add(key.value)
        return super().construct_mapping(node, deep)


def _opencv_matrix(loader: yaml.SafeLoader, node: yaml.Node) -> object:
    if not isinstance(node, yaml.MappingNode):
        raise InvalidRig(f"line {node.start_mark.line + 1}: an opencv-matrix must have rows, cols and data")
    table = loader.construct_mapping(node, deep=True)
    where = f"matrix in line {node.start_mark.line + 1}"
    for key in ("rows", "cols", "data"):
        if key not in table:
            raise InvalidRig(f"{where}: {key} is missing: an opencv-matrix has rows, cols and data")
    rows, columns = table["rows"], table["cols"]
    if 0 in (rows, columns):
        return []
    values = matrix(table["data"], where, pixels(rows, f"{where}, rows"), pixels(columns, f"{where}, cols"))
    return values.tolist()


_Loader.add_constructor(_OPENCV_MATRIX, _opencv_matrix)


def yaml_table(text: str) -> Mapping[str, object]:
    """The table that a YAML text holds; OpenCV's matrices as lists of rows.

    Raises:
        InvalidRig: it is no YAML, or no table.
    """
    try:
        found = yaml.load(_DIRECTIVE.sub("", text, count=1), Loader=_Loader)  # a SafeLoader
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


def _size(value: object, known: dict[int, int]) -> int:
    """How many values there are once every alias is written out; `known` are those of earlier containers."""
    if not isinstance(value, dict | list):
        return 1
    if id(value) not in known:
        known[id(value)] = _MOST_VALUES  # one that holds itself has no end
        parts = value.values() if isinstance(value, dict) else value
        known[id(value)] = 1 + sum(_size(part, known) for part in parts)
    return known[id(value)]
