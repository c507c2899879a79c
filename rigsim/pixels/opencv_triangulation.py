"""OpenCV's linear triangulation in the slot of the built-in ones: an outside witness."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from rigsim.errors import TriangulatorError
from rigsim.pixels.opencv import load_cv2
from rigsim.rig.arrays import Array
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.rational import Rational
from rigsim.rig.stereo import StereoRig

_STEPS, _EPSILON = 200, 1e-15


def triangulate_cv2(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    """``cv2.triangulatePoints`` on undistorted pixels; points (N, 3) m in the left camera's frame.

    Rows with a NaN pixel, or whose lines of sight meet behind a camera or nowhere, are NaN.

    Raises:
        MeasurementFailed: OpenCV is not installed.
        TriangulatorError: it does not have the rig's lens.
    """
    cv2 = load_cv2()
    found = np.full((len(uv_left), 3), np.nan)
    given = np.isfinite(uv_left).all(axis=1) & np.isfinite(uv_right).all(axis=1)
    if not given.any():
        return found
    seen = []
    for camera, uv in ((rig.left, uv_left), (rig.right, uv_right)):
        undistort, D = _undistortion(cv2, camera.lens)
        criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, _STEPS, _EPSILON)
        ideal = undistort(np.ascontiguousarray(uv[given])[:, None, :], camera.K, D, criteria=criteria)
        seen.append(np.ascontiguousarray(ideal[:, 0, :].T))
    pose = rig.right_from_left
    P_right = np.column_stack([pose.R, pose.t])
    X = cv2.triangulatePoints(np.eye(3, 4), P_right, seen[0], seen[1])
    with np.errstate(all="ignore"):
        points = (X[:3] / X[3]).T
    depth_right = pose.apply(points)[:, 2]
    points[~((points[:, 2] > 0) & (depth_right > 0) & np.isfinite(points).all(axis=1))] = np.nan
    found[given] = points
    return found


def _undistortion(cv2: Any, lens: Lens | None) -> tuple[Callable[..., Array], Array | None]:
    """OpenCV's function that undistorts this lens's points, and the coefficients for it."""
    if lens is None:
        return cv2.undistortPoints, None
    if not isinstance(lens, BrownConrady | Rational | KannalaBrandt):
        raise TriangulatorError(
            f"triangulator 'cv2': OpenCV undistorts no points of a {lens.model} lens: use 'optimal'",
            "misused",
        )
    module = cv2.fisheye if isinstance(lens, KannalaBrandt) else cv2
    return module.undistortPoints, np.array([getattr(lens, name) for name in lens.names()])
