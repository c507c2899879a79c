"""Where the corners of a scene's checker boards are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array, Ids
from rigsim.sim.scenes.scene import Scene


@dataclass(frozen=True, slots=True, eq=False)
class TrueCorners:
    """Inner corners of all boards; one row a corner."""

    points_left: Array
    """In the left camera's frame, (N, 3), m."""
    sizes: Ids
    """Rows and columns of inner corners of the corner's board, (N, 2)."""


def true_corners(scene: Scene) -> TrueCorners:
    """Corners of every board that the scene declares, in front of the placed rig or not.

    A board's text says `rows`, `cols` and `square_mm`; its pattern is centred on the +Z face of its geom.
    """
    points, sizes = [np.empty((0, 3))], [np.empty((0, 2), dtype=np.int32)]
    left_from_world = scene.world_from_camera(0).inverse
    for name, board in scene.boards.items():
        rows, cols, square_m = int(board["rows"]), int(board["cols"]), board["square_mm"] / 1e3
        geom = scene.model.geom(name).id
        r, c = np.mgrid[:rows, :cols]
        corners_geom = np.column_stack(
            [
                (c.ravel() - (cols - 1) / 2) * square_m,
                ((rows - 1) / 2 - r.ravel()) * square_m,
                np.full(rows * cols, scene.model.geom_size[geom][2]),
            ]
        )
        R = scene.data.geom_xmat[geom].reshape(3, 3)
        points.append(left_from_world.apply(corners_geom @ R.T + scene.data.geom_xpos[geom]))
        sizes.append(np.tile(np.array([rows, cols], dtype=np.int32), (rows * cols, 1)))
    return TrueCorners(np.concatenate(points), np.concatenate(sizes))
