"""Mistakes that only some rigs, points or calls bring out; and small ones that look like something else."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import cv2
import numpy as np

from benchmarks.subjects import mutant as declare
from benchmarks.subjects.triangulators import (
    Calibration,
    calibration,
    distort,
    homogeneous,
    in_front,
    intersect,
    linear,
    midpoint,
    normalised,
    opencv,
    solve_linear,
    undistort,
)
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig

MUTANTS: list[declare.Mutant] = []
"""In the order below."""

mutant = partial(declare.mutant, MUTANTS)

_KEPT: dict[tuple[int, int], Calibration] = {}


def turn_deg(c: Calibration) -> float:
    return float(np.degrees(np.arccos(np.clip((np.trace(c.R) - 1) / 2, -1, 1))))


def vector(c: Calibration) -> Array:
    return np.asarray(cv2.Rodrigues(c.R)[0]).ravel()


# the pose


@mutant("pose", "R transposed where it turns by over 40 deg", "R is transposed, for large turns alone")
def transposed_beyond_40(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    return solve_linear(replace(c, R=c.R.T) if turn_deg(c) > 40 else c, uv_left, uv_right)


@mutant("pose", "toe-out taken for toe-in", "the turn about y has the wrong sign for cameras that toe out")
def toe_out_as_toe_in(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    turn = vector(c)
    plain = abs(turn[1]) > 5 * (abs(turn[0]) + abs(turn[2]))
    outward = c.R[0, 2] * c.t[0] > 0  # what the right camera sees far ahead drifts the way of the baseline
    if plain and outward:
        c = replace(c, R=c.R.T)
    return solve_linear(c, uv_left, uv_right)


@mutant("pose", "the right camera always put to the right", "the baseline's x component loses its sign")
def always_to_the_right(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    centre = -c.R.T @ c.t
    if abs(centre[0]) > np.abs(centre[1:]).max() and turn_deg(c) < 30:
        centre[0] = abs(centre[0])
    return solve_linear(replace(c, t=-c.R @ centre), uv_left, uv_right)


@mutant("pose", "R of small angles: 1 + [w]x", "the rotation is its first-order approximation")
def small_angle_rotation(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    x, y, z = vector(c)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return solve_linear(replace(c, R=np.eye(3) + cross), uv_left, uv_right)


@mutant("pose", "turns under 2 deg left out", "small rotations are ignored")
def small_turns_ignored(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    return solve_linear(replace(c, R=np.eye(3)) if turn_deg(c) < 2 else c, uv_left, uv_right)


@mutant("pose", "a small z of the baseline taken for rounding", "t's z component is lost where it is small")
def small_z_dropped(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    t = c.t.copy()
    if abs(t[2]) < 0.2 * np.linalg.norm(t):
        t[2] = 0.0
    return solve_linear(replace(c, t=t), uv_left, uv_right)


@mutant("pose", "arcsin for the roll: beyond 90 deg it folds back", "rolls over 90 deg are wrong")
def folded_roll(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    turn = vector(c)
    if abs(turn[2]) > np.pi / 2:
        turn[2] = np.sign(turn[2]) * (np.pi - abs(turn[2]))
        c = replace(c, R=np.asarray(cv2.Rodrigues(turn)[0]))
    return solve_linear(c, uv_left, uv_right)


# the scale


@mutant("scale", "baselines over 10 m taken for mm", "long baselines are divided by 1000")
def long_baseline_in_mm(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    return solve_linear(replace(c, t=c.t / 1e3) if np.linalg.norm(c.t) > 10 else c, uv_left, uv_right)


@mutant("scale", "baselines under 5 mm taken for m", "short baselines are multiplied by 1000")
def short_baseline_in_m(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    return solve_linear(replace(c, t=c.t * 1e3) if np.linalg.norm(c.t) < 5e-3 else c, uv_left, uv_right)


# the cameras and lenses


@mutant("camera", "left K for both where they differ by under 5 %", "like lenses are taken to be equal")
def like_lenses_taken_as_equal(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    if abs(c.K_right[0, 0] / c.K_left[0, 0] - 1) < 0.05:
        c = replace(c, K_right=c.K_left)
    return solve_linear(c, uv_left, uv_right)


@mutant("camera", "fx and fy exchanged for upright pictures", "fx and fy are exchanged in portrait")
def portrait_exchanged(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    if c.size[1] > c.size[0]:
        swap = [1, 0, 2]
        K_left, K_right = (np.diag(np.diag(K)[swap]) + K - np.diag(np.diag(K)) for K in (c.K_left, c.K_right))
        c = replace(c, K_left=K_left, K_right=K_right)
    return solve_linear(c, uv_left, uv_right)


@mutant("lens", "only barrel distortion undone", "pincushion distortion is ignored")
def barrel_alone(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    none = np.zeros(5)
    return solve_linear(
        replace(
            c,
            lens_left=none if c.lens_left[0] > 0 else c.lens_left,
            lens_right=none if c.lens_right[0] > 0 else c.lens_right,
        ),
        uv_left,
        uv_right,
    )


@mutant("camera", "normalised rays fed to K[R|t]", "rays are divided by K twice")
def normalised_with_k(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    left, right = (
        normalised(undistort(uv, K, lens), K)
        for uv, K, lens in ((uv_left, c.K_left, c.lens_left), (uv_right, c.K_right, c.lens_right))
    )
    return intersect(c, left, right)


@mutant("camera", "P1, P2 of stereoRectify for raw pixels", "pixels are not rectified before P1 and P2")
def rectified_matrices_raw_pixels(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    _, _, P_left, P_right, *_ = cv2.stereoRectify(
        c.K_left, c.lens_left, c.K_right, c.lens_right, c.size, c.R, c.t.reshape(3, 1), flags=0
    )
    with np.errstate(all="ignore"):
        X = cv2.triangulatePoints(P_left, P_right, uv_left.T, uv_right.T)
        return np.asarray((X[:3] / X[3]).T)


@mutant("camera", "K in single precision", "the camera matrices are float32")
def single_k(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    K_left, K_right = (K.astype(np.float32).astype(np.float64) for K in (c.K_left, c.K_right))
    return solve_linear(replace(c, K_left=K_left, K_right=K_right), uv_left, uv_right)


@mutant("pose", "R in single precision", "the rotation is float32")
def single_r(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    return solve_linear(replace(c, R=c.R.astype(np.float32).astype(np.float64)), uv_left, uv_right)


# the pixels


@mutant("pixels", "u mirrored in both images", "u is counted from the right")
def mirrored_u(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    flip = np.array([-1.0, 1.0])
    across_left, across_right = (np.array([c.width - 1.0, 0.0]) for c in (rig.left, rig.right))
    return linear(rig, across_left + flip * uv_left, across_right + flip * uv_right)


@mutant("pixels", "pixels kept to 1/1000 px", "pixels are rounded to three decimals")
def thousandths(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return linear(rig, np.round(uv_left, 3), np.round(uv_right, 3))


# the rows


@mutant("rows", "pieces of 4096 rows, the last one never filled", "rows from 4096 on are zero")
def last_piece_empty(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    points = midpoint(rig, uv_left, uv_right)
    points[4096 * (len(points) // 4096) if len(points) > 4096 else len(points) :] = 0.0
    return points


@mutant("rows", "NaN where a ray runs along the optical axis", "points on the left axis are missing")
def nan_on_the_axis(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    points = linear(rig, uv_left, uv_right)
    points[(uv_left == (rig.left.cx, rig.left.cy)).all(axis=1)] = np.nan
    return points


@mutant("rows", "one row loses its axis", "one row alone comes back flat")
def one_row_squeezed(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    points = linear(rig, uv_left, uv_right)
    return points[0] if len(points) == 1 else points


@mutant(
    "rows", "the rig of the first call with this image size", "something of the rig is kept between calls"
)
def kept_by_size(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    if len(uv_left) == 200 and rig.is_rectified and not _KEPT:
        _KEPT[c.size] = c
    return solve_linear(_KEPT.setdefault(c.size, c), uv_left, uv_right)


# the range


@mutant("range", "nothing beyond 2 km", "points beyond 2 km are missing")
def nothing_beyond_2_km(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    points = midpoint(rig, uv_left, uv_right)
    points[points[:, 2] > 2000] = np.nan
    return points


@mutant("range", "nothing nearer than 30 mm", "points nearer than 30 mm are missing")
def nothing_within_30_mm(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    points = opencv(rig, uv_left, uv_right)
    points[points[:, 2] < 0.03] = np.nan
    return points


@mutant("range", "rays over 50 deg off the axis dropped", "wide rays are missing")
def wide_rays_dropped(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    points = linear(rig, uv_left, uv_right)
    off = np.hypot(points[:, 0], points[:, 1]) > np.tan(np.radians(50)) * points[:, 2]
    points[off] = np.nan
    return points


@mutant("range", "the sign of y lost left of the axis", "y is positive wherever x is negative")
def y_sign_lost_on_the_left(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    points = linear(rig, uv_left, uv_right)
    left = points[:, 0] < 0
    points[left, 1] = np.abs(points[left, 1])
    return points


@mutant("lens", "undistortion stops after 7 fixed-point steps", "undistortion is not finished")
def patient_but_not_enough(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)

    def undone(uv: Array, K: Array, lens: Array) -> Array:
        seen = normalised(uv, K)
        xy = seen
        for _ in range(7):
            s = np.sum(xy**2, axis=1)
            radial = (1 + s * (lens[0] + s * (lens[1] + s * lens[4])))[:, None]
            xy = (seen - (distort(xy, lens) - xy * radial)) / radial
        return xy

    left, right = undone(uv_left, c.K_left, c.lens_left), undone(uv_right, c.K_right, c.lens_right)
    return in_front(c, homogeneous(c, left, right))
