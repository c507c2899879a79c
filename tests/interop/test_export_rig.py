"""`rigsim export rig`, and what `--rig` takes."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given

from rigsim.cli.app import run
from rigsim.errors import InvalidRange, InvalidRig, OutputError
from rigsim.interop.files.dataset import DATASET_FORMATS
from rigsim.interop.formats.calibration import read_calibration
from rigsim.interop.formats.kitti.kitti import calib_cam_to_cam, parse_kitti
from rigsim.interop.formats.middlebury import calib_text, parse_calib
from rigsim.interop.formats.registry import RIG_FORMATS, rig_files
from rigsim.interop.formats.rig_toml import write_rig
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from tests.helpers.documents import valid
from tests.helpers.rig_strategies import lenses, rectified_rigs, same_rig

LENS = Intrinsics(640, 480, 800.0, 800.0, 320.0, 240.0)
RIG = StereoRig.rectified(LENS, 0.12)
DOFFS = StereoRig.rectified(LENS, 0.12, right=Intrinsics(640, 480, 800.0, 800.0, 331.0, 240.0))

# --- calib.txt and KITTI ------------------------------------------------------------------------


def test_calib_by_hand() -> None:
    assert calib_text(DOFFS, (3.2, 60.5)) == (
        "cam0=[800.0 0 320.0; 0 800.0 240.0; 0 0 1]\n"
        "cam1=[800.0 0 331.0; 0 800.0 240.0; 0 0 1]\n"
        "doffs=11.0\nbaseline=120.0\nwidth=640\nheight=480\nndisp=61\nisint=0\nvmin=3\nvmax=61\n"
    )


@given(rectified_rigs())
def test_calib_there_and_back(rig: StereoRig) -> None:
    same_rig(parse_calib(calib_text(rig)).rig, rig)


# the rectified colour cameras of KITTI 2015's first training pair
KITTI = """calib_time: 09-Jan-2012 13:57:47
S_rect_02: 1.242000e+03 3.750000e+02
P_rect_02: 7.215377e+02 0.000000e+00 6.095593e+02 4.485728e+01 0.000000e+00 7.215377e+02 1.728540e+02 \
2.163791e-01 0.000000e+00 0.000000e+00 1.000000e+00 2.745884e-03
P_rect_03: 7.215377e+02 0.000000e+00 6.095593e+02 -3.395242e+02 0.000000e+00 7.215377e+02 1.728540e+02 \
2.199936e+00 0.000000e+00 0.000000e+00 1.000000e+00 2.729905e-03
"""


def test_kitti_s_own_file() -> None:
    rig = parse_kitti(KITTI).rig
    # x: ((44.85728 - 609.5593 * .002745884) + (339.5242 + 609.5593 * .002729905)) / 721.5377
    assert -rig.right_from_left.t[0] == pytest.approx(0.5327119, abs=1e-6)
    assert rig.right_from_left.t[0] < 0
    # z: 2.729905 - 2.745884 mm; y: (2.199936 - .2163791 - 172.854 * (.002729905 - .002745884)) / 721.5377
    np.testing.assert_allclose(rig.right_from_left.t[1:], [2.7529e-3, -1.5979e-5], rtol=1e-4)
    assert (rig.left.width, rig.left.height, rig.left.cx) == (1242, 375, 609.5593)


def test_kitti_by_hand() -> None:
    lines = dict(line.split(": ") for line in calib_cam_to_cam(RIG).splitlines())
    assert lines["S_rect_02"] == "640.0 480.0"
    assert lines["P_rect_02"] == "800.0 0.0 320.0 0.0 0.0 800.0 240.0 0.0 0.0 0.0 1.0 0.0"
    assert lines["P_rect_03"].split()[3] == "-96.0"  # 800 px * 0.12 m


@given(lenses(distorted=False))
def test_kitti_there_and_back(lens: Intrinsics) -> None:
    rig = StereoRig.rectified(lens, 0.3)
    same_rig(parse_kitti(calib_cam_to_cam(rig)).rig, rig)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("P_rect_03", "P_rect_01", r"has camera 1, 2: must have 2 and 3 \(colour\) or 0 and 1"),
        ("S_rect_02: 1.242000e+03", "S_rect_02:", "S_rect_02: 3.750000e.02: must be 2 numbers"),
        ("P_rect_03: 7.2", "P_rect_03: 7.1", "must share focal lengths and cy"),
    ],
)
def test_bad_kitti_is_one_line(old: str, new: str, message: str) -> None:
    with pytest.raises(InvalidRig, match=message):
        parse_kitti(KITTI.replace(old, new, 1))


# --- any format ---------------------------------------------------------------------------------


@pytest.mark.parametrize("format", RIG_FORMATS)
def test_every_format_is_read_from_its_folder_and_its_file(format: str, tmp_path: Path) -> None:
    files = rig_files(DOFFS, format)
    for name, content in files.items():
        (tmp_path / name).write_bytes(content)
    same_rig(read_calibration(tmp_path), DOFFS)
    for name in files:
        if name not in ("frames.txt", "points3D.txt"):
            same_rig(read_calibration(tmp_path / name), DOFFS)


@pytest.mark.parametrize("format", RIG_FORMATS)
def test_the_command_writes_what_rig_takes(
    format: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["--baseline", "120", "--focal", "800", "--resolution", "640x480"]
    assert run(["export", "rig", *words, "--format", format, "--out", "out"]) == 0
    names = sorted(path.name for path in Path("out").iterdir())
    said = capsys.readouterr().out.strip()
    assert said == f"out: {', '.join(rig_files(RIG, format))}; read it back with --rig out"
    assert names == sorted(rig_files(RIG, format))
    assert run(["calc", "point", "--rig", "out", "--left", "400,240", "--right", "352,240"]) == 0
    assert "2000" in capsys.readouterr().out.replace(",", "")  # 800 * 120 / 48 mm
    assert run(["export", "rig", *words, "--format", format, "--out", "out"]) == 1
    assert "already holds" in capsys.readouterr().err
    assert run(["export", "rig", *words, "--format", format, "--out", "out", "--force", "--json"]) == 0
    document = valid("export-rig", capsys.readouterr().out)
    assert (document["format"], document["written"]) == (format, {"folder": "out", "files": names})
    assert document["rig"]["baseline_mm"] == 120
    assert document["rig"]["rectified"]


@pytest.mark.parametrize(
    ("rig", "format", "able"),
    [
        (
            StereoRig.rectified(Intrinsics(640, 480, 800, 800, 320, 240, BrownConrady(k3=0.1)), 0.1),
            "kalibr",
            "opencv, ros, basalt, colmap, nerfstudio, mrcal",
        ),
        (
            StereoRig.rectified(Intrinsics(640, 480, 800, 800, 320, 240, BrownConrady(k1=0.1)), 0.1),
            "mjcf",
            "opencv, ros, kalibr, basalt, colmap, nerfstudio, mrcal",
        ),
        (
            StereoRig.verged(LENS, 0.1, 5.0),
            "middlebury",
            "opencv, ros, kalibr, basalt, colmap, mjcf, nerfstudio, mrcal",
        ),
        (
            StereoRig(LENS, LENS, Pose(t=np.array([0.0, 0.0, -0.4]))),
            "ros",
            "opencv, kalibr, basalt, colmap, mjcf, nerfstudio, mrcal",
        ),
    ],
)
def test_a_rig_that_a_format_cannot_hold(rig: StereoRig, format: str, able: str) -> None:
    with pytest.raises(InvalidRig) as caught:
        rig_files(rig, format)
    assert str(caught.value).startswith(f"format {format}: ")
    # where the lens is what is in the way, one that is not can be fitted
    fit = "; or fit its nearest lens with --approximate" if format in ("kalibr", "mjcf") else ""
    assert str(caught.value).endswith(f"; formats that hold this rig: {able}{fit}")
    assert "\n" not in str(caught.value)


def test_calib_of_two_sizes_is_refused() -> None:
    rig = StereoRig.rectified(LENS, 0.1, right=Intrinsics(600, 480, 800.0, 800.0, 320.0, 240.0))
    with pytest.raises(InvalidRig, match="640x480 and 600x480 px: calib"):
        rig_files(rig, "middlebury")
    with pytest.raises(InvalidRange, match="format 'matlab': must be one of opencv, ros"):
        rig_files(rig, "matlab")


def test_sizes_that_differ_are_kept(tmp_path: Path) -> None:
    rig = StereoRig.rectified(LENS, 0.1, right=Intrinsics(600, 470, 800.0, 800.0, 320.0, 240.0))
    for format in ("opencv", "ros", "kalibr", "colmap", "mjcf", "nerfstudio"):
        (tmp_path / format).mkdir()
        for name, content in rig_files(rig, format).items():
            (tmp_path / format / name).write_bytes(content)
        same_rig(read_calibration(tmp_path / format), rig)


def test_kitti_and_toml_are_told_by_what_they_say(tmp_path: Path) -> None:
    (tmp_path / "000000.txt").write_text(KITTI)
    assert read_calibration(tmp_path / "000000.txt").left.fx == 721.5377
    (tmp_path / "mine.xml").write_text(write_rig(RIG))
    assert read_calibration(tmp_path / "mine.xml") == RIG


def test_folders_that_say_nothing_or_too_much(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="holds no calibration; name a folder with rig"):
        read_calibration(tmp_path)
    for format, rig in (("opencv", RIG), ("kalibr", StereoRig.rectified(LENS, 0.15))):
        for name, content in rig_files(rig, format).items():
            (tmp_path / name).write_bytes(content)
    with pytest.raises(OutputError, match=r"holds stereo\.yml, camchain\.yaml; name one of them"):
        read_calibration(tmp_path)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        (
            "stereo.yml",
            "rows: [1",
            "stereo.yml: looks like YAML, but is not YAML: line .* that are read: rig",
        ),
        ("stereo.yml", "", "stereo.yml: is empty; calibrations that are read: rig.toml, opencv"),
        ("stereo.yml", "K1: 5\nimage_width: 1", "stereo.yml: looks like YAML with K1, image_width; "),
        (
            "stereo.yml",
            "%YAML:1.0\n---\nK1: !!opencv-matrix\n   rows: 3",
            "stereo.yml: matrix in line 3: cols",
        ),
        ("calib.txt", "cam0=1", "calib.txt: cam0=1: must be"),
        ("calib.txt", "nothing", "calib.txt: looks like text; calibrations"),
        ("calib.txt", "1 2 3\n4 5 6", "calib.txt: looks like a table of numbers; "),
        ("rig.toml", "<!DOCTYPE html><html>", "rig.toml: looks like a web page .HTML.: save the file itself"),
        ("rig.toml", "\x89PNG\r\n", "rig.toml: looks like a PNG picture; "),
        ("rig.toml", "a\x00b", "rig.toml: looks like binary data; "),
        ("rig.xml", "<robot name='x'/>", "rig.xml: looks like XML with the root robot; "),
        ("cameras.txt", "1 PINHOLE", "COLMAP's cameras.txt, and no rigs.txt or images.txt lies beside it"),
        ("rig.xml", "<mujoco", "rig.xml: is not XML"),
        ("transforms.json", "{}", "transforms.json: looks like JSON with nothing; "),
        ("left.yaml", "camera_matrix: 1", "left.yaml: camera_info of one camera: name the other's beside it"),
        ("rig.toml", "a = 1", "rig.toml: "),
    ],
)
def test_malformed_files_are_one_line_of_the_command(
    name: str, content: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / name).write_text(content, encoding="latin-1")
    assert run(["calc", "limits", "--rig", str(tmp_path / name)]) == 1
    said = capsys.readouterr().err
    assert re.search(message, said), said
    assert said.count("\n") == 1


def test_the_command_says_what_is_missing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = str(tmp_path / "out")
    assert run(["export", "rig", "--format", "ros", "--out", out]) == 2
    assert "--rig is missing: give a file, or --preset" in capsys.readouterr().err
    assert run(["export", "rig", "--preset", "boards", "--format", "ross", "--out", out]) == 2
    assert "format 'ross': must be one of opencv" in capsys.readouterr().err
    assert run(["export", "rig", "--baseline", "100", "--focal", "800", "--format", "ros", "--out", out]) == 2
    assert "an export needs --resolution" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


DOCUMENT = (Path(__file__).parents[2] / "docs" / "reference" / "export.md").read_text()


def test_what_the_document_shows_is_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    blocks = re.findall(r"```text\n\$ \./run (.*?)\n(.*?)```", DOCUMENT, re.DOTALL)
    assert len(blocks) == 4
    for command, shown in blocks:
        if "dataset" in command:
            continue
        run(shlex.split(command))
        said = capsys.readouterr()
        lines = (said.out + said.err).strip().splitlines()
        assert [line.rstrip() for line in lines] == shown.strip().splitlines()
    (example,) = re.findall(r"```python\n(.*?)```", DOCUMENT, re.DOTALL)
    exec(compile(example, "export.md", "exec"), {})
    same_rig(read_calibration(tmp_path / "stereo.yml"), read_calibration(tmp_path / "calibration"))


def test_the_document_names_every_format() -> None:
    rows = re.findall(r"^\| `(\w+)` \|", DOCUMENT, re.MULTILINE)
    assert rows == [*RIG_FORMATS, *DATASET_FORMATS]


@pytest.mark.parametrize("format", ["opencv", "kalibr", "colmap"])
def test_a_right_camera_on_the_left_is_told_and_read(
    format: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    exchanged = StereoRig(RIG.right, RIG.left, RIG.right_from_left.inverse)
    for name, content in rig_files(exchanged, format).items():
        (tmp_path / name).write_bytes(content)
    same_rig(read_calibration(tmp_path), exchanged)
    assert run(["calc", "depth", "--z", "3m", "--rig", str(tmp_path)]) == 0
    said = capsys.readouterr().err.splitlines()
    assert [
        line
        for line in said
        if "120 mm to the left of the left one: exchange the cameras with --rig-swap" in line
    ]
    assert run(["calc", "depth", "--z", "3m", "--rig", str(tmp_path), "--rig-swap"]) == 0
    said = capsys.readouterr()
    assert said.err == ""
    assert "32" in said.out  # 800 px * 120 mm / 3 m


def test_a_vertical_pair_is_not_called_exchanged(tmp_path: Path) -> None:
    above = StereoRig(RIG.left, RIG.right, Pose(np.eye(3), np.array([0.01, 0.2, 0.0])))
    (tmp_path / "stereo.yml").write_bytes(rig_files(above, "opencv")["stereo.yml"])
    same_rig(read_calibration(tmp_path), above)
