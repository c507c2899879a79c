"""A scene made for a calibration: one board before a far wall, moved in place from picture to picture."""

from __future__ import annotations

import mujoco
import numpy as np

from rigsim.rig.board import Board
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.sim.scenes.made import MadeScene
from rigsim.sim.scenes.scene import Scene

_NAME = "held"
_TEXELS = 32
"""Of a square's side."""
_MARGIN = 0.5
"""Light rim round the outer squares, in squares."""
_THICK = 0.05
"""Half of the board's thickness, in squares."""
_NODES = 4
"""Of a warped board's mesh, along a square's side."""
_WALL = 6.0
"""Distance of the wall behind, in the distance of the farthest board."""
_GEOM_FROM_BOARD = np.diag([1.0, -1.0, -1.0])
"""The pattern is on the geom's +z face, rows down along -y: a board's z points away from whoever sees it."""


def held_board(board: Board, far_m: float) -> MadeScene:
    """A scene with a board, `hold` says where, that is held no farther than `far_m` from the rig."""
    (width, height), square = board.size_m, board.square_m
    rim = (1 + _MARGIN) * square
    sizes = f"{width / 2 + rim:.12g} {height / 2 + rim:.12g} {_THICK * square:.12g}"
    wall_m, flat = _WALL * far_m, not any(board.warp_m)
    return MadeScene(
        f"{board.text} held",
        _DOCUMENT.format(
            pattern=f"checker rows={board.rows} cols={board.cols} square={_TEXELS} "
            f"margin={round(_MARGIN * _TEXELS)}",
            declared=f'<text name="board:{_NAME}" data="rows={board.rows} cols={board.cols} '
            f'square_mm={square * 1e3:.12g}"/>'
            if flat
            else "",
            mesh="" if flat else _sheet(board),
            shape=f'type="box" pos="0 0 {-_THICK * square:.12g}" size="{sizes}"'
            if flat
            else 'type="mesh" mesh="sheet"',
            wall_m=wall_m,
            wall_size_m=4 * wall_m,
        ),
        n_points=1,
    )


def hold(scene: Scene, rig: StereoRig, board: Board, left_from_board: Pose) -> None:
    """Place the rig, and the board of a scene of `held_board` before it."""
    scene.place(rig)
    world_from_board = scene.world_from_camera(0) @ left_from_board
    body = scene.model.body(_NAME).id
    width, height = board.size_m
    scene.model.body_pos[body] = world_from_board.apply([width / 2, height / 2, 0.0])
    quat = np.empty(4)
    mujoco.mju_mat2Quat(quat, (world_from_board.R @ _GEOM_FROM_BOARD).ravel())
    scene.model.body_quat[body] = quat
    scene.place(rig)


def _sheet(board: Board) -> str:
    """A warped board's face as a mesh in the geom's frame, its pattern laid onto it."""
    width, height = board.size_m
    rim = (1 + _MARGIN) * board.square_m
    x = np.linspace(-rim, width + rim, _NODES * (board.cols + 3) + 1)
    y = np.linspace(-rim, height + rim, _NODES * (board.rows + 3) + 1)
    across, down = np.meshgrid(x, y)
    rise = board.warp_shape_at(across, down) @ np.array(board.warp_m)
    points = np.stack([across - width / 2, down - height / 2, rise], axis=-1) @ _GEOM_FROM_BOARD
    places = np.stack([(across + rim) / (width + 2 * rim), (down + rim) / (height + 2 * rim)], axis=-1)
    node = np.arange(across.size).reshape(across.shape)
    a, b, c, d = node[:-1, :-1], node[:-1, 1:], node[1:, :-1], node[1:, 1:]
    faces = np.concatenate([np.stack([a, c, b], axis=-1), np.stack([b, c, d], axis=-1)])
    vertex, texcoord, face = (
        " ".join(f"{number:.9g}" for number in numbers.ravel()) for numbers in (points, places, faces)
    )
    return f'<mesh name="sheet" inertia="shell" vertex="{vertex}" texcoord="{texcoord}" face="{face}"/>'


_DOCUMENT = """<mujoco model="held">
  <visual>
    <headlight ambient=".42 .42 .42" diffuse="0 0 0" specular="0 0 0"/>
  </visual>
  <custom>
    <text name="texture:board" data="{pattern}"/>
    <text name="texture:wall" data="plaster base=#8d9197 contrast=0.1 size=512 seed=1"/>
    {declared}
  </custom>
  <default>
    <material specular="0" shininess="0" reflectance="0"/>
    <geom contype="0" conaffinity="0"/>
  </default>
  <asset>
    <texture name="board" type="2d" builtin="flat" width="64" height="64" colorspace="linear"/>
    <material name="board" texture="board"/>
    {mesh}
    <texture name="wall" type="2d" builtin="flat" width="64" height="64" colorspace="linear"/>
    <material name="wall" texture="wall"/>
  </asset>
  <worldbody>
    <site name="rig" pos="0 0 0" size=".001"/>
    <light type="directional" dir=".9 -.3 -.3" diffuse=".5 .5 .5" ambient="0 0 0" specular="0 0 0"
      castshadow="false"/>
    <body pos="{wall_m:.9g} 0 0" xyaxes="0 -1 0 0 0 1">
      <geom name="wall" type="box" size="{wall_size_m:.9g} {wall_size_m:.9g} .1" material="wall"/>
    </body>
    <body name="held" pos="1 0 0">
      <geom name="held" {shape} material="board"/>
    </body>
  </worldbody>
</mujoco>
"""
