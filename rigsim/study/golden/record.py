"""A command's answer, or a table, as golden numbers: each by its column and by what its row is about."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from rigsim.study.golden.compare import (
    COMMAND,
    MADE_BY,
    NOISE_SIGMAS,
    TABLE,
    GoldenValue,
    Number,
    Record,
    rounded,
)
from rigsim.study.golden.errors import standard_error
from rigsim.study.golden.kinds import EXACT_RELATIVE, IDENTITY, POINTS_RELATIVE, SMALLEST, kind_of
from rigsim.study.scene.axes import registry

FROM_PROVENANCE = (*MADE_BY, "scene", "seed", "points", "trials")
"""What of a document's provenance its record's head takes over."""

_AXES = tuple(column.name for axis in registry.ALL for column in axis.columns)
_TELLING = {
    "sweep": "by_depth",
    "design": "recommended",
    "tolerance": "yield_build_alone",
    "calc points": "n_inconsistent",
    "calc point": "uv_origin",
    "calc limits": "blind_zone",
    "calc depth": "depth_bias",
    "calc motion": "most_along_px",
}
"""A key of the document of each command, which those after it may have as well."""
_UNITS = {"_per_m": "1/m", "_mm": "mm", "_px": "px", "_deg": "deg", "_pct": "%", "_m": "m"}
_LENGTHS_OF_CALC = frozenset(
    (
        "x", "y", "z", "world_per_pixel", "depth_std", "depth_near", "depth_far", "depth_bias", "depth_step",
        "blind_zone", "min_depth", "max_depth", "overlap_width", "overlap_height", "dead_band",
        "depth_error", "most_depth_error",
    )
)  # fmt: skip


def document_record(command: str, document: Mapping[str, Any], about: Mapping[str, str]) -> Record:
    """The golden numbers of what `rigsim COMMAND --json` prints.

    Args:
        command: as ``sweep`` or ``calc depth``; the record's name has a dash for its blank.
        document: the whole document.
        about: what made it, beside what the document's provenance says.
    """
    made_by = document.get("provenance") or {}
    head = {key: str(made_by[key]) for key in FROM_PROVENANCE if key in made_by}
    walker = _Walker(command, dict(document))
    whole = {COMMAND: command, **head, **about}
    walker.knows_renderer = "renderer" in whole
    return _record(command, walker.numbers("", document, _best(_once(document))), whole)


def command_of(document: Mapping[str, Any]) -> str | None:
    """The command whose document this is, by keys that no other's has; None for none with golden results."""
    return next((command for command, key in _TELLING.items() if key in document), None)


def table_record(rows: Sequence[Mapping[str, Any]], keys: Sequence[str], about: Mapping[str, str]) -> Record:
    """The golden numbers of a table, whose rows are told apart by the columns `keys`."""
    walker = _Walker(TABLE, {}, tuple(keys))
    return _record(TABLE, walker.listed("rows", rows), {COMMAND: TABLE, **about})


def _record(command: str, numbers: Iterable[Number], about: Mapping[str, str]) -> Record:
    clean = {key: " ".join(text.split()) for key, text in about.items()}
    return Record(command.replace(" ", "-"), clean, tuple(map(rounded, numbers)))


class _Walker:
    """Goes through a document, naming each number by where it stands."""

    def __init__(self, command: str, root: Mapping[str, Any], keys: tuple[str, ...] | None = None) -> None:
        self.command, self.keys = command, keys
        self.knows_renderer = True
        self.n_rigs = {"rigs": root["rigs"]} if "rigs" in root else {}

    def numbers(self, path: str, node: Mapping[str, Any], said: Mapping[str, Any]) -> Iterator[Number]:
        for key, value in said.items():
            where = f"{path}{key}"
            if value is None or isinstance(value, bool | str) or hasattr(value, "__float__"):
                yield from self._number(where, key, value, node)
            elif isinstance(value, Mapping):
                if not self._is_left_out(key, where):
                    yield from self.numbers(f"{where}.", {**self.n_rigs, **value}, value)
            elif self._is_left_out(key, where):
                continue
            elif value and all(isinstance(item, Mapping) for item in value):
                yield from self.listed(where, value)
            else:
                for place, item in enumerate(value):
                    yield from self._number(f"{where}[{place}]", key, item, node)

    def listed(self, path: str, rows: Sequence[Mapping[str, Any]]) -> Iterator[Number]:
        """The numbers of rows, each row named by the keys that tell it apart."""
        name = path.rpartition(".")[2]
        found = self.keys if self.keys is not None else (*_AXES, *IDENTITY.get(name, ()))
        present = [key for key in found if all(key in row for row in rows)]
        telling = [key for key in present if len({_shown(row[key]) for row in rows}) > 1]
        if name in IDENTITY:
            telling = [key for key in present if key in telling or key in IDENTITY[name][:1]]
        seen: Counter[str] = Counter()
        for row in rows:
            label = ", ".join(f"{key}={_shown(row[key])}" for key in telling)
            seen[label] += 1
            if seen[label] > 1 or (not label and len(rows) > 1):
                label = f"{label} #{seen[label]}".strip()
            head = f"{path}[{label}] " if label else f"{path} "
            said = {key: value for key, value in row.items() if key not in telling}
            yield from self.numbers(head, {**self.n_rigs, **row}, said)

    def _is_left_out(self, key: str, where: str) -> bool:
        return kind_of(self.command, key, where, is_word=True) == "left out"

    def _number(self, name: str, key: str, value: Any, row: Mapping[str, Any]) -> Iterator[Number]:
        word = isinstance(value, bool | str)
        kind = kind_of(self.command, key, name, word)
        if kind == "left out":
            return
        if kind == "exact" and f"{key}_se" in row:
            kind = "simulated"
        drawn_only = kind in ("predicted", "finding")
        if word:
            yield Number(name, _word(value), "", drawn_only=drawn_only)
            return
        number = math.nan if value is None else float(value)
        error = standard_error(kind, key, number, row)
        relative = POINTS_RELATIVE if kind == "predicted" else EXACT_RELATIVE
        allowed = SMALLEST + (relative * abs(number) if math.isfinite(number) else 0.0)
        if kind == "measured" and not self.knows_renderer:  # another driver's pictures cannot be told apart
            allowed = max(allowed, NOISE_SIGMAS * math.sqrt(2) * error)
        yield Number(name, number, self._unit(key), allowed, error, drawn_only)

    def _unit(self, key: str) -> str:
        if self.command.startswith("calc") and key in _LENGTHS_OF_CALC:
            return "mm"
        return next((unit for end, unit in _UNITS.items() if key.endswith(end)), "")


def _once(document: Mapping[str, Any]) -> Mapping[str, Any]:
    """The document of ``calc depth`` of one rig and distance without what its row only says again."""
    rows = document.get("rows")
    if _TELLING["calc depth"] not in document or not rows or len(rows) > 1:
        return document
    own = {key: value for key, value in rows[0].items() if key.removesuffix("_mm") not in document}
    return {**document, "rows": [{key: value for key, value in own.items() if key not in document}]}


def _best(document: Mapping[str, Any]) -> Mapping[str, Any]:
    """A sweep's order of its rows as the best one's columns: places mean nothing once a row is added."""
    best, rows, swept = (document.get(key) for key in ("best", "rows", "swept"))
    if not (best and rows and swept is not None):
        return document
    words = ", ".join(f"{key}={_shown(rows[best[0]][key])}" for key in swept) or "the only one"
    return {**document, "best": words}


def _shown(value: Any) -> str:
    return value if isinstance(value, str) else "none" if value is None else f"{float(value):.10g}"


def _word(value: GoldenValue | bool) -> str:
    # of an agreement, only its kind: its reason holds numbers
    text = str(value).lower() if isinstance(value, bool) else " ".join(str(value).split())
    kind, colon, _ = text.partition(": ")
    return kind if colon and kind in ("flagged", "untold") else text
