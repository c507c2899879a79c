"""Mistakes in what goes in: the pixels, the camera matrices, the pose, the lenses."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from benchmarks.subjects import mutant as declare
from benchmarks.subjects.triangulators import (
    calibration,
    distort,
    intersect,
    linear,
    midpoint,
    normalised,
    opencv,
    rays,
    solve_linear,
    undistort,
)
from rigsim.rig.arrays import Array
from rigsim.rig.pose import rotation_from_rotvec
from rigsim.rig.stereo import StereoRig

MUTANTS: list[declare.Mutant] = []
"""In the order below."""

mutant = partial(declare.mutant, MUTANTS)


# what is done to the pixels


@mutant("pixels", "the left image's pixels go in for the right's", "left and right pixels are swapped")
def swapped_pixels(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return linear(rig, uv_right, uv_left)


@mutant(
    "pixels",
    "pixels counted from the corner of the first, as in COLMAP: 0.5 too much",
    "half a pixel: positions are 0.5 px too large for a principal point that counts from pixel centres",
)
def corner_origin(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return linear(rig, uv_left + 0.5, uv_right + 0.5)


@mutant(
    "pixels",
    "cx and cy half a pixel too large: the middle taken at W / 2",
    "half a pixel: W/2 was used where pixel centres want (W - 1)/2",
)
def middle_at_half_width(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return midpoint(rig, uv_left - 0.5, uv_right - 0.5)


@mutant("pixels", "half a pixel in the right image alone", "the right image's pixels are half a pixel off")
def half_pixel_right(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return opencv(rig, uv_left, uv_right + np.array([0.5, 0.0]))


@mutant(
    "pixels",
    "v counted from the lowest row up, as in OpenGL and MATLAB's plots",
    "pixel rows run the wrong way: v is flipped",
)
def rows_from_below(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    up = np.array([1.0, -1.0])
    low_left, low_right = (np.array([0.0, c.height - 1.0]) for c in (rig.left, rig.right))
    return linear(rig, low_left + up * uv_left, low_right + up * uv_right)


@mutant("pixels", "(row, column) taken for (column, row)", "u and v are exchanged")
def rows_for_columns(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return linear(rig, uv_left[:, ::-1], uv_right[:, ::-1])


@mutant("pixels", "pixels rounded to whole ones", "pixel positions are rounded to whole pixels")
def whole_pixels(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return linear(rig, np.round(uv_left), np.round(uv_right))


@mutant(
    "pixels",
    "u of the right image kept to 1/16 px, as in a block matcher's fixed point",
    "pixel positions are rounded to 1/16 px",
)
def sixteenths(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return midpoint(rig, uv_left, np.round(uv_right * 16) / 16)


# what is done to the cameras


@mutant(
    "camera",
    "left K used for the right camera and the other way round",
    "the two camera matrices are swapped",
)
def cameras_exchanged(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    return solve_linear(replace(c, K_left=c.K_right, K_right=c.K_left), uv_left, uv_right)


@mutant("camera", "left K used for both cameras", "the right camera has the left one's intrinsics")
def one_camera_matrix(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    return solve_linear(replace(c, K_right=c.K_left), uv_left, uv_right)


@mutant(
    "camera", "the right camera's cx set to the left one's", "doffs, the difference of the cx, is ignored"
)
def no_doffs(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    K = c.K_right.copy()
    K[0, 2] = c.K_left[0, 2]
    return solve_linear(replace(c, K_right=K), uv_left, uv_right)


@mutant(
    "camera",
    "principal points set to the images' middle",
    "the calibrated principal point is ignored: the image's middle is used",
)
def centred_cameras(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    K_left, K_right = c.K_left.copy(), c.K_right.copy()
    K_left[:2, 2] = (rig.left.width - 1) / 2, (rig.left.height - 1) / 2
    K_right[:2, 2] = (rig.right.width - 1) / 2, (rig.right.height - 1) / 2
    return solve_linear(replace(c, K_left=K_left, K_right=K_right), uv_left, uv_right)


@mutant("camera", "fx used for fy as well", "fy is taken to be fx: pixels are not square")
def square_pixels(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    K_left, K_right = c.K_left.copy(), c.K_right.copy()
    K_left[1, 1], K_right[1, 1] = K_left[0, 0], K_right[0, 0]
    return solve_linear(replace(c, K_left=K_left, K_right=K_right), uv_left, uv_right)


@mutant("camera", "cx and cy exchanged", "cx and cy are exchanged")
def centre_exchanged(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    K_left, K_right = c.K_left.copy(), c.K_right.copy()
    K_left[:2, 2], K_right[:2, 2] = K_left[1::-1, 2], K_right[1::-1, 2]
    return solve_linear(replace(c, K_left=K_left, K_right=K_right), uv_left, uv_right)


@mutant(
    "camera", "focal length 1 % long: mm times a wrong pixel size", "the focal length is about 1 % too long"
)
def long_focal(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    longer = np.diag([1.01, 1.01, 1.0])
    K_left, K_right = (K @ np.eye(3) for K in (c.K_left, c.K_right))
    K_left[:2, :2], K_right[:2, :2] = (longer @ K_left)[:2, :2], (longer @ K_right)[:2, :2]
    return solve_linear(replace(c, K_left=K_left, K_right=K_right), uv_left, uv_right)


@mutant("camera", "K of a calibration at half the resolution", "K belongs to pictures of half the size")
def half_resolution(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    half = np.diag([0.5, 0.5, 1.0])
    return solve_linear(replace(c, K_left=half @ c.K_left, K_right=half @ c.K_right), uv_left, uv_right)


# what is done to the pose


@mutant("pose", "R transposed, t kept", "the rotation is transposed")
def transposed_rotation(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    return solve_linear(replace(c, R=c.R.T), uv_left, uv_right)


@mutant("pose", "left-from-right in the place of right-from-left", "the pose is inverted")
def inverse_pose(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    return solve_linear(replace(c, R=c.R.T, t=-c.R.T @ c.t), uv_left, uv_right)


@mutant("pose", "t negated", "the baseline has the wrong sign")
def negated_baseline(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    return solve_linear(replace(c, t=-c.t), uv_left, uv_right)


@mutant("pose", "t taken for the right camera's place", "t is used as the camera's centre: it is -R C")
def translation_as_centre(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    return solve_linear(replace(c, t=c.R @ c.t), uv_left, uv_right)


@mutant("pose", "the rotation left out", "the cameras' rotation is ignored")
def no_rotation(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return solve_linear(replace(calibration(rig), R=np.eye(3)), uv_left, uv_right)


@mutant("pose", "the rotation vector read as degrees", "degrees and radians are mixed up in the rotation")
def radians_as_degrees(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    R = rotation_from_rotvec(np.radians(rig.right_from_left.rotvec_rad))
    return solve_linear(replace(calibration(rig), R=R), uv_left, uv_right)


@mutant("pose", "the rotation vector read as Euler angles", "the rotation vector is used as Euler angles")
def rotvec_as_euler(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    R = euler(*rig.right_from_left.rotvec_rad)
    return solve_linear(replace(calibration(rig), R=R), uv_left, uv_right)


@mutant("pose", "t[1] and t[2] dropped", "only the x part of the baseline is used")
def sideways_baseline(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    return solve_linear(replace(c, t=c.t * (1, 0, 0)), uv_left, uv_right)


@mutant(
    "pose",
    "Z = f B / d of the pixels as they are, on every rig",
    "Z = fB/d is used on a rig that is not rectified: rotation and lens are ignored",
)
def never_rectified(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    xy_left, xy_right = normalised(uv_left, c.K_left), normalised(uv_right, c.K_right)
    with np.errstate(all="ignore"):
        z = rig.baseline_m / (xy_left[:, :1] - xy_right[:, :1])
        return np.where(z > 0, z * rays(xy_left), np.nan)


# what is done to the lenses


@mutant("lens", "distortion left out", "lens distortion is ignored")
def no_undistortion(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    return solve_linear(replace(c, lens_left=np.zeros(5), lens_right=np.zeros(5)), uv_left, uv_right)


@mutant("lens", "distortion applied where it should be removed", "distortion is applied instead of removed")
def distorted_again(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    left = distort(normalised(uv_left, c.K_left), c.lens_left)
    return intersect(c, left, distort(normalised(uv_right, c.K_right), c.lens_right))


@mutant("lens", "pixels undistorted twice", "distortion is removed twice")
def undistorted_twice(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    left = undistort(uv_left, c.K_left, c.lens_left) * (rig.left.fx, rig.left.fy) + c.K_left[:2, 2]
    right = undistort(uv_right, c.K_right, c.lens_right) * (rig.right.fx, rig.right.fy) + c.K_right[:2, 2]
    return solve_linear(c, left, right)


@mutant("lens", "only the left image undistorted", "the right camera's distortion is ignored")
def right_lens_forgotten(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return solve_linear(replace(calibration(rig), lens_right=np.zeros(5)), uv_left, uv_right)


@mutant("lens", "p1 and p2 exchanged", "the tangential coefficients p1 and p2 are exchanged")
def tangential_exchanged(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return reordered(rig, uv_left, uv_right, [0, 1, 3, 2, 4])


@mutant(
    "lens",
    "coefficients in the order k1 k2 k3 p1 p2",
    "the distortion coefficients are out of order: k3 comes last",
)
def k3_third(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return reordered(rig, uv_left, uv_right, [0, 1, 4, 2, 3])


def reordered(rig: StereoRig, uv_left: Array, uv_right: Array, order: list[int]) -> Array:
    c = calibration(rig)
    return solve_linear(
        replace(c, lens_left=c.lens_left[order], lens_right=c.lens_right[order]), uv_left, uv_right
    )


@mutant("lens", "Newton's method stopped after two steps", "undistortion stops before it has converged")
def impatient_newton(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    left = undistort(uv_left, c.K_left, c.lens_left, steps=2)
    return intersect(c, left, undistort(uv_right, c.K_right, c.lens_right, steps=2))


def euler(x: float, y: float, z: float) -> Array:
    """Rotation about x, then y, then z."""
    turns = (rotation_from_rotvec(angle * axis) for angle, axis in zip((x, y, z), np.eye(3), strict=True))
    about_x, about_y, about_z = turns
    return about_z @ about_y @ about_x
