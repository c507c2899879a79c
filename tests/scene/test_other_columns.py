"""The columns of compare, tolerance and measure: each typed once, and files and documents follow."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import pytest

from rigsim.interop.documents.compare import Row
from rigsim.interop.documents.tolerance.models import Quantity
from rigsim.present.compare.console import HEADS
from rigsim.study.compare import columns as compare
from rigsim.study.measure import columns as measure
from rigsim.study.scene.column import Column
from rigsim.study.tolerance import columns as tolerance

ROOT = Path(__file__).resolve().parents[2]
TABLES = {"compare": compare.COLUMNS, "tolerance": tolerance.COLUMNS, "measure": measure.COLUMNS}
WORDS = {"n", "unit", "kind", "form", "source", "board", "corner", "quantity", "tolerance", "score"}
"""Of the language, too."""
UNITS = {"_px": "px", "_mm": "mm"}


@pytest.mark.parametrize("table", TABLES)
def test_a_column_is_typed_in_one_file(table: str) -> None:
    own = set(TABLES[table]) - WORDS
    assert len(own) > 6
    rooms = [ROOT / "rigsim" / floor / table for floor in ("study", "present", "interop/documents")]
    paths = [path for room in rooms for path in room.rglob("*.py")]
    paths += [ROOT / "rigsim" / "interop" / "files" / "measure.py", *_document(table)]
    typed = {
        path.relative_to(ROOT).as_posix(): set(re.findall(r"[\"'](\w+)[\"']", path.read_text("utf-8"))) & own
        for path in paths
    }
    assert [path for path, names in typed.items() if names] == [f"rigsim/study/{table}/columns.py"]


def _document(table: str) -> list[Path]:
    return [path for path in [ROOT / "rigsim" / "interop" / "documents" / f"{table}.py"] if path.exists()]


@pytest.mark.parametrize("columns", TABLES.values(), ids=list(TABLES))
def test_a_name_carries_its_unit(columns: Mapping[str, Column]) -> None:
    for name, column in columns.items():
        assert column.unit in (UNITS.get(name[-3:], ""), "1/s"), name
        assert column.meaning.endswith(".")


def test_keys_of_the_documents_are_the_columns() -> None:
    assert list(Row.model_fields) == [*compare.COLUMNS, "within_noise_of_bound"]
    head, rest = ([one.name for one in columns] for columns in (tolerance.HEAD, tolerance.REST))
    assert list(Quantity.model_fields) == [*head, "depth_error_mm", *rest]
    for model, columns in ((Row, compare.COLUMNS), (Quantity, tolerance.COLUMNS)):
        for name, column in columns.items():
            assert model.model_fields[name].description == column.meaning


def test_the_consoles_heads_are_the_tables() -> None:
    assert HEADS[:3] == ("geometry", "triangulator", "pixel error\nover bound")
    assert HEADS[5:7] == ("lost\n%", "expected\n%")
    assert tolerance.at_distance(2500.0).name == "depth_error_at_2500_mm"
    assert tolerance.at_distance(2500.0).heading == "at\n2.5 m"
