"""One camera from corners of a board, by OpenCV (Zhang, "A flexible new technique for camera calibration",
2000)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rigsim.errors import InvalidRange, InvalidRig, MeasurementFailed
from rigsim.pixels.calibration.models import CameraModel, camera_model
from rigsim.pixels.opencv import load_cv2
from rigsim.rig.arrays import Array, Mask
from rigsim.rig.board import Board
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.lens import Lens
from rigsim.rig.pose import Pose

LEAST_CORNERS = 6
"""Fewest corners of a picture that count."""
_STEPS = 200
_STILL = 1e-12


@dataclass(frozen=True, slots=True, eq=False)
class CameraNumbers:
    """One camera as OpenCV has it."""

    K: Array
    D: Array


@dataclass(frozen=True, slots=True, eq=False)
class CameraViews:
    """What one camera saw."""

    name: str
    board: Board
    uv: Array
    seen: Mask
    size: tuple[int, int]


@dataclass(frozen=True, slots=True, eq=False)
class OneCamera:
    """One camera as OpenCV finds it."""

    camera: Intrinsics
    """The camera."""
    poses: tuple[Pose | None, ...]
    """camera_from_board of each board; None where it saw too little of one."""


def calibrate_camera(
    board: Board,
    uv: Array,
    size: tuple[int, int],
    lens: type[Lens] | None,
    fix: Sequence[str] = (),
    name: str = "left",
) -> OneCamera:
    """Calibrate one camera from corners (n, m, 2) px of n boards, row-major, NaN where it saw none.

    Raises:
        InvalidRange: OpenCV has no such model, or cannot hold what `fix` names; as of `calibrate_stereo`.
        MeasurementFailed: it cannot be calibrated.
    """
    model = camera_model((lens, lens), fix)
    seen: Mask = np.asarray(np.isfinite(uv).all(axis=2))
    seen &= (seen.sum(axis=1) >= LEAST_CORNERS)[:, None]
    numbers = from_scratch(model, CameraViews(name, board, uv, seen, size))
    try:
        camera = intrinsics(model, numbers.K, numbers.D, size)
    except InvalidRig as error:
        raise MeasurementFailed(f"OpenCV finds a {name} camera that cannot be: {error}") from None
    points = board.points
    poses = [
        board_pose(camera, points[which], uv[k, which]) if which.any() else None
        for k, which in enumerate(seen)
    ]
    return OneCamera(camera, tuple(poses))


def from_scratch(model: CameraModel, views: CameraViews) -> CameraNumbers:
    """One camera of which nothing is known; of a board that is not flat OpenCV needs a start, which a flat
    one gives."""
    flat = replace(views.board, warp_m=(0.0, 0.0))
    if views.board == flat:
        return solve_one(model, views, None)
    return solve_one(model, views, solve_one(model, replace(views, board=flat), None))


def begin_at(model: CameraModel, camera: Intrinsics) -> CameraNumbers:
    """A known camera in OpenCV's numbers."""
    if camera.lens is not None and (model.lens is None or not isinstance(camera.lens, model.lens)):
        wanted = "pinhole" if model.lens is None else model.lens.model
        raise InvalidRange(f"lens {camera.lens.said}: is no {wanted}; start from one of that model")
    D = [0.0 if camera.lens is None else getattr(camera.lens, term) for term in model.terms]
    return CameraNumbers(camera.K, np.array(D))


def solve_one(model: CameraModel, views: CameraViews, begin: CameraNumbers | None) -> CameraNumbers:
    """One camera from all boards that it saw."""
    cv2 = load_cv2()
    points, corners = lists(views, model.fisheye)
    guess = () if begin is None else ("CALIB_USE_INTRINSIC_GUESS",)
    K, D = (np.eye(3), np.zeros(len(model.terms))) if begin is None else (begin.K.copy(), begin.D.copy())
    solve = cv2.fisheye.calibrate if model.fisheye else cv2.calibrateCamera
    try:
        flags = model.flag(cv2, *guess)
        _, K, D, *_ = solve(points, corners, views.size, K, D, flags=flags, criteria=criteria(cv2))
    except cv2.error as error:
        raise MeasurementFailed(f"OpenCV cannot calibrate the {views.name} camera: {reason(error)}") from None
    return CameraNumbers(np.asarray(K), np.ravel(D)[: len(model.terms)])


def board_pose(camera: Intrinsics, points: Array, uv: Array) -> Pose | None:
    """A board's pose camera_from_board from corners (m, 3) m seen at (m, 2) px; None where none explains
    them."""
    cv2 = load_cv2()
    straight = camera.normalize(uv)
    known = np.isfinite(straight).all(axis=1)
    if known.sum() < LEAST_CORNERS:
        return None
    try:
        flags = cv2.SOLVEPNP_ITERATIVE
        found, turn, shift = cv2.solvePnP(points[known], straight[known], np.eye(3), None, flags=flags)
    except cv2.error:
        return None
    if not found or not np.isfinite(turn).all() or not np.isfinite(shift).all():
        return None
    return Pose.from_rotvec(np.ravel(turn), np.ravel(shift))


def lists(views: CameraViews, fisheye: bool) -> tuple[list[Any], list[Any]]:
    """Corners on the board and in the picture, board by board, in the types that OpenCV takes."""
    kind = np.float64 if fisheye else np.float32
    points, corners = [], []
    for k in np.flatnonzero(views.seen.any(axis=1)):
        which = views.seen[k]
        points.append(views.board.points[which].astype(kind).reshape(1, -1, 3))
        corners.append(views.uv[k, which].astype(kind).reshape(1, -1, 2))
    return points, corners


def intrinsics(model: CameraModel, K: Array, D: Array, size: tuple[int, int]) -> Intrinsics:
    """A camera of OpenCV's numbers."""
    terms = np.ravel(D)[: len(model.terms)]
    lens = None if model.lens is None else model.lens(*(float(term) for term in terms))
    fx, fy, cx, cy = (float(K[at]) for at in ((0, 0), (1, 1), (0, 2), (1, 2)))
    return Intrinsics(size[0], size[1], fx, fy, cx, cy, lens)


def criteria(cv2: Any) -> tuple[int, int, float]:
    """When steps end."""
    return (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, _STEPS, _STILL)


def reason(error: Exception) -> str:
    """OpenCV's own words, in one line."""
    return " ".join(str(getattr(error, "err", "") or error).split())[:160]
