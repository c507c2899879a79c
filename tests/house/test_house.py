"""One place for everything, and none too large: what the package's files hold, read from their source."""

from __future__ import annotations

import ast
from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).resolve().parents[2]
ROOM = CHECKOUT / "rigsim"
TREES = {
    str(path.relative_to(CHECKOUT)): ast.parse(path.read_text(encoding="utf-8"))
    for path in sorted(ROOM.rglob("*.py"))
}
MOST_FILES, MOST_LINES, MOST_PARAMETERS = 15, 60, 7
# the build reads the version there, so that it need not import the package
BUILD_READS = {"rigsim._version"}
# their names are those of the published schemas in docs/schema, where each document is a name space
SCHEMA_NAMES = "rigsim/interop/documents/"


def _functions() -> Iterator[tuple[str, ast.FunctionDef]]:
    for name, tree in TREES.items():
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef):
                yield name, node


def _is_private(name: str) -> bool:
    return name.startswith("_") and not name.endswith("__")


@pytest.mark.parametrize("place", ["rigsim", "tests", "benchmarks", "tools"])
def test_no_file_imports_what_is_private_to_another(place: str) -> None:
    found = []
    for path in sorted((CHECKOUT / place).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names: list[str] = []
            if isinstance(node, ast.ImportFrom) and node.module not in {"__future__", *BUILD_READS}:
                names = [*(node.module or "").split("."), *(alias.name for alias in node.names)]
            elif isinstance(node, ast.Import):
                names = [part for alias in node.names for part in alias.name.split(".")]
            found += [
                f"{path.relative_to(CHECKOUT)}:{node.lineno} {name}" for name in names if _is_private(name)
            ]
    assert found == []


def test_no_file_reaches_into_anothers_module() -> None:
    found = []
    for name, tree in TREES.items():
        modules = {
            alias.asname or alias.name
            for node in ast.walk(tree)
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("rigsim")
            for alias in node.names
        }
        found += [
            f"{name}:{node.lineno} {ast.unparse(node)}"
            for node in ast.walk(tree)
            if isinstance(node, ast.Attribute)
            and _is_private(node.attr)
            and isinstance(node.value, ast.Name)
            and node.value.id in modules
        ]
    assert found == []


def test_every_type_has_a_name_of_its_own() -> None:
    homes: dict[str, list[str]] = defaultdict(list)
    for name, tree in TREES.items():
        if name.startswith(SCHEMA_NAMES):
            continue
        for node in ast.walk(tree):
            if isinstance(node, ast.ClassDef):
                homes[node.name].append(name)
            elif isinstance(node, ast.AnnAssign) and "TypeAlias" in ast.unparse(node.annotation):
                homes[ast.unparse(node.target)].append(name)
    assert "StereoRig" in homes
    assert {name: files for name, files in homes.items() if len(files) > 1} == {}


def test_no_folder_is_crowded() -> None:
    counts = Counter(str(Path(name).parent) for name in TREES if not name.endswith("__init__.py"))
    assert counts["rigsim/rig"] > 5
    assert {folder: count for folder, count in counts.items() if count > MOST_FILES} == {}


def test_functions_are_short() -> None:
    """What a public function says of its arguments does not count."""
    lengths = {f"{name}:{node.lineno} {node.name}": _lines(node) for name, node in _functions()}
    assert len(lengths) > 1000
    assert {name: length for name, length in lengths.items() if length > MOST_LINES} == {}


def _lines(node: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    says = node.body[0] if ast.get_docstring(node, clean=False) is not None else None
    whole = (node.end_lineno or 0) - node.lineno + 1
    return whole - (0 if says is None else (says.end_lineno or 0) - says.lineno + 1)


def test_functions_take_few_parameters() -> None:
    """More belong together: in a frozen dataclass of options, as `Wanted` of a pair or a command's words."""
    found = {}
    for name, node in _functions():
        given = [
            argument.arg for argument in (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs)
        ]
        count = len([argument for argument in given if argument not in ("self", "cls")])
        if count > MOST_PARAMETERS:
            found[f"{name}:{node.lineno} {node.name}"] = count
    assert found == {}
