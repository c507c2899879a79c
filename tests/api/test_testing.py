"""What other people's tests import: run as they would, in a folder of their own."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.testing import assert_triangulates, render_stereo, stereo_cases
from rigsim.theory.triangulation import triangulate

PAGE = Path(__file__).resolve().parents[2] / "docs" / "howto" / "testing.md"


def run_pytest(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *words],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )


def example(place: int = 0) -> str:
    """The ten lines of docs/howto/testing.md; the second block is on golden results."""
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(), flags=re.S)
    assert len(blocks) == 2
    return str(blocks[place])


def test_the_example_of_the_docs_passes_in_a_folder_of_its_own(tmp_path: Path) -> None:
    assert len([line for line in example().splitlines() if line.strip()]) <= 10
    (tmp_path / "test_stereo.py").write_text(example())
    done = run_pytest(tmp_path, "-q")
    assert done.returncode == 0, done.stdout
    assert "1 passed" in done.stdout


def test_a_forgotten_doffs_fails_with_a_table_that_says_so(tmp_path: Path) -> None:
    (tmp_path / "test_stereo.py").write_text(example().replace(" + rig.doffs_px", ""))
    done = run_pytest(tmp_path, "-q")
    assert done.returncode == 1
    assert "doffs exact" in done.stdout
    assert "rectified exact" not in done.stdout
    assert re.search(r"Diagnosis: [\w-]*doffs", done.stdout), done.stdout


def test_the_golden_results_of_the_docs_are_written_then_held_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "test_rig.py").write_text(example(1))
    monkeypatch.setenv("RIGSIM_UPDATE_GOLDEN", "1")
    assert "2 passed" in run_pytest(tmp_path, "-q").stdout
    assert {file.name for file in (tmp_path / "golden").iterdir()} == {"oak-d.csv", "accuracy.csv"}
    monkeypatch.delenv("RIGSIM_UPDATE_GOLDEN")
    (tmp_path / "test_rig.py").write_text(
        example(1).replace("2.0,", "2.5,").replace("[50, 100]", "[50, 101]")
    )
    done = run_pytest(tmp_path, "-q")
    assert "2 failed" in done.stdout
    assert "moved: rows error_mm: was 2.00 mm, now 2.50 mm" in done.stdout
    assert re.search(r"golden results of golden/oak-d.csv: .*\d+ gone", done.stdout)


def test_fixtures_marks_and_xdist(tmp_path: Path) -> None:
    (tmp_path / "test_stereo.py").write_text(
        "import pytest\n"
        "from rigsim import Intrinsics, StereoRig\n"
        "from rigsim.testing import assert_triangulates\n"
        "def test_each(stereo_case):\n    assert_triangulates('optimal', stereo_case)\n"
        "def test_all(stereo_cases):\n    assert len(stereo_cases) > 30\n"
        "@pytest.mark.rigsim_quick\n"
        "def test_pair(rendered_stereo):\n"
        "    rig = StereoRig.rectified(Intrinsics.from_focal(120, 80, 90.0), 0.06)\n"
        "    pair = rendered_stereo('bin', rig)\n"
        "    assert pair is rendered_stereo('bin', rig)\n"
        "    assert pair.left.shape == pair.depth_left.shape == (80, 120)\n"
    )
    long = "import pytest\n@pytest.mark.rigsim_full\ndef test_long():\n    raise SystemError\n"
    (tmp_path / "test_long.py").write_text(long)
    done = run_pytest(tmp_path, "-n", "2", "--strict-markers", "-W", "error", "-rs")
    assert done.returncode == 0, done.stdout
    assert re.search(rf"{len(stereo_cases()) + 2} passed, 1 skipped", done.stdout)
    assert "runs with --rigsim-suite full" in done.stdout
    assert run_pytest(tmp_path, "--rigsim-suite", "full", "test_long.py").returncode == 1


def test_the_plugin_loads_nothing_for_tests_that_do_not_ask() -> None:
    code = (
        "import sys, pytest, rigsim.pytest_plugin;"
        "print(sorted(name for name in sys.modules if name.split('.')[0] in ('rigsim', 'numpy', 'mujoco')))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "['rigsim', 'rigsim._version', 'rigsim.pytest_plugin']"


def swapped(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return triangulate(rig, uv_right, uv_left)


def test_the_message_is_a_table_of_cases_and_worst_rows() -> None:
    with pytest.raises(AssertionError) as caught:
        assert_triangulates(swapped, only=["verged", "rectified"])
    first, *rest = str(caught.value).splitlines()
    assert re.match(r"swapped: 4 of 4 cases failed", first)
    assert any(line.startswith("rectified exact [") and line.endswith("nothing") for line in rest)


def test_lists_and_a_single_case_are_taken_and_none_at_all_is_told() -> None:
    def listed(rig: StereoRig, uv_left: Array, uv_right: Array) -> list[list[float]]:
        return triangulate(rig, uv_left, uv_right).tolist()

    (case,) = stereo_cases(only=["near exact"])
    assert_triangulates(listed, case)
    with pytest.raises(ValueError, match="no cases"):
        assert_triangulates(listed, [])


def test_a_rendered_pair_is_true() -> None:
    pair = render_stereo("boards", points=200)
    # by hand at the first points: Z = f B / d, X = (u - cx) Z / f
    d = pair.uv_left[:, 0] - pair.uv_right[:, 0]
    z = pair.rig.left.fx * pair.rig.baseline_m / d
    np.testing.assert_allclose(pair.points_left[:, 2], z, rtol=1e-12)
    v, u = 300, 640
    seen = pair.disparity[v, u]
    assert seen == pytest.approx(pair.rig.left.fx * pair.rig.baseline_m / pair.depth_left[v, u], abs=2e-3)
    assert pair.left.shape == pair.disparity.shape == (720, 1280)
    assert pair.left.dtype == np.uint8
    assert pair.left.std() > 10
