"""Every public name has an example, and it runs."""

from __future__ import annotations

import ast
import doctest
import importlib
import inspect
import itertools
from pathlib import Path

import pytest

import rigsim

OPTIONS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def said_of(name: str) -> str:
    """A public name's docstring; of a value, the words under it in its module."""
    value = getattr(rigsim, name)
    if inspect.isclass(value) or inspect.isroutine(value):
        return inspect.getdoc(value) or ""
    stub = ast.parse(Path(rigsim.__file__).with_name("__init__.pyi").read_text(encoding="utf-8"))
    (module,) = [
        node.module
        for node in stub.body
        if isinstance(node, ast.ImportFrom) and any(alias.name == name for alias in node.names)
    ]
    source = Path(inspect.getfile(importlib.import_module(f"rigsim.{module}"))).read_text(encoding="utf-8")
    body = ast.parse(source).body
    for one, after in itertools.pairwise(body):
        targets = one.targets if isinstance(one, ast.Assign) else [getattr(one, "target", None)]
        if any(isinstance(target, ast.Name) and target.id == name for target in targets):
            assert isinstance(after, ast.Expr), name
            assert isinstance(after.value, ast.Constant), name
            return inspect.cleandoc(str(after.value.value))
    raise AssertionError(name)


@pytest.mark.parametrize("name", rigsim.__all__)
def test_its_example_runs(name: str) -> None:
    test = doctest.DocTestParser().get_doctest(said_of(name), {}, name, None, None)
    assert test.examples, f"{name} has no example"
    told: list[str] = []
    doctest.DocTestRunner(optionflags=OPTIONS).run(test, out=told.append)
    assert not told, "".join(told)
