"""The example programs of docs/reference/exec.md, one compiled as it says: exact on every kind of rig."""

from __future__ import annotations

import json
import re
import shlex
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rigsim.interop.exec.contract import ExecTriangulator
from rigsim.interop.exec.files import calibration_json
from rigsim.theory.triangulation import triangulate
from tests.helpers.sampling import RIGS, close, noisy, points_in_view

ROOT = Path(__file__).resolve().parents[2]
PYTHON = ROOT / "docs" / "examples" / "verify" / "triangulate.py"
CPP = PYTHON.with_suffix(".cpp")
SAID = (ROOT / "docs" / "reference" / "exec.md").read_text()


@pytest.fixture(scope="module", params=["python", "c++"])
def program(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> ExecTriangulator:
    """Each example, run as a stranger would; there must be a compiler."""
    if request.param == "python":
        command = f"{shlex.quote(sys.executable)} {shlex.quote(str(PYTHON))}"
    else:
        binary = tmp_path_factory.mktemp("cpp") / "triangulate"
        (compile_line,) = re.findall(r"^g\+\+ .*$", SAID, re.MULTILINE)
        words = shlex.split(compile_line)
        words[words.index("-o") + 1] = str(binary)
        subprocess.run([*words, "-Wall", "-Wextra", "-Werror"], cwd=ROOT, check=True)
        command = shlex.quote(str(binary))
    return ExecTriangulator(command, 60.0)


@pytest.mark.parametrize("kind", RIGS)
def test_exact_pixels_return_the_point(kind: str, program: ExecTriangulator) -> None:
    rig = RIGS[kind]
    points = points_in_view(rig, 500, 0.5, 10.0)
    uv_left, uv_right = rig.project(points)
    uv_left[7, 0], uv_right[8, 1] = np.nan, np.inf
    points[7:9] = np.nan
    found = program(rig, uv_left, uv_right)
    close(found, points, rtol=0, atol=1e-9)
    close(found, triangulate(rig, uv_left, uv_right, "optimal"), rtol=0, atol=1e-9)
    assert program.notes == []


@pytest.mark.parametrize("kind", RIGS)
def test_noisy_pixels_return_the_midpoint(kind: str, program: ExecTriangulator) -> None:
    rig = RIGS[kind]
    uv = noisy(rig, points_in_view(rig, 300, 0.5, 10.0), 0.5)
    close(program(rig, *uv), triangulate(rig, *uv, "midpoint"), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("kind", RIGS)
def test_pixels_of_no_point_have_no_answer(kind: str, program: ExecTriangulator) -> None:
    rig = RIGS[kind]
    rng = np.random.default_rng(5)
    uv = rng.uniform(-500, 2500, (2, 400, 2))
    expected = triangulate(rig, *uv, "midpoint")
    assert np.isnan(expected).any()
    close(program(rig, *uv), expected, rtol=1e-9, atol=1e-9)


def test_swapped_cameras_put_every_point_behind(program: ExecTriangulator) -> None:
    rig = RIGS["rectified"]
    rig = replace(rig, right=rig.left)
    uv_left, uv_right = rig.project(points_in_view(rig, 50, 0.5, 10.0))
    assert np.isnan(program(rig, uv_right, uv_left)).all()


def test_no_observations_are_no_mistake(program: ExecTriangulator) -> None:
    assert program(RIGS["verged"], np.zeros((0, 2)), np.zeros((0, 2))).shape == (0, 3)
    assert program.notes == []


def test_the_page_shows_the_calibration_as_it_is() -> None:
    (shown,) = (json.loads(block) for block in re.findall(r"```json\n(.*?)```", SAID, re.DOTALL))
    written = json.loads(calibration_json(RIGS["distorted"]))
    assert shown["left"] == written["left"]
    assert written["right"].keys() == shown["left"].keys()
    assert shown["right_from_left"].keys() == written["right_from_left"].keys()
    assert [shown["format"], shown["version"]] == [written["format"], written["version"]]


def test_the_page_names_what_is_here() -> None:
    for path in (PYTHON, CPP):
        assert str(path.relative_to(ROOT)) in SAID
