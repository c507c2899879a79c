"""Words are made in `present` alone: `study` says which sentence and what stands in it, and each has one."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from rigsim.present.design.tolerance import CHANGED
from rigsim.present.design.words import NOISE
from rigsim.present.kit.mistakes.faults import FAULTS
from rigsim.present.kit.mistakes.of_amounts import AMOUNTS
from rigsim.present.kit.mistakes.said import MISTAKES, in_words
from rigsim.present.kit.sayings import Sentences, spoken
from rigsim.present.verify.sentences import ABOUT, WHY
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig
from rigsim.study.saying import saying
from rigsim.study.sweep.models import models
from rigsim.study.verify.diagnosis.mistakes import LIBRARY

ROOM = Path(__file__).resolve().parents[2] / "rigsim"
STUDY = {
    path.relative_to(ROOM / "study").as_posix(): ast.parse(path.read_text(encoding="utf-8"))
    for path in sorted((ROOM / "study").rglob("*.py"))
}
# who says something: the study, and the library where it fills in what was not asked for
TREES = [*STUDY.values(), ast.parse((ROOM / "api/kit/requirements.py").read_text(encoding="utf-8"))]
TABLES: dict[str, Sentences] = {
    "faults": FAULTS,
    "about": ABOUT,
    "why": WHY,
    "changed": CHANGED,
    "noise": NOISE,
}
MOST_WORDS = 6
# one table of columns, of axes and of classes each: their help and their meaning stand beside the entry
REGISTRIES = (
    *(f"{room}/columns.py" for room in ("scene", "compare", "measure", "tolerance")),
    "scene/axes/",
    "tolerance/classes.py",
)
# parts of errors and remarks, or why something was not run
REASONS = (
    "calc/limits.py",
    "calc/points.py",
    "calc/sight.py",
    "calibrate/pictures/remarks.py",
    "calibrate/plan/explain.py",
    "calibrate/plan/free.py",
    "calibrate/plan/models.py",
    "calibrate/plan/odd.py",
    "calibrate/plan/unreachable.py",
    "calibrate/witness/measured.py",
    "design/solve.py",
    "design/words.py",
    "infer/remarks.py",
    "measure/rows.py",
    "rig/remarks.py",
    "golden/compare.py",
    "sweep/run.py",
    "tolerance/joint/cause.py",
    "sweep/advice.py",
    "triangulators/isolated.py",
    "verify/golden.py",
    "verify/rendered.py",
    "verify/runner.py",
    "verify/session.py",
    "verify/suite.py",
)


def texts(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Strings that are no docstrings and in no error or remark made on the spot; a gap is a ``{}``."""
    spared: set[int] = set()
    for node in ast.walk(tree):
        called = ast.unparse(node.func) if isinstance(node, ast.Call) else ""
        is_docstring = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        is_type = isinstance(node, ast.AnnAssign) and isinstance(node.value, ast.Constant)
        is_error = isinstance(node, ast.Raise) or called.endswith("Error") or called.startswith("Invalid")
        if is_docstring or is_type or is_error or called.startswith(("Remark", "given.")):
            spared |= {id(part) for part in ast.walk(node)}
    for node in ast.walk(tree):
        if id(node) in spared:
            continue
        if isinstance(node, ast.JoinedStr):
            spared |= {id(part) for part in node.values}
            yield node.lineno, _template(node)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.lineno, node.value


def _template(node: ast.JoinedStr) -> str:
    return "".join(str(part.value) if isinstance(part, ast.Constant) else "{}" for part in node.values)


def _asked_for(node: ast.expr) -> Iterator[str]:
    """The forms that the first argument of `saying` may be, where they stand there."""
    if isinstance(node, ast.Constant):
        yield str(node.value)
    elif isinstance(node, ast.IfExp):
        yield from (*_asked_for(node.body), *_asked_for(node.orelse))


def forms() -> set[str]:
    calls = [node for tree in TREES for node in ast.walk(tree) if isinstance(node, ast.Call)]
    makers = ("saying", "Saying", "sides")
    named = [
        node for node in calls if isinstance(node.func, ast.Name) and node.func.id in makers and node.args
    ]
    return {form for node in named for form in _asked_for(node.args[0])}


def test_the_study_makes_no_sentences() -> None:
    found = [
        f"{name}:{line} {text}"
        for name, tree in STUDY.items()
        if not name.startswith((*REGISTRIES, *REASONS))
        for line, text in texts(tree)
        if len(text.split()) > MOST_WORDS or re.fullmatch(r"[A-Z][^.]* .*\.", text)
    ]
    assert found == []


def test_who_may_make_sentences_does() -> None:
    for name in (*REGISTRIES, *REASONS):
        trees = [tree for file, tree in STUDY.items() if file.startswith(name)]
        assert any(len(text.split()) > 4 for tree in trees for _, text in texts(tree)), name


def test_all_that_is_said_has_words() -> None:
    said = forms()
    assert {"swapped-images", "distortion-k3", "rows-repeated", "none-known", "behind", "measured"} <= said
    assert said - {form for table in TABLES.values() for form in table} == set()


def test_every_mistake_of_the_library_has_words() -> None:
    assert len(LIBRARY) > 300
    said = [in_words(mistake.said) for mistake in LIBRARY]
    assert all(re.fullmatch(r"\S.*\.", sentence) and "{" not in sentence for sentence in said)


def test_mistakes_with_an_amount_have_words_and_no_others() -> None:
    rig = StereoRig.rectified(Intrinsics.from_focal(1280, 720, 900.0), 0.1)
    names = {model.name for model in models(rig, np.array([[0.0, 0.0, 2.0]]))}
    assert {*AMOUNTS} == {"amount", *(f"{name}: {sign}" for name in names for sign in ("more", "less"))}
    amount = saying("amount", amount=-0.0123, amount_se=0.002, unit="deg")
    assert spoken(saying("yaw: less", amount=amount), FAULTS) == (
        "yaw: the right camera looks 0.0123 +- 0.002 deg further left than the triangulation takes it to"
    )


@pytest.mark.parametrize("table", TABLES)
def test_all_words_are_said_by_somebody(table: str) -> None:
    said = {text for tree in TREES for _, text in texts(tree)}
    filled = {
        re.compile(re.escape(text).replace(r"\{\}", "(.+)"))
        for text in said
        if re.search(r"\{\}: [a-z]+|[a-z]+: \{\}|-\{\}|^\{\}-\{\}$", text) and "{}" in text
    }
    for form in TABLES[table].keys() - AMOUNTS.keys():
        matches = (pattern.fullmatch(form) for pattern in filled)
        assert form in said or any(match and {*match.groups()} <= said for match in matches), form


def test_no_mistake_has_two_sentences() -> None:
    assert not AMOUNTS.keys() & MISTAKES.keys()
    kinds = ROOM / "present/kit/mistakes"
    keys = [
        key.value
        for path in sorted(kinds.glob("of_*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.AnnAssign)
        and isinstance(node.value, ast.Dict)
        and isinstance(node.annotation, ast.Name)
        and node.annotation.id == "Sentences"
        for key in node.value.keys
        if isinstance(key, ast.Constant)
    ]
    assert len(keys) == len({*keys}) > 150
