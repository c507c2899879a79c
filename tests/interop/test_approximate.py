"""`export rig --approximate`: what is fitted, and whether what is told of it is true."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from rigsim.cli.app import run
from rigsim.errors import InvalidRig
from rigsim.interop.formats.calibration import read_calibration
from rigsim.interop.formats.registry import approximate_files, rig_files
from rigsim.interop.formats.rig_toml import write_rig
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.fov import FieldOfView
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.rational import Rational
from rigsim.rig.stereo import StereoRig
from rigsim.study.export.approximate import FAMILIES, nearest


def camera(lens: Lens | None, focal: float = 300.0) -> Intrinsics:
    return Intrinsics(640, 480, focal, 1.02 * focal, 322.0, 236.5, lens)


FAMILY = {family.lens.model: family for family in FAMILIES if family.lens is not None}


def test_a_special_case_is_found_exactly() -> None:
    own = camera(BrownConrady(-0.2, 0.05, 1e-3, -2e-3), 700.0)
    found = nearest(own, FAMILY["rational"])
    assert found is not None
    assert found.rms_px < 1e-4
    assert (found.camera.fx, found.camera.cx) == pytest.approx((700.0, 322.0), abs=1e-2)
    itself = nearest(own, FAMILY["brown"])
    assert itself is not None
    assert itself.camera is own


def test_what_is_told_is_what_it_is_off_by() -> None:
    own = camera(FieldOfView(0.9))
    found = nearest(own, FAMILY["eucm"])
    assert found is not None
    # other pixels than those it was fitted to
    rng = np.random.default_rng(5)
    uv = rng.uniform(-0.5, [639.5, 479.5], (4000, 2))
    off = np.linalg.norm(found.camera.project(own.ray(uv)) - uv, axis=1)
    assert np.sqrt(np.mean(off**2)) == pytest.approx(found.rms_px, rel=0.1)
    assert off.max() <= 1.05 * found.largest_px
    assert 1e-3 < found.rms_px < 0.2


def test_no_plane_shows_what_lies_beside_the_camera() -> None:
    wide = Intrinsics(640, 640, 180.0, 180.0, 319.5, 319.5, KannalaBrandt(0.01))
    assert wide.hfov_deg > 190
    assert nearest(wide, FAMILY["rational"]) is None
    rig = StereoRig.rectified(wide, 0.1)
    with pytest.raises(InvalidRig, match="no lens that it has shows all that these do") as caught:
        approximate_files(rig, "mrcal")
    assert "\n" not in str(caught.value)


def test_the_way_out_is_named_and_leads_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    own = camera(FieldOfView(0.9))
    rig = StereoRig.rectified(own, 0.1)
    with pytest.raises(
        InvalidRig, match=r"hold this rig: kalibr, basalt, colmap; or fit its nearest lens with --approximate"
    ):
        rig_files(rig, "opencv")
    (tmp_path / "rig.toml").write_text(write_rig(rig))
    words = [
        "export",
        "rig",
        "--rig",
        str(tmp_path / "rig.toml"),
        "--format",
        "opencv",
        "--out",
        str(tmp_path / "out"),
    ]
    assert run([*words, "--approximate", "--json"]) == 0
    said = capsys.readouterr()
    remarks = [remark for remark in json.loads(said.out)["remarks"] if remark["code"] == "approximate"]
    assert len(remarks) == 2
    told = re.search(
        r"the left lens, fov, was fitted by (\w+): off by (\S+) px rms over the image, (\S+) px",
        remarks[0]["text"],
    )
    assert told is not None
    assert told[0] in said.err
    found = read_calibration(tmp_path / "out")
    assert found.left.lens is not None
    assert found.left.lens.model == told[1] == "kannala_brandt"
    u, v = np.meshgrid(np.linspace(0, 639, 50), np.linspace(0, 479, 40))
    uv = np.stack([u.ravel(), v.ravel()], axis=1)
    off = np.linalg.norm(found.left.project(own.ray(uv)) - uv, axis=1)
    assert np.sqrt(np.mean(off**2)) == pytest.approx(float(told[2]), rel=0.2)
    assert found.right_from_left == rig.right_from_left


def test_what_a_format_has_is_left_alone() -> None:
    rig = StereoRig.rectified(camera(Rational(0.1, k4=0.05), 700.0), 0.1)
    assert approximate_files(rig, "mrcal") == (rig_files(rig, "mrcal"), ())
