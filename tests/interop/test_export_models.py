"""COLMAP's text model and Nerfstudio's transforms: by hand, by pycolmap, and there and back."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pycolmap
import pytest
from hypothesis import given

from rigsim.errors import InvalidRig
from rigsim.interop.formats.colmap import FORMAT as COLMAP
from rigsim.interop.formats.colmap import colmap_files, parse_colmap
from rigsim.interop.formats.format import Asked
from rigsim.interop.formats.nerfstudio import FORMAT as NERFSTUDIO
from rigsim.interop.formats.nerfstudio import parse_transforms, transforms_json
from rigsim.interop.formats.photogrammetry.colmap_models import camera_of
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.eucm import Eucm
from rigsim.rig.lens.fov import FieldOfView
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.rational import Rational
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from tests.helpers.calibrations import read
from tests.helpers.rig_strategies import rigs, same_rig

LENS = Intrinsics(640, 480, 800.0, 810.0, 319.5, 239.5)
# the right camera half a metre to the right, turned by 90 deg about z: quaternion (cos 45, 0, 0, sin 45)
QUARTER = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
RIG = StereoRig(LENS, LENS, Pose(QUARTER, np.array([0.0, -0.5, 0.0])))
MOVED = Pose.from_rotvec([0.2, -0.1, 0.3], [0.5, -0.25, 1.0])
POINTS_WORLD = np.array([[0.1, -0.2, 3.0], [-0.3, 0.25, 4.0]])


# --- COLMAP -------------------------------------------------------------------------------------


def test_colmap_by_hand() -> None:
    files = colmap_files(RIG)
    lines = {name: [line for line in text.splitlines() if line[:1] != "#"] for name, text in files.items()}
    # an image of 640 px has its middle at 319.5 here and at 320.0 there
    assert lines["cameras.txt"][0] == "1 PINHOLE 640 480 800.0 810.0 320.0 240.0"
    assert lines["images.txt"][0] == "1 1.0 0.0 0.0 0.0 0.0 0.0 0.0 1 left.png"
    assert lines["images.txt"][1] == ""
    words = lines["images.txt"][2].split()
    assert (words[0], words[8], words[9]) == ("2", "2", "right.png")
    np.testing.assert_allclose(
        [float(word) for word in words[1:8]], [0.5**0.5, 0, 0, 0.5**0.5, 0, -0.5, 0], atol=1e-15
    )
    assert lines["rigs.txt"][0].split()[:7] == ["1", "2", "CAMERA", "1", "CAMERA", "2", "1"]
    assert lines["frames.txt"] == ["1 1 1.0 0.0 0.0 0.0 0.0 0.0 0.0 2 CAMERA 1 1 CAMERA 2 2"]


@given(rigs())
def test_colmap_there_and_back(rig: StereoRig) -> None:
    files = colmap_files(rig, [MOVED], [("a.png", "b.png")])
    same_rig(parse_colmap(files), rig)
    # older models have no rigs: the first two images tell
    same_rig(parse_colmap({name: files[name] for name in ("cameras.txt", "images.txt")}), rig)


@pytest.mark.parametrize(
    ("distortion", "model"),
    [
        (None, "PINHOLE"),
        (BrownConrady(-0.2, 0.05, 1e-3, -2e-3), "OPENCV"),
        (BrownConrady(-0.2, 0.05, 1e-3, -2e-3, 0.01), "FULL_OPENCV"),
        (Rational(-0.2, 0.05, 1e-3, -2e-3, 0.01, 0.1, 0.02, 0.003), "FULL_OPENCV"),
        (KannalaBrandt(-0.02, 0.01, -0.003, 0.002), "OPENCV_FISHEYE"),
        (FieldOfView(0.9), "FOV"),
        (Eucm(0.6, 1.1), "EUCM"),
    ],
)
def test_pycolmap_opens_it_and_projects_alike(tmp_path: Path, distortion: Lens | None, model: str) -> None:
    lens = Intrinsics(640, 480, 800.0, 810.0, 301.5, 251.25, distortion)
    other = Intrinsics(600, 500, 700.0, 705.0, 299.0, 260.0, distortion)
    turned = Pose.from_rotvec([0.02, -0.1, 0.03])
    rig = StereoRig(lens, other, Pose(turned.R, -turned.R @ [0.2, 0.01, -0.02]))
    names = [("left/0.png", "right/0.png"), ("left/1.png", "right/1.png")]
    poses = [Pose(), MOVED]
    for name, text in colmap_files(rig, poses, names).items():
        (tmp_path / name).write_text(text)
    found = pycolmap.Reconstruction(str(tmp_path))
    assert (found.num_cameras(), found.num_images(), found.num_rigs(), found.num_frames()) == (2, 4, 1, 2)
    by_name = {image.name: image for image in found.images.values()}
    for pose, pair in zip(poses, names, strict=True):
        expected = rig.project(pose.apply(POINTS_WORLD))
        for name, uv in zip(pair, expected, strict=True):
            image = by_name[name]
            assert found.cameras[image.camera_id].model.name == model
            projected = [image.project_point(point) for point in POINTS_WORLD]
            np.testing.assert_allclose(np.array(projected) - 0.5, uv, rtol=0, atol=1e-9)
    files = [(path.name, path.read_text()) for path in tmp_path.iterdir()]
    got = read(COLMAP, *files)
    same_rig(got.rig, rig)
    assert got.unit == "m"


# one focal length, its own numbers of terms; 320.5 from the corner is the pixel 320 here
@pytest.mark.parametrize(
    ("line", "lens"),
    [
        ("SIMPLE_PINHOLE 640 480 500 320.5 240.5", None),
        ("SIMPLE_RADIAL 640 480 500 320.5 240.5 0.1", BrownConrady(0.1)),
        ("RADIAL 640 480 500 320.5 240.5 0.1 0.02", BrownConrady(0.1, 0.02)),
        ("SIMPLE_FISHEYE 640 480 500 320.5 240.5", KannalaBrandt()),
        ("FISHEYE 640 480 500 500 320.5 240.5", KannalaBrandt()),
        ("SIMPLE_RADIAL_FISHEYE 640 480 500 320.5 240.5 0.1", KannalaBrandt(0.1)),
        ("RADIAL_FISHEYE 640 480 500 320.5 240.5 0.1 0.02", KannalaBrandt(0.1, 0.02)),
    ],
)
def test_short_models(line: str, lens: Lens | None) -> None:
    name, width, height, *params = line.split()
    found = camera_of(["1", *line.split()], "here")
    assert found == Intrinsics(640, 480, 500, 500, 320, 240, lens)
    theirs = pycolmap.Camera(
        model=name, width=int(width), height=int(height), params=[float(p) for p in params]
    )
    point = np.array([0.3, -0.2, 1.0])
    np.testing.assert_allclose(theirs.img_from_cam(point[None])[0] - 0.5, found.project(point), atol=1e-9)


def test_rigs_of_three_and_of_one() -> None:
    pose = "1 0 0 0 {} 0 0"
    files = colmap_files(RIG)
    cameras = "".join(f"{i} PINHOLE 640 480 {400 + i} 400 320 240\n" for i in (1, 2, 3))
    three = f"1 1 CAMERA 1\n2 4 CAMERA 1 IMU 9 0 CAMERA 2 1 {pose.format(-1)} CAMERA 3 1 {pose.format(-3)}\n"
    texts = [("cameras.txt", cameras), ("rigs.txt", three), ("images.txt", files["images.txt"])]
    got = read(COLMAP, *texts, asked=Asked(cameras=("2", "3")))
    assert (got.rig.left.fx, got.rig.right_from_left.t.tolist(), got.unit) == (402, [-2, 0, 0], None)
    with pytest.raises(InvalidRig, match="a rig of the cameras 1, 2, 3: choose two, as --rig-cameras 1,2"):
        read(COLMAP, *texts)
    with pytest.raises(
        InvalidRig, match="every rig has one, so that its pictures are of a camera that moves"
    ):
        read(COLMAP, texts[0], ("rigs.txt", "1 1 CAMERA 1\n"))


def test_cameras_without_a_rig_must_keep_still() -> None:
    names = [("cam0/a_001.png", "cam1/b_001.png"), ("cam0/a_002.png", "cam1/b_002.png")]
    files = colmap_files(RIG, [Pose(), MOVED], names)
    texts = [(name, files[name]) for name in ("cameras.txt", "images.txt")]
    same_rig(read(COLMAP, *texts).rig, RIG)
    *before, last = (line for line in texts[1][1].splitlines() if line)
    words = last.split()
    moved = "\n\n".join([*before[1:], " ".join([*words[:5], str(float(words[5]) + 0.1), *words[6:]]), ""])
    with pytest.raises(InvalidRig, match="camera 2 moves against camera 1"):
        read(COLMAP, texts[0], ("images.txt", moved))
    alone = texts[1][1].replace("b_001", "b_7").replace("b_002", "b_8")
    with pytest.raises(InvalidRig, match="no image of camera 2 is called like one of camera 1"):
        read(COLMAP, texts[0], ("images.txt", alone))


@given(rigs(distorted=False))
def test_what_pycolmap_writes_is_read(tmp_path_factory: pytest.TempPathFactory, rig: StereoRig) -> None:
    folder = tmp_path_factory.mktemp("colmap")
    for name, text in colmap_files(rig).items():
        (folder / name).write_text(text)
    pycolmap.Reconstruction(str(folder)).write_text(str(folder))
    same_rig(parse_colmap({path.name: path.read_text() for path in folder.iterdir()}), rig)


@pytest.mark.parametrize(
    ("file", "old", "new", "message"),
    [
        (
            "cameras.txt",
            "1 PINHOLE",
            "1 DIVISION",
            r"cameras.txt, line 2: camera model DIVISION: must be one of",
        ),
        ("cameras.txt", "2 PINHOLE", "3 PINHOLE", "cameras.txt: camera 2 is missing: a rig needs two"),
        ("cameras.txt", "240.0\n", "240.0 0.1\n", "line 2: PINHOLE has 5 numbers, must have 4"),
        ("cameras.txt", "800.0", "fast", "cameras.txt, line 2: parameter fast: must be a number"),
        ("rigs.txt", "1 2 CAMERA", "1 1 CAMERA", "rigs.txt, line 2: must be a rig of two cameras"),
        ("rigs.txt", " 0.0 -0.5 0.0", " 0.0 -0.5", "rigs.txt, line 2: must be a rig of two cameras"),
        (
            "rigs.txt",
            "CAMERA 2 1 0.7",
            "CAMERA 2 1 0.9",
            "line 2: a quaternion of length 1.15 is no rotation",
        ),
    ],
)
def test_bad_colmap_is_one_line(file: str, old: str, new: str, message: str) -> None:
    files = colmap_files(RIG)
    assert old in files[file]
    files[file] = files[file].replace(old, new, 1)
    with pytest.raises(InvalidRig, match=message) as caught:
        parse_colmap(files)
    assert "\n" not in str(caught.value)


def test_a_colmap_model_of_one_image_is_no_rig() -> None:
    files = colmap_files(RIG)
    one = "".join(files["images.txt"].splitlines(keepends=True)[:3])
    with pytest.raises(InvalidRig, match=r"images.txt: has 1 image\(s\), must have 2"):
        parse_colmap({"cameras.txt": files["cameras.txt"], "images.txt": one})


def test_two_poses_of_one_colmap_camera_are_no_rig() -> None:
    files = colmap_files(RIG, names=[("000.png", "001.png")])
    one_camera = files["images.txt"].replace(" 2 001.png", " 1 001.png")
    assert one_camera != files["images.txt"]
    with pytest.raises(
        InvalidRig, match=r"000.png and 001.png are both of camera 1: two poses of one camera"
    ):
        parse_colmap({"cameras.txt": files["cameras.txt"], "images.txt": one_camera})


# --- Nerfstudio ---------------------------------------------------------------------------------


def test_transforms_by_hand() -> None:
    left, right = json.loads(transforms_json(RIG))["frames"]
    assert (left["fl_x"], left["fl_y"], left["cx"], left["cy"]) == (800, 810, 320, 240)
    assert (left["w"], left["h"], left["k1"], left["file_path"]) == (640, 480, 0, "left.png")
    # the left camera is at the origin and looks along the world's +z, its y up is the world's -y
    assert left["transform_matrix"] == [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]]
    # the right one sits at -R^T t = (0.5, 0, 0); its right, (1, 0, 0), is R^T x = (0, -1, 0) in the world
    assert right["transform_matrix"] == [[0, -1, 0, 0.5], [-1, 0, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]]


def test_transforms_project_alike_through_opengl_s_axes() -> None:
    frames = json.loads(transforms_json(RIG, [MOVED], [("left_0.png", "right_0.png")]))["frames"]
    for frame, uv in zip(frames, RIG.project(MOVED.apply(POINTS_WORLD)), strict=True):
        camera_from_world = np.linalg.inv(np.array(frame["transform_matrix"]))
        x, y, z, _ = camera_from_world @ np.column_stack([POINTS_WORLD, np.ones(2)]).T
        assert (z < 0).all()
        column = frame["fl_x"] * x / -z + frame["cx"]  # px from the picture's left edge
        row = frame["fl_y"] * -y / -z + frame["cy"]
        np.testing.assert_allclose(np.column_stack([column, row]) - 0.5, uv, atol=1e-9)


@given(rigs())
def test_transforms_there_and_back(rig: StereoRig) -> None:
    same_rig(parse_transforms(transforms_json(rig, [MOVED])), rig)


def test_transforms_with_shared_intrinsics_and_the_right_one_first() -> None:
    document = json.loads(transforms_json(RIG))
    shared = {key: document["frames"][0][key] for key in ("w", "h", "fl_x", "fl_y", "cx", "cy")}
    frames = [
        {key: frame[key] for key in ("file_path", "transform_matrix")} for frame in document["frames"][::-1]
    ]
    same_rig(parse_transforms(json.dumps({**shared, "frames": frames})), RIG)


def test_fisheyes_and_words_of_their_own() -> None:
    fisheye = Intrinsics(640, 480, 300, 301, 319.5, 239.5, KannalaBrandt(0.1, 0.02, 0.003, 0.004))
    rig = StereoRig(fisheye, fisheye, RIG.right_from_left)
    text = transforms_json(rig, names=[("cam0/1.png", "cam1/1.png")])
    got = read(NERFSTUDIO, text, asked=Asked(cameras=("cam0", "cam1")))
    same_rig(got.rig, rig)
    assert got.unit == "m"
    assert (
        read(NERFSTUDIO, text.replace("length_unit", "other"), asked=Asked(cameras=("cam0", "cam1"))).unit
        is None
    )
    with pytest.raises(InvalidRig, match="one model for all frames"):
        transforms_json(StereoRig(fisheye, LENS, RIG.right_from_left))


def test_poses_of_one_moving_camera_are_no_rig() -> None:
    document = json.loads(transforms_json(RIG, names=[("frame_1.png", "frame_2.png")]))
    with pytest.raises(
        InvalidRig, match="2 frames, none called left and right: poses of one camera that moves"
    ):
        parse_transforms(json.dumps(document))


def test_sides_that_move_against_each_other_are_no_rig() -> None:
    document = json.loads(
        transforms_json(RIG, [Pose(), MOVED], [("left_0", "right_0"), ("left_1", "right_1")])
    )
    same_rig(parse_transforms(json.dumps(document)), RIG)
    document["frames"][3]["transform_matrix"][0][3] += 0.1
    with pytest.raises(InvalidRig, match="the right camera moves against the left one"):
        parse_transforms(json.dumps(document))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"frames": []}, "frames 0: must be a list of two or more"),
        ({"camera_model": "EQUIRECTANGULAR"}, "camera_model EQUIRECTANGULAR: must be one of OPENCV"),
        ({"k4": 0.1}, "k4 of frame 0 0.1: must be 0"),
    ],
)
def test_bad_transforms_are_one_line(change: dict[str, object], message: str) -> None:
    with pytest.raises(InvalidRig, match=message):
        parse_transforms(json.dumps({**json.loads(transforms_json(RIG)), **change}))


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("fl_x", "fast", "fl_x of frame 1 fast: must be a number"),
        ("fl_x", -1, "focal length fx -1 px: must be > 0"),
        ("transform_matrix", [[1, 0], [0, 1]], "transform_matrix of frame 1: has 2 rows, must be 4"),
        (
            "transform_matrix",
            [[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
            "is no rotation .* det = -1",
        ),
    ],
)
def test_bad_frames_are_one_line(key: str, value: object, message: str) -> None:
    document = json.loads(transforms_json(RIG))
    document["frames"][1][key] = value
    with pytest.raises(InvalidRig, match=message):
        parse_transforms(json.dumps(document))


def test_what_is_no_json_is_one_line() -> None:
    with pytest.raises(InvalidRig, match="is not JSON: Expecting value"):
        parse_transforms("frames")
