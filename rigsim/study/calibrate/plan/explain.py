"""Why boards leave a rig open, in the words of whom holds them."""

from __future__ import annotations

import math

import numpy as np

from rigsim.errors import CalibrationUndetermined
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.plan.asked import MOST_POSES, PlanAsked
from rigsim.study.calibrate.plan.held import smallest_square_px
from rigsim.study.calibrate.plan.reach import LEAST_SQUARE_PX, ReachedPoses
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.covariance import CalibrationCovariance
from rigsim.theory.calibration.parameters import CAMERA

_NO_TILT_RAD = math.radians(2)
_BESIDE = 1e-3
"""So far off its axis a camera's scale is taken, a share of the distance."""
_SAME = 1e-6
_MIDDLE = 0.6
"""Share of the half diagonal of a picture; within, a lens bends little."""


def check_shared(reached: ReachedPoses) -> None:
    """Refuse boards none of which both cameras see: where the cameras stand is open."""
    if not len(reached):
        raise CalibrationUndetermined(
            "no board is seen whole by either camera: nothing to calibrate from; see that the poses are"
            " left_from_board, rad and m",
            "no_poses",
        )
    if not reached.both.any():
        raise CalibrationUndetermined(
            "no board is seen whole by both cameras: where the one stands beside the other stays open; hold"
            " some where both pictures show all corners",
            "one_camera",
        )


def undetermined(asked: PlanAsked, reached: ReachedPoses, names: tuple[str, ...]) -> CalibrationUndetermined:
    """What to say of boards that leave `names` open."""
    n = len(reached)
    tilt = largest_tilt_rad(asked.rig, reached.poses)
    if n == 1:
        return CalibrationUndetermined(
            f"a single board leaves {_some(names)} open: hold it in several places, tilted differently",
            "one_pose",
        )
    if _same(reached):
        return CalibrationUndetermined(
            f"all {n} boards are held in the same pose, which leaves {_some(names)} open as a single one"
            " does: hold it in several places, tilted differently",
            "one_pose",
        )
    chosen = isinstance(asked.poses, int)
    if tilt < _NO_TILT_RAD:
        allowed = f"{math.degrees(asked.reach.tilt_rad):.2g}deg"
        why = f" (`--tilt {allowed}` allows no more)" if chosen else ""
        way = (
            "allow some tilt (`--tilt 40deg`)"
            if chosen
            else "tilt some by 30 deg and more, about different axes"
        )
        return CalibrationUndetermined(
            f"no board is tilted{why}: all {n} are parallel to the pictures (largest tilt"
            f" {math.degrees(tilt):.2g} deg), where a longer focal length looks like boards farther"
            f" off; {way}",
            "no_tilt",
        )
    square = typical_square_px(asked, reached)
    if square < LEAST_SQUARE_PX:
        return CalibrationUndetermined(
            f"the boards are so far off that their squares are {square:.2g} px: {_some(names)} stay open;"
            f" hold them nearer (poses are rad and m), with squares of {LEAST_SQUARE_PX:g} px and more",
            "open",
        )
    out = farthest_out(asked, reached)
    if out < _MIDDLE:
        return CalibrationUndetermined(
            f"all {n} boards are in the middle of the pictures (within {100 * out:.0f} % of the way to"
            f" corners): {_some(names)} stay open; hold some near rims and corners, or fix lens coefficients",
            "middle",
        )
    ways = _ways_out(asked, n) if chosen else "hold more, tilted and placed differently, or fix some of these"
    return CalibrationUndetermined(f"these {n} boards leave {_some(names)} open: {ways}", "open")


def _same(reached: ReachedPoses) -> bool:
    """Whether all boards are held in one pose."""
    poses = reached.poses
    return bool(
        np.allclose(poses.R, poses.R[:1], rtol=0, atol=_SAME)
        and np.allclose(poses.t, poses.t[:1], rtol=_SAME, atol=_SAME)
    )


def _ways_out(asked: PlanAsked, count: int) -> str:
    """What to ask for instead where poses that were chosen leave a rig open."""
    ways = []
    if count < MOST_POSES:
        ways.append(f"choose more (`--poses {min(3 * count, MOST_POSES)}`)")
    free = set(asked.parameters.free_names(asked.rig))
    rational = [name for name in ("k4", "k5", "k6") if {f"left.{name}", f"right.{name}"} & free]
    if rational:
        ways += ["plan a leaner lens (`--model brown`)", f"hold some (`--fix {','.join(rational)}`)"]
    elif any(name.endswith(".k3") for name in free):
        ways.append("hold some (`--fix k3`)")
    return ", or ".join([*ways, "hold the board nearer (`--range`)"])


def lens_coefficients(asked: PlanAsked) -> tuple[str, ...]:
    """What the lens models have that is estimated, as sentences call it."""
    free = [name.partition(".")[2] for name in asked.parameters.free_names(asked.rig) if "." in name]
    own = [name for name in dict.fromkeys(free) if name not in CAMERA]
    return (f"the lens coefficients ({', '.join(own)})",) if own else ("the focal lengths",)


def tilts_rad(rig: StereoRig, poses: BoardPoses) -> Array:
    """Angle (n,) between each board and the plane of the picture that it is turned out of the most."""
    axes = np.stack([np.array([0.0, 0.0, 1.0]), rig.right_from_left.R[2]])
    return np.asarray(np.arccos(np.clip(np.abs(poses.R[:, :, 2] @ axes.T), 0, 1)).max(axis=1))


def largest_tilt_rad(rig: StereoRig, poses: BoardPoses) -> float:
    """Of all boards."""
    return float(tilts_rad(rig, poses).max(initial=0.0))


def typical_square_px(asked: PlanAsked, reached: ReachedPoses) -> float:
    """Median of the boards' smallest squares, px."""
    sizes = smallest_square_px(reached.poses.project(asked.rig, asked.board), asked.board)
    return float(np.median(sizes[reached.seen]))


def farthest_out(asked: PlanAsked, reached: ReachedPoses) -> float:
    """How far out a corner of a board is in either picture, as a share of the half diagonal."""
    uv = reached.poses.project(asked.rig, asked.board)
    out = 0.0
    for side, camera in enumerate((asked.rig.left, asked.rig.right)):
        middle = np.array([(camera.width - 1) / 2, (camera.height - 1) / 2])
        seen = uv[reached.seen[:, side], side]
        if seen.size:
            out = max(out, float(np.linalg.norm(seen - middle, axis=-1).max() / np.linalg.norm(middle)))
    return out


def focal_openness(covariance: CalibrationCovariance) -> float:
    """Largest standard deviation of a camera's scale on its axis, as a share of it.

    That of the focal length, whatever a lens's coefficients do to it.
    """
    rig, parameters, found = covariance.rig, covariance.parameters, 0.0
    beside = np.array([[_BESIDE, 0, 1], [-_BESIDE, 0, 1], [0, _BESIDE, 1], [0, -_BESIDE, 1]])
    for side, camera in enumerate((rig.left, rig.right)):
        own = parameters.columns(side)
        slopes = parameters.camera_slopes(rig, side, beside)
        scale = np.stack([slopes[0, 0] - slopes[1, 0], slopes[2, 1] - slopes[3, 1]]) / (2 * _BESIDE)
        variance = np.einsum("kp,pq,kq->k", scale, covariance.matrix[own, own], scale)
        found = max(found, float((np.sqrt(np.maximum(variance, 0)) / np.abs(camera.axial_focal_px)).max()))
    return found


def rim_openness(covariance: CalibrationCovariance, distance_m: float) -> float:
    """Largest standard deviation of what a camera shows in a corner of its picture, in half diagonals."""
    rig, found = covariance.rig, 0.0
    for side, camera in enumerate((rig.left, rig.right)):
        ends = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
        points = camera.ray(ends * [camera.width - 1, camera.height - 1]) * distance_m
        points = points[np.isfinite(points).all(axis=1)]
        if len(points):
            std = covariance.projection_std(side, points).max()
            found = max(found, float(2 * std / np.hypot(camera.width, camera.height)))
    return found


def _some(names: tuple[str, ...]) -> str:
    """The first few of them."""
    few = ", ".join(names[:4])
    return f"{few} and others" if len(names) > 4 else few
