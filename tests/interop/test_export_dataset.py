"""`rigsim export dataset`: each layout by its readers, the truth by the pictures, whole or absent."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import weakref
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pycolmap
import pytest

from rigsim.cli.app import run
from rigsim.errors import InvalidImage, InvalidRange, InvalidRig, NothingSeen, OutputError
from rigsim.interop.files.dataset import DATASET_FORMATS, check_format, write_dataset
from rigsim.interop.formats.calibration import read_calibration
from rigsim.interop.formats.rig_toml import write_rig
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig
from rigsim.sim.simulator import Simulator
from rigsim.study.scene.frames import DatasetFrame, Views, render_frames
from rigsim.study.scene.pictures import Pictures
from tests.helpers import scenes
from tests.helpers.documents import valid
from tests.helpers.rig_strategies import same_rig

RIG = StereoRig.rectified(Intrinsics(320, 240, 300.0, 300.0, 150.0, 125.0), 0.12)
TURNED = Pose.from_rotvec([0.02, -0.05, 0.03])
DISTORTED = StereoRig(
    Intrinsics(320, 240, 300.0, 310.0, 150.0, 125.0, BrownConrady(-0.1, 0.02, 1e-3, -1e-3)),
    Intrinsics(320, 240, 310.0, 300.0, 165.0, 118.0, BrownConrady(-0.08, 0.01, -1e-3, 1e-3)),
    Pose(TURNED.R, -TURNED.R @ [0.12, 0.01, -0.02]),
)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Every format once, three frames each; opencv's and colmap's from a rig that is nothing special."""
    folder = tmp_path_factory.mktemp("datasets")
    (folder / "rectified.toml").write_text(write_rig(RIG))
    (folder / "distorted.toml").write_text(write_rig(DISTORTED))
    for format in DATASET_FORMATS:
        rig = folder / ("rectified.toml" if format in ("middlebury", "kitti") else "distorted.toml")
        words = f"--scene boards --format {format} --frames 3 --seed 5 --turn 4".split()
        assert run(["export", "dataset", *words, "--rig", str(rig), "--out", str(folder / format)]) == 0
    return folder


def grey(path: Path) -> np.ndarray:
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    assert image.shape == (240, 320)
    return np.asarray(image, dtype=np.float64)


def sampled(image: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    found = cv2.remap(image.astype(np.float32), u.astype(np.float32), v.astype(np.float32), cv2.INTER_LINEAR)
    return np.asarray(found, dtype=np.float64)


def misfit(left: np.ndarray, right: np.ndarray, mask: np.ndarray) -> float:
    """Correlation lost between what should be the same, away from the mask's rim."""
    inner = cv2.erode((mask == 255).astype(np.uint8), np.ones((5, 5), np.uint8)).astype(bool)
    assert inner.mean() > 0.3
    return float(1 - np.corrcoef(left[inner], right[inner])[0, 1])


def lies_best_where_it_should(
    left: np.ndarray, right: np.ndarray, u: np.ndarray, v: np.ndarray, mask: np.ndarray
) -> None:
    """The right picture looks like the left one at u, v, and less so a quarter of a pixel beside."""
    found = misfit(left, sampled(right, u, v), mask)
    assert found < 0.02
    for du, dv in ((0.25, 0.0), (-0.25, 0.0), (0.0, 0.25), (0.0, -0.25)):
        assert misfit(left, sampled(right, u + du, v + dv), mask) > 1.3 * found


GRID_V, GRID_U = np.mgrid[:240, :320].astype(np.float64)


@pytest.mark.parametrize("index", [0, 2])
def test_middlebury_s_disparity_takes_one_picture_to_the_other(made: Path, index: int) -> None:
    folder = made / "middlebury" / f"{index:06d}"
    left, right = grey(folder / "im0.png"), grey(folder / "im1.png")
    disparity = cv2.imread(str(folder / "disp0.pfm"), cv2.IMREAD_UNCHANGED).astype(np.float64)
    other = cv2.imread(str(folder / "disp1.pfm"), cv2.IMREAD_UNCHANGED).astype(np.float64)
    mask = cv2.imread(str(folder / "mask0nocc.png"), cv2.IMREAD_UNCHANGED)
    at = np.where(np.isfinite(disparity), GRID_U - disparity, -9)
    lies_best_where_it_should(left, right, at, GRID_V, mask)
    # the right one's disparity agrees where both see the point, and not where only the left one does
    back = sampled(other, at, GRID_V)
    same = np.abs(back - disparity) < 0.3
    assert same[mask == 255].mean() > 0.98
    assert (mask == 128).sum() > 200
    assert same[mask == 128].mean() < 0.2
    calib = (folder / "calib.txt").read_text()
    known = disparity[np.isfinite(disparity)]
    assert f"vmin={int(np.floor(known.min()))}\nvmax={int(np.ceil(known.max()))}\n" in calib


def test_kitti_s_disparities_are_256ths(made: Path) -> None:
    folder = made / "kitti" / "training"
    left, right = grey(folder / "image_2" / "000001_10.png"), grey(folder / "image_3" / "000001_10.png")
    occ = cv2.imread(str(folder / "disp_occ_0" / "000001_10.png"), cv2.IMREAD_UNCHANGED)
    noc = cv2.imread(str(folder / "disp_noc_0" / "000001_10.png"), cv2.IMREAD_UNCHANGED)
    mask = cv2.imread(str(folder / "mask" / "000001_10.png"), cv2.IMREAD_UNCHANGED)
    assert occ.dtype == noc.dtype == np.uint16
    assert np.array_equal(noc > 0, mask == 255)
    assert np.array_equal(occ > 0, mask > 0)
    assert np.array_equal(noc[noc > 0], occ[noc > 0])
    lies_best_where_it_should(left, right, GRID_U - occ / 256, GRID_V, mask)
    # the same view as Middlebury's, whose disparity is not rounded
    exact = cv2.imread(str(made / "middlebury" / "000001" / "disp0.pfm"), cv2.IMREAD_UNCHANGED)
    assert np.abs(occ[occ > 0] / 256 - exact[occ > 0]).max() <= 0.5 / 256 + 1e-5


def test_opencv_s_depth_projects_into_the_other_picture(made: Path) -> None:
    folder = made / "opencv"
    storage = cv2.FileStorage(str(folder / "stereo.yml"), cv2.FILE_STORAGE_READ)
    K1, D1, K2, D2, R, T = (storage.getNode(name).mat() for name in ("K1", "D1", "K2", "D2", "R", "T"))
    left, right = (grey(folder / side / "000002.png") for side in ("left", "right"))
    depth = np.load(folder / "depth_left" / "000002.npy")
    assert depth.dtype == np.float32
    mask = cv2.imread(str(folder / "mask" / "000002.png"), cv2.IMREAD_UNCHANGED)
    uv = np.column_stack([GRID_U.ravel(), GRID_V.ravel()])
    normal = cv2.undistortPoints(uv[:, None], K1, D1)[:, 0]
    points = np.column_stack([normal, np.ones(len(uv))]) * np.nan_to_num(depth.ravel(), nan=1.0)[:, None]
    seen, _ = cv2.projectPoints(points @ R.T + T[:, 0], np.zeros(3), np.zeros(3), K2, D2)
    at = seen[:, 0].reshape(240, 320, 2)
    lies_best_where_it_should(left, right, at[..., 0], at[..., 1], mask)
    # and where the right camera sees the point, its depth map has it
    deeper = (points @ R.T + T[:, 0])[:, 2].reshape(240, 320)
    there = sampled(np.load(folder / "depth_right" / "000002.npy"), at[..., 0], at[..., 1])
    assert (np.abs(there / deeper - 1) < 0.01)[mask == 255].mean() > 0.95  # but for edges, interpolated


def test_colmap_s_poses_take_one_frame_to_the_next(made: Path) -> None:
    folder = made / "colmap"
    model = pycolmap.Reconstruction(str(folder / "sparse" / "0"))
    images = {image.name: image for image in model.images.values()}
    assert sorted(images) == sorted(f"{side}/{i:06d}.png" for side in ("left", "right") for i in range(3))
    for name in images:
        assert (folder / "images" / name).is_file()
    first, moved = images["left/000000.png"], images["left/000002.png"]
    camera = model.cameras[first.camera_id]
    assert camera.model.name == "OPENCV"
    depth = np.load(folder / "depth_left" / "000000.npy").astype(np.float64)
    other = np.load(folder / "depth_left" / "000002.npy").astype(np.float64)
    checked = agrees = 0
    for v, u in [(v, u) for v in range(10, 240, 20) for u in range(10, 320, 20)]:
        if not np.isfinite(depth[v, u]):
            continue
        ray = camera.cam_from_img(np.array([u + 0.5, v + 0.5]))
        world = first.cam_from_world().inverse() * (np.append(ray, 1.0) * depth[v, u])
        at = moved.project_point(world)
        column, row = (int(np.floor(value)) for value in at)
        if 0 <= column < 320 and 0 <= row < 240 and np.isfinite(other[row, column]):
            checked += 1
            agrees += abs((moved.cam_from_world() * world)[2] / other[row, column] - 1) < 0.02
    assert checked > 80
    assert agrees > 0.9 * checked
    # they are different places: somewhere within 5 % of the depth and 4 degrees
    moved_pose = moved.cam_from_world() * first.cam_from_world().inverse()
    angle = np.degrees(np.linalg.norm(np.array(moved_pose.rotation.matrix()) - np.eye(3)) / np.sqrt(2))
    assert 0.3 < angle < 4 * 3**0.5
    assert 0.01 < np.linalg.norm(moved_pose.translation) < 0.05 * 3**0.5 * 5


@pytest.mark.parametrize("format", DATASET_FORMATS)
def test_the_rig_is_read_from_the_folder(made: Path, format: str) -> None:
    same_rig(read_calibration(made / format), RIG if format in ("middlebury", "kitti") else DISTORTED)


@pytest.mark.parametrize("format", DATASET_FORMATS)
def test_the_cloud_is_the_depth(made: Path, format: str) -> None:
    (path, *_) = sorted((made / format).rglob("*points*/*.ply")) or sorted(
        (made / format).rglob("points.ply")
    )
    header, _, body = path.read_bytes().partition(b"end_header\n")
    assert b"comment metres; x right, y down, z forward of the left camera" in header
    table = np.frombuffer(body, dtype=[("xyz", "<f4", 3), ("rgb", "u1", 3)])
    rig = read_calibration(made / format)
    uv = rig.left.project(table["xyz"])
    np.testing.assert_allclose(uv, np.rint(uv), atol=2e-3)
    u, v = np.rint(uv).astype(int).T
    images = sorted(
        path
        for path in (made / format).rglob("*.png")
        if "im0" in path.name or path.parent.name in ("left", "image_2")
    )
    assert np.array_equal(grey(images[0])[v, u], table["rgb"][:, 0])


@pytest.mark.parametrize("format", DATASET_FORMATS)
def test_the_manifest_says_what_made_it(made: Path, format: str) -> None:
    manifest = json.loads((made / format / "manifest.json").read_text())
    assert (manifest["format"], manifest["seed"], manifest["scene"]) == (format, 5, "boards")
    assert {"rigsim", "mujoco", "numpy", "renderer", "command", "sensor", "turn_deg"} <= set(manifest)
    poses = [frame["left_from_world"] for frame in manifest["frames"]]
    assert len(poses) == 3
    assert poses[0] != poses[1] != poses[2]


def test_the_document_says_what_was_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "kitti"
    words = "--format kitti --frames 1 --seed 5 --move 2cm --baseline 100 --focal 80 --resolution 120x80"
    assert run(["export", "dataset", *words.split(), "--out", str(folder), "--json"]) == 0
    document = valid("export-dataset", capsys.readouterr().out)
    files = sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())
    assert document["written"] == {"folder": str(folder), "files": files}
    assert (document["frames"], document["seed"], document["move_mm"]) == (1, 5, 20)
    assert document["rig"]["baseline_mm"] == 100
    assert document["provenance"]["scene"] == "boards"


def test_one_seed_one_data_set_and_frames_of_their_own(made: Path, tmp_path: Path) -> None:
    """The first two of three frames are the two of two, to the byte; another seed's are others."""
    for seed, name in ((5, "same"), (6, "other")):
        words = f"--scene boards --format kitti --frames 2 --seed {seed} --turn 4".split()
        rig = str(made / "rectified.toml")
        assert run(["export", "dataset", *words, "--rig", rig, "--out", str(tmp_path / name)]) == 0
    files = [path.relative_to(tmp_path / "same") for path in (tmp_path / "same").rglob("*_10.*")]
    assert len(files) == 12
    for file in files:
        same = (tmp_path / "same" / file).read_bytes()
        assert same == (made / "kitti" / file).read_bytes()
        first_frame = "000000" in file.name
        assert (same == (tmp_path / "other" / file).read_bytes()) == first_frame


# --- viewpoints ---------------------------------------------------------------------------------


def test_a_rig_moved_off_its_mount_takes_the_truth_along(tmp_path: Path) -> None:
    """Half a metre forward, then 0.3 m to the right and a turn of 0.2 rad to the left, by hand."""
    lens = Intrinsics(200, 100, 150.0, 150.0, 99.5, 49.5)
    rig = StereoRig.rectified(lens, 0.2)
    rng = np.random.default_rng(3)
    with Simulator(scenes.write(tmp_path, scenes.SLANTED), renderer="rays") as simulator:
        for shift in (Pose(t=np.array([0.0, 0.0, 0.5])), Pose.from_rotvec([0, -0.2, 0], [0.3, 0, 0])):
            simulator.place(rig, shift)
            # the rig's x is the world's -y, its z the world's x; the left camera sits 0.1 m to its left
            angle = -shift.rotvec_rad[1]
            forward = np.array([np.cos(angle), np.sin(angle), 0.0])
            to_right = np.array([np.sin(angle), -np.cos(angle), 0.0])
            origin = np.array([shift.t[2], -shift.t[0], 1.0]) - 0.1 * to_right
            np.testing.assert_allclose(simulator.left_from_world.inverse.t, origin, atol=1e-12)
            truth = simulator.truth(200, rng)
            x, y, z = truth.points_left.T
            world = origin + x[:, None] * to_right + y[:, None] * [0, 0, -1.0] + z[:, None] * forward
            wall = np.abs((world - scenes.WALL_POINT_WORLD) @ scenes.WALL_NORMAL_WORLD) < 1e-6
            assert wall.sum() > 60
            frame = simulator.render(supersample=1)
            depth = frame.left.depth[50, 150]
            ray = np.array([(150 - 99.5) / 150, (50 - 49.5) / 150, 1.0])
            hit = origin + depth * (ray[0] * to_right + ray[1] * np.array([0, 0, -1.0]) + forward)
            assert abs((hit - scenes.WALL_POINT_WORLD) @ scenes.WALL_NORMAL_WORLD) < 1e-6
        simulator.place(rig)
        np.testing.assert_allclose(simulator.left_from_world.inverse.t, [0, 0.1, 1], atol=1e-12)


def test_views_that_see_too_little_are_drawn_again(tmp_path: Path) -> None:
    rig = StereoRig.rectified(Intrinsics(64, 48, 60.0, 60.0, 31.5, 23.5), 0.1)
    with Simulator(scenes.write(tmp_path, scenes.SLANTED), renderer="rays") as simulator:
        frames = list(render_frames(simulator, rig, Views(count=6, seed=1, turn_deg=45), Sensor()))
        near = min(float(np.nanmin(frame.depth_left)) for frame in frames)
        floor = near * 1.01
        views = Views(count=6, seed=1, turn_deg=45, nearest_m=floor)
        farther = render_frames(simulator, rig, views, Sensor())
        assert min(float(np.nanmin(frame.depth_left)) for frame in list(farther)[1:]) >= floor
        share = [np.isfinite(frame.depth_left).mean() for frame in frames]
        assert min(share) > 0.4 * share[0]
        for words, message in (
            ({"turn_deg": 91.0}, r"turn 91 deg: must be >= 0 and <= 90"),
            ({"move_m": -1.0}, "move -1 m: must be >= 0"),
            ({"seed": -1}, "seed -1: must be >= 0"),
            ({"count": 0}, "frames 0: must be >= 1"),
        ):
            with pytest.raises(InvalidRange, match=message):
                Views(**{"count": 1, "seed": 1, **words})
        with pytest.raises(InvalidRange, match="sensor bits 0"):
            next(render_frames(simulator, rig, Views(count=1, seed=1), Sensor(bits=0)))
        with pytest.raises(
            NothingSeen, match=r"of 50 views within 1e\+07 mm .* nothing nearer .* a smaller --move"
        ):
            list(render_frames(simulator, rig, Views(count=2, seed=1, move_m=1e4), Sensor()))


def test_a_sensor_of_12_bits_with_a_lens_fills_16(tmp_path: Path) -> None:
    """What the lens bends is straightened, so that the rig stays a pinhole's, and white is near 65535."""
    rig = StereoRig.rectified(Intrinsics(160, 120, 150.0, 150.0, 79.5, 59.5), 0.1)
    bent = Sensor(bits=12, distortion=BrownConrady(k1=-0.1), full_well_e=8000.0, read_noise_e=3.0)
    with Simulator("boards", renderer="rays") as simulator:
        pictures = {
            name: next(render_frames(simulator, rig, Views(count=1, seed=1), sensor)).pictures.left
            for name, sensor in (("bent", bent), ("plain", Sensor()))
        }
    assert pictures["bent"].dtype == np.uint16
    assert (pictures["bent"] % 16 == 0).all()
    assert pictures["plain"].dtype == np.uint8
    bright = pictures["plain"] > 100
    assert np.median(pictures["bent"][bright] / 65520 - pictures["plain"][bright] / 255) == pytest.approx(
        0, abs=0.02
    )
    assert np.corrcoef(pictures["bent"].ravel(), pictures["plain"].ravel())[0, 1] > 0.95


# --- whole or absent ----------------------------------------------------------------------------


def frame_of(index: int, rig: StereoRig = RIG, depth_m: float = 2.0) -> DatasetFrame:
    shape = (rig.left.height, rig.left.width)
    image = np.full(shape, index, dtype=np.uint8)
    depth = np.full(shape, depth_m)
    return DatasetFrame(
        index, rig, Pictures(image, image), depth, depth.copy(), np.ones(shape, dtype=bool), Pose()
    )


def everything(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


@pytest.mark.parametrize("error", [KeyboardInterrupt(), OSError(28, "full"), NothingSeen("no")])
def test_what_ends_half_way_leaves_nothing(tmp_path: Path, error: BaseException) -> None:
    def frames() -> Iterator[DatasetFrame]:
        yield frame_of(0)
        assert list(tmp_path.rglob("*.pfm"))  # it was on disk, under another name
        assert not (tmp_path / "new" / "set").exists()
        raise error

    kind = OutputError if isinstance(error, OSError) and not isinstance(error, OutputError) else type(error)
    with pytest.raises(kind):
        write_dataset(tmp_path / "new" / "set", "middlebury", RIG, frames(), count=2, manifest={})
    assert list(tmp_path.iterdir()) == []


def test_a_killed_one_leaves_nothing_under_its_name(tmp_path: Path) -> None:
    script = (
        "import sys, time; sys.path.insert(0, sys.argv[1])\n"
        "from pathlib import Path\n"
        "from tests.interop.test_export_dataset import RIG, frame_of\n"
        "from rigsim.interop.files.dataset import write_dataset\n"
        "def frames():\n"
        "    yield frame_of(0)\n"
        "    print('half', flush=True)\n"
        "    time.sleep(60)\n"
        "write_dataset(Path('set'), 'opencv', RIG, frames(), count=2, manifest={})\n"
    )
    here = str(Path(__file__).parents[2])
    process = subprocess.Popen(
        [sys.executable, "-c", script, here], cwd=tmp_path, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "half\n"
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    process.stdout.close()
    assert not (tmp_path / "set").exists()
    # what was unfinished is being removed
    assert all(name.startswith(".rigsim-") for name in os.listdir(tmp_path))


def test_memory_holds_two_frames_at_most(tmp_path: Path) -> None:
    alive: list[weakref.ref[np.ndarray]] = []
    most = 0

    def frames() -> Iterator[DatasetFrame]:
        nonlocal most
        for index in range(6):
            frame = frame_of(index)
            alive.append(weakref.ref(frame.depth_left))
            most = max(most, sum(ref() is not None for ref in alive))
            yield frame
            del frame

    write_dataset(tmp_path / "set", "opencv", RIG, frames(), count=6, manifest={})
    assert most <= 2
    assert len(list((tmp_path / "set" / "left").iterdir())) == 6


def test_a_filled_folder_needs_force(tmp_path: Path) -> None:
    for i in range(2):
        write_dataset(tmp_path / "set", "opencv", RIG, [frame_of(i)], count=1, manifest={}, force=i == 1)
        names = everything(tmp_path / "set")
        image = tmp_path / "set" / "left" / f"{i:06d}.png"
        assert cv2.imread(str(image), cv2.IMREAD_UNCHANGED)[0, 0] == i
    assert "left/000000.png" in names  # what was there under another name stays
    assert not [name for name in names if ".tmp" in name]
    with pytest.raises(OutputError, match=r"already holds .* add --force"):
        write_dataset(tmp_path / "set", "opencv", RIG, [frame_of(0)], count=1, manifest={})


# --- what a format cannot hold ------------------------------------------------------------------


def test_rigs_that_a_format_cannot_hold() -> None:
    doffs = StereoRig.rectified(RIG.left, 0.1, right=Intrinsics(320, 240, 300.0, 300.0, 160.0, 125.0))
    with pytest.raises(
        InvalidRig, match=r"kitti: doffs 10 px: must be 0.*hold this rig: middlebury, opencv, colmap"
    ):
        check_format("kitti", doffs)
    for format in ("kitti", "middlebury"):
        with pytest.raises(
            InvalidRig, match=f"format {format}: .*rectified rig.*hold this rig: opencv, colmap"
        ):
            check_format(format, DISTORTED)
    with pytest.raises(InvalidRange, match="format 'tum': must be one of middlebury, kitti, opencv, colmap"):
        check_format("tum", RIG)


def test_doffs_are_in_middlebury_s_disparity(tmp_path: Path) -> None:
    rig = StereoRig.rectified(RIG.left, 0.1, right=Intrinsics(320, 240, 300.0, 300.0, 160.0, 125.0))
    write_dataset(tmp_path / "set", "middlebury", rig, [frame_of(0, rig)], count=1, manifest={})
    found = cv2.imread(str(tmp_path / "set" / "000000" / "disp0.pfm"), cv2.IMREAD_UNCHANGED)
    assert found[7, 8] == 300 * 0.1 / 2.0 - 10  # Z = f b / (d + doffs)


def test_kitti_s_png_holds_256_px(tmp_path: Path) -> None:
    near = [frame_of(0), frame_of(1, depth_m=0.1)]  # 300 px * 0.12 m / 0.1 m = 360 px
    with pytest.raises(
        InvalidImage, match=r"frame 1: disparities 360 to 360 px: a PNG holds 0 to 255.996 px"
    ):
        write_dataset(tmp_path / "set", "kitti", RIG, near, count=2, manifest={})
    assert not (tmp_path / "set").exists()


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        ("--format kitti --frames 0", 2, "frames 0: must be >= 1"),
        ("--format tum --frames 1", 2, "format 'tum': must be one of"),
        ("--format kitti --frames 1 --vergence 4", 1, "formats that hold this rig: opencv, colmap"),
        ("--format kitti --frames 1 --move -3", 2, "move -3"),
        ("--format kitti --frames 1 --scene nowhere", 1, "nowhere"),
        ("--format kitti --frames 1 --turn 180", 2, "turn 180 deg: must be >= 0 and <= 90"),
        ("--format opencv --frames 1 --image-noise 1,2", 2, "this command takes one"),
    ],
)
def test_bad_words_are_one_line(
    words: str, code: int, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["export", "dataset", *words.split(), "--out", str(tmp_path / "set")]) == code
    said = capsys.readouterr().err
    assert message in said
    assert said.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
