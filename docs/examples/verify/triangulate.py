"""A program for `rigsim verify --exec "python3 docs/examples/verify/triangulate.py"`; needs numpy alone.

The midpoint of the shortest line between the two rays, after the lens distortion is undone.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np


def distort(x: np.ndarray, y: np.ndarray, lens: dict[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """Where a lens shows the ideal normalised coordinates x, y."""
    k1, k2, p1, p2, k3 = (lens[name] for name in ("k1", "k2", "p1", "p2", "k3"))
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    return (
        x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
        y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
    )


def undistort(xd: np.ndarray, yd: np.ndarray, lens: dict[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """The inverse of `distort` by Newton's method; NaN where the lens shows nothing."""
    k1, k2, p1, p2, k3 = (lens[name] for name in ("k1", "k2", "p1", "p2", "k3"))
    x, y = xd.copy(), yd.copy()
    for _ in range(20):
        r2 = x * x + y * y
        radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        slope = 2 * (k1 + r2 * (2 * k2 + 3 * r2 * k3))
        a = radial + x * x * slope + 2 * p1 * y + 6 * p2 * x
        b = x * y * slope + 2 * p1 * x + 2 * p2 * y
        d = radial + y * y * slope + 6 * p1 * y + 2 * p2 * x
        det = a * d - b * b
        x_now, y_now = distort(x, y, lens)
        ex, ey = x_now - xd, y_now - yd
        x, y = x - (d * ex - b * ey) / det, y - (a * ey - b * ex) / det
    x_now, y_now = distort(x, y, lens)
    # beyond its fold a lens would mirror or turn the picture: there the derivative is not positive definite
    met = (np.hypot(x_now - xd, y_now - yd) < 1e-9) & (a > 0) & (det > 0)
    return np.where(met, x, np.nan), np.where(met, y, np.nan)


def rays(camera: dict[str, Any], uv: np.ndarray) -> np.ndarray:
    """Directions (N, 3) with z = 1 of pixels (N, 2)."""
    x = (uv[:, 0] - camera["cx_px"]) / camera["fx_px"]
    y = (uv[:, 1] - camera["cy_px"]) / camera["fy_px"]
    x, y = undistort(x, y, camera["distortion"])
    return np.column_stack([x, y, np.ones(len(x))])


def triangulate(rig: dict[str, Any], uv_left: np.ndarray, uv_right: np.ndarray) -> np.ndarray:
    """Points (N, 3), m, in the left camera's frame; NaN where there is none in front of both cameras."""
    R, t = np.array(rig["right_from_left"]["R"]), np.array(rig["right_from_left"]["t_m"])
    center = -R.T @ t  # of the right camera, seen from the left one
    left = rays(rig["left"], uv_left)
    right = rays(rig["right"], uv_right) @ R
    normal = np.cross(left, right)
    length2 = (normal**2).sum(axis=1)
    along_left = (np.cross(center, right) * normal).sum(axis=1) / length2
    along_right = (np.cross(center, left) * normal).sum(axis=1) / length2
    points = 0.5 * (along_left[:, None] * left + center + along_right[:, None] * right)
    in_front = (along_left > 0) & (along_right > 0) & (points[:, 2] > 0) & (points @ R[2] + t[2] > 0)
    points[~in_front] = np.nan
    return points


def main(folder: Path) -> None:
    """Answer the task in `folder`."""
    rig = json.loads((folder / "calibration.json").read_text())
    lines = (folder / "observations.csv").read_text().splitlines()[1:]
    rows = np.array([line.split(",") for line in lines], dtype=float).reshape(-1, 5)
    with np.errstate(all="ignore"):
        points = triangulate(rig, rows[:, 1:3], rows[:, 3:5])
    with (folder / "points.csv").open("w") as file:
        file.write("id,x_m,y_m,z_m\n")
        for i, (x, y, z) in zip(rows[:, 0].astype(int).tolist(), points.tolist(), strict=True):
            file.write(f"{i},{x!r},{y!r},{z!r}\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
