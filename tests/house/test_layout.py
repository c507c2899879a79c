"""Where things are: one name a use case on every floor, small folders, helpers of their own."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
USE_CASES = ("sweep", "design", "tolerance", "verify", "compare", "infer", "measure", "rig", "calibrate")
FLOORS = ("rigsim/study", "rigsim/present", "rigsim/interop/documents", "rigsim/cli", "tests")
MOST_FILES = 15


def sources(*folders: str) -> Iterator[tuple[str, ast.Module]]:
    for folder in folders:
        for path in sorted((ROOT / folder).rglob("*.py")):
            yield path.relative_to(ROOT).as_posix(), ast.parse(path.read_text(encoding="utf-8"))


def imported(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


@pytest.mark.parametrize("floor", FLOORS)
def test_a_use_case_has_one_name_on_every_floor(floor: str) -> None:
    here = {path.name.removesuffix(".py") for path in (ROOT / floor).iterdir()}
    assert set(USE_CASES) <= here


def test_every_use_case_has_a_page_of_its_name() -> None:
    assert set(USE_CASES) <= {path.stem for path in (ROOT / "docs").rglob("*.md")}


def test_no_floor_has_a_use_case_of_another_name() -> None:
    beside = {
        "study": {"scene", "agreement", "triangulators", "calc", "golden", "export"},
        "present": {"kit", "live", "templates"},
    }
    for floor, others in beside.items():
        folders = {path.name for path in (ROOT / "rigsim" / floor).iterdir() if path.is_dir()}
        assert folders - {"__pycache__"} == {*USE_CASES, *others}


def test_folders_stay_small() -> None:
    for top in ("rigsim", "tests", "benchmarks/subjects"):
        for folder in (ROOT / top, *(path for path in (ROOT / top).rglob("*") if path.is_dir())):
            files = [path for path in folder.glob("*.py") if path.name != "__init__.py"]
            assert len(files) <= MOST_FILES, folder


def test_tests_share_helpers_and_no_tests() -> None:
    for path, tree in sources("tests", "benchmarks", "tools"):
        for name in imported(tree):
            assert not name.startswith("tests.") or name.startswith("tests.helpers"), (path, name)
            assert not (name.startswith("tests.") and path.startswith("benchmarks/")), (path, name)
