"""SN<serial>.conf: modes, signs of Baseline, TY, TZ and of the rotation, by hand."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked
from rigsim.interop.formats.makers.zed import FORMAT
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from tests.helpers.calibrations import read


def cameras(mode: str, focal: float, terms: str = "k1=-0.17\nk2=0.03\np1=0.001\np2=-0.002\nk3=0.5") -> str:
    return "".join(
        f"[{side}_CAM_{mode}]\nfx={focal + i}\nfy={focal + 2}\ncx={focal - 60 + i}\n"
        f"cy={focal / 2}\n{terms}\n\n"
        for i, side in enumerate(("LEFT", "RIGHT"))
    )


STEREO = (
    "[STEREO]\nBaseline=120\nTY=0.5\nTZ=-0.25\nCV_2K=1\nCV_HD=0.02\nRX_HD=-0.01\nRZ_HD=0.03\nCV_VGA=0.1\nRX_VGA=0\n"
    "RZ_VGA=0\n[MISC]\nSensor_ID=0\n"
)
CONF = cameras("2K", 1400.0) + cameras("HD", 700.0) + cameras("VGA", 350.0) + STEREO


def test_hd_by_hand() -> None:
    found = read(FORMAT, CONF)
    rig = found.rig
    assert (rig.left.width, rig.left.height, rig.left.fx, rig.right.fx, rig.right.cx) == (
        1280,
        720,
        700,
        701,
        641,
    )
    assert rig.left.lens == BrownConrady(-0.17, 0.03, 0.001, -0.002, 0.5)
    # the right camera is 120 mm to the right: the left one lies at a negative x of its frame
    np.testing.assert_allclose(rig.right_from_left.t, [-0.12, -0.0005, 0.00025])
    np.testing.assert_allclose(
        rig.right_from_left.R, cv2.Rodrigues(np.array([-0.01, 0.02, 0.03]))[0], atol=1e-12
    )
    assert found.unit == "m"
    assert [remark.code for remark in found.remarks] == ["mode"]


def test_modes() -> None:
    found = read(FORMAT, CONF, asked=Asked(mode="vga"))
    assert (found.rig.left.width, found.rig.left.height, found.remarks) == (672, 376, ())
    assert found.rig.vergence_deg == pytest.approx(np.degrees(0.1))
    assert read(FORMAT, CONF, asked=Asked(size_px=(2208, 1242))).rig.left.fx == 1400
    with pytest.raises(InvalidRig, match="mode FHD: must be one of 2K, HD, VGA"):
        read(FORMAT, CONF, asked=Asked(mode="FHD"))


def test_wide_lens_and_shared_terms() -> None:
    wide = cameras("HD", 500.0, "k1=0.1\nk2=0.2\nk3=0.3\nk4=0.4") + STEREO
    assert read(FORMAT, wide).rig.left.lens == KannalaBrandt(0.1, 0.2, 0.3, 0.4)
    shared = cameras("FHD1200", 900.0, "") + "[LEFT_DISTO]\nk1=0.1\n[RIGHT_DISTO]\nk1=0.2\n" + STEREO
    rig = read(FORMAT, shared.replace("\n", "\r\n")).rig
    assert (rig.left.lens, rig.right.lens, rig.left.height) == (BrownConrady(0.1), BrownConrady(0.2), 1200)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (CONF.replace("Baseline=120\n", ""), "baseline of STEREO is missing"),
        (CONF.replace("[RIGHT_CAM_HD]", "[RIGHT_HD]"), "section RIGHT_CAM_HD is missing"),
        (CONF + "[STEREO]\n", "is not INI"),
        (CONF.replace("fx=700.0", "fx=seven"), "fx of LEFT_CAM_HD seven: must be a number"),
    ],
)
def test_what_is_none(text: str, says: str) -> None:
    with pytest.raises(InvalidRig, match=says):
        read(FORMAT, text)
