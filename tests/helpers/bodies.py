"""Two cameras on a body, each where its matrix says: nothing here knows of rigsim's poses."""

from __future__ import annotations

import cv2
import numpy as np

from rigsim.interop.formats.format import Asked, File, Format, Found
from rigsim.rig.stereo import StereoRig

POINTS_BODY = np.array([[2.0, 0.3, -0.2], [1.5, -0.4, 0.1], [3.0, 0.2, 0.4], [2.2, -0.1, -0.5]])
"""Points (N, 3) m before both cameras, in the body's frame (x forward)."""


def matrix(rotvec: tuple[float, float, float], place: tuple[float, float, float]) -> np.ndarray:
    """Body from camera, (4, 4): the camera turned by a rotation vector, rad, from looking along x."""
    made = np.eye(4)
    looking = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    made[:3, :3] = cv2.Rodrigues(np.array(rotvec))[0] @ looking
    made[:3, 3] = place
    return made


BODY_FROM_LEFT = matrix((0.02, -0.03, 0.05), (0.11, 0.07, -0.02))
BODY_FROM_RIGHT = matrix((-0.01, 0.04, -0.02), (0.105, -0.06, -0.015))
"""The right camera's matrix: 0.13 m to the right of the left one, as the body's y points to the left."""


def seen(body_from_camera: np.ndarray) -> np.ndarray:
    """The points (N, 3) in a camera's frame."""
    homogeneous = np.hstack([POINTS_BODY, np.ones((len(POINTS_BODY), 1))])
    return (homogeneous @ np.linalg.inv(body_from_camera).T)[:, :3]


def check_pose(
    rig: StereoRig,
    left: np.ndarray = BODY_FROM_LEFT,
    right: np.ndarray = BODY_FROM_RIGHT,
    tolerance: float = 1e-12,
) -> None:
    """Assert that the rig's pose takes what the left camera sees to what the right one sees."""
    np.testing.assert_allclose(rig.right_from_left.apply(seen(left)), seen(right), rtol=0, atol=tolerance)


def rows(matrix: np.ndarray, indent: str = "  ") -> str:
    """A matrix as YAML's list of rows."""
    return "".join(f"{indent}- [{', '.join(repr(float(value)) for value in row)}]\n" for row in matrix)


def opencv(name: str, matrix: np.ndarray) -> str:
    """A matrix as OpenCV's YAML has it."""
    data = ", ".join(repr(float(value)) for value in matrix.ravel())
    return (
        f"{name}: !!opencv-matrix\n   rows: {matrix.shape[0]}\n   cols: {matrix.shape[1]}\n   dt: d\n"
        f"   data: [{data}]\n"
    )


def found(format: Format, files: list[File], asked: Asked | None = None) -> Found:
    """What a format finds in files that must be one group of its own."""
    assert format.groups is not None
    assert format.open is not None
    (group,) = format.groups(files)
    return format.open(group, asked or Asked())
