"""Files of Middlebury and KITTI, and point clouds, byte by byte."""

from __future__ import annotations

import io
import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigsim.errors import InvalidImage, InvalidRig, OutputError
from rigsim.interop.files.ply import ply_bytes
from rigsim.interop.formats.middlebury import disparity_png, parse_calib, read_calib, read_disparity
from rigsim.pixels.dense.pfm import parse_pfm, pfm_bytes
from rigsim.pixels.reading import read_image

NAN, INF = float("nan"), float("inf")

# --- calib.txt ----------------------------------------------------------------------------------

# the example of Middlebury's own page on the format (2014 data sets)
CALIB = """cam0=[3997.684 0 1176.728; 0 3997.684 1011.728; 0 0 1]
cam1=[3997.684 0 1307.839; 0 3997.684 1011.728; 0 0 1]
doffs=131.111
baseline=193.001
width=2964
height=1988
ndisp=280
isint=0
vmin=31
vmax=257
dyavg=0.918
dymax=1.516
"""


def test_the_example_of_the_format() -> None:
    calibration = parse_calib(CALIB)
    rig = calibration.rig
    assert rig.is_rectified
    assert rig.baseline_m == pytest.approx(0.193001)
    assert rig.doffs_px == pytest.approx(131.111)
    assert (rig.left.width, rig.left.height, rig.left.fx, rig.left.fy) == (2964, 1988, 3997.684, 3997.684)
    assert (rig.left.cx, rig.left.cy, rig.right.cx) == (1176.728, 1011.728, 1307.839)
    assert calibration.disparity_range == (31.0, 257.0)
    # the page's own formula: Z = baseline * f / (d + doffs) = 193.001 * 3997.684 / 231.111 = 3338.4694 mm
    point = np.array([[0.0, 0.0, 3.3384694]])
    uv_left, uv_right = rig.project(point)
    assert uv_left[0, 0] - uv_right[0, 0] == pytest.approx(100.0, abs=1e-3)


def test_a_calibration_is_read_from_a_file(tmp_path: Path) -> None:
    path = tmp_path / "calib.txt"
    path.write_bytes(CALIB.replace("\n", "\r\n").encode())
    assert read_calib(path) == parse_calib(CALIB)
    with pytest.raises(OutputError, match="No such file"):
        read_calib(tmp_path / "missing.txt")


def test_the_search_range_may_be_given_or_not() -> None:
    short = "\n".join(line for line in CALIB.splitlines() if not line.startswith(("vmin", "vmax")))
    assert parse_calib(short).disparity_range == (0.0, 280.0)
    assert parse_calib(short.replace("ndisp=280", "")).disparity_range is None


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("doffs=131.111", "doffs=-131.111", "must be cx1 - cx0 = 131.111; are the cameras swapped"),
        ("doffs=131.111", "doffs=131.2", "doffs 131.2 px"),
        ("doffs=131.111", "", "no line doffs="),
        ("doffs=131.111", "doffs=many", "doffs=many: must be a number"),
        ("baseline=193.001", "baseline=0", "baseline 0 mm"),
        ("baseline=193.001", "baseline=nan", "baseline nan mm"),
        ("width=2964", "width=29.5", "whole number"),
        ("cam0=[3997.684 0", "cam0=[4000 0", "share focal lengths"),
        (
            "0 3997.684 1011.728; 0 0 1]\ndoffs",
            "0 3997.684 1012; 0 0 1]\ndoffs",
            "share focal lengths and cy",
        ),
        (
            "cam0=[3997.684 0 1176.728; 0",
            "cam0=[3997.684 0.1 1176.728; 0",
            r"must be \[f 0 cx; 0 f cy; 0 0 1\]",
        ),
        ("cam0=[", "cam0=[x", "cam0"),
        ("cam0=", "cam9=", "no line cam0="),
    ],
)
def test_a_calibration_that_contradicts_itself_is_one_line(old: str, new: str, message: str) -> None:
    assert old in CALIB
    with pytest.raises(InvalidRig, match=message) as caught:
        parse_calib(CALIB.replace(old, new))
    assert "\n" not in str(caught.value)


# --- PFM ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("scale", "order"), [(b"-1.0", "<"), (b"1", ">"), (b"-0.00390625", "<")])
def test_pfm_by_hand(scale: bytes, order: str) -> None:
    # two columns, three rows, the bottom row first
    values = struct.pack(f"{order}6f", 5.0, 6.0, 3.0, INF, 1.0, -2.5)
    found = parse_pfm(b"Pf\n2 3\n" + scale + b"\n" + values)
    assert np.array_equal(found, [[1.0, -2.5], [3.0, NAN], [5.0, 6.0]], equal_nan=True)


def test_pfm_written_by_hand() -> None:
    expected = b"Pf\n2 2\n-1.0\n" + bytes.fromhex("000040400000807f0000803f00000040")
    assert pfm_bytes(np.array([[1.0, 2.0], [3.0, NAN]])) == expected


def test_pfm_values_that_look_like_white_space_are_kept() -> None:
    # 0x20202020 as the first value: only one byte of white space ends the header
    content = b"Pf\n1 1\n-1.0\n" + b"\x20\x20\x20\x20"
    assert parse_pfm(content)[0, 0] == struct.unpack("<f", b"\x20\x20\x20\x20")[0]


def test_pfm_in_colour() -> None:
    content = b"PF\n1 2\n-1\n" + struct.pack("<6f", *range(6))
    assert parse_pfm(content).tolist() == [[[3, 4, 5]], [[0, 1, 2]]]


@given(st.integers(1, 7), st.integers(1, 7), st.integers(0, 2**32 - 1))
def test_pfm_there_and_back(width: int, height: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    values = rng.normal(0, 100, (height, width)).astype(np.float32).astype(np.float64)
    values[rng.random(values.shape) < 0.2] = NAN
    assert np.array_equal(parse_pfm(pfm_bytes(values)), values, equal_nan=True)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"P5\n1 1\n255\n0",
        b"Pf\n2 2\n-1.0\n1234",
        b"Pf\n0 2\n-1.0\n",
        b"Pf\n1 1\n0\n1234",
        b"Pf\n1 1\nx\n1234",
    ],
)
def test_what_is_no_pfm_is_one_line(content: bytes) -> None:
    with pytest.raises(InvalidImage, match=r"^truth\.pfm") as caught:
        parse_pfm(content, "truth.pfm")
    assert "\n" not in str(caught.value)


# --- disparity maps -----------------------------------------------------------------------------

DISPARITY = np.array([[1.0, 2.5, NAN], [0.00390625, 200.0, 17.25]])


def npy_bytes(values: object) -> bytes:
    file = io.BytesIO()
    np.save(file, values)
    return file.getvalue()


@pytest.mark.parametrize("content", [pfm_bytes(DISPARITY), npy_bytes(DISPARITY), disparity_png(DISPARITY)])
def test_a_disparity_map_is_told_by_its_content(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "truth.bin"
    path.write_bytes(content)
    assert np.array_equal(read_disparity(path), DISPARITY, equal_nan=True)


def test_a_png_holds_256_steps_a_pixel(tmp_path: Path) -> None:
    path = tmp_path / "disparity.png"
    path.write_bytes(disparity_png(DISPARITY))
    levels = read_image(path)  # another decoder than the one that wrote it
    assert levels.dtype == np.uint16
    assert levels.tolist() == [[256, 640, 0], [1, 51200, 4416]]
    path.write_bytes(disparity_png(np.array([[3.0, 0.0]]), png_scale=4))
    assert read_image(path).tolist() == [[12, 1]]  # a known 0 must not read as unknown
    assert read_disparity(path, png_scale=4).tolist() == [[3.0, 0.25]]


@pytest.mark.parametrize("value", [-1.0, 256.0])
def test_a_png_says_what_it_cannot_hold(value: float) -> None:
    with pytest.raises(InvalidImage, match="a PNG holds 0 to 255"):
        disparity_png(np.array([[value, 1.0, NAN]]))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"nonsense", "must be a PFM, NPY or PNG"),
        (b"\x93NUMPY\x01\x00nonsense", "no NPY file"),
        (b"\x89PNG\r\n\x1a\nnonsense", "PNG file that cannot be read"),
        (npy_bytes(np.zeros((2, 2, 2))), "one channel"),
        (npy_bytes(np.full((2, 2), INF)), "no disparity is known"),
        (npy_bytes(np.array(["a"])), "no NPY file of numbers"),
        (b"PF\n1 1\n-1\n" + bytes(12), "one channel"),
    ],
)
def test_what_is_no_disparity_map_is_one_line(content: bytes, message: str, tmp_path: Path) -> None:
    path = tmp_path / "truth"
    path.write_bytes(content)
    with pytest.raises(InvalidImage, match=message):
        read_disparity(path)


def test_a_missing_file_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="No such file"):
        read_disparity(tmp_path / "none.pfm")
    with pytest.raises(OutputError, match="No such file"):
        read_image(tmp_path / "none.png")


def test_a_picture_is_read_with_red_first_and_all_its_bits(tmp_path: Path) -> None:
    from PIL import Image

    path = tmp_path / "picture.png"
    Image.fromarray(np.array([[[255, 128, 0], [1, 2, 3]]], np.uint8)).save(path)
    assert read_image(path).tolist() == [[[255, 128, 0], [1, 2, 3]]]
    Image.fromarray(np.array([[1, 65535]], np.uint16)).save(path)
    assert read_image(path).tolist() == [[1, 65535]]
    for content in (b"", b"nonsense"):
        path.write_bytes(content)
        with pytest.raises(InvalidImage, match="no picture"):
            read_image(path)


# --- PLY ----------------------------------------------------------------------------------------


def test_a_binary_cloud_by_hand() -> None:
    points = np.array([[1.0, 2.0, 3.0], [NAN, 0.0, 0.0], [-1.0, 0.5, 4.0]])
    content = ply_bytes(
        points,
        depth_std_m=np.array([0.25, 1.0, NAN]),
        colors=np.array([[1, 2, 3], [4, 5, 6], [255, 0, 7]], np.uint8),
    )
    header, body = content.split(b"end_header\n")
    assert header.decode().splitlines() == [
        "ply",
        "format binary_little_endian 1.0",
        "comment metres; x right, y down, z forward of the left camera",
        "element vertex 2",
        "property float x",
        "property float y",
        "property float z",
        "property uchar red",
        "property uchar green",
        "property uchar blue",
        "property float depth_std",
    ]
    first, second = struct.iter_unpack("<3f3Bf", body)
    assert first == (1.0, 2.0, 3.0, 1, 2, 3, 0.25)
    assert second[:6] == (-1.0, 0.5, 4.0, 255, 0, 7)
    assert np.isnan(second[6])


def test_a_cloud_in_words_says_the_same() -> None:
    points = np.array([[0.5, 2.0, 3.25]])
    content = ply_bytes(points, colors=np.array([[9, 8, 7]], np.uint8), binary=False).decode()
    assert "format ascii 1.0" in content
    assert content.splitlines()[-1] == "0.5 2 3.25 9 8 7"
    assert ply_bytes(np.empty((0, 3)), binary=False).decode().endswith("end_header\n")


def test_columns_that_do_not_belong_together_are_refused() -> None:
    with pytest.raises(ValueError, match=r"\(N, 3\)"):
        ply_bytes(np.zeros((2, 2)))
    with pytest.raises(ValueError, match="depth std"):
        ply_bytes(np.zeros((2, 3)), depth_std_m=np.zeros(3))
    with pytest.raises(ValueError, match="colours"):
        ply_bytes(np.zeros((2, 3)), colors=np.zeros((2, 4), np.uint8))
