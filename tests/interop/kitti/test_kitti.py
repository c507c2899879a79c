"""KITTI's odometry and object data, and pairs of the raw data that are asked for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rigsim.errors import InvalidRig
from rigsim.interop.formats.calibration import parse
from rigsim.interop.formats.format import Asked, File
from rigsim.interop.formats.kitti import kitti
from rigsim.interop.formats.kitti.kitti import parse_kitti
from tests.helpers.bodies import found

FX, CX, CY = 718.856, 610.25, 180.75
PLACES = ((0.0, 0.0, 0.0), (-0.5, 0.0, 0.0), (0.06, -0.001, 0.004), (-0.47, 0.002, 0.003))
"""Where the first camera stands in each one's frame, m."""


def line(key: str, place: tuple[float, float, float], fx: float = FX) -> str:
    K = np.array([[fx, 0.0, CX], [0.0, fx, CY], [0.0, 0.0, 1.0]])
    P = np.hstack([K, (K @ place)[:, None]])
    return f"{key}: {' '.join(f'{value:.15e}' for value in P.ravel())}\n"


ODOMETRY = "".join(line(f"P{i}", place) for i, place in enumerate(PLACES))
OBJECT = ODOMETRY + "R0_rect: 1 0 0 0 1 0 0 0 1\nTr_velo_to_cam: 1 0 0 0 0 1 0 0 0 0 1 0\n"
RAW = "calib_time: now\n" + "".join(
    f"S_rect_0{i}: 1242 37{i}\n{line(f'P_rect_0{i}', place)}" for i, place in enumerate(PLACES)
)


@pytest.mark.parametrize(
    ("text", "cameras", "pair"),
    [
        (ODOMETRY, None, (0, 1)),
        (ODOMETRY, ("2", "3"), (2, 3)),
        (ODOMETRY, ("P3", "P2"), (3, 2)),
        (ODOMETRY, ("00", "03"), (0, 3)),
        (OBJECT, None, (2, 3)),
        (RAW, None, (2, 3)),
        (RAW, ("0", "1"), (0, 1)),
        (RAW, ("02", "03"), (2, 3)),
    ],
)
def test_pairs_with_all_their_offsets(
    text: str, cameras: tuple[str, str] | None, pair: tuple[int, int]
) -> None:
    read = found(kitti.FORMAT, [File(Path("a"), text)], Asked(size_px=None, cameras=cameras))
    expected = np.subtract(PLACES[pair[1]], PLACES[pair[0]])
    np.testing.assert_allclose(read.rig.right_from_left.t, expected, rtol=0, atol=1e-14)
    np.testing.assert_array_equal(read.rig.right_from_left.R, np.eye(3))
    assert (read.rig.left.fx, read.rig.left.cx, read.rig.right.cy) == (FX, CX, CY)
    codes = [remark.code for remark in read.remarks]
    assert codes == ["cameras"] * (cameras is None) + ["no_size"] * (text is not RAW)
    if text is RAW:
        assert [read.rig.left.height, read.rig.right.height] == [370 + i for i in pair]


def test_a_size_is_taken_from_the_person_or_from_kitti() -> None:
    asked = parse_kitti(ODOMETRY, Asked(size_px=(1280, 400)))
    assert (asked.rig.left.width, asked.rig.left.height) == (1280, 400)
    assert [remark.code for remark in asked.remarks] == ["cameras"]
    own = parse("".join(line(f"P{i}", PLACES[i], 707.0912) for i in (0, 1)))
    assert (own.rig.left.width, own.rig.left.height) == (1226, 370)
    assert own.remarks[0].text.startswith("the calibration has no image size: 1226x370 assumed, as KITTI's")


@pytest.mark.parametrize(
    ("text", "asked", "message"),
    [
        (line("P2", PLACES[2]), None, "has camera 2: must have 2 and 3 .colour. or 0 and 1"),
        (ODOMETRY, ("0", "4"), "camera 4: the file has P0, P1, P2, P3; name two of them"),
        (ODOMETRY.replace("P1: 7", "P1: 6", 1), None, "P0 and P1: must share focal lengths and cy"),
        (RAW.replace("S_rect_03: 1242", "S_rect_03:"), None, "S_rect_03: 373: must be 2 numbers"),
        (RAW.replace("S_rect", "S"), None, "no line S_rect_02: ...: KITTI's calib_cam_to_cam.txt has one"),
        (ODOMETRY.replace("P1: 7", "P1: nan 7", 1), None, "P1: .* must be 12 numbers"),
    ],
)
def test_bad_files_are_one_line(text: str, asked: tuple[str, str] | None, message: str) -> None:
    with pytest.raises(InvalidRig, match=message) as caught:
        found(kitti.FORMAT, [File(Path("a"), text)], Asked(cameras=asked))
    assert "\n" not in str(caught.value)
