"""A scene made for a working range: a low wall, with a chess board on it, at each of the distances asked for.

The walls stand one above the other in the picture, the nearest at the bottom. Cameras of equal height, as of
a rectified rig, see each wall between the same rows, so that no wall hides another from one of them, however
long the baseline: side by side the nearer ones would. They are turned about the vertical in turns, and the
boards in their planes as well, so that edges run along no rows (docs/adr/0004).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidRange

_SAME = 1.1  # distances within this factor share a wall
_DEEP = 0.04  # depth of a wall to either side of its middle, as a share of its distance
_LEAST_SHARED = 0.1  # of a picture's width: a wall of which less is shared is not drawn any higher
_BEYOND = 1.15  # of the picture's edges
_BOARD = (5, 7)  # inner corners down and across
_TURN_DEG = 7.0  # of a board in its plane
_FILLS = 0.8  # of its wall's height that a board takes
_TEXELS = 1024  # across a wall
_POINTS = 250  # of each wall: a wall may lie in two bins of depth, over which points are spread evenly
_SURFACES = (
    "plaster base=#a8aba6 contrast=0.16",
    "cork base=#b08455 dark=#5f3f22",
    "plaster base=#8d9bb0 contrast=0.2",
    "paint base=#6f8a72 under=#3a463c wear=1.2 grain=0.2",
    "plaster base=#b3907c contrast=0.18",
    "plaster base=#9a9a7c contrast=0.14",
)


@dataclass(frozen=True, slots=True)
class MadeScene:
    """A scene that no file holds."""

    name: str
    """What it is called after the word scene: ``made for 0.8 to 1.2 m``."""
    text: str
    """MJCF; the rig sits at the site `rig`."""
    n_points: int
    """Truth points of which each wall gets 100 that both cameras see."""


@dataclass(frozen=True, slots=True)
class Wall:
    """One wall, in front of the rig; tangents are of angles up from the axis, as the cameras see them."""

    depth_m: float
    """Depth of the middle of its face."""
    low: float
    """Tangent of its lower edge, where it comes out from behind the nearer ones."""
    high: float
    """Tangent of its upper edge."""
    deep: float
    """Depth of its face to either side of the middle, as a share of `depth_m`."""


def made_scene(
    distances_m: Sequence[float], hfov_rad: float, vfov_rad: float, baseline_m: float = 0.0
) -> MadeScene:
    """A scene with surfaces at `distances_m` that both cameras of a rectified rig see.

    Args:
        distances_m: where something is to be seen; the nearest and the farthest are the ends of the range,
            beyond which no wall reaches.
        hfov_rad: horizontal field of view of its cameras.
        vfov_rad: vertical field of view.
        baseline_m: longest baseline that it is to serve.

    Raises:
        InvalidRange: a distance is not positive, or there are fewer than two.
    """
    near, far = min(distances_m, default=0.0), max(distances_m, default=0.0)
    if not 0 < near < far < math.inf:
        raise InvalidRange(f"a scene for {near:g} to {far:g} m: must be 0 < nearest < farthest distance")
    across, up = math.tan(hfov_rad / 2), math.tan(vfov_rad / 2)
    walls = _walls(sorted(distances_m), across, up, baseline_m)
    texts, assets, bodies = [], [], []
    for index, wall in enumerate(walls):
        # below the nearest and above the farthest there is nothing else; others begin behind a nearer one
        low = -3 * up if index == 0 else wall.low - 0.3 * up
        high = 3 * up if index == len(walls) - 1 else wall.high
        text, asset, face = _face(index, wall, (low, high), across, baseline_m)
        declared, board = _board(index, wall, across, baseline_m)
        texts += [text, declared]
        assets.append(asset)
        bodies.append(f'<body pos="{wall.depth_m:.9g} 0 0" {face}{board}</body>')
    parts = ("\n    ".join(part) for part in (texts, assets, bodies))
    least_shared = min(_shared(wall.depth_m, across, baseline_m) for wall in walls)
    n_points = math.ceil(_POINTS * len(walls) / least_shared)
    return MadeScene(f"made for {near:.3g} to {far:.3g} m", _DOCUMENT.format(*parts), n_points)


_DOCUMENT = """<mujoco model="made">
  <compiler angle="degree"/>
  <visual>
    <headlight ambient=".4 .4 .42" diffuse="0 0 0" specular="0 0 0"/>
  </visual>
  <custom>
    {0}
    <text name="texture:board" data="checker rows=5 cols=7 square=64 margin=32"/>
  </custom>
  <default>
    <material specular="0" shininess="0" reflectance="0"/>
    <geom contype="0" conaffinity="0"/>
  </default>
  <asset>
    {1}
    <texture name="board" type="2d" builtin="flat" width="64" height="64" colorspace="linear"/>
    <material name="board" texture="board"/>
  </asset>
  <worldbody>
    <site name="rig" pos="0 0 0" size=".001"/>
    <light type="directional" dir=".8 -.4 -.45" diffuse=".55 .54 .52" ambient="0 0 0" specular="0 0 0"
      castshadow="false"/>
    {2}
  </worldbody>
</mujoco>
"""


def _walls(distances_m: Sequence[float], across: float, up: float, baseline_m: float) -> list[Wall]:
    """From the nearest to the farthest; the less of one is shared, the higher it is."""
    near, far = distances_m[0], distances_m[-1]
    deep = min(_DEEP, (far / near - 1) / 8)
    # a little inside the range: no point of a wall or board is to lie beyond its ends
    inner, outer = near / (1 - 1.15 * deep), far / (1 + 1.15 * deep)
    at_m = [inner]
    for distance_m in distances_m:
        if distance_m > at_m[-1] * _SAME and distance_m * _SAME < outer:
            at_m.append(distance_m)
    at_m.append(outer)
    shared = np.array([_shared(depth_m, across, baseline_m) for depth_m in at_m])
    edges = up * (2 * np.cumsum([0.0, *(1 / shared)]) / (1 / shared).sum() - 1)
    return [
        Wall(depth_m, float(low), float(high), deep)
        for depth_m, (low, high) in zip(at_m, itertools.pairwise(edges), strict=True)
    ]


def _shared(depth_m: float, across: float, baseline_m: float) -> float:
    """Share of a picture's width that the other camera sees too; as much as a wall is drawn for."""
    return max(1 - baseline_m / (2 * across * depth_m), _LEAST_SHARED)


def _face(
    index: int, wall: Wall, ends: tuple[float, float], across: float, baseline_m: float
) -> tuple[str, str, str]:
    """What a wall's texture shows, its material, and its body but for its beginning and its end.

    `ends` are tangents, as those of the wall: it is no lower and no higher.
    """
    half_width = wall.depth_m * across * _BEYOND + min(baseline_m / 2, wall.depth_m * across)
    half_height, middle = ((ends[1] + sign * ends[0]) / 2 * wall.depth_m for sign in (-1, 1))
    rows = _power_of_two(_TEXELS * half_height / half_width)
    text = (
        f'<text name="texture:wall_{index}" data="{_SURFACES[index % len(_SURFACES)]} width={_TEXELS} '
        f'height={rows} seed={index + 1}"/>'
    )
    asset = (
        f'<texture name="wall_{index}" type="2d" builtin="flat" width="64" height="64" '
        f'rgb1=".6 .6 .6" colorspace="linear"/><material name="wall_{index}" texture="wall_{index}"/>'
    )
    turn = math.atan(wall.deep * wall.depth_m / half_width) * (-1) ** index
    thick = 0.01 * wall.depth_m
    body = (
        f'xyaxes="{math.sin(turn):.9g} {-math.cos(turn):.9g} 0 0 0 1">'
        f'<geom name="wall_{index}" type="box" pos="0 {middle:.9g} {-thick:.9g}" '
        f'size="{half_width:.9g} {half_height:.9g} {thick:.9g}" material="wall_{index}"/>'
    )
    return text, asset, body


def _board(index: int, wall: Wall, across: float, baseline_m: float) -> tuple[str, str]:
    """The text that declares a wall's board, and the board, where both cameras see it."""
    rows, cols = _BOARD
    turn = math.radians(_TURN_DEG)
    # in squares, with a margin of half a one all round
    tall = (rows + 2) * math.cos(turn) + (cols + 2) * math.sin(turn)
    wide = (cols + 2) * math.cos(turn) + (rows + 2) * math.sin(turn)
    shared_m = 2 * across * wall.depth_m * _shared(wall.depth_m, across, baseline_m)
    square_m = _FILLS * min((wall.high - wall.low) * wall.depth_m / tall, shared_m / wide)
    thick = 0.05 * wall.deep * wall.depth_m
    aside_m = 0.35 * (shared_m - wide * square_m) * (-1) ** index
    geom = (
        f'<geom name="board_{index}" type="box" euler="0 0 {_TURN_DEG * (-1) ** index:g}" '
        f'pos="{aside_m:.9g} {(wall.high + wall.low) / 2 * wall.depth_m:.9g} {thick:.9g}" '
        f'size="{(cols + 2) / 2 * square_m:.9g} {(rows + 2) / 2 * square_m:.9g} {thick:.9g}" '
        'material="board"/>'
    )
    declared = f"rows={rows} cols={cols} square_mm={square_m * 1e3:.12g}"
    return f'<text name="board:board_{index}" data="{declared}"/>', geom


def _power_of_two(texels: float) -> int:
    return int(np.clip(2 ** round(math.log2(texels)), 64, 2 * _TEXELS))
