"""`rigsim.read_rig`: a rig by name, path, text or as it is; and `rig.figure()`."""

from __future__ import annotations

from pathlib import Path

import pytest

import rigsim
from rigsim.errors import InvalidRange, InvalidRig
from rigsim.interop.formats.registry import RIG_FORMATS, rig_files
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig

RIG = StereoRig.rectified(Intrinsics.from_focal(640, 480, 500.0), 0.1)


def test_a_name_is_a_preset_however_it_is_written() -> None:
    # what Luxonis publishes of the OAK-D: 75 mm between its mono cameras
    for name in ("oak-d", "OAK-D", "Luxonis OAK-D"):
        assert rigsim.read_rig(name).baseline_m == 0.075
    with pytest.raises(InvalidRange, match=r"rig 'oakd-9': no file here and no preset"):
        rigsim.read_rig("oakd-9")


def test_a_rig_is_itself() -> None:
    assert rigsim.read_rig(RIG) is RIG


@pytest.mark.parametrize("format", sorted(set(RIG_FORMATS) - {"ros", "colmap", "mrcal"}))
def test_a_text_of_every_format_of_one_file_is_read(format: str) -> None:
    (content,) = rig_files(RIG, format).values()
    rig = rigsim.read_rig(content.decode())
    assert rig.baseline_m == pytest.approx(0.1)
    assert rig.left.fx == pytest.approx(500.0)
    assert rig.right_from_left.t[0] < 0


def test_a_text_is_read_as_rig_toml() -> None:
    text = "baseline_mm = 50\nwidth_px = 640\nheight_px = 480\nfocal_px = 500\n"
    assert rigsim.read_rig(text).baseline_m == 0.05
    assert rigsim.read_rig(rigsim.write_rig(RIG)) == RIG


def test_a_calibration_with_its_sides_exchanged_is_refused_as_text_too() -> None:
    (content,) = rig_files(RIG, "middlebury").values()
    text = content.decode()
    assert "baseline=100" in text.replace(" ", "")
    turned = (
        text.replace("100", "-100", 1)
        if "baseline=100" in text
        else text.replace("baseline = ", "baseline = -")
    )
    with pytest.raises(InvalidRig):
        rigsim.read_rig(turned)


def test_a_path_comes_before_a_preset(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("oak-d").mkdir()
    assert rigsim.read_rig("oak-d").baseline_m == 0.075  # an empty folder is no calibration
    Path("oak-d", "rig.toml").write_text(rigsim.write_rig(RIG))
    assert rigsim.read_rig("oak-d").baseline_m == 0.1


def test_a_rig_draws_itself() -> None:
    figure = RIG.figure([[0, 0, 2.0]], title="mine")
    assert figure.axes[0].get_title(loc="left") == "mine"
    low, high = figure.axes[0].get_ylim()
    assert low < 0.1
    assert high > 2.0  # the cameras and the point are on it
