"""The house rules: who imports whom, what a command loads, and what the package promises by name."""

from __future__ import annotations

import ast
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from importlinter.cli import lint_imports

import rigsim
from tests.helpers.processes import modules_after

CHECKOUT = Path(__file__).resolve().parents[2]
HEAVY = {"cv2", "jinja2", "matplotlib", "mujoco", "pandas", "scipy"}
W1 = ["calc", "point", "--focal", "1200", "--baseline", "150", "--left", "980,500", "--right", "910,500"]


def test_import_contract_is_kept(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(CHECKOUT)
    code = lint_imports(no_cache=True)
    assert code == 0, capsys.readouterr().out


def test_import_contract_names_every_room() -> None:
    config = tomllib.loads((CHECKOUT / "pyproject.toml").read_text(encoding="utf-8"))
    layers = config["tool"]["importlinter"]["contracts"][0]["layers"]
    named = {room.strip().removeprefix("rigsim.") for layer in layers for room in layer.split("|")}
    rooms = {path.parent.name for path in (CHECKOUT / "rigsim").glob("*/__init__.py")}
    assert named == rooms


def test_what_the_package_imports_is_declared() -> None:
    project = tomllib.loads((CHECKOUT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    declared = [*project["dependencies"], *extras["vision"], *extras["studio"], *extras["pytest"]]
    names = {requirement.partition(">=")[0] for requirement in declared}
    # imported under another name, or brought along by the package on the right
    origin = {"PIL": "pillow", "cv2": "opencv-python-headless", "OpenGL": "mujoco", "markupsafe": "jinja2"}
    origin |= {"yaml": "pyyaml", "starlette": "nicegui"}
    imported: set[str] = set()
    for path in (CHECKOUT / "rigsim").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                imported |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                imported.add(node.module or "")
    foreign = {name.partition(".")[0] for name in imported} - set(sys.stdlib_module_names) - {"rigsim"}
    assert "numpy" in foreign
    assert {origin.get(name, name) for name in foreign} <= names


@pytest.mark.parametrize(
    "words",
    [["--help"], ["--version"], ["calc", "--help"], ["calc", "point", "-h"], ["calibrate", "plan", "-h"]],
)
def test_help_loads_no_numbers(words: list[str]) -> None:
    loaded = {name.partition(".")[0] for name in modules_after(*words)}
    assert "typer" in loaded
    assert not loaded & (HEAVY | {"numpy", "rich"})


@pytest.mark.parametrize(
    "words",
    [
        W1,
        [*W1, "--json"],
        ["calc", "depth", "--z", "3m", "--preset", "branch"],
        ["calc", "limits", "--preset", "bin"],
    ],
)
def test_calc_loads_nothing_heavy(words: list[str]) -> None:
    loaded = {name.partition(".")[0] for name in modules_after(*words)}
    assert "numpy" in loaded
    assert not loaded & HEAVY


def test_importing_rigsim_loads_nothing() -> None:
    code = "import sys, rigsim; print(' '.join(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = {name.partition(".")[0] for name in done.stdout.split()}
    assert not loaded & (HEAVY | {"numpy", "typer", "rich", "pydantic"})


def test_every_promised_name_is_there() -> None:
    assert "__version__" in rigsim.__all__
    assert len(set(rigsim.__all__)) == len(rigsim.__all__)
    for name in rigsim.__all__:
        assert getattr(rigsim, name) is not None, name
        assert name in dir(rigsim)
    missing = "nonsense"
    with pytest.raises(AttributeError, match=missing):
        getattr(rigsim, missing)


def test_the_names_people_work_with_are_promised() -> None:
    assert {
        "Intrinsics",
        "Pose",
        "StereoRig",
        "PixelNoise",
        "triangulate",
        "predict_covariance",
        "predict_depth_std",
        "predict_depth_bias",
        "depth_bounds",
        "sweep",
    } <= set(rigsim.__all__)
