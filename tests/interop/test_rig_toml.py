"""rig.toml: what the keys mean, exact round trips, and one line for every slip."""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigsim.errors import InvalidRig, OutputError
from rigsim.interop.formats.rig_toml import parse_rig, parse_sensor, read_rig, read_sensor, write_rig
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.presets import PRESETS
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig

SHORT = """
baseline_mm = 120
width_px = 1280
height_px = 720
focal_px = 900
"""
FULL = """
[left]
width_px = 640
height_px = 480
fx_px = 500.0
fy_px = 501.0
cx_px = 320.5
cy_px = 239.0

[left.distortion]
k1 = -0.1
p2 = 0.002

[right]
width_px = 641
height_px = 481
fx_px = 502.0
fy_px = 503.0
cx_px = 319.0
cy_px = 240.0

[right_from_left]
R = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
t_mm = [-100.0, 2.0, 3.0]
"""
SENSOR = """
[sensor]
blur_px = 0.7
full_well_e = 10000
read_noise_e = 3.5
grey_noise = 1.25
gain = 2
bits = 12
right_gain = 1.1
right_offset = -0.02
vignetting = 0.3

[sensor.distortion]
k1 = -0.1
k3 = 0.02
p2 = 0.001
"""


def test_short_form_means_two_equal_parallel_cameras() -> None:
    rig = parse_rig(SHORT)
    assert rig == StereoRig.rectified(Intrinsics(1280, 720, 900.0, 900.0, 639.5, 359.5), 0.120)
    # 0.12 m to the right: a point straight ahead of the left camera lies left of the right one's middle
    uv_left, uv_right = rig.project([[0.0, 0.0, 1.0]])
    assert uv_left.tolist() == [[639.5, 359.5]]
    np.testing.assert_allclose(uv_right, [[639.5 - 108.0, 359.5]], atol=1e-12)


def test_short_form_takes_the_lens_in_three_ways() -> None:
    size = "baseline_mm = 120\nwidth_px = 320\nheight_px = 240\n"
    by_field = parse_rig(size + "hfov_deg = 90").left
    assert by_field == Intrinsics.from_hfov(320, 240, 90.0)
    assert by_field.fx == pytest.approx(160.0, rel=1e-15)
    # W11 (strands robots): 6 mm behind 6.4 mm of sensor and 320 px
    assert parse_rig(size + "focal_mm = 6\nsensor_width_mm = 6.4").left.fx == 300.0
    assert parse_rig(size + "focal_px = 300").left.fx == 300.0


def test_short_form_options() -> None:
    rig = parse_rig(SHORT + "vergence_deg = 5\ncx_px = 600.0\ncy_px = 350.0")
    assert rig == StereoRig.verged(Intrinsics(1280, 720, 900.0, 900.0, 600.0, 350.0), 0.120, 5.0)
    assert rig.vergence_deg == pytest.approx(5.0, abs=1e-12)


def test_full_form_means_what_it_says() -> None:
    rig = parse_rig(FULL)
    assert rig.left == Intrinsics(640, 480, 500.0, 501.0, 320.5, 239.0, BrownConrady(k1=-0.1, p2=0.002))
    assert rig.right == Intrinsics(641, 481, 502.0, 503.0, 319.0, 240.0)
    assert rig.right_from_left == Pose(
        np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]), np.array([-0.1, 0.002, 0.003])
    )
    turned = parse_rig(FULL.replace("R = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]", "rotvec_deg = [0, 0, 90.0]"))
    np.testing.assert_allclose(turned.right_from_left.R, rig.right_from_left.R, atol=1e-15)


def test_written_rig_says_units_and_frames_and_carries_a_comment() -> None:
    text = write_rig(PRESETS["branch"].rig, comment="first line\n\nthird line")
    assert text.startswith("# first line\n#\n# third line\n# rigsim stereo rig. Lengths in mm, angles in deg")
    assert "x right, y down, z forward" in text
    assert text.endswith("\nbaseline_mm = 150.0\nwidth_px = 1280\nheight_px = 960\nfocal_px = 1200.0\n")


def test_short_form_is_written_where_it_is_exact() -> None:
    verged = write_rig(StereoRig.verged(Intrinsics.from_hfov(1280, 720, 70.0), 0.063, 5.0))
    assert "vergence_deg = 5.0\n" in verged
    assert "baseline_mm = 63.0\n" in verged
    lens = Intrinsics.from_focal(640, 480, 500.0)
    bent = Pose(np.eye(3), np.array([-0.1, 0.0, 1e-17]))
    assert "[right_from_left]" in write_rig(StereoRig(lens, lens, bent))
    assert "[right_from_left]" in write_rig(
        StereoRig.rectified(lens, 0.1, right=Intrinsics.from_focal(640, 480, 501.0))
    )


size = st.integers(1, 5000)
focal = st.floats(0.1, 1e5)
middle = st.floats(-1e4, 1e4)
small = st.floats(-1.0, 1.0)
lenses = st.builds(
    Intrinsics, size, size, focal, focal, middle, middle, st.none() | st.builds(BrownConrady, *[small] * 5)
)
square = st.builds(Intrinsics.from_focal, size, size, focal)
vectors = st.tuples(small, small, small)
poses = st.builds(Pose.from_rotvec, vectors, vectors.filter(lambda t: math.hypot(*t) > 1e-6))
rigs = st.one_of(
    st.builds(StereoRig, lenses, lenses, poses),
    st.builds(StereoRig.rectified, square, st.floats(1e-9, 1e3)),
    st.builds(StereoRig.verged, square, st.floats(1e-3, 10.0), st.floats(-60.0, 60.0)),
)


@given(rigs)
def test_what_is_written_reads_back_exactly(rig: StereoRig) -> None:
    assert parse_rig(write_rig(rig)) == rig


@given(st.decimals("0.001", "10000", places=3), st.decimals("-90", "90", places=2))
def test_typed_numbers_survive(baseline_mm: object, vergence_deg: object) -> None:
    rig = parse_rig(SHORT.replace("120", str(baseline_mm)) + f"vergence_deg = {vergence_deg}")
    assert "[right_from_left]" not in write_rig(rig)
    assert parse_rig(write_rig(rig)) == rig


def test_a_sensor_means_what_it_says() -> None:
    meant = Sensor(
        blur_px=0.7,
        distortion=BrownConrady(k1=-0.1, p2=0.001, k3=0.02),
        full_well_e=10_000.0,
        read_noise_e=3.5,
        grey_noise=1.25,
        gain=2.0,
        bits=12,
        right_gain=1.1,
        right_offset=-0.02,
        vignetting=0.3,
    )
    for text in (SHORT, FULL):
        assert parse_sensor(text + SENSOR) == meant
        assert parse_rig(text + SENSOR) == parse_rig(text)


def test_what_is_not_said_is_ideal() -> None:
    assert parse_sensor(SHORT) is None
    assert parse_sensor(SHORT + "[sensor]") == Sensor()
    assert parse_sensor(SHORT + "[sensor]\nblur_px = 1") == Sensor(blur_px=1.0)


def test_a_named_sensor_and_what_replaces_its_numbers() -> None:
    named = SHORT + '[sensor]\nname = "IMX477"\n'
    assert parse_sensor(named) == Sensor(full_well_e=8180.0, read_noise_e=3.0, bits=12)
    assert parse_sensor(named + "read_noise_e = 5\nbits = 0\nvignetting = 0.2") == Sensor(
        full_well_e=8180.0, read_noise_e=5.0, bits=0, vignetting=0.2
    )
    silent = parse_sensor(named + "full_well_e = 0\nread_noise_e = 0")
    assert silent == Sensor(bits=12)
    given = SHORT + '[sensor]\nname = "imx219"\nfull_well_e = 4700\nread_noise_e = 2'
    assert parse_sensor(given) == Sensor(full_well_e=4700.0, read_noise_e=2.0, bits=10)


share = st.floats(0.0, 1.0, exclude_max=True)
number = st.floats(0.0, 1e9)
positive = st.floats(1e-6, 1e6)
sensors = st.builds(
    Sensor,
    blur_px=number,
    distortion=st.none() | st.builds(BrownConrady, *[small] * 5),
    full_well_e=st.floats(1e-3, 1e9),
    read_noise_e=number,
    grey_noise=number,
    gain=positive,
    bits=st.sampled_from([0, 8, 10, 12, 16]),
    right_gain=positive,
    right_offset=st.floats(-1.0, 1.0, exclude_min=True, exclude_max=True),
    vignetting=share,
)


@given(sensors, st.sampled_from([SHORT, FULL]))
def test_a_written_sensor_reads_back_exactly(sensor: Sensor, text: str) -> None:
    rig = parse_rig(text)
    written = write_rig(rig, sensor=sensor)
    assert parse_sensor(written) == sensor
    assert parse_rig(written) == rig


def test_a_sensor_is_written_only_when_there_is_one() -> None:
    rig = parse_rig(SHORT)
    assert "sensor" not in write_rig(rig)
    assert parse_sensor(write_rig(rig, sensor=Sensor())) == Sensor()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("blur = 1", ["unknown key sensor.blur: must be one of name, blur_px, full_well_e", "vignetting"]),
        ("distortion.k4 = 1", ["unknown key sensor.distortion.k4: must be one of k1, k2, p1, p2, k3"]),
        ("blur_px = -1", ["sensor.blur_px -1: must be >= 0"]),
        ("blur_px = 'wide'", ["sensor.blur_px 'wide': must be a number"]),
        ("blur_px = nan", ["sensor.blur_px", "finite"]),
        ("full_well_e = -0.5", ["sensor.full_well_e -0.5: must be >= 0"]),
        ("full_well_e = 9\nread_noise_e = -2", ["sensor.read_noise_e -2: must be >= 0"]),
        ("read_noise_e = 2", ["read noise 2 e- without a full well", "full_well_e"]),
        ("grey_noise = -1e-9", ["sensor.grey_noise -1E-9: must be >= 0"]),
        ("gain = 0", ["sensor.gain 0: must be > 0"]),
        ("right_gain = -1", ["sensor.right_gain -1: must be > 0"]),
        ("right_offset = 1", ["sensor.right_offset 1: must be < 1"]),
        ("right_offset = -1.0", ["sensor.right_offset -1.0: must be > -1"]),
        ("vignetting = 1.0", ["sensor.vignetting 1.0: must be < 1"]),
        ("vignetting = 0.99999999999999999999", ["vignetting 1: must be >= 0 and < 1"]),
        ("bits = 9", ["sensor.bits 9: must be one of 0, 8, 10, 12, 16"]),
        ("bits = 8.0", ["sensor.bits 8.0: must be a whole number"]),
        ("bits = true", ["sensor.bits True: must be a whole number"]),
        ("distortion = 3", ["sensor.distortion 3: must be a table"]),
        ("distortion.k1 = 'a'", ["sensor.distortion.k1 'a': must be a number"]),
        ("name = 477", ["sensor.name 477: must be a name in quotes"]),
        ("name = 'kodak'", ["unknown sensor 'kodak'", "imx219", "imx477", "ov9282"]),
        ("name = 'IMX296'", ["sensor imx296: no published full_well_e and read_noise_e: give it"]),
        ("name = 'OV5647'", ["sensor ov5647: no published read_noise_e: give it"]),
        ("name = 'IMX477'\nfull_well_e = 0", ["read noise 3 e- without a full well"]),
    ],
)
@pytest.mark.parametrize("read", [read_rig, read_sensor])
def test_slips_in_a_sensor_are_named_in_one_line(
    tmp_path: Path, read: Callable[[Path], object], text: str, words: list[str]
) -> None:
    path = tmp_path / "rig.toml"
    path.write_text(f"{SHORT}\n[sensor]\n{text}\n", encoding="utf-8")
    with pytest.raises(InvalidRig) as raised:
        read(path)
    message = str(raised.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    for word in words:
        assert word in message


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", ["baseline_mm is missing"]),
        (SHORT.replace("120", "0"), ["baseline_mm 0: must be > 0"]),
        (SHORT.replace("120", "-5.5"), ["baseline_mm -5.5: must be > 0"]),
        (SHORT.replace("120", "nan"), ["baseline_mm", "finite"]),
        (SHORT.replace("120", "inf"), ["baseline_mm", "finite"]),
        (SHORT.replace("120", "1e99"), ["baseline_mm", "finite"]),
        (SHORT.replace("120", "1e99999999999999999999"), ["number is too large"]),
        (SHORT.replace("120", "'120'"), ["baseline_mm '120': must be a number"]),
        (SHORT.replace("120", "true"), ["baseline_mm True: must be a number"]),
        (SHORT.replace("1280", "1280.0"), ["width_px 1280.0: must be a whole number"]),
        (SHORT.replace("1280", "0"), ["width_px 0: must be >= 1"]),
        (SHORT.replace("baseline_mm", "baseline"), ["unknown key baseline:", "baseline_mm, width_px"]),
        (SHORT.replace("focal_px = 900", ""), ["lens given by nothing", "focal_px, hfov_deg, or focal_mm"]),
        (SHORT + "hfov_deg = 70", ["lens given by focal_px, hfov_deg"]),
        (SHORT.replace("focal_px", "focal_mm"), ["lens given by focal_mm:"]),
        (SHORT.replace("focal_px = 900", "hfov_deg = 180"), ["hfov_deg 180: must be < 180"]),
        (SHORT + "vergence_deg = 180", ["vergence_deg 180: must be < 180"]),
        ("baseline_mm = 3 mm\n", ["not TOML", "line 1"]),
        (FULL + "\n[middle]\n", ["unknown key middle", "left, right, right_from_left"]),
        ("baseline_mm = 3\n" + FULL, ["unknown key baseline_mm"]),
        (FULL.replace("p2", "p3"), ["unknown key left.distortion.p3", "k1, k2, p1, p2, k3"]),
        (FULL.replace("fx_px = 502.0", ""), ["right.fx_px is missing"]),
        (FULL.replace("fx_px = 502.0", "fx_px = 0"), ["right.fx_px 0: must be > 0"]),
        (FULL.replace("[0, 0, 1]]", "[0, 0, 2]]"), ["R is no rotation"]),
        (FULL.replace("[1, 0, 0], ", ""), ["right_from_left.R", "list of 3"]),
        (FULL.replace("[1, 0, 0]", "[1, 0, 'x']"), ["right_from_left.R[1][2] 'x'"]),
        (FULL.replace("[-100.0, 2.0, 3.0]", "[-100.0, 2.0]"), ["t_mm [-100.0, 2.0]: must be a list of 3"]),
        (FULL.replace("[-100.0, 2.0, 3.0]", "[0, 0, 0]"), ["baseline 0 mm: must be > 0"]),
        (FULL + "rotvec_deg = [0, 0, 90]", ["one of R (3 x 3) and rotvec_deg"]),
        ("left = 3", ["left 3: must be a table"]),
        ("sensor = 3\n" + SHORT, ["sensor 3: must be a table"]),
        (SHORT + "[[sensor]]\nbits = 8", ["sensor [{'bits': 8}]: must be a table"]),
        (SHORT + "[sensors]", ["unknown key sensors", "sensor"]),
        (FULL + "[sensors]", ["unknown key sensors", "right_from_left, sensor"]),
        (FULL.replace("[right_from_left]", "[right_from_lefty]"), ["unknown key right_from_lefty"]),
    ],
)
def test_slips_are_named_in_one_line(tmp_path: Path, text: str, words: list[str]) -> None:
    path = tmp_path / "rig.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InvalidRig) as raised:
        read_rig(path)
    message = str(raised.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    for word in words:
        assert word in message


def test_unreadable_files(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"absent\.toml: cannot be read \(No such file"):
        read_rig(tmp_path / "absent.toml")
    with pytest.raises(OutputError, match="cannot be read"):
        read_rig(tmp_path)
    (tmp_path / "picture.toml").write_bytes(b"\x89PNG\xff\xfe")
    with pytest.raises(InvalidRig, match="is not TOML"):
        read_rig(tmp_path / "picture.toml")


def test_read_rig_reads_what_write_rig_wrote(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text(write_rig(PRESETS["artifact"].rig), encoding="utf-8")
    assert read_rig(path) == PRESETS["artifact"].rig
    assert read_sensor(path) is None
    path.write_text(write_rig(PRESETS["artifact"].rig, sensor=Sensor(blur_px=0.5)), encoding="utf-8")
    assert read_rig(path) == PRESETS["artifact"].rig
    assert read_sensor(path) == Sensor(blur_px=0.5)


def test_a_rig_without_a_sensor_loads_nothing_of_it(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text(SHORT, encoding="utf-8")
    code = (
        "import sys\nfrom pathlib import Path\nfrom rigsim.interop.formats.rig_toml import read_rig\n"
        "read_rig(Path(sys.argv[1]))\n"
        "print('rigsim.interop.formats.tables.rig' in sys.modules, 'scipy' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code, path], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["True", "False"]
