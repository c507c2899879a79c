"""The tests that a change can break, nearest first, for as long as there is time: `./check --fast`.

What has changed is what git says, since the branch left main or, on main itself, since the last commit. A
test is as near as its imports are to what changed; tests of the same room or use case come before all others.
"""

from __future__ import annotations

import argparse
import ast
import os
import re
import subprocess
import sys
import time
from collections.abc import Iterable, Mapping
from pathlib import Path

import grimp
import pytest

ROOT = Path(__file__).resolve().parent.parent
SECONDS = 30.0
"""How long tests are begun; format, lint, types, imports and finding the tests take the rest of a minute."""

_ABOUT_ALL = ("check", "run", "pyproject.toml", "constraints.txt", "tools/")
_LONGEST = "RIGSIM_FAST_SECONDS"


def changed(root: Path = ROOT) -> list[str]:
    """Paths of files that differ from where the branch began, those not yet added to git included."""
    head = _git(root, "rev-parse", "HEAD")
    bases = [
        _git(root, "merge-base", "HEAD", name) for name in ("origin/main", "main", "origin/master", "master")
    ]
    base = next((base for base in bases if base and base != head), ["HEAD"])
    differ = _git(root, "diff", "--name-only", *base)
    new = _git(root, "ls-files", "--others", "--exclude-standard")
    return sorted({*differ, *new}) or _git(root, "diff", "--name-only", "HEAD~1")


def _git(root: Path, *words: str) -> list[str]:
    done = subprocess.run(["git", *words], cwd=root, capture_output=True, text=True, check=False)
    return done.stdout.split("\n")[:-1] if done.returncode == 0 else []


def affected(paths: Iterable[str], root: Path = ROOT) -> list[str]:
    """Test files that changes of `paths` can break, nearest first.

    Args:
        paths: files that changed, from the checkout's folder.
        root: the checkout.
    """
    paths = list(paths)
    tests = sorted(path.relative_to(root).as_posix() for path in root.glob("tests/*/test_*.py"))
    distance = _distances({module(path) for path in paths if path.endswith(".py")}, _importers(root))
    folders = {test.split("/")[1] for test in tests}
    rooms = {room for path in paths for room in _rooms(path, folders)}
    found: dict[str, int] = {}
    for test in tests:
        if test in paths:
            found[test] = -2
        elif test.split("/")[1] in rooms:
            found[test] = -1
        elif module(test) in distance:
            found[test] = distance[module(test)]
    return sorted(found, key=lambda test: (found[test], test))


def module(path: str) -> str:
    """The dotted name of a file: ``rigsim/rig/pose.py`` is ``rigsim.rig.pose``."""
    return path.removesuffix(".py").replace("/", ".").removesuffix(".__init__")


def _rooms(path: str, folders: set[str]) -> set[str]:
    """Which folders of tests hold those of the room or use case that a file belongs to."""
    if path.endswith(".md") or path.startswith(("docs/", *_ABOUT_ALL)):
        return {"house"}
    if path.startswith("models/"):
        return {"sim", "scene"}
    if not path.startswith("rigsim/"):
        return set()
    # a use case is a folder of its floor, or a file
    return set([part for part in path.partition(".")[0].split("/") if part in folders][-1:])


def _importers(root: Path) -> Mapping[str, set[str]]:
    """Who imports a module, by its name."""
    sys.path.insert(0, str(root))
    graph = grimp.build_graph("rigsim", cache_dir=None)
    who = {name: set(graph.find_modules_that_directly_import(name)) for name in graph.modules}
    app = root / "rigsim" / "cli" / "app.py"
    for command in re.findall(r'"(rigsim[\w.]+):\w+"', app.read_text(encoding="utf-8")):
        who.setdefault(command, set()).add("rigsim.cli.app")  # loaded when it is called
    for folder in ("tests", "benchmarks"):
        for file in root.glob(f"{folder}/**/*.py"):
            name = module(file.relative_to(root).as_posix())
            for imported in _imports(ast.parse(file.read_text(encoding="utf-8"))):
                who.setdefault(imported, set()).add(name)
    return who


def _imports(tree: ast.AST) -> set[str]:
    """Modules that a file names, wherever it does; ``from a import b`` may mean a or a.b."""
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return names


def _distances(begin: set[str], importers: Mapping[str, set[str]]) -> dict[str, int]:
    """How many imports lie between a module and the nearest of `begin`."""
    distance = dict.fromkeys(begin, 0)
    edge = begin
    while edge:
        step = max(distance.values()) + 1
        edge = {who for name in edge for who in importers.get(name, ()) if who not in distance}
        distance |= dict.fromkeys(edge, step)
    return distance


class Deadline:
    """Begins no test once the time is over, which runs from the first."""

    def __init__(self, seconds: float) -> None:
        """Tests are begun for so many seconds."""
        self.seconds = seconds
        self.end: float | None = None

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self) -> bool | None:
        """Leave a test out when it is too late."""
        now = time.monotonic()
        self.end = now + self.seconds if self.end is None else self.end
        return True if now > self.end else None


def pytest_configure(config: pytest.Config) -> None:
    """As a plugin, in every worker process."""
    if _LONGEST in os.environ:
        config.pluginmanager.register(Deadline(float(os.environ[_LONGEST])))


def main(words: list[str] | None = None) -> int:
    """Run what the change can break; returns pytest's exit code, the last line says what was run."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--list", action="store_true", help="say which test files, and run none")
    listed = parser.parse_args(words).list
    paths = changed()
    files = affected(paths)
    if listed or not files:
        print("\n".join(files) or f"{len(paths)} files changed; no test depends on them")
        return 0
    os.environ[_LONGEST] = str(SECONDS)
    os.environ["PYTHONPATH"] = os.pathsep.join([str(ROOT / "tools"), os.environ.get("PYTHONPATH", "")])
    begin = time.monotonic()
    command = [sys.executable, "-m", "pytest", "-q", "-n", "2", "--dist", "load", "-p", "fast", *files]
    code = subprocess.run(command, cwd=ROOT, check=False).returncode
    late = time.monotonic() - begin > SECONDS
    print(
        f"{len(files)} test files depend on {len(paths)} changed files"
        + ("; those farthest from the change may be left to ./check" if late else "")
    )
    return code


if __name__ == "__main__":
    sys.exit(main())
