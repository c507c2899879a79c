"""Time of a sweep against a bare loop that draws the same pictures and depths; memory of a large one."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from importlib.metadata import version
from statistics import median

import numpy as np

from rigsim import Plan, RigGrid, Simulator, StereoRig, preset, sweep
from rigsim.sim.simulator import SUPERSAMPLE
from rigsim.sim.supersampling import box_average

REPEATS = 5
BASELINES_M = tuple(np.linspace(0.05, 0.5, 10))


def run() -> None:
    """Print the ratio for ten rigs of `boards`, and the peak memory of larger sweeps."""
    grid = RigGrid(preset("boards").rig, baselines_m=BASELINES_M)
    sweeps, measured, loops = [], [], []
    with Simulator("boards") as simulator:
        _bare_loop(simulator, grid)  # start-up and first-frame compilation
        sweep(grid, Plan(n_points=100, n_trials=1, measure="none"))
        for _ in range(REPEATS):
            loops.append(_bare_loop(simulator, grid))
            start_up = _timed(lambda: _open_and_draw_once(grid))
            sweeps.append(_timed(lambda: sweep(grid, Plan(measure="none"))) - start_up)
            measured.append(_timed(lambda: sweep(grid, Plan())) - start_up)
    ratios = [a / b for a, b in zip(sweeps, loops, strict=True)]
    print(f"mujoco {version('mujoco')}, {len(grid)} rigs of boards at 1280x720, 2000 points x 100 trials")
    for what, seconds, ratio in (
        ("bare loop of mujoco.Renderer, colour and depth of both views", loops, 1.0),
        ("rigsim.sweep, one process, start-up excluded", sweeps, median(ratios)),
        ("the same, and board corners measured in every pair", measured, median(measured) / median(loops)),
    ):
        print(f"  {what:64}{median(seconds):6.2f} s   {ratio:.2f}")
    print("peak memory of a whole process (limit 1536 MB)")
    for points, trials in ((2000, 100), (2000, 100_000), (1_000_000, 20)):
        print(f"  {points:>9,} points x {trials:>7,} trials   {_peak_mb(points, trials):6.0f} MB")


def _bare_loop(simulator: Simulator, grid: RigGrid) -> float:
    """Seconds for colour, twice as fine and averaged, and depth: what a sweep draws, by MuJoCo."""
    import mujoco  # once the simulator has said which GL there is

    scene = simulator.scene
    lens = grid.base.left
    fine = lens.supersampled(SUPERSAMPLE)
    scene.model.vis.global_.offwidth, scene.model.vis.global_.offheight = fine.width, fine.height
    with (
        mujoco.Renderer(scene.model, fine.height, fine.width) as color,
        mujoco.Renderer(scene.model, lens.height, lens.width) as depth,
    ):
        depth.enable_depth_rendering()
        begin = time.perf_counter()
        for rig in grid:
            simulator.place(rig)
            for side, camera in enumerate(scene.camera_ids):
                scene.set_lens(side, fine)
                color.update_scene(scene.data, camera)
                box_average(color.render(), SUPERSAMPLE)
                scene.set_lens(side, lens)
                depth.update_scene(scene.data, camera)
                depth.render()
        return time.perf_counter() - begin


def _open_and_draw_once(grid: RigGrid) -> None:
    """What a sweep does once, however many rigs it has: load the scene, start GL, compile the shaders."""
    rig: StereoRig = next(iter(grid))
    with Simulator("boards") as simulator:
        simulator.place(rig)
        _ = simulator.gl_renderer


def _timed(action: Callable[[], object]) -> float:
    begin = time.perf_counter()
    action()
    return time.perf_counter() - begin


def _peak_mb(points: int, trials: int) -> float:
    code = (
        "from rigsim import *\n"
        f"sweep([preset('boards').rig], Plan(n_points={points}, n_trials={trials}))\n"
        "import resource; print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return int(done.stdout) / 1024
