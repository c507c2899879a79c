"""Two cameras and their relative pose from corners of a board, by OpenCV.

Each camera first, from every board that it saw (Zhang, "A flexible new technique for camera calibration",
2000); then both together from the boards that both saw. OpenCV reads corners in single precision: some
1e-5 px. Its pixels are rigsim's: whole numbers are pixel centres.
"""

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
from rigsim.rig.stereo import StereoRig

LEAST_CORNERS = 6
"""Fewest corners of a picture that count."""
LEAST_BOARDS = 2
"""Fewest boards that each camera, and both together, must have seen."""
_STEPS = 200
_STILL = 1e-12


@dataclass(frozen=True, slots=True, eq=False)
class FoundRig:
    """What OpenCV finds."""

    rig: StereoRig
    """The rig."""
    left_from_board: Array
    """Rotation vectors, rad, and translations, m, of each board (n, 6); NaN where no camera saw it."""
    rms_px: float
    """As OpenCV says it: root mean square distance of a corner from where it should be, px, over the boards
    that both cameras saw."""


@dataclass(frozen=True, slots=True, eq=False)
class _Camera:
    """One camera as OpenCV has it."""

    K: Array
    D: Array


@dataclass(frozen=True, slots=True, eq=False)
class _Views:
    """What one camera saw."""

    name: str
    board: Board
    uv: Array
    seen: Mask
    size: tuple[int, int]


def calibrate_stereo(
    board: Board,
    observed: Array,
    sizes: tuple[tuple[int, int], tuple[int, int]],
    lenses: tuple[type[Lens] | None, type[Lens] | None],
    fix: Sequence[str] = (),
    start: StereoRig | None = None,
) -> FoundRig:
    """Calibrate both cameras and their relative pose.

    Args:
        board: The board; a warp of it is believed.
        observed: Corners (n, 2, m, 2) px of n boards in the left and the right picture, row-major; NaN where
            a camera did not see one.
        sizes: Width and height of the left and the right pictures, px.
        lenses: Lens models of the left and the right camera; see `camera_model`.
        fix: What is held: at what `start` says, or at square pixels, a principal point in the middle, and
            coefficients of 0.
        start: Where to begin, its lenses in these models; None lets OpenCV begin.

    Raises:
        InvalidRange: OpenCV has no such model, cannot hold this, or needs a start for it.
        MeasurementFailed: too few boards, or OpenCV finds no rig.
    """
    model = camera_model(lenses, fix)
    if start is None and "CALIB_FIX_FOCAL_LENGTH" in model.flags:
        raise InvalidRange("fix focal: is held at what is known of it: give a rig to start from")
    seen: Mask = np.asarray(np.isfinite(observed).all(axis=3))
    seen &= (seen.sum(axis=2) >= LEAST_CORNERS)[:, :, None]
    both: Mask = np.asarray(seen.all(axis=1))
    both &= (both.sum(axis=1) >= LEAST_CORNERS)[:, None]
    _check(seen, both)
    views = tuple(
        _Views(name, board, observed[:, side], seen[:, side], sizes[side])
        for side, name in enumerate(("left", "right"))
    )
    cameras = []
    for side, view in enumerate(views):
        begin = None if start is None else _begin(model, (start.left, start.right)[side])
        if begin is None and any(board.warp_m):
            # OpenCV needs a start where a board is not flat
            begin = _one(model, replace(view, board=replace(board, warp_m=(0.0, 0.0))), None)
        cameras.append(_one(model, view, begin))
    together = (replace(views[0], seen=both), replace(views[1], seen=both))
    try:
        rig, rms = _together(model, together, (cameras[0], cameras[1]))
    except InvalidRig as error:
        raise MeasurementFailed(f"OpenCV finds a rig that cannot be: {error}") from None
    return FoundRig(rig, _poses(rig, board, observed, seen), rms)


def _poses(rig: StereoRig, board: Board, observed: Array, seen: Mask) -> Array:
    """Each board's pose (n, 6) by the left camera, or by the right one where the left saw too little."""
    poses = np.full((len(observed), 6), np.nan)
    for k in np.flatnonzero(seen.any(axis=(1, 2))):
        side = 0 if seen[k, 0].any() else 1
        which = seen[k, side]
        pose = board_pose((rig.left, rig.right)[side], board.points[which], observed[k, side, which])
        if pose is not None:
            pose = pose if side == 0 else rig.right_from_left.inverse @ pose
            poses[k] = [*pose.rotvec_rad, *pose.t]
    return poses


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


def _check(seen: Mask, both: Mask) -> None:
    for which, who in (
        (seen[:, 0], "the left camera saw"),
        (seen[:, 1], "the right camera saw"),
        (both, "both cameras saw"),
    ):
        count = int(which.any(axis=1).sum())
        if count < LEAST_BOARDS:
            raise MeasurementFailed(f"{who} {count} board(s): must be >= {LEAST_BOARDS} to calibrate with")


def _begin(model: CameraModel, camera: Intrinsics) -> _Camera:
    """A known camera in OpenCV's numbers."""
    if camera.lens is not None and (model.lens is None or not isinstance(camera.lens, model.lens)):
        wanted = "pinhole" if model.lens is None else model.lens.model
        raise InvalidRange(f"lens {camera.lens.said}: is no {wanted}; start from one of that model")
    D = [0.0 if camera.lens is None else getattr(camera.lens, term) for term in model.terms]
    return _Camera(camera.K, np.array(D))


def _one(model: CameraModel, views: _Views, begin: _Camera | None) -> _Camera:
    """One camera from all boards that it saw."""
    cv2 = load_cv2()
    points, corners = _lists(views, model.fisheye)
    guess = () if begin is None else ("CALIB_USE_INTRINSIC_GUESS",)
    K, D = (np.eye(3), np.zeros(len(model.terms))) if begin is None else (begin.K.copy(), begin.D.copy())
    solve = cv2.fisheye.calibrate if model.fisheye else cv2.calibrateCamera
    try:
        flags = model.flag(cv2, *guess)
        _, K, D, *_ = solve(points, corners, views.size, K, D, flags=flags, criteria=_criteria(cv2))
    except cv2.error as error:
        raise MeasurementFailed(
            f"OpenCV cannot calibrate the {views.name} camera: {_reason(error)}"
        ) from None
    return _Camera(np.asarray(K), np.ravel(D)[: len(model.terms)])


def _together(
    model: CameraModel, views: tuple[_Views, _Views], cameras: tuple[_Camera, _Camera]
) -> tuple[StereoRig, float]:
    """The rig, and the rms, from boards that both saw."""
    cv2 = load_cv2()
    points, corners_left = _lists(views[0], model.fisheye)
    _, corners_right = _lists(views[1], model.fisheye)
    left, right = cameras
    solve = cv2.fisheye.stereoCalibrate if model.fisheye else cv2.stereoCalibrate
    try:
        rms, K_left, D_left, K_right, D_right, R, t, *_ = solve(
            *(points, corners_left, corners_right),
            *(left.K.copy(), left.D.copy(), right.K.copy(), right.D.copy(), views[0].size),
            flags=model.flag(cv2, "CALIB_USE_INTRINSIC_GUESS"),
            criteria=_criteria(cv2),
        )
    except cv2.error as error:
        raise MeasurementFailed(
            f"OpenCV cannot calibrate the two cameras together: {_reason(error)}"
        ) from None
    if not all(np.isfinite(each).all() for each in (K_left, D_left, K_right, D_right, R, t)):
        raise MeasurementFailed(
            "OpenCV finds no rig: its numbers are not finite; are both pictures' corners in the same order?"
        )
    rig = StereoRig(
        _intrinsics(model, K_left, D_left, views[0].size),
        _intrinsics(model, K_right, D_right, views[1].size),
        Pose(np.asarray(R), np.ravel(t)),
    )
    return rig, float(rms)


def _lists(views: _Views, fisheye: bool) -> tuple[list[Any], list[Any]]:
    """Corners on the board and in the picture, board by board, in the types that OpenCV takes."""
    kind = np.float64 if fisheye else np.float32
    points, corners = [], []
    for k in np.flatnonzero(views.seen.any(axis=1)):
        which = views.seen[k]
        points.append(views.board.points[which].astype(kind).reshape(1, -1, 3))
        corners.append(views.uv[k, which].astype(kind).reshape(1, -1, 2))
    return points, corners


def _intrinsics(model: CameraModel, K: Array, D: Array, size: tuple[int, int]) -> Intrinsics:
    terms = np.ravel(D)[: len(model.terms)]
    lens = None if model.lens is None else model.lens(*(float(term) for term in terms))
    fx, fy, cx, cy = (float(K[at]) for at in ((0, 0), (1, 1), (0, 2), (1, 2)))
    return Intrinsics(size[0], size[1], fx, fy, cx, cy, lens)


def _criteria(cv2: Any) -> tuple[int, int, float]:
    return (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, _STEPS, _STILL)


def _reason(error: Exception) -> str:
    """OpenCV's own words, in one line."""
    return " ".join(str(getattr(error, "err", "") or error).split())[:160]
