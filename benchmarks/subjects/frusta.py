"""The frustum that MuJoCo draws a placed camera with, without a picture."""

from __future__ import annotations

import mujoco

from rigsim.sim.render import read_frustum
from rigsim.sim.simulator import Simulator


def drawn_frustum(simulator: Simulator, side: int) -> tuple[float, float, float, float]:
    """What ``fx, fy, cx, cy``, px, the GL camera of the left (0) or right (1) lens says."""
    scene, lens = simulator.scene, simulator.scene.lens(side)
    scene.set_lens(side, lens)
    camera = mujoco.MjvCamera()
    camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
    camera.fixedcamid = scene.camera_ids[side]
    shown = mujoco.MjvScene(scene.model, maxgeom=1000)
    every = mujoco.mjtCatBit.mjCAT_ALL.value
    mujoco.mjv_updateScene(scene.model, scene.data, mujoco.MjvOption(), None, camera, every, shown)
    return read_frustum(shown.camera[0], lens.width, lens.height)
