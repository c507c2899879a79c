"""The bundled scenes: they compile, let rays and pictures agree, and show what they say."""

from __future__ import annotations

import importlib.util
import math
import sys
from collections import Counter
from pathlib import Path
from types import ModuleType
from typing import Any

import mujoco
import numpy as np
import pytest
from PIL import Image

from rigsim.rig.presets import preset
from rigsim.rig.stereo import StereoRig
from rigsim.sim.scenes.textures import PREFIX, apply_textures, generate

MODELS = Path(__file__).resolve().parents[2] / "models"
SCENES = ("artifact", "bin", "boards", "branch", "corridor")
WITH_BOARDS = ("artifact", "bin", "boards")
REP103_FROM_CV = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


class Loaded:
    """A scene, its texts, and its rig's left camera."""

    def __init__(self, name: str) -> None:
        self.path = MODELS / name / "scene.xml"
        self.spec = mujoco.MjSpec.from_file(str(self.path))
        self.texts = {text.name: text.data for text in self.spec.texts}
        apply_textures(self.spec)
        self.model: Any = self.spec.compile()
        self.data: Any = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)
        site = self.data.site("rig")
        self.center = site.xpos.copy()
        self.R = site.xmat.reshape(3, 3) @ REP103_FROM_CV
        self.rig = preset(name).rig

    def eye(self, side: int, baseline_m: float) -> np.ndarray:
        """Centre of the left (-1) or right (1) camera of a rectified rig."""
        return self.center + self.R @ (side * baseline_m / 2, 0, 0)

    def depth(self, eye: np.ndarray, normalized: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Planar depth (N,) m along rays (x/z, y/z), NaN where there is nothing, and geom ids (N,)."""
        n = len(normalized)
        rays = np.ascontiguousarray(np.column_stack([normalized, np.ones(n)]) @ self.R.T)
        ids, dist = np.full(n, -1, dtype=np.int32), np.empty(n)
        mujoco.mj_multiRay(
            self.model, self.data, eye, rays.ravel(), None, True, -1, ids, dist, None, n, mujoco.mjMAXVAL
        )
        return np.where(ids >= 0, dist, np.nan), ids

    def picture_depth(self) -> np.ndarray:
        """Depth on a coarse grid of the left picture's pixels, edges included."""
        lens = self.rig.left
        u, v = np.meshgrid(np.linspace(0, lens.width - 1, 96), np.linspace(0, lens.height - 1, 72))
        normalized = lens.normalize(np.stack([u, v], axis=-1).reshape(-1, 2))
        return self.depth(self.eye(-1, self.rig.baseline_m), normalized)[0]

    def boards(self) -> dict[str, dict[str, float]]:
        return {
            name.removeprefix("board:"): {
                key: float(value) for key, value in (item.split("=") for item in data.split())
            }
            for name, data in self.texts.items()
            if name.startswith("board:")
        }

    def corners_geom(self, name: str) -> np.ndarray:
        """Corners (rows, cols, 3) m in the frame of the geom that bears board `name`."""
        board = self.boards()[name]
        rows, cols, square = int(board["rows"]), int(board["cols"]), board["square_mm"] * 1e-3
        r, c = np.mgrid[:rows, :cols]
        thick = self.model.geom(name).size[2]
        return np.stack(
            [(c - (cols - 1) / 2) * square, ((rows - 1) / 2 - r) * square, np.full(r.shape, thick)], axis=-1
        )

    def corners_world(self, name: str) -> np.ndarray:
        geom = self.data.geom(name)
        return self.corners_geom(name) @ geom.xmat.reshape(3, 3).T + geom.xpos

    def seen(self, points: np.ndarray, side: int, rig: StereoRig) -> tuple[np.ndarray, np.ndarray]:
        """Pixels (N, 2) of world points in one camera, and whether each is in the picture and unhidden."""
        eye = self.eye(side, rig.baseline_m)
        points_camera = (points - eye) @ self.R
        uv = rig.left.project(points_camera)
        inside = ((uv >= 0) & (uv <= (rig.left.width - 1, rig.left.height - 1))).all(axis=1)
        hit, _ = self.depth(eye, points_camera[:, :2] / points_camera[:, 2:])
        return uv, inside & (hit > points_camera[:, 2] * (1 - 1e-6))


@pytest.fixture(scope="module")
def scenes() -> dict[str, Loaded]:
    return {name: Loaded(name) for name in SCENES}


@pytest.fixture(scope="module")
def meshes() -> ModuleType:
    sys.path.insert(0, str(MODELS))
    try:
        spec = importlib.util.spec_from_file_location("make_meshes", MODELS / "make_meshes.py")
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(MODELS))
    return module


def test_five_scenes_are_bundled() -> None:
    assert sorted(path.parent.name for path in MODELS.glob("*/scene.xml")) == sorted(SCENES)


@pytest.mark.parametrize("name", SCENES)
def test_folder_explains_and_shows_the_scene(name: str) -> None:
    folder = MODELS / name
    readme = (folder / "README.md").read_text(encoding="utf-8")
    for words in (f"# {name}\n", f"preset `{name}`", "preview.png", "Apache-2.0", "site `rig`"):
        assert words in readme
    lens, baseline = preset(name).rig.left, preset(name).rig.baseline_m
    assert f"{lens.width} x {lens.height} px, f {lens.fx:g} px, baseline {baseline * 1e3:g} mm" in readme
    assert (folder / "preview.png").stat().st_size <= 250_000
    with Image.open(folder / "preview.png") as preview:
        assert preview.width >= 640
        assert preview.width / preview.height == pytest.approx(lens.width / lens.height, rel=0.005)
    for asset in folder.glob("*.obj"):
        assert asset.stat().st_size < 300_000
    assert not list(folder.glob("*.jpg")) + [p for p in folder.glob("*.png") if p.name != "preview.png"]


@pytest.mark.parametrize("name", SCENES)
def test_scene_says_what_it_is_about_and_where_the_rig_sits(name: str, scenes: dict[str, Loaded]) -> None:
    scene = scenes[name]
    assert 10 < len(scene.texts["about"]) < 100
    assert "\n" not in scene.texts["about"]
    assert scene.model.site("rig").id >= 0
    assert np.linalg.det(scene.R) == pytest.approx(1)


@pytest.mark.parametrize("name", SCENES)
def test_every_texture_is_described_and_every_description_has_a_texture(
    name: str, scenes: dict[str, Loaded]
) -> None:
    scene = scenes[name]
    declared = {texture.name for texture in scene.spec.textures}
    described = {text.removeprefix(PREFIX) for text in scene.texts if text.startswith(PREFIX)}
    assert described == declared
    for texture in scene.spec.textures:
        assert not texture.file
        picture = generate(scene.texts[PREFIX + texture.name])
        compiled = scene.model.texture(texture.name)
        assert (compiled.height[0], compiled.width[0]) == picture.shape[:2]


@pytest.mark.parametrize("name", SCENES)
def test_nothing_in_the_scene_lets_left_right_or_rays_disagree(name: str, scenes: dict[str, Loaded]) -> None:
    scene = scenes[name]
    model = scene.model
    assert scene.path.read_text(encoding="utf-8").count("<visual>") == 1
    assert (model.njnt, model.nflex, model.nskin, model.ntendon) == (0, 0, 0, 0)
    assert not model.light_specular.any()
    assert not model.vis.headlight.specular.any()
    assert not model.vis.headlight.diffuse.any()
    assert not model.mat_specular.any()
    assert not model.mat_reflectance.any()
    assert (model.geom_rgba[:, 3] == 1).all()
    assert (model.mat_rgba[:, 3] == 1).all()
    assert (model.geom_matid >= 0).all()  # no plain surfaces
    assert not (model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE).any()
    assert model.vis.quality.shadowsize == 1024
    assert model.stat.extent == 1  # shadows and clip planes are in metres
    assert not model.geom_contype.any()


@pytest.mark.parametrize(
    ("name", "nearest", "farthest", "surface"),
    [
        ("boards", (0.45, 0.6), (4.9, 5.01), 1.0),
        ("branch", (0.2, 2.5), (10.0, 13.0), 0.88),
        ("artifact", (0.9, 1.0), (1.6, 1.8), 1.0),
        ("corridor", (1.8, 2.2), (29.5, 30.05), 1.0),
        ("bin", (0.38, 0.45), (0.88, 0.91), 1.0),
    ],
)
def test_depth_spans_what_is_advertised(
    name: str,
    nearest: tuple[float, float],
    farthest: tuple[float, float],
    surface: float,
    scenes: dict[str, Loaded],
) -> None:
    depth = scenes[name].picture_depth()
    hit = np.isfinite(depth)
    assert hit.mean() >= surface
    assert nearest[0] <= depth[hit].min() <= nearest[1]
    assert farthest[0] <= depth[hit].max() <= farthest[1]
    # spread, not two walls: no fifth of the (logarithmic) span is empty
    span = np.log(depth[hit])
    shares = np.histogram(span, bins=5)[0] / hit.sum()
    assert (shares > (0.0005 if name == "branch" else 0.005)).sum() >= (4 if name == "branch" else 5)


def test_most_of_the_boards_picture_lies_from_half_a_metre_to_five(scenes: dict[str, Loaded]) -> None:
    depth = scenes["boards"].picture_depth()
    assert ((depth >= 0.5) & (depth <= 5.0 + 1e-9)).mean() > 0.9
    assert (depth < 4.5).mean() > 0.5


@pytest.mark.parametrize(
    ("name", "geom", "disparity_px"), [("branch", "limb", 70.0), ("artifact", "amphora", 150.0)]
)
def test_the_worked_examples_stand_where_their_disparity_says(
    name: str, geom: str, disparity_px: float, scenes: dict[str, Loaded]
) -> None:
    scene = scenes[name]
    expected = scene.rig.left.fx * scene.rig.baseline_m / disparity_px  # 2.5714 m and 1.0667 m
    depth, ids = scene.depth(scene.center, np.zeros((1, 2)))
    assert scene.model.geom(int(ids[0])).name == geom
    assert depth[0] == pytest.approx(expected, abs=0.001)


def test_a_corner_of_the_wall_board_by_hand(scenes: dict[str, Loaded]) -> None:
    # the geom `wall`: at (4.985, -2.493, 2.223), x to the picture's right (-y), y up, z to the rig (-x),
    # half thickness 6 mm; 7 x 10 corners of 92 mm: the first lies 4.5 squares left and 3 squares up of a
    # board that hangs 5 degrees askew, turned against the clock
    scene = scenes["boards"]
    corner = scene.corners_world("wall")[0, 0]
    right = 0.092 * (-4.5 * math.cos(math.radians(5)) - 3 * math.sin(math.radians(5)))
    up = 0.092 * (-4.5 * math.sin(math.radians(5)) + 3 * math.cos(math.radians(5)))
    np.testing.assert_allclose(corner, [4.985 - 0.006, -2.493 - right, 2.223 + up], atol=1e-9)
    # left camera at (0, 0.06, 1.06), f 900, principal point (639.5, 359.5)
    uv, visible = scene.seen(corner[None], -1, scene.rig)
    np.testing.assert_allclose(
        uv[0],
        [639.5 + 900 * (0.06 + 2.493 + right) / 4.979, 359.5 - 900 * (2.223 + up - 1.06) / 4.979],
        atol=1e-6,
    )
    assert visible[0]


def _boards() -> list[tuple[str, str]]:
    pairs = []
    for name in WITH_BOARDS:
        spec = mujoco.MjSpec.from_file(str(MODELS / name / "scene.xml"))
        pairs += [
            (name, text.name.removeprefix("board:")) for text in spec.texts if text.name.startswith("board:")
        ]
    return pairs


@pytest.mark.parametrize(("name", "board"), _boards())
def test_the_pattern_has_its_corners_where_the_metadata_says(
    name: str, board: str, scenes: dict[str, Loaded]
) -> None:
    scene = scenes[name]
    geom = scene.model.geom(board)
    assert geom.type[0] == mujoco.mjtGeom.mjGEOM_BOX
    texture_name = scene.model.texture(
        int(scene.model.mat_texid[int(geom.matid[0]), mujoco.mjtTextureRole.mjTEXROLE_RGB.value])
    ).name
    picture = generate(scene.texts[PREFIX + texture_name])[..., 0].astype(int)
    height, width = picture.shape
    # a 2-D texture covers the face once: u runs with x, and row 0 is at +y
    corners = scene.corners_geom(board).reshape(-1, 3)
    half_x, half_y, _ = geom.size
    col = (corners[:, 0] / half_x + 1) / 2 * width
    row = (1 - corners[:, 1] / half_y) / 2 * height
    np.testing.assert_allclose(col, np.rint(col), atol=1e-6)  # between two texels
    np.testing.assert_allclose(row, np.rint(row), atol=1e-6)
    i, j = np.rint(row).astype(int), np.rint(col).astype(int)
    north_west, north_east = picture[i - 1, j - 1], picture[i - 1, j]
    south_west, south_east = picture[i, j - 1], picture[i, j]
    assert np.array_equal(north_west, south_east)
    assert np.array_equal(north_east, south_west)
    assert (np.abs(north_west - north_east) > 150).all()
    # and nowhere else: as many crossings in the picture as corners in the metadata
    a, b, c, d = picture[:-1, :-1], picture[:-1, 1:], picture[1:, :-1], picture[1:, 1:]
    assert ((a == d) & (b == c) & (a != b)).sum() == len(corners)


@pytest.mark.parametrize(("name", "board"), _boards())
def test_boards_can_be_read_at_their_distance(name: str, board: str, scenes: dict[str, Loaded]) -> None:
    scene = scenes[name]
    corners = scene.corners_world(board)
    rows, cols, _ = corners.shape
    uv, visible = scene.seen(corners.reshape(-1, 3), -1, scene.rig)
    grid = uv.reshape(rows, cols, 2)
    steps = [np.linalg.norm(np.diff(grid, axis=axis), axis=-1).min() for axis in (0, 1)]
    assert min(steps) >= 12
    assert visible.mean() >= 0.85


@pytest.mark.parametrize("baseline_mm", [50, 120, 300, 500])
def test_boards_stay_in_both_pictures_over_the_swept_baselines(
    baseline_mm: int, scenes: dict[str, Loaded]
) -> None:
    scene = scenes["boards"]
    rig = StereoRig.rectified(scene.rig.left, baseline_mm * 1e-3)
    shares = {}
    for board in scene.boards():
        points = scene.corners_world(board).reshape(-1, 3)
        both = scene.seen(points, -1, rig)[1] & scene.seen(points, 1, rig)[1]
        shares[board] = both.mean()
    assert sum(share >= 0.75 for share in shares.values()) >= 10
    assert shares["near"] == 1.0


def test_some_boards_hide_others(scenes: dict[str, Loaded]) -> None:
    scene = scenes["boards"]
    rig = StereoRig.rectified(scene.rig.left, 0.5)
    hidden = 0
    for board in scene.boards():
        points = scene.corners_world(board).reshape(-1, 3)
        for side in (-1, 1):
            uv, visible = scene.seen(points, side, rig)
            inside = ((uv >= 0) & (uv <= (rig.left.width - 1, rig.left.height - 1))).all(axis=1)
            hidden += int((inside & ~visible).sum())
    assert hidden > 20


def _read_obj(path: Path) -> tuple[np.ndarray, np.ndarray, list[list[tuple[int, int]]]]:
    lines = [line.split() for line in path.read_text(encoding="utf-8").splitlines()]
    vertices = np.array([line[1:] for line in lines if line[0] == "v"], dtype=float)
    texture = np.array([line[1:] for line in lines if line[0] == "vt"], dtype=float)
    faces = [
        [tuple(int(i) - 1 for i in corner.split("/")) for corner in line[1:]]
        for line in lines
        if line[0] == "f"
    ]
    return vertices, texture, faces


def _obj_files() -> list[str]:
    return sorted(path.relative_to(MODELS).as_posix() for path in MODELS.glob("*/*.obj"))


def test_every_mesh_has_a_maker(meshes: ModuleType) -> None:
    assert sorted(meshes.MESHES) == _obj_files()


@pytest.mark.parametrize("path", _obj_files())
def test_mesh_files_are_what_the_script_makes(path: str, meshes: ModuleType) -> None:
    vertices, texture, faces = _read_obj(MODELS / path)
    made = meshes.MESHES[path]()
    np.testing.assert_allclose(vertices, made.vertices, atol=2e-5)
    np.testing.assert_allclose(texture, made.texture, atol=2e-4)
    assert faces == made.faces


@pytest.mark.parametrize("path", _obj_files())
def test_meshes_are_closed_and_turned_outwards(path: str) -> None:
    # else culled back faces are holes in the picture that rays do not see
    vertices, _, faces = _read_obj(MODELS / path)
    keys: dict[tuple[float, ...], int] = {}
    merged = [keys.setdefault(tuple(vertex), len(keys)) for vertex in vertices]
    edges: Counter[tuple[int, int]] = Counter()
    volume = 0.0
    for face in faces:
        corners = [merged[i] for i, _ in face]
        edges.update((a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True) if a != b)
        p = vertices[[i for i, _ in face]]
        volume += sum(float(p[0] @ np.cross(p[k], p[k + 1])) / 6 for k in range(1, len(p) - 1))
    assert all(edges[b, a] == count for (a, b), count in edges.items())
    assert volume > 0
