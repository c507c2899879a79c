"""Pictures of wide lenses against the projected truth: corners of boards all about a camera.

Boards on a sphere of a metre, from straight ahead to past 90 degrees off the axis. The detector looks for
whole boards, which it knows by straight lines; so that none is left out, its own sub-pixel fit also starts
half a pixel beside each projected corner. Both are told. Light is linear, levels are 8 bits.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator

import numpy as np

from rigsim import BrownConrady, DoubleSphere, Intrinsics, KannalaBrandt, Mei, Rational, Simulator, StereoRig
from rigsim.pixels.corners.boards import find_sizes
from rigsim.pixels.corners.corners import fit_corners
from rigsim.pixels.images import grey
from rigsim.rig.arrays import Array
from rigsim.rig.lens.lens import Lens
from rigsim.sim.scenes.made import MadeScene

_ROWS, _COLS, _SQUARE_M = 4, 5, 0.06
_RINGS_DEG = {0: 1, 32: 5, 62: 9, 93: 11}  # none hides another
_SIZE = 960
_BANDS_DEG = ((0, 60), (60, 85), (85, 180))
# focal lengths in px of a picture 1280 px wide
_CAMERAS: dict[str, tuple[float, Lens | None]] = {
    "pinhole": (640.0, None),
    "brown": (640.0, BrownConrady(-0.2, 0.04, 0.001, -0.0008)),
    "rational": (560.0, Rational(0.4, 0.03, 0.0005, -0.0003, 0.001, 0.75, 0.12, 0.004)),
    "kannala_brandt": (380.0, KannalaBrandt(0.01, -0.003, 0.0005, -0.0001)),
    "mei": (960.0, Mei(1.5, -0.05, 0.01, 0.0005, -0.0005)),
    "double_sphere": (330.0, DoubleSphere(-0.2, 0.6)),
}


def run() -> None:
    """Print rms errors in px by the angle off the axis, and times."""
    print(f"{'lens':<16}{'corners':>8}{'rms px':>9}", end="")
    print("".join(f"{f'{a}-{b} deg':>12}" for a, b in _BANDS_DEG), end="")
    print(f"{'found by itself':>17}{'rms px':>9}{'s/picture':>11}")
    with Simulator(_scene()) as simulator:
        for name, (focal, lens) in _CAMERAS.items():
            focal *= _SIZE / 1280
            camera = Intrinsics(_SIZE, _SIZE, focal, focal, _SIZE / 2 - 0.3, _SIZE / 2 - 0.9, lens)
            _report(name, simulator, camera)


def _report(name: str, simulator: Simulator, camera: Intrinsics) -> None:
    simulator.place(StereoRig.rectified(camera, 0.02))
    simulator.render(2)  # what is kept of a lens is made once
    start = time.perf_counter()
    frame = simulator.render(2)
    seconds = (time.perf_counter() - start) / 2
    levels = grey(frame.left.image)
    points = simulator.true_corners().points_left
    off, angles = _fitted(levels, camera, points)
    bands = [off[(angles >= low) & (angles < high)] for low, high in _BANDS_DEG]
    print(f"{name:<16}{len(off):>8}{_rms(off):>9.4f}", end="")
    print("".join(f"{_rms(band):>12.4f}" if len(band) else f"{'-':>12}" for band in bands), end="")
    alone = _found(levels, camera, points)
    print(f"{len(alone):>17}{_rms(alone):>9.4f}{seconds:>11.2f}")


def _fitted(levels: Array, camera: Intrinsics, points: Array) -> tuple[Array, Array]:
    """Errors (N, 2) px of corners fitted from half a pixel aside, and their angles off the axis, deg."""
    rng = np.random.default_rng(0)
    errors, angles = [], []
    for board, true in _boards(camera, points):
        grid = true.reshape(_ROWS, _COLS, 2)
        steps = np.stack([np.gradient(grid, axis=1), np.gradient(grid, axis=0)], axis=2).reshape(-1, 2, 2)
        turn = rng.uniform(0, 2 * math.pi, len(true))
        start = true + 0.5 * np.column_stack([np.cos(turn), np.sin(turn)])
        half = int(np.clip(0.35 * np.linalg.norm(steps, axis=2).min(), 3, 7))
        fitted, _ = fit_corners(levels, 1 / 12, start, half, steps)
        errors.append((fitted.uv - true)[fitted.valid])
        axis = np.degrees(np.arctan2(np.hypot(board[:, 0], board[:, 1]), board[:, 2]))
        angles.append(axis[fitted.valid])
    return np.concatenate(errors), np.concatenate(angles)


def _found(levels: Array, camera: Intrinsics, points: Array) -> Array:
    """Errors (N, 2) px of the corners of the boards that the detector finds by itself."""
    true = camera.project(points)
    true = true[np.isfinite(true).all(axis=1)]
    errors = []
    for board in find_sizes(levels, [(_ROWS, _COLS)], name="picture", limit=64):
        uv = board.uv[board.valid]
        nearest = true[np.linalg.norm(uv[:, None] - true, axis=2).argmin(axis=1)]
        errors.append(uv - nearest)
    return np.concatenate(errors) if errors else np.empty((0, 2))


def _boards(camera: Intrinsics, points: Array) -> Iterator[tuple[Array, Array]]:
    """Corners (N, 3) m and (N, 2) px of each board that is wholly in the picture."""
    for board in points.reshape(-1, _ROWS * _COLS, 3):
        uv = camera.project(board)
        inside = np.isfinite(uv).all() and (uv > 12).all() and (uv < _SIZE - 13).all()
        if inside and np.isfinite(camera.ray(uv)).all():
            yield board, uv


def _rms(errors: Array) -> float:
    """Of one coordinate."""
    return float(np.sqrt(np.mean(errors**2))) if errors.size else math.nan


def _scene() -> MadeScene:
    """Boards that face the rig, on rings about its axis."""
    texts, geoms = [], []
    size = f"{(_COLS + 2) / 2 * _SQUARE_M:g} {(_ROWS + 2) / 2 * _SQUARE_M:g} .002"
    for angle, count in _RINGS_DEG.items():
        for k in range(count):
            away, about = math.radians(angle), 2 * math.pi * (k + 0.3) / count
            x, y, z = math.cos(away), math.sin(away) * math.cos(about), math.sin(away) * math.sin(about)
            name = f"b{angle}_{k}"
            texts.append(f'<text name="board:{name}" data="rows={_ROWS} cols={_COLS} square_mm=60"/>')
            geoms.append(
                f'<body pos="{x} {y} {z}" zaxis="{-x} {-y} {-z}">'
                f'<geom name="{name}" type="box" size="{size}" euler="0 0 {17 + 31 * k}" '
                'material="board"/></body>'
            )
    return MadeScene(
        "boards all about",
        f"""<mujoco><compiler angle="degree"/>
        <visual><headlight ambient=".8 .8 .8" diffuse="0 0 0" specular="0 0 0"/></visual>
        <custom><text name="texture:board" data="checker rows={_ROWS} cols={_COLS} square=64 margin=32"/>
        {"".join(texts)}</custom>
        <default><material specular="0" shininess="0" reflectance="0"/></default>
        <asset><texture name="board" type="2d" builtin="flat" width="64" height="64" colorspace="linear"/>
        <material name="board" texture="board"/></asset>
        <worldbody><site name="rig"/>{"".join(geoms)}</worldbody></mujoco>""",
        1000,
    )
