"""`rigsim sweep` and its friends as people type them."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

from rigsim.cli.app import run
from rigsim.study.scene.columns import DEPTH_COLUMNS, ROW_COLUMNS
from tests.helpers.cli import rigsim
from tests.helpers.scenes import SLANTED, write

SMALL = ["--points", "200", "--trials", "5", "--resolution", "160x120", "--measure", "none"]
FILES = {
    "report.html",
    "sweep.csv",
    "sweep_by_depth.csv",
    "topdown.png",
    "depth_error.png",
    "left.png",
    "right.png",
    "rig.toml",
    "provenance.json",
}


def process(*args: object, cwd: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "rigsim", *map(str, args)],
        cwd=cwd,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )


class Here:
    """The command line in this process and an empty folder: quicker than a new interpreter."""

    def __init__(self, folder: Path, capture: pytest.CaptureFixture[str]) -> None:
        self.folder = folder
        self.module = f"mine_{folder.name}"  # a module is imported only once
        self._capture = capture
        self.error = ""

    def run(self, *args: object) -> int:
        code = run([str(arg) for arg in args])
        self.error = self._capture.readouterr().err.strip()
        return code


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Here:
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    return Here(tmp_path, capsys)


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, subprocess.CompletedProcess[str]]:
    folder = tmp_path_factory.mktemp("sweep")
    done = process(
        "sweep",
        "--baseline",
        "60,120",
        "--noise",
        "0.02,0.1",
        *SMALL,
        "--trials",
        50,
        "--out",
        "out",
        cwd=folder,
    )
    return folder / "out", done


def test_a_sweep_writes_all_its_files(swept):
    out, done = swept
    assert done.returncode == 0, done.stderr
    assert {path.name for path in out.iterdir()} == FILES
    assert "120" in done.stdout
    assert "out/report.html" in done.stdout


def test_tables_hold_one_row_a_configuration(swept):
    out, _ = swept
    rows = pd.read_csv(out / "sweep.csv")
    assert tuple(rows.columns) == ROW_COLUMNS
    assert sorted(zip(rows["baseline_mm"], rows["noise_px"], strict=True)) == [
        (60, 0.02),
        (60, 0.1),
        (120, 0.02),
        (120, 0.1),
    ]
    assert tuple(pd.read_csv(out / "sweep_by_depth.csv").columns) == DEPTH_COLUMNS
    # five times the noise is five times the error, but for the second order
    error = rows.set_index(["baseline_mm", "noise_px"])["depth_rmse_mm"]
    assert error[120, 0.1] / error[120, 0.02] == pytest.approx(5, rel=0.1)


def test_the_written_rig_and_command_repeat_the_numbers(swept, tmp_path: Path):
    out, _ = swept
    provenance = json.loads((out / "provenance.json").read_text())
    assert provenance["seed"] == 0
    assert provenance["command"].startswith("rigsim sweep --baseline 60,120")
    done = rigsim(
        "sweep", "--rig", out / "rig.toml", "--noise", 0.1, "--points", 200, "--trials", 50,
        "--measure", "none", "--out", "again", cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    again = pd.read_csv(tmp_path / "again" / "sweep.csv").iloc[0]
    rows = pd.read_csv(out / "sweep.csv")
    same = rows[(rows["baseline_mm"] == again["baseline_mm"]) & (rows["noise_px"] == 0.1)].iloc[0]
    assert again["depth_rmse_mm"] == same["depth_rmse_mm"]


def test_rays_run_the_main_job_where_there_is_no_gl(tmp_path: Path):
    done = rigsim("sweep", "--baseline", "120", *SMALL, "--renderer", "rays", "--out", "out", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads((tmp_path / "out" / "provenance.json").read_text())["renderer"] == "rays"


def test_a_user_scene_and_triangulator(tmp_path: Path):
    scene = write(tmp_path, SLANTED)
    (tmp_path / "mine.py").write_text(
        "import rigsim\n\ndef twice_as_far(rig, uv_left, uv_right):\n"
        "    return 2 * rigsim.triangulate(rig, uv_left, uv_right)\n"
    )
    done = process(
        "sweep", "--scene", scene, "--mount", "camera:front", "--triangulator", "dlt,mine:twice_as_far",
        *SMALL, "--out", "out", cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    rows = pd.read_csv(tmp_path / "out" / "sweep.csv").set_index("triangulator")
    assert rows.loc["dlt", "agreement"] == "agrees"
    assert rows.loc["mine:twice_as_far", "agreement"].startswith("flagged: simulated error")


@pytest.mark.parametrize(
    ("args", "code", "words"),
    [
        (["--baseline", "0"], 2, ["baseline 0", "> 0"]),
        (["--baseline=-5"], 2, ["baseline -5", "> 0"]),
        (["--baseline", "nan"], 2, ["nan"]),
        (["--baseline", "500:50"], 2, ["500:50"]),
        (["--baseline", "50:500:0"], 2, ["step"]),
        (["--baseline", "abc"], 2, ["abc"]),
        (["--baseline", ""], 2, ["empty"]),
        (
            ["--baseline", "50:500/1000", "--noise", "0.1:0.5/10", "--focal", "500:900/10"],
            2,
            ["10,000", "--yes"],
        ),
        (["--resolution", "0x480"], 2, ["0x480"]),
        (["--resolution", "20000x100"], 1, ["20000x100", "16384"]),
        (["--focal", "0"], 2, ["focal length 0"]),
        (["--hfov", "180"], 2, ["180"]),
        (["--focal", "800", "--hfov", "60"], 2, ["--focal and --hfov"]),
        (["--noise=-0.1"], 2, ["noise -0.1"]),
        (["--scene", "atlantis"], 1, ["atlantis", "boards", "corridor"]),
        (["--preset", "atlantis"], 1, ["atlantis", "branch", "artifact"]),
        (["--triangulator", "magic"], 1, ["magic", "optimal", "midpoint"]),
        (["--triangulator", "nowhere:function"], 1, ["nowhere"]),
        (["--mount", "body:tail"], 1, ["body:tail", "site:rig"]),
        (["--range", "50:60m"], 1, ["nothing between 50 and 60 m"]),
        (["--range", "5:1m"], 2, ["5:1m"]),
        (["--renderer", "crayon"], 1, ["crayon", "egl"]),
        (["--points", "0"], 2, ["points 0"]),
        (["--trials", "0"], 2, ["trials 0"]),
        (["--jobs", "0"], 2, ["jobs 0"]),
        (["--seed=-1"], 2, ["seed -1"]),
        (["--rig", "nowhere.toml"], 1, ["nowhere.toml"]),
        (["--baseline", "90m", "--range", "0.5:2m"], 1, ["left camera", "sees nothing"]),
        (["--bogus"], 2, ["--bogus"]),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing(here: Here, args: list[str], code: int, words: list[str]):
    renderer = [] if "--renderer" in args else ["--renderer", "rays"]
    assert here.run("sweep", *args, "--out", "out", *renderer) == code
    assert len(here.error.splitlines()) == 1, here.error
    assert all(word in here.error for word in words), here.error
    assert list(here.folder.iterdir()) == []


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("raise ValueError('no')", "ValueError"),
        ("return uv_left", "a row a point"),
        ("return None", "must be"),
        ("return uv_left[:, [0, 0, 0]] * float('nan')", "every triangulation failed"),
    ],
)
def test_a_broken_triangulator_is_one_line(here: Here, body: str, words: str):
    (here.folder / f"{here.module}.py").write_text(f"def f(rig, uv_left, uv_right):\n    {body}\n")
    assert here.run("sweep", "--triangulator", f"{here.module}:f", *SMALL, "--out", "out") == 1
    assert len(here.error.splitlines()) == 1, here.error
    assert words in here.error
    assert not (here.folder / "out").exists()


def test_a_report_is_not_overwritten_without_force(swept, here: Here):
    out, _ = swept
    before = (out / "report.html").read_bytes()
    assert here.run("sweep", "--baseline", "60", *SMALL, "--out", out) == 1
    assert "--force" in here.error
    assert (out / "report.html").read_bytes() == before


def test_the_same_bytes_for_any_number_of_processes(tmp_path: Path):
    for jobs, started in ((1, rigsim), (2, process)):
        done = started(
            "sweep", "--baseline", "60:120/3", *SMALL, "--renderer", "rays", "--jobs", jobs,
            "--out", f"out{jobs}", cwd=tmp_path,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
    for name in ("sweep.csv", "sweep_by_depth.csv"):
        assert (tmp_path / "out1" / name).read_bytes() == (tmp_path / "out2" / name).read_bytes()


@pytest.mark.parametrize("jobs", [1, 2])
def test_interrupt_keeps_what_is_done(tmp_path: Path, jobs: int):
    # Ctrl-C reaches the terminal's whole group; here the parent gets it when the third rig is being tried
    (tmp_path / "mine.py").write_text(
        "import os, pathlib, signal, rigsim\n"
        f"parent = {jobs} > 1\n"
        "def f(rig, uv_left, uv_right):\n"
        "    seen = pathlib.Path('seen')\n"
        "    with seen.open('a') as file:\n"
        "        file.write('x')\n"
        "    if len(seen.read_text()) == 6:\n"
        "        os.kill(os.getppid() if parent else os.getpid(), signal.SIGINT)\n"
        "    return rigsim.triangulate(rig, uv_left, uv_right)\n"
    )
    done = process(
        "sweep", "--baseline", "50:500/40", "--renderer", "rays", "--resolution", "160x120", "--points", 100,
        "--trials", 1, "--measure", "none", "--triangulator", "mine:f", "--in-process", "--jobs", jobs,
        "--out", "out", cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 130, done.stderr
    rows = pd.read_csv(tmp_path / "out" / "sweep.csv")
    assert 0 < len(rows) < 40
    assert "interrupted" in done.stdout
    assert {path.name for path in (tmp_path / "out").iterdir()} == FILES


def test_render_writes_a_pair_that_agrees_with_itself(tmp_path: Path):
    import numpy as np

    done = rigsim("render", "--resolution", "160x120", "--out", "pair", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    pair = tmp_path / "pair"
    depth, disparity = np.load(pair / "depth_left.npy"), np.load(pair / "disparity.npy")
    rig = pd.Series({"f": 900 / 8, "b": 0.12})
    seen = np.isfinite(disparity)
    assert 0.5 < seen.mean() < 1
    # d = f b / Z, the formula the page began with
    np.testing.assert_allclose(disparity[seen], (rig.f * rig.b / depth)[seen], rtol=1e-5)
    assert {path.name for path in pair.iterdir()} == {
        "left.png", "right.png", "depth_left.npy", "depth_right.npy", "disparity.npy",
        "segmentation_left.npy", "anaglyph.png", "disparity.png", "rig.toml", "provenance.json",
    }  # fmt: skip


def test_render_draws_a_lens_that_distorts(tmp_path: Path):
    import numpy as np
    from PIL import Image

    (tmp_path / "rig.toml").write_text(
        "".join(
            f"[{side}]\nwidth_px = 160\nheight_px = 120\nfx_px = 110\nfy_px = 110\n"
            f"cx_px = 79.5\ncy_px = 59.5\n[{side}.distortion]\nk1 = -0.1\n"
            for side in ("left", "right")
        )
        + "[right_from_left]\nrotvec_deg = [0, 0, 0]\nt_mm = [-120, 0, 0]\n"
    )
    done = rigsim("render", "--rig", "rig.toml", "--out", "pair", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    plain = rigsim("render", "--resolution", "160x120", "--focal", "110", "--out", "plain", cwd=tmp_path)
    assert plain.returncode == 0, plain.stderr
    bent, straight = (np.load(tmp_path / name / "depth_left.npy") for name in ("pair", "plain"))
    assert bent[60, 80] == pytest.approx(straight[60, 80], rel=1e-3)  # the middle stays
    # a barrel sees further out: the pixel at radius r_d shows what lies at r_d = r (1 - 0.1 r^2)
    r_d = 59.5 / 110
    r = min(np.roots([-0.1, 0, 1, -r_d]).real, key=lambda root: abs(root - r_d))
    assert round(79.5 - 110 * r) == 18
    assert bent[59, 20] == pytest.approx(straight[59, 18], rel=0.01)
    assert np.asarray(Image.open(tmp_path / "pair" / "left.png")).std() > 20


def test_scenes_and_doctor_speak(tmp_path: Path):
    scenes = rigsim("scenes", cwd=tmp_path)
    assert scenes.returncode == 0
    assert all(name in scenes.stdout for name in ("artifact", "bin", "boards", "branch", "corridor"))
    # cameras one can buy are presets' business
    assert not any(name in scenes.stdout for name in ("oak-d", "d435", "zed-mini"))
    doctor = rigsim("doctor", cwd=tmp_path)
    assert doctor.returncode == 0
    assert "rays" in doctor.stdout


@pytest.mark.parametrize("preset", ["osmesa", "egl", "glfw", "nonsense"])
def test_a_preset_gl_library_that_is_missing_does_no_harm(tmp_path: Path, preset: str):
    # importing mujoco with one of these set can kill the interpreter
    done = process(
        "render",
        "--renderer",
        "rays",
        "--resolution",
        "64x48",
        "--out",
        "out",
        cwd=tmp_path,
        MUJOCO_GL=preset,
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "left.png").exists()
