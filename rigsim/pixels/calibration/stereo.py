"""Two cameras and their relative pose from corners of a board, by OpenCV.

Each camera first, from every board that it saw (Zhang, "A flexible new technique for camera calibration",
2000); then both together from the boards that both saw. OpenCV reads corners in single precision: some
1e-5 px. Its pixels are rigsim's: whole numbers are pixel centres.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rigsim.errors import InvalidRange, InvalidRig, MeasurementFailed
from rigsim.pixels.calibration.camera import (
    LEAST_CORNERS,
    CameraNumbers,
    CameraViews,
    begin_at,
    board_pose,
    criteria,
    from_scratch,
    intrinsics,
    lists,
    reason,
    solve_one,
)
from rigsim.pixels.calibration.models import CameraModel, camera_model
from rigsim.pixels.opencv import load_cv2
from rigsim.rig.arrays import Array, Mask
from rigsim.rig.board import Board
from rigsim.rig.lens.lens import Lens
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

LEAST_BOARDS = 2
"""Fewest boards that each camera, and both together, must have seen."""


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
        CameraViews(name, board, observed[:, side], seen[:, side], sizes[side])
        for side, name in enumerate(("left", "right"))
    )
    cameras = []
    for side, view in enumerate(views):
        begin = None if start is None else begin_at(model, (start.left, start.right)[side])
        cameras.append(from_scratch(model, view) if begin is None else solve_one(model, view, begin))
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


def _check(seen: Mask, both: Mask) -> None:
    for which, who in (
        (seen[:, 0], "the left camera saw"),
        (seen[:, 1], "the right camera saw"),
        (both, "both cameras saw"),
    ):
        count = int(which.any(axis=1).sum())
        if count < LEAST_BOARDS:
            raise MeasurementFailed(f"{who} {count} board(s): must be >= {LEAST_BOARDS} to calibrate with")


def _together(
    model: CameraModel, views: tuple[CameraViews, CameraViews], cameras: tuple[CameraNumbers, CameraNumbers]
) -> tuple[StereoRig, float]:
    """The rig, and the rms, from boards that both saw."""
    cv2 = load_cv2()
    points, corners_left = lists(views[0], model.fisheye)
    _, corners_right = lists(views[1], model.fisheye)
    left, right = cameras
    solve = cv2.fisheye.stereoCalibrate if model.fisheye else cv2.stereoCalibrate
    try:
        rms, K_left, D_left, K_right, D_right, R, t, *_ = solve(
            *(points, corners_left, corners_right),
            *(left.K.copy(), left.D.copy(), right.K.copy(), right.D.copy(), views[0].size),
            flags=model.flag(cv2, "CALIB_USE_INTRINSIC_GUESS"),
            criteria=criteria(cv2),
        )
    except cv2.error as error:
        raise MeasurementFailed(
            f"OpenCV cannot calibrate the two cameras together: {reason(error)}"
        ) from None
    if not all(np.isfinite(each).all() for each in (K_left, D_left, K_right, D_right, R, t)):
        raise MeasurementFailed(
            "OpenCV finds no rig: its numbers are not finite; are both pictures' corners in the same order?"
        )
    rig = StereoRig(
        intrinsics(model, K_left, D_left, views[0].size),
        intrinsics(model, K_right, D_right, views[1].size),
        Pose(np.asarray(R), np.ravel(t)),
    )
    return rig, float(rms)
