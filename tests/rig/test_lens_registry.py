"""Lens models: a new one is one file and its line in the registry, from projection to files and reports."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

# Fitzgibbon, CVPR 2001, forwards: r_d = r / (1 + k r^2), so k r_d r^2 - r + r_d = 0; r_d is greatest at 1/|k|
DIVISION = '''
"""The division model, x_d = x / (1 + k r^2)."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.lens.planar import PlanarLens


@dataclass(frozen=True, slots=True)
class Division(PlanarLens):
    """One coefficient, k."""

    model: ClassVar[str] = "division"
    title: ClassVar[str] = "division model"

    k: float

    @property
    def is_ideal(self) -> bool:
        return self.k == 0

    @property
    def fold_radius2(self) -> float:
        return float(1 / abs(self.k)) if self.k else np.inf

    def distort(self, normalized: Array) -> Array:
        return normalized / (1 + self.k * np.sum(normalized**2, axis=-1, keepdims=True))

    def undistort(self, distorted: Array) -> Array:
        with np.errstate(invalid="ignore"):
            root = np.sqrt(1 - 4 * self.k * np.sum(distorted**2, axis=-1, keepdims=True))
        return 2 * distorted / (1 + root)

    def slope(self, normalized: Array) -> Array:
        below = (1 + self.k * np.sum(normalized**2, axis=-1))[..., None, None]
        outer = normalized[..., :, None] * normalized[..., None, :]
        return np.eye(2) / below - 2 * self.k * outer / below**2

    def distort_slopes(self, normalized: Array) -> Array:
        r2 = np.sum(normalized**2, axis=-1, keepdims=True)
        return (-normalized * r2 / (1 + self.k * r2) ** 2)[..., None]
'''

TRIAL = """
import json, sys
from dataclasses import replace
import numpy as np
import rigsim
from rigsim.pixels.opencv_triangulation import triangulate_cv2
from rigsim.rig.lens.division import Division
from rigsim.study.tolerance.batch import PARAMETERS, RigBatch, read_rays_near

said = {}
lens = rigsim.Intrinsics(640, 480, 300.0, 300.0, 319.5, 239.5, Division(0.25))
said["seen"] = lens.project([[1.2, 1.6, 2.0], [2.2, 0.0, 1.0]]).tolist()
said["ideal"] = lens.normalize([[559.5, 239.5], [623.0, 239.5]]).tolist()
pose = rigsim.Pose.from_rotvec((0.02, -0.1, 0.03), (-0.2, 0.01, 0.0))
rig = rigsim.StereoRig(lens, replace(lens, fx=320.0, lens=Division(-0.1)), pose)
text = rigsim.write_rig(rig)
said["text"] = text
open("rig.toml", "w").write(text)
mild = rigsim.Intrinsics(320, 240, 250.0, 250.0, 159.5, 119.5, Division(0.15))
open("mild.toml", "w").write(rigsim.write_rig(rigsim.StereoRig.rectified(mild, 0.1)))
said["same"] = rigsim.read_rig("rig.toml") == rig
points = np.array([[0.9, 0.7, 1.5], [-0.5, 0.3, 2.0], [0.0, 0.0, 4.0]])
found = rigsim.triangulate(rig, *rig.project(points), "optimal")
said["off_m"] = float(np.abs(found - points).max())

rng = np.random.default_rng(5)
noise = rigsim.PixelNoise(0.25)
pinholes = replace(rig, left=replace(rig.left, lens=None), right=replace(rig.right, lens=None))
one = points[:1]
for name, assumed in (("predicted", rig), ("of_pinholes", pinholes)):
    said[name] = float(np.sqrt(rigsim.predict_covariance(assumed, one, noise)[0, 2, 2]))
uv_left, uv_right = (np.repeat(uv, 10000, axis=0) for uv in rig.project(one))
noisy = [uv + 0.25 * rng.standard_normal(uv.shape) for uv in (uv_left, uv_right)]
said["simulated"] = float(rigsim.triangulate(rig, *noisy, "optimal")[:, 2].std())
refused = {}
for what, do in {
    "opencv": lambda: rigsim.export_rig(rig, "opencv"),
    "cv2": lambda: triangulate_cv2(rig, uv_left, uv_right),
    "k1": lambda: rigsim.Perturbation(both_k1=0.01).apply(rig),
    "tolerance": lambda: rigsim.tolerance(rig, range_m=(1, 3), tolerances={"right_k1": 0.01}),
}.items():
    try:
        do()
    except rigsim.RigsimError as error:
        refused[what] = str(error)
slips = {"model": ('"division"', '"fisheye"'), "key": ("k = 0.25", "k1 = 1"), "term": ("k = 0.25", "")}
for what, change in slips.items():
    open("bad.toml", "w").write(text.replace(*change, 1))
    try:
        rigsim.read_rig("bad.toml")
    except rigsim.RigsimError as error:
        refused[what] = str(error)
said["refused"] = refused
said["built"] = repr(rigsim.tolerance(
    rig, range_m=(1, 3), tolerances={"right_k1": 0, "both_k1": 0}, rigs=60, points=40
).verdict)
turned = rigsim.Perturbation(yaw_rad=1e-4).apply(rig)
seen = np.stack([*turned.left.project(points).T, *turned.project(points)[1].T])
theta = np.zeros((1, len(PARAMETERS)))
theta[0, PARAMETERS.index("yaw_rad")] = 1e-4
pixels = RigBatch(rig, theta).project(points)
said["batch_off_px"] = float(np.abs(pixels[:, 0] - seen).max())
read = read_rays_near(rig, pixels, points)
again = np.stack(RigBatch(rig, 0 * theta).triangulate(read))[:, 0].T
exact = rigsim.triangulate(rig, seen[:2].T, seen[2:].T, "optimal")
said["batch_off_m"] = float(np.abs(again - exact).max())
said["moved_m"] = float(np.abs(exact - points).max())
print(json.dumps(said))
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the package with a lens more: one file, and its lines in the registry."""
    folder = tmp_path_factory.mktemp("lens")
    shutil.copytree(ROOT / "rigsim", folder / "rigsim", ignore=shutil.ignore_patterns("__pycache__"))
    (folder / "models").symlink_to(ROOT / "models")
    lenses = folder / "rigsim" / "rig" / "lens"
    (lenses / "division.py").write_text(DIVISION, encoding="utf-8")
    text = (lenses / "registry.py").read_text(encoding="utf-8")
    text = text.replace("import distortion, ", "import distortion, division, ", 1)
    text = text.replace("fov.FieldOfView,", "fov.FieldOfView, division.Division,", 1)
    (lenses / "registry.py").write_text(text, encoding="utf-8")
    return folder


def _run(place: Path, *words: str) -> subprocess.CompletedProcess[str]:
    env = {**os.environ, "PYTHONPATH": str(place)}
    return subprocess.run(
        [sys.executable, *words], cwd=place, env=env, capture_output=True, text=True, check=False
    )


@pytest.fixture(scope="module")
def said(place: Path) -> dict[str, object]:
    done = _run(place, "-c", TRIAL)
    assert done.returncode == 0, done.stderr
    document = json.loads(done.stdout.replace("NaN", "null"))
    assert isinstance(document, dict)
    return document


def test_a_new_lens_projects_and_undistorts(said: dict[str, object]) -> None:
    # (0.6, 0.8) over 1 + 0.25: (0.48, 0.64), 300 px each; x/z = 2.2 lies past the fold at 1/sqrt(k) = 2
    assert said["seen"] == [pytest.approx([319.5 + 144, 239.5 + 192], abs=1e-9), [None, None]]
    # seen 0.8: root sqrt(1 - 0.64) = 0.6, ideal 1.6 / 1.6 = 1; seen 1.012 is past the image of the fold, 1
    assert said["ideal"] == [pytest.approx([1.0, 0.0], abs=1e-12), [None, None]]


def test_a_new_lens_is_written_read_triangulated_and_predicted(said: dict[str, object]) -> None:
    text = str(said["text"])
    assert '[left.distortion]\nmodel = "division"\nk = 0.25\n' in text
    assert '[right.distortion]\nmodel = "division"\nk = -0.1\n' in text
    assert said["same"] is True
    assert said["off_m"] == pytest.approx(0, abs=1e-10)
    # 10,000 trials tell a standard deviation to 0.7 %
    assert said["predicted"] == pytest.approx(said["simulated"], rel=0.03)
    assert said["predicted"] != pytest.approx(said["of_pinholes"], rel=0.1)


def test_what_has_another_lens_alone_says_so_in_one_line(said: dict[str, object]) -> None:
    refused = said["refused"]
    assert isinstance(refused, dict)
    alone = "takes Brown-Conrady's k1, k2, p1, p2, k3 alone"
    assert refused["opencv"] == (
        "format opencv: lens division with k 0.25: OpenCV, beside fisheyes and omnidirectional ones, takes "
        "OpenCV's terms alone (brown, rational); formats that hold this rig: none but rig.toml "
        "(rigsim.write_rig); or fit its nearest lens with --approximate"
    )
    assert refused["cv2"] == (
        "triangulator 'cv2': OpenCV undistorts no points of a division lens: use 'optimal'"
    )
    assert refused["k1"] == f"lens division with k 0.25: a change of k1 {alone}"
    assert refused["tolerance"] == (
        "tolerance of right k1 0.01: is of Brown-Conrady lenses, one is a division: leave it out"
    )
    assert (
        refused["model"] == "bad.toml: left.distortion.model 'fisheye': must be one of brown, rational, "
        "kannala_brandt, mei, double_sphere, eucm, fov, division"
    )
    assert refused["key"] == "bad.toml: unknown key left.distortion.k1: must be one of k, model"
    assert refused["term"] == "bad.toml: left.distortion.k is missing: add it"


def test_a_new_lens_has_tolerances(said: dict[str, object]) -> None:
    assert said["built"]
    assert said["batch_off_px"] == pytest.approx(0, abs=1e-9)
    # one step towards the pixels whose rays meet differs from all steps in second order alone
    moved = said["moved_m"]
    assert isinstance(moved, float)
    assert moved > 1e-3
    assert said["batch_off_m"] == pytest.approx(0, abs=1e-3 * moved)


def test_a_new_lens_is_swept_and_agrees(place: Path, said: dict[str, object]) -> None:
    small = ["--points", "200", "--trials", "20", "--measure", "none", "--json"]
    done = _run(place, "-m", "rigsim", "sweep", "--rig", "mild.toml", *small)
    assert done.returncode == 0, done.stderr
    row = json.loads(done.stdout)["rows"][0]
    assert row["predicted_over_simulated"] == pytest.approx(1, abs=0.1)
