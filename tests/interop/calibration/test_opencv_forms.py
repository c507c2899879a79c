"""The names and files under which people keep what OpenCV returns: one rig, whatever they are called."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from rigsim.errors import InvalidRig, OutputError
from rigsim.interop.formats.calibration import parse, read
from rigsim.interop.formats.kit.reading import Reading, RigReading
from rigsim.interop.formats.opencv.filestorage import storage_table
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.mei import Mei
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

K1 = np.array([[812.5, 0, 633.25], [0, 813.75, 357.5], [0, 0, 1]])
K2 = np.array([[820.25, 0, 645.5], [0, 819.5, 362.75], [0, 0, 1]])
D1 = np.array([[-0.31, 0.12, 1.5e-3, -2.5e-4, -0.02]])
D2 = np.array([[-0.29, 0.1, -1e-3, 3e-4, -0.01]])
POSE = Pose.from_rotvec([0.004, -0.021, 0.0075])
R = POSE.R
T = np.array([[-0.0831], [0.0007], [0.0021]])


def is_the_rig(rig: StereoRig) -> None:
    np.testing.assert_array_equal(rig.left.K, K1)
    np.testing.assert_array_equal(rig.right.K, K2)
    np.testing.assert_allclose(rig.right_from_left.R, R, atol=1e-12)
    np.testing.assert_allclose(rig.right_from_left.t, T[:, 0], rtol=1e-12)
    assert rig.left.lens == BrownConrady(*D1[0])
    assert rig.right.lens == BrownConrady(*D2[0])
    assert (rig.left.width, rig.left.height, rig.right.width, rig.right.height) == (1280, 720, 1280, 720)


def stored(path: Path, **values: object) -> Path:
    """A file that cv2 itself writes, in the dialect of its ending."""
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    for name, value in values.items():
        storage.write(name, value)
    storage.release()
    return path


WHOLE = {"image_width": 1280, "image_height": 720, "R": R, "T": T}

NAMES: dict[str, dict[str, object]] = {
    "sample": {"M1": K1, "D1": D1, "M2": K2, "D2": D2, **WHOLE},
    "long": {
        "cameraMatrix1": K1,
        "distCoeffs1": D1.T,
        "cameraMatrix2": K2,
        "distCoeffs2": D2.T,
        "imageSize": [1280, 720],
        "R": R,
        "T": T,
    },
    "sides": {
        "camera_matrix_left": K1,
        "dist_coeffs_left": D1,
        "camera_matrix_right": K2,
        "dist_coeffs_right": D2,
        "Image_Width": 1280,
        "Image_Height": 720,
        "rotation_mat": R,
        "translation_vec": T,
    },
    "first": {
        "left_camera_matrix": K1,
        "left_distortion_coefficients": D1,
        "right_camera_matrix": K2,
        "right_distortion_coefficients": D2,
        **WHOLE,
    },
    "loud": {"LEFT_K": K1, "LEFT_D": D1, "RIGHT_K": K2, "RIGHT_D": D2, **WHOLE},
    "letters": {"K_l": K1, "D_l": D1, "K_r": K2, "D_r": D2, **WHOLE},
    "short": {"KL": K1, "DL": D1, "KR": K2, "DR": D2, **WHOLE},
    "python": {"mtxL": K1, "distL": D1, "mtxR": K2, "distR": D2, "Rot": R, "Trns": T, **WHOLE},
    "from zero": {"CM0": K1, "dist0": D1, "CM1": K2, "dist1": D2, "om": cv2.Rodrigues(R)[0], **WHOLE},
    "Tr": {"K1": K1, "D1": D1, "K2": K2, "D2": D2, "R": R, "Tr": T, "image_size": [1280, 720]},
}


@pytest.mark.parametrize("ending", ["yml", "xml", "json"])
@pytest.mark.parametrize("names", NAMES)
def test_one_rig_under_all_its_names_as_cv2_writes_them(names: str, ending: str, tmp_path: Path) -> None:
    values = {
        key: np.array(value) if isinstance(value, list) else value for key, value in NAMES[names].items()
    }
    path = stored(tmp_path / f"calibration.{ending}", **values)
    found = read([path])
    assert (found.format, found.unit, found.remarks) == ("opencv", None, ())
    is_the_rig(found.rig)
    is_the_rig(read([tmp_path]).rig)


def test_nested_tables_by_hand() -> None:
    """As Python programs dump them: a table a camera, numbers by name, the pose in a table of its own."""
    scalars = {
        "fx": 812.5,
        "fy": 813.75,
        "cx": 633.25,
        "cy": 357.5,
        **dict(zip(["k1", "k2", "p1", "p2", "k3"], D1[0], strict=True)),
    }
    right = {"K": K2.tolist(), "D": D2[0].tolist(), "resolution": [1280, 720]}
    pose = {"R": R.tolist(), "T": T[:, 0].tolist()}
    is_the_rig(parse(json.dumps({"left": scalars, "right": right, "extrinsics": pose})).rig)
    is_the_rig(
        parse(
            json.dumps({"cameras": [scalars, right], "left_to_right": pose, "image_shape": [720, 1280]})
        ).rig
    )
    with pytest.raises(InvalidRig, match="not R and T between the cameras"):
        parse(json.dumps({"left": scalars, "right": right, "right_to_left": pose}))


def test_what_opencv_s_dialect_allows_is_read() -> None:
    rows = ", ".join(repr(float(value)) for value in K1.ravel())
    text = (
        "%YAML:1.0   # by hand, caf\xe9\r\n"
        "image_width:1280\r\nimage_height: 720\r\n"
        f"K1: !!opencv-matrix\r\n\trows: 3\r\n\tcols: 3\r\n\tdt: d\r\n\tdata:[{rows}]\r\n"
        f"K2: !!opencv-matrix\r\n\trows: 3\r\n\tcols: 3\r\n\tdt: d\r\n\tdata:[{rows}]\r\n"
        "R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\r\nT: [-1e-1, 0., .0]\r\nT: [-1e-1, 0., .0]\r\n"
    )
    for content in (text.encode("latin-1"), b"\xef\xbb\xbf" + text.encode(), text.encode("utf-16")):
        rig = parse(content).rig
        assert rig.left.K.tolist() == K1.tolist()
        assert rig.right_from_left.t.tolist() == [-0.1, 0, 0]
    with pytest.raises(InvalidRig, match="T is given twice, differently: remove one"):
        parse(text.replace("T: [-1e-1, 0., .0]\r\n", "T: [-2e-1, 0., .0]\r\n", 1))


# --- pairs and threes ---------------------------------------------------------------------------

CAMERAS = {"M1": K1, "D1": D1, "M2": K2, "D2": D2}
WAY = {"R": R, "T": T, "R1": np.eye(3), "P1": np.eye(3, 4)}


def test_the_sample_s_pair_by_either_file_by_both_and_by_its_folder(tmp_path: Path) -> None:
    cameras = stored(tmp_path / "intrinsics.yml", **CAMERAS)
    way = stored(tmp_path / "extrinsics.yml", **WAY)
    (tmp_path / "notes.txt").write_text("calibrated on Monday\n")
    (tmp_path / "broken.json").write_text("{")
    for paths in ([cameras], [way], [cameras, way], [way, cameras], [tmp_path]):
        found = read(paths)
        is_the_rig(found.rig)
        assert [remark.code for remark in found.remarks] == ["no_size"]
        assert "1280x720 assumed" in found.remarks[0].text
    way.unlink()
    with pytest.raises(InvalidRig, match=r"intrinsics.yml: has both camera matrices, but not R and T"):
        read([cameras])


def test_a_file_of_cameras_beside_a_whole_one_must_agree(tmp_path: Path) -> None:
    whole = stored(tmp_path / "stereo.yml", **CAMERAS, R=R, T=T)
    cameras = stored(tmp_path / "intrinsics.yml", **CAMERAS)
    is_the_rig(read([cameras]).rig)
    is_the_rig(read([cameras, whole]).rig)
    stored(cameras, **{**CAMERAS, "M1": K2})
    with pytest.raises(
        InvalidRig, match=r"are not the files of one calibration: intrinsics.yml is a part of"
    ):
        read([cameras, whole])


@pytest.mark.parametrize(
    "names", [("left", "right"), ("calib_l", "calib_r"), ("cam0", "cam1"), ("Left-1", "Right-1")]
)
def test_a_file_a_camera_and_one_of_both(names: tuple[str, str], tmp_path: Path) -> None:
    # exchanged names must exchange the cameras
    left = stored(tmp_path / f"{names[0]}.xml", cameraMatrix=K1, distCoeffs=D1, rms_error=0.2)
    right = stored(tmp_path / f"{names[1]}.xml", cameraMatrix=K2, distCoeffs=D2, rms_error=0.3)
    way = stored(tmp_path / "stereo.xml", R=R, T=T)
    for paths in ([left], [right], [way], [tmp_path], [right, way, left]):
        is_the_rig(read(paths).rig)
    left.rename(tmp_path / "x")
    right.rename(left)
    (tmp_path / "x").rename(right)
    assert read([way]).rig.left.fx == 820.25


def test_the_file_of_the_right_camera_may_hold_the_pose(tmp_path: Path) -> None:
    stored(tmp_path / "left.yml", camera_matrix=K1, distortion_coefficients=D1)
    stored(tmp_path / "right.yml", camera_matrix=K2, distortion_coefficients=D2, R=R, T=T)
    is_the_rig(read([tmp_path / "left.yml"]).rig)


# --- rectified, fisheye, omnidirectional --------------------------------------------------------


def rectified(**other: object) -> tuple[dict[str, object], tuple[np.ndarray, ...]]:
    found = cv2.stereoRectify(K1, D1, K2, D2, (1280, 720), R, T, **other)[:5]
    return dict(zip(("R1", "R2", "P1", "P2", "Q"), found, strict=True)), found


@pytest.mark.parametrize("keys", [("P1", "P2"), ("Q",)])
@pytest.mark.parametrize("flags", [0, cv2.CALIB_ZERO_DISPARITY])
def test_p_and_q_alone_are_the_rectified_pair(keys: tuple[str, ...], flags: int, tmp_path: Path) -> None:
    values, (_, _, P1, P2, _) = rectified(flags=flags)
    path = stored(
        tmp_path / "rectified.yml", **{key: values[key] for key in keys}, size=np.array([1280, 720])
    )
    rig = read([path]).rig
    assert rig.baseline_m == pytest.approx(float(np.linalg.norm(T)), rel=1e-12)
    assert rig.is_rectified
    points = np.array([[0.3, -0.2, 2.0], [-0.4, 0.1, 5.0]])
    homogeneous = np.hstack([points, np.ones((2, 1))])
    for P, uv in zip((P1, P2), rig.project(points), strict=True):
        image = homogeneous @ P.T
        np.testing.assert_allclose(uv, image[:, :2] / image[:, 2:], atol=1e-9)


def test_turns_that_rectify_stand_for_r_and_t(tmp_path: Path) -> None:
    values, _ = rectified()
    for keys in (("R1", "R2", "P1", "P2"), ("R1", "R2", "Q")):
        path = stored(tmp_path / "rectified.yml", **CAMERAS, **{key: values[key] for key in keys})
        rig = read([path], RigReading(size_px=(1280, 720))).rig
        np.testing.assert_allclose(rig.right_from_left.R, R, atol=1e-9)
        np.testing.assert_allclose(rig.right_from_left.t, T[:, 0], atol=1e-9)
        assert rig.left.lens == BrownConrady(*D1[0])


F1, F2 = np.array([[-0.03, 0.011, -0.007, 0.0012]]), np.array([[-0.028, 0.01, -0.006, 0.001]])


@pytest.mark.parametrize(
    "said",
    [
        {"distortion_model": "fisheye"},
        {"model": "equidistant"},
        {"fisheye": 1},
        {"camera_model": "KANNALA_BRANDT"},
    ],
)
def test_four_terms_are_a_fisheye_s_where_the_file_says_so(said: dict[str, object], tmp_path: Path) -> None:
    values: dict[str, object] = {"K1": K1, "D1": F1.T, "K2": K2, "D2": F2.T, **WHOLE}
    rig = read([stored(tmp_path / "plain.yml", **values)]).rig
    assert rig.left.lens == BrownConrady(*F1[0])  # k1, k2, p1, p2
    rig = read([stored(tmp_path / "fisheye.yml", **values, **said)]).rig
    assert (rig.left.lens, rig.right.lens) == (KannalaBrandt(*F1[0]), KannalaBrandt(*F2[0]))
    points = np.array([[1.5, -0.7, 1.0], [-0.2, 0.3, 0.4]])
    found, _ = cv2.fisheye.projectPoints(points[:, None], np.zeros(3), np.zeros(3), K1, F1)
    np.testing.assert_allclose(rig.left.project(points), found[:, 0], atol=1e-9)
    five = stored(tmp_path / "fisheye.yml", **{**values, "D1": D1}, **said)
    with pytest.raises(InvalidRig, match="D1: has 5 numbers, must have 4, as of a fisheye lens"):
        read([five])


def test_xi_is_an_omnidirectional_lens(tmp_path: Path) -> None:
    xi = {"xi1": np.array([[1.25]]), "xi2": 1.5}
    path = stored(tmp_path / "omni.xml", K1=K1, D1=F1, K2=K2, D2=F2, **xi, **WHOLE)
    rig = read([path]).rig
    assert (rig.left.lens, rig.right.lens) == (Mei(1.25, *F1[0]), Mei(1.5, *F2[0]))


# --- the unit that a file says ------------------------------------------------------------------

NO_UNIT = {"K1": K1.tolist(), "D1": D1.tolist(), "K2": K2.tolist(), "D2": D2.tolist(), "R": R.tolist()}
NO_UNIT["image_size"] = [1280, 720]
LONG = float(np.linalg.norm(T)) * 1e3


def of_unit(times: float, **said: object) -> Reading:
    """The rig whose T is written `times` as long as in metres, beside what the file says of lengths."""
    return parse(json.dumps({**NO_UNIT, "T": (T * times).tolist(), **said}))


@pytest.mark.parametrize(
    ("times", "said", "unit"),
    [
        (1e3, {"baseline_mm": LONG}, "mm"),
        (1e3, {"baseline_cm": round(LONG / 10, 2)}, "mm"),
        (1e2, {"stereo": {"baseline_mm": -LONG}}, "cm"),
        (1e3, {"baseline_m": LONG / 1e3}, "mm"),
        (1e3, {"baseline": LONG / 1e3}, "mm"),
        (1e2, {"baseline": LONG}, "cm"),
        (40, {"baseline_mm": LONG, "square_size_mm": 25}, "25mm"),
        (1e3, {"units": "mm"}, "mm"),
        (1e3, {"square_size_mm": 24.5}, "mm"),
    ],
)
def test_a_baseline_or_a_board_s_side_tells_the_unit(
    times: float, said: dict[str, object], unit: str
) -> None:
    found = of_unit(times, **said)
    assert found.unit == unit
    is_the_rig(found.rig)
    assert [remark.code for remark in found.remarks] == ([] if "units" in said else ["unit_said"])
    same = parse(json.dumps({**NO_UNIT, "T": (T * times).tolist(), **said}), RigReading(unit=unit))
    is_the_rig(same.rig)
    assert same.remarks == ()


def test_metres_are_no_news_and_the_same_number_twice_tells_nothing() -> None:
    for said in ({"baseline_m": LONG / 1e3}, {"square_size_m": 0.025}, {"baseline": LONG / 1e3}):
        found = of_unit(1, **said)
        is_the_rig(found.rig)
        assert found.remarks == ()
    with pytest.raises(InvalidRig, match="unit of its lengths is not said"):
        of_unit(1e3, baseline=LONG)
    with pytest.raises(InvalidRig, match="unit of its lengths is not said"):  # 29 mm, or 7 squares
        parse(json.dumps({**NO_UNIT, "T": [-29, 0, 0], "square_size_mm": 25}))


def test_a_person_s_unit_goes_before_the_file_s() -> None:
    text = json.dumps({**NO_UNIT, "T": (T * 1e3).tolist(), "baseline_mm": LONG})
    found = parse(text, RigReading(unit="cm"))
    assert found.rig.baseline_m == pytest.approx(LONG / 1e2)
    assert [remark.code for remark in found.remarks] == ["unit_said"]


def test_a_baseline_of_no_unit_is_remarked_on() -> None:
    for times, said in (
        (1, {"baseline": 0.68}),
        (1, {"baseline_mm": 85.2}),
        (1, {"baseline_mm": 83.1, "unit": "cm"}),
    ):
        (remark, *_) = of_unit(times, **said).remarks
        assert remark.code == "baseline_differs"
        assert f"{next(iter(said.values()))} differs from the length 0.08313 of T" in remark.text


# --- names that are not understood --------------------------------------------------------------


@pytest.mark.parametrize(
    ("renamed", "said"),
    [
        (
            {"R": "turn_ab"},
            "but not R between the cameras; not understood: turn_ab; rename",
        ),
        (
            {"T": "shift"},
            "but not T between the cameras; not understood: shift; rename",
        ),
        (
            {"R": "turn_ab", "T": "shift"},
            "but not R and T between the cameras; not understood: turn_ab",
        ),
        (
            {"K1": "K_event", "D1": "dist_event", "K2": "K_ir", "D2": "dist_ir"},
            "has R and T, and no camera matrices found; not understood: K_event, dist_event, K_ir, dist_ir;",
        ),
        (
            {"K1": "cam_K", "K2": "proj_K"},
            "matrix, cam_K, of no side; not understood: proj_K",
        ),
        ({"K2": "K_ir"}, "K2 is missing: the right camera's matrix; not understood: K_ir; rename what is K2"),
    ],
)
def test_what_was_not_understood_is_named_and_renaming_it_cures(renamed: dict[str, str], said: str) -> None:
    values: dict[str, object] = {**NO_UNIT, "T": T[:, 0].tolist()}
    with pytest.raises(InvalidRig) as caught:
        parse(json.dumps({renamed.get(key, key): value for key, value in values.items()}))
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)
    is_the_rig(parse(json.dumps(values)).rig)


def test_six_names_are_enough() -> None:
    values = {"K1": NO_UNIT["K1"], "K2": NO_UNIT["K2"], **{f"odd_{letter}": [1, 2] for letter in "abcdefgh"}}
    with pytest.raises(InvalidRig, match="odd_e, odd_f; rename what is R and T, or name the file"):
        parse(json.dumps(values))


def test_a_folder_with_a_file_of_a_known_name_says_what_it_looks_like(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("calibrated on Monday")
    path = tmp_path / "calib.txt"
    for text, said in (
        ("1 2 3\n4 5 6\n", "looks like a table of numbers"),
        (
            "D = [0.1]\n# oST version 5.0\n[image]\n",
            "looks like what ROS's",
        ),
    ):
        path.write_text(text)
        with pytest.raises(OutputError, match=f"holds no calibration: .*calib.txt: {said}"):
            read([tmp_path])


# --- what is no calibration ---------------------------------------------------------------------


def nested(depth: int) -> str:
    return "<opencv_storage>" + "<a>" * depth + "</a>" * depth + "</opencv_storage>"


HARM: dict[str, Callable[[], str]] = {
    "laughs": lambda: (
        '<!DOCTYPE a [<!ENTITY a "aaa"><!ENTITY b "&a;&a;">]><opencv_storage><K1>&b;</K1></opencv_storage>'
    ),
    "a file": lambda: (
        '<!DOCTYPE a [<!ENTITY a SYSTEM "file:///etc/passwd">]><opencv_storage><K1>&a;</K1></opencv_storage>'
    ),
    "deep XML": lambda: nested(5000),
    "deep JSON": lambda: '{"K1":' + "[" * 100_000,
    "deep YAML": lambda: "%YAML:1.0\n" + "".join(f"{' ' * i}K1:\n" for i in range(1000)),
    "long YAML": lambda: "%YAML:1.0\nK1: [" + "1, " * 500_000 + "1]",
    "merges": lambda: "%YAML:1.0\na: &a {K1: 1}\nb: {<<: [*a, *a]}",
    "an object": lambda: "%YAML:1.0\nK1: !!python/object/apply:os.getcwd []",
}


@pytest.mark.parametrize("harm", HARM)
def test_what_means_harm_is_one_line(harm: str) -> None:
    with pytest.raises(InvalidRig) as caught:
        storage_table(HARM[harm]())
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 250
    with pytest.raises(InvalidRig):
        parse(HARM[harm]())
