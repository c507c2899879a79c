"""What `pip install` gives: the wheel, built from this checkout, in a clean environment of its own."""

from __future__ import annotations

import os
import subprocess
import sys
import sysconfig
import venv
import zipfile
from pathlib import Path

import pytest

from rigsim import __version__

CHECKOUT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    build = [
        sys.executable,
        "-m",
        "build",
        "--wheel",
        "--no-isolation",
        "--outdir",
        str(folder),
        str(CHECKOUT),
    ]
    subprocess.run(build, check=True, capture_output=True)
    (path,) = folder.glob("*.whl")
    return path


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An environment of its own that borrows the dependencies, but not rigsim, from this one."""
    folder = tmp_path_factory.mktemp("venv")
    venv.create(folder, with_pip=False, symlinks=True)
    (packages,) = folder.glob("lib/python*/site-packages")
    (packages / "borrowed.pth").write_text(sysconfig.get_path("purelib") + "\n")
    pip = [sys.executable, "-m", "pip", "--python", str(folder / "bin" / "python"), "install", "--quiet"]
    subprocess.run([*pip, "--no-deps", "--no-index", str(wheel)], check=True, capture_output=True)
    return folder


def output_of(installed: Path, *words: str) -> str:
    """What a command of the environment prints, run far away from the checkout."""
    clean = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    done = subprocess.run(
        [installed / "bin" / words[0], *words[1:]],
        cwd=installed,
        env=clean,
        check=True,
        capture_output=True,
        text=True,
    )
    return done.stdout


def test_wheel_holds_code_scenes_and_templates_and_nothing_else(wheel: Path) -> None:
    names = set(zipfile.ZipFile(wheel).namelist())
    scenes = {f"rigsim/{path.relative_to(CHECKOUT)}" for path in CHECKOUT.glob("models/*/scene.xml")}
    templates = {str(path.relative_to(CHECKOUT)) for path in CHECKOUT.glob("rigsim/present/templates/*")}
    modules = {str(path.relative_to(CHECKOUT)) for path in CHECKOUT.glob("rigsim/**/*.py")}
    assert scenes
    assert templates
    assert scenes | templates | modules | {"rigsim/py.typed"} <= names
    outside = {name for name in names if not name.startswith(("rigsim/", f"rigsim-{__version__}.dist-info/"))}
    assert outside == set()
    assert not {name for name in names if "__pycache__" in name}


def test_wheel_is_small(wheel: Path) -> None:
    assert wheel.stat().st_size < 10_000_000


def test_installed_program_is_the_wheel_s_own(installed: Path) -> None:
    where = output_of(installed, "python", "-c", "import rigsim; print(rigsim.__file__)").strip()
    assert Path(where).is_relative_to(installed)
    assert output_of(installed, "rigsim", "--version") == f"rigsim {__version__}\n"


def test_installed_program_calculates(installed: Path) -> None:
    words = [
        "calc",
        "point",
        "--focal",
        "1200",
        "--baseline",
        "150",
        "--left",
        "980,500",
        "--right",
        "910,500",
    ]
    assert "2571.4" in output_of(installed, "rigsim", *words)


def test_installed_program_finds_its_scenes(installed: Path) -> None:
    listed = output_of(installed, "rigsim", "scenes")
    for path in CHECKOUT.glob("models/*/scene.xml"):
        assert path.parent.name in listed
    code = "from rigsim.sim.scenes import library; print(library.models_dir())"
    assert Path(output_of(installed, "python", "-c", code).strip()).is_relative_to(installed)
