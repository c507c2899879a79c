"""Layouts of data sets: a new one is one file and its line in the registry."""

from __future__ import annotations

import io
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]

STACKED = '''
"""Both pictures one over the other, the calibration beside them."""

import numpy as np

from rigsim.interop.formats.opencv_yaml import FILE_NAME, opencv_yaml
from rigsim.interop.layouts.layout import Layout, png

LAYOUT = Layout(
    "stacked",
    "a picture a frame, left over right",
    lambda frame: {f"{frame.index}.png": png(np.vstack([frame.pictures.left, frame.pictures.right]))},
    opencv_yaml,
    lambda rig, poses: {FILE_NAME: opencv_yaml(rig)},
)
'''


def test_a_new_layout_is_one_file_and_its_lines_in_the_registry(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "rigsim", tmp_path / "rigsim", ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "models").symlink_to(ROOT / "models")
    room = tmp_path / "rigsim" / "interop" / "layouts"
    (room / "stacked.py").write_text(STACKED, encoding="utf-8")
    text = (room / "registry.py").read_text(encoding="utf-8")
    text = text.replace("middlebury, opencv\n", "middlebury, opencv, stacked\n", 1)
    text = text.replace("    colmap.LAYOUT,\n", "    colmap.LAYOUT,\n    stacked.LAYOUT,\n", 1)
    (room / "registry.py").write_text(text, encoding="utf-8")

    def export(format: str) -> subprocess.CompletedProcess[str]:
        words = ["--format", format, "--frames", "1", "--out", format, "--seed", "3"]
        words += ["--baseline", "60", "--focal", "60", "--resolution", "64x48", "--renderer", "rays"]
        return subprocess.run(
            [sys.executable, "-m", "rigsim", "export", "dataset", *words, "--json"],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(tmp_path)},
            capture_output=True,
            text=True,
            check=False,
        )

    done = export("stacked")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["format"] == "stacked"
    assert {path.name for path in (tmp_path / "stacked").iterdir()} == {
        "0.png",
        "stereo.yml",
        "manifest.json",
    }
    assert export("opencv").returncode == 0
    halves = [
        np.asarray(Image.open(io.BytesIO((tmp_path / "opencv" / side / "000000.png").read_bytes())))
        for side in ("left", "right")
    ]
    stacked = np.asarray(Image.open(tmp_path / "stacked" / "0.png"))
    assert np.array_equal(stacked, np.vstack(halves))
    refused = export("sideways")
    assert refused.returncode == 2
    assert "must be one of middlebury, kitti, opencv, colmap, stacked" in refused.stderr
