"""Metashape's exported cameras: half a pixel, exchanged p1 and p2, and poses, by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File
from rigsim.interop.formats.photogrammetry.metashape import FORMAT
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from tests.helpers.calibrations import read

FRAME = "<k1>0.1</k1><k2>0.02</k2><k3>0.003</k3><p1>0.004</p1><p2>0.005</p2><b1>2</b1>"


def sensor(index: int, label: str, terms: str = FRAME, kind: str = "frame") -> str:
    return (
        f'<sensor id="{index}" label="{label}" type="{kind}"><resolution width="640" height="480"/>'
        f'<calibration type="{kind}" class="initial"><f>1</f></calibration>'
        f'<calibration type="{kind}" class="adjusted"><resolution width="640" height="480"/><f>500</f>'
        f"<cx>3</cx><cy>-4</cy>{terms}</calibration></sensor>"
    )


def camera(index: int, sensor_id: int, label: str, place: str, R: str = "1 0 0 0 1 0 0 0 1") -> str:
    r, t = R.split(), place.split()
    rows = " ".join(" ".join([*r[3 * i : 3 * i + 3], t[i]]) for i in range(3))
    transform = f"<transform>{rows} 0 0 0 1</transform>"
    return f'<camera id="{index}" sensor_id="{sensor_id}" label="{label}">{transform}</camera>'


def document(*cameras: str, sensors: str = "", after: str = "") -> str:
    sensors = sensors or sensor(0, "left eye") + sensor(1, "right eye", "")
    return (
        f'<?xml version="1.0"?>\n<document version="2.0.0"><chunk label="1"><sensors>{sensors}</sensors>'
        f'<components><component id="0">{after}</component></components><cameras>{"".join(cameras)}</cameras>'
        "</chunk></document>"
    )


# the right camera's x is the chunk's y, its y the chunk's -x
TURNED = "0 -1 0 1 0 0 0 0 1"
PAIR = (camera(0, 0, "L_001", "1 2 3"), camera(1, 1, "R_001", "1.5 2 3", TURNED))


def test_by_hand() -> None:
    found = read(FORMAT, document(*PAIR))
    rig = found.rig
    # cx is counted from the middle: 320 + 3 from the corner, which is half a pixel before the first centre
    assert rig.left == Intrinsics(
        640, 480, 502, 500, 322.5, 235.5, BrownConrady(0.1, 0.02, 0.005, 0.004, 0.003)
    )
    # u = w / 2 + cx + f x' + b1 x' with x' = x + p1 (r^2 + 2 x^2) alone, less the half pixel
    own = document(*PAIR, sensors=sensor(0, "a", "<p1>0.01</p1>") + sensor(1, "b", ""))
    u, v = read(FORMAT, own).rig.left.project([0.2, 0.0, 1.0])
    assert (u, v) == pytest.approx((320 + 3 - 0.5 + 500 * (0.2 + 0.01 * 3 * 0.04), 235.5))
    # the left camera's origin lies at -0.5 along the chunk's x, which is the right camera's -y
    np.testing.assert_allclose(rig.right_from_left.apply([0.0, 0, 0]), [0, 0.5, 0], atol=1e-12)
    assert found.unit is None


def test_scale_fisheye_and_choice() -> None:
    fisheye = sensor(0, "a", "<k1>0.1</k1><k4>0.4</k4>", "equidistant_fisheye")
    text = document(
        *PAIR,
        sensors=fisheye + sensor(1, "b", "") + sensor(2, "c", ""),
        after="<transform><scale>2</scale></transform>",
    )
    found = read(FORMAT, text, asked=Asked(cameras=("b", "0")))
    assert found.rig.right.lens == KannalaBrandt(0.1, 0, 0, 0.4)
    assert (found.rig.baseline_m, found.unit) == (1.0, "m")
    with pytest.raises(InvalidRig, match=r"sensors 0 \(a\), 1 \(b\), 2 \(c\): choose two"):
        read(FORMAT, text)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (document(*PAIR, sensors=sensor(0, "one")), "1 sensor: poses of one camera that moves are no rig"),
        (
            document(*PAIR, camera(2, 0, "L_002", "9 9 9"), camera(3, 1, "R_002", "9.7 9 9", TURNED)),
            "moves against",
        ),
        (
            document(PAIR[0], camera(1, 1, "R_7", "1 1 1"), camera(2, 0, "L_3", "0 0 0")),
            "is called like one of",
        ),
        (
            document(*PAIR, sensors=sensor(0, "a", "<k4>1</k4>") + sensor(1, "b")),
            "k4 of sensor 0 1: must be 0",
        ),
        (
            document(*PAIR, sensors=sensor(0, "a", "<b2>1</b2>") + sensor(1, "b")),
            "b2 of sensor 0 1: must be 0",
        ),
        (document(*PAIR, sensors=sensor(0, "a", kind="spherical") + sensor(1, "b")), "must be frame or"),
        (document(), "no camera has a transform"),
    ],
)
def test_what_is_none(text: str, says: str) -> None:
    with pytest.raises(InvalidRig, match=says):
        read(FORMAT, text)


def test_a_calibration_alone_has_no_pose() -> None:
    text = '<?xml version="1.0"?>\n<calibration>\n  <projection>frame</projection></calibration>'
    assert FORMAT.lacks is not None
    assert "without a pose" in str(FORMAT.lacks(File(Path("a.xml"), text)))
