"""What a person says beside a calibration: unit, size, sides; and what is said back."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import rigsim
from rigsim.cli.app import run
from rigsim.errors import InvalidRange, InvalidRig, OutputError
from rigsim.interop.formats.calibration import parse, read
from rigsim.interop.formats.format import Asked
from rigsim.interop.formats.kit.reading import RigReading, metres
from rigsim.interop.formats.registry import rig_files
from rigsim.interop.formats.values import size_or_guess
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig


def text(x: float, y: float = 0.0, size: str = "image_size: [640, 480]", cx: float = 319.0) -> str:
    K = f"[600, 0, {cx}, 0, 600, 241, 0, 0, 1]"
    right = f"[610, 0, {cx}, 0, 610, 239, 0, 0, 1]"
    return f"{size}\nK1: {K}\nK2: {right}\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [{x}, {y}, 0]\n"


@pytest.mark.parametrize(
    ("unit", "length_m"),
    [
        ("mm", 1e-3),
        ("cm", 0.01),
        ("m", 1.0),
        ("in", 0.0254),
        ("25mm", 0.025),
        ("2.5 cm", 0.025),
        ("1.5IN", 0.0381),
    ],
)
def test_units_by_hand(unit: str, length_m: float) -> None:
    assert metres(unit) == pytest.approx(length_m, rel=1e-15)
    rig = parse(text(-4), RigReading(unit=unit)).rig
    assert rig.right_from_left.t.tolist() == [pytest.approx(-4 * length_m), 0, 0]


@pytest.mark.parametrize("unit", ["", "km", "0mm", "-1mm", "1e3mm", "mmm", "25", "m" * 1000])
def test_a_unit_that_is_none_is_one_line(unit: str) -> None:
    with pytest.raises(
        InvalidRange, match="must be mm, cm, m or in, or the side of a board's squares, as 25mm"
    ):
        parse(text(-4), RigReading(unit=unit))


def test_a_baseline_that_no_rig_has_asks_for_the_unit() -> None:
    with pytest.raises(InvalidRig) as caught:
        parse(text(-62.5))
    assert str(caught.value) == (
        "rig: the unit of its lengths is not said, and a baseline of 62.5 can be 62.5 mm with --rig-unit mm,"
        " 625 mm with cm, 1562 mm with 25mm (squares of 25 mm): choose one"
    )
    with pytest.raises(InvalidRig, match=r"0\.5 mm with --rig-unit m, 0\.0127 mm with in"):
        parse(text(-0.0005))
    assert parse(text(-0.0005), RigReading(unit="m")).rig.baseline_m == 0.0005


@pytest.mark.parametrize(
    ("x", "codes"), [(-0.06, []), (-1.5, ["unit"]), (-0.008, ["unit"]), (-1.0, []), (-0.01, [])]
)
def test_an_odd_baseline_is_said(x: float, codes: list[str]) -> None:
    assert [remark.code for remark in parse(text(x)).remarks] == codes
    assert parse(text(x), RigReading(unit="m")).remarks == ()


def test_a_file_that_says_its_unit_is_believed() -> None:
    found = parse(text(-62.5) + "unit: mm\n")
    assert (found.unit, found.rig.baseline_m) == ("mm", pytest.approx(0.0625))
    rig = StereoRig(*[Intrinsics.from_focal(640, 480, 600.0)] * 2, Pose(t=np.array([-9.0, 0.0, 0.0])))
    (content,) = rig_files(rig, "opencv").values()
    assert parse(content).rig == rig  # rigsim's own file is in metres


def test_a_unit_that_the_format_fixes_is_not_said_again() -> None:
    toml = rigsim.write_rig(rigsim.preset("bin").rig)
    for unit in ("mm", "m", "25mm"):
        with pytest.raises(InvalidRig, match=r"rig.toml is in mm always; leave --rig-unit out"):
            parse(toml, RigReading(unit=unit))


def test_sides_exchanged_are_read_as_they_stand_and_said() -> None:
    found = parse(text(0.06))
    assert found.rig.right_from_left.t.tolist() == [0.06, 0, 0]
    assert [remark.code for remark in found.remarks] == ["swapped"]
    assert "60 mm to the left of the left one: exchange the cameras with --rig-swap" in found.remarks[0].text
    turned = parse(text(0.06), RigReading(swap=True))
    assert (turned.rig.left.fx, turned.rig.right.fx, turned.remarks) == (610, 600, ())
    assert turned.rig.right_from_left.t.tolist() == [-0.06, 0, 0]
    assert parse(text(0.06), RigReading(cameras=("right", "left"))).rig == turned.rig
    assert parse(text(0.0, 0.06)).remarks == ()  # one above the other


def test_a_size_is_said_guessed_or_contradicted() -> None:
    assert parse(text(-0.06, size=""), RigReading(size_px=(648, 488))).rig.left.width == 648
    found = parse(text(-0.06, size=""))
    assert (found.rig.left.width, found.rig.left.height) == (640, 480)
    assert [remark.code for remark in found.remarks] == ["no_size"]
    with pytest.raises(
        InvalidRig, match=r"size 1280x720: contradicts the file's own 640x480; leave --rig-size out"
    ):
        parse(text(-0.06), RigReading(size_px=(1280, 720)))
    with pytest.raises(InvalidRig, match="has no image size: give it as --rig-size 1280x720"):
        parse(text(-0.06, size="", cx=5000))


def test_the_guess_by_hand() -> None:
    # 641.2, 355: 4.8 px from the middle of 1280x720, 44.5 from that of 1280x800
    assert size_or_guess(Asked(), [(640.4, 350), (642, 360)])[:2] == (1280, 720)
    # a region down to row 760 needs more than 720 rows
    assert size_or_guess(Asked(), [(640.4, 350), (642, 360)], (900, 760))[:2] == (1280, 800)
    with pytest.raises(InvalidRig, match="image size 640x480: the file has regions up to 900,760 px"):
        size_or_guess(Asked((640, 480)), [(320, 240)], (900, 760))


def test_cameras_that_there_are_not() -> None:
    with pytest.raises(InvalidRig, match="cameras cam4,cam5: the file has left and right"):
        parse(text(-0.06), RigReading(cameras=("cam4", "cam5")))


def test_a_mode_that_there_is_not() -> None:
    with pytest.raises(InvalidRig, match="mode 'HD': opencv has no modes; leave --rig-mode out"):
        parse(text(-0.06), RigReading(mode="HD"))


def test_several_files(tmp_path: Path) -> None:
    (tmp_path / "a.yml").write_text(text(-0.06))
    (tmp_path / "b.txt").write_bytes(rig_files(parse(text(-0.06)).rig, "kalibr")["camchain.yaml"])
    assert read([tmp_path]).format == "kalibr"  # both say the same; this one says the unit
    with pytest.raises(
        InvalidRig, match=r"not the files of one calibration: a\.yml is opencv; b\.txt is kalibr"
    ):
        read([tmp_path / "a.yml", tmp_path / "b.txt"])
    (tmp_path / "b.txt").write_text(text(-0.07))
    with pytest.raises(OutputError, match=r"holds a\.yml, b\.txt; name one of them"):
        read([tmp_path])
    assert read([tmp_path / "b.txt"]).rig.baseline_m == 0.07


def test_the_options_on_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "mine"
    path.write_text(text(60, size=""))
    rig = ["--rig", str(path), "--rig-unit", "mm", "--rig-size", "644x482", "--rig-swap"]
    assert run(["export", "rig", *rig, "--format", "kalibr", "--out", str(tmp_path / "out"), "--json"]) == 0
    said = capsys.readouterr()
    assert said.err == ""
    assert json.loads(said.out)["rig"]["baseline_mm"] == 60
    assert run(["calc", "depth", "--z", "3m", "--rig", str(path), "--rig-unit", "mm", "--json"]) == 0
    said = capsys.readouterr()
    notes = [line for line in said.err.splitlines() if line.startswith("rigsim: note: ")]
    codes = [remark["code"] for remark in json.loads(said.out)["remarks"]]
    assert (codes[:2], len(notes)) == (["no_size", "swapped"], len(codes))
    for words, message in (
        (["--rig-unit", "mm"], "--rig-... says something of a calibration: name its file with --rig"),
        (["--rig", str(path), "--rig-cameras", "a"], "name the left and the right one, as 0,1"),
        (["--rig", str(path), "--rig-size", "640x480,1280x720"], "must be one width and height"),
    ):
        assert run(["calc", "depth", "--z", "3m", *words]) == 2
        assert message in capsys.readouterr().err
    (tmp_path / "two").mkdir()
    lines = text(-60).splitlines()
    for name, part in (("intrinsics.yml", lines[:3]), ("extrinsics.yml", lines[3:])):
        (tmp_path / "two" / name).write_text("\n".join(part))
    both = [f"--rig={tmp_path / 'two' / name}" for name in ("intrinsics.yml", "extrinsics.yml")]
    assert run(["calc", "depth", "--z", "3m", *both, "--rig-unit", "mm"]) == 0
    assert "12" in capsys.readouterr().out  # 600 px * 60 mm / 3 m


def test_python_takes_the_same_words(tmp_path: Path) -> None:
    path = tmp_path / "mine.yml"
    path.write_text(text(60, size=""))
    rig = rigsim.read_rig(path, unit="mm", size_px=(644, 482), swap=True)
    assert (rig.left.fx, rig.left.width, rig.baseline_m) == (610, 644, pytest.approx(0.06))
    assert rigsim.read_rig(path.read_text(), unit="mm", size_px=(644, 482), swap=True) == rig
    with pytest.raises(InvalidRange, match="a rig and words about a file"):
        rigsim.read_rig(rig, unit="mm")
