"""Rendered depth against rays, and the frustum that is drawn against the one that was asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigsim import Simulator, StereoRig, preset

SCENES = ("boards", "artifact", "bin")
NEAR_M, FAR_M = 0.5, 5.0
BEND = 1e-4  # of the depth, between neighbouring pixels


def run() -> None:
    """Print the largest differences over every pixel of boxes, planes and meshes in both views."""
    from importlib.metadata import version

    print(
        f"mujoco {version('mujoco')}; boxes, planes and meshes at {NEAR_M:g} to {FAR_M:g} m, off-centre lens"
    )
    head = f"{'pixels':>9} {'median, um':>11} {'99.9 %, um':>11} {'largest, um':>12} {'over 5 um':>10}"
    print(f"{'scene':10} {head}   frustum, px")
    for name in SCENES:
        rig = preset(name).rig
        lens = replace(rig.left, cx=rig.left.cx - 37.3, cy=rig.left.cy + 21.7, fy=rig.left.fy * 1.02)
        error_um, frustum_px = compare(name, StereoRig.rectified(lens, rig.baseline_m))
        print(
            f"{name:10} {len(error_um):9,} {np.median(error_um):11.3f} {np.quantile(error_um, 0.999):11.3f} "
            f"{error_um.max():12.3f} {(error_um > 5).mean():10.1e}   {frustum_px:.1e}"
        )
    print("limits: 5 um; 1e-3 px. Pixels within one of an edge are left out: there either answer is right.")


def compare(scene: str, rig: StereoRig) -> tuple[np.ndarray, float]:
    """Absolute depth differences (N,) um over both views, and the largest frustum difference, px."""
    import mujoco

    from benchmarks.subjects.frusta import drawn_frustum
    from rigsim.sim.truth import rays

    flat = (mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_MESH)
    errors, frustum_px = [], 0.0
    with Simulator(scene) as simulator:
        simulator.place(rig)
        frame = simulator.render(1)
        for side, view in enumerate((frame.left, frame.right)):
            exact, geom = rays.depth_picture(simulator.scene, side)
            same = (geom == view.segmentation) & (geom >= 0)
            for axis in (0, 1):
                before, after = (np.roll(exact, step, axis) for step in (1, -1))
                same &= (np.roll(geom, 1, axis) == geom) & (np.roll(geom, -1, axis) == geom)
                # one object may stand before itself: its own edges bend the depth
                same &= np.abs(before + after - 2 * exact) < BEND * exact
            same &= np.isin(simulator.scene.model.geom_type[geom], flat) & (exact > NEAR_M) & (exact < FAR_M)
            errors.append(np.abs(view.depth - exact)[same] * 1e6)
            lens = simulator.scene.lens(side)
            drawn = drawn_frustum(simulator, side)
            asked = (lens.fx, lens.fy, lens.cx, lens.cy)
            frustum_px = max(frustum_px, float(np.abs(np.subtract(drawn, asked)).max()))
    return np.concatenate(errors), frustum_px
