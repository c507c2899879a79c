"""Mistakes in a calibration file between the rig that wrote it and the OpenCV program that reads it."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import cv2
import numpy as np

from benchmarks.subjects import mutant as declare
from benchmarks.subjects.triangulators import Calibration, in_front, solve_opencv
from rigsim.interop.formats.opencv_yaml import opencv_yaml
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig

MUTANTS: list[declare.Mutant] = []
"""In the order below."""

mutant = partial(declare.mutant, MUTANTS)

_NAMES = ("K1", "D1", "K2", "D2", "R", "T")
_TO_MEMORY = cv2.FileStorage_WRITE | cv2.FileStorage_MEMORY | cv2.FileStorage_FORMAT_YAML
_FROM_MEMORY = cv2.FileStorage_READ | cv2.FileStorage_MEMORY

Matrices = dict[str, Array]


def as_written(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    """The right one: triangulates with the file as it was written."""
    return solve_opencv(through_file(rig, lambda matrices: None), uv_left, uv_right)


def through_file(rig: StereoRig, edit: Callable[[Matrices], object]) -> Calibration:
    """What an OpenCV program reads of the rig's file once another has edited the matrices in it."""
    matrices = matrices_in(opencv_yaml(rig))
    edit(matrices)
    storage = cv2.FileStorage(".yml", _TO_MEMORY)
    for name, matrix in matrices.items():
        storage.write(name, matrix)
    read = matrices_in(storage.releaseAndGetString())
    return Calibration(
        read["K1"],
        read["K2"],
        np.append(read["D1"], np.zeros(5))[:5],
        np.append(read["D2"], np.zeros(5))[:5],
        read["R"],
        read["T"].ravel(),
        (rig.left.width, rig.left.height),
    )


def matrices_in(text: str) -> Matrices:
    storage = cv2.FileStorage(text, _FROM_MEMORY)
    return {name: storage.getNode(name).mat() for name in _NAMES}


@mutant("pose", "T negated in the file", "the baseline has the wrong sign")
def file_baseline_negated(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return solve_opencv(through_file(rig, lambda m: m.update(T=-m["T"])), uv_left, uv_right)


@mutant("pose", "R written column by column", "the rotation is transposed")
def file_rotation_by_columns(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return solve_opencv(through_file(rig, lambda m: m.update(R=m["R"].T.copy())), uv_left, uv_right)


@mutant("pose", "R and T of the right camera in the left: the inverse of OpenCV's", "the pose is inverted")
def file_pose_inverted(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = through_file(rig, lambda m: m.update(R=m["R"].T.copy(), T=-m["R"].T @ m["T"]))
    return solve_opencv(c, uv_left, uv_right)


@mutant(
    "scale", "T in mm in the file, as OpenCV's samples have it", "the answer is in mm: 1000 times too large"
)
def file_baseline_in_mm(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return solve_opencv(through_file(rig, lambda m: m.update(T=1e3 * m["T"])), uv_left, uv_right)


@mutant("camera", "K1 and K2 exchanged in the file", "the two camera matrices are swapped")
def file_cameras_exchanged(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return solve_opencv(through_file(rig, lambda m: m.update(K1=m["K2"], K2=m["K1"])), uv_left, uv_right)


@mutant("lens", "D1 and D2 left out of the file", "lens distortion is ignored")
def file_distortion_dropped(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    none = np.zeros((1, 5))
    return solve_opencv(through_file(rig, lambda m: m.update(D1=none, D2=none)), uv_left, uv_right)


@mutant("lens", "four numbers in D1 and D2: k3 is lost", "k3 of the distortion is missing")
def file_k3_dropped(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = through_file(rig, lambda m: m.update(D1=m["D1"][:, :4].copy(), D2=m["D2"][:, :4].copy()))
    return solve_opencv(c, uv_left, uv_right)


@mutant("lens", "k3 in the place of p1", "the distortion coefficients are out of order: k3 comes last")
def file_k3_third(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    order = [0, 1, 4, 2, 3]
    c = through_file(rig, lambda m: m.update(D1=m["D1"][:, order], D2=m["D2"][:, order]))
    return solve_opencv(c, uv_left, uv_right)


@mutant(
    "pixels",
    "cx and cy in the file half a pixel larger, as COLMAP counts",
    "half a pixel in the principal point",
)
def file_corner_origin(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    half = np.array([[0.0, 0.0, 0.5], [0.0, 0.0, 0.5], [0.0, 0.0, 0.0]])
    c = through_file(rig, lambda m: m.update(K1=m["K1"] + half, K2=m["K2"] + half))
    return solve_opencv(c, uv_left, uv_right)


@mutant("scale", "four digits of every number in the file", "the calibration has lost its digits")
def file_four_digits(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    def rounded(matrices: Matrices) -> None:
        for name, matrix in matrices.items():
            matrices[name] = np.vectorize(lambda value: float(f"{value:.4g}"))(matrix)

    return solve_opencv(through_file(rig, rounded), uv_left, uv_right)


@mutant(
    "pixels",
    "P1 and P2 of stereoRectify used for pixels that nobody rectified",
    "rectified projections are used for pixels that are not: rotation and lens are ignored",
)
def file_projections_of_raw_pixels(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = through_file(rig, lambda matrices: None)
    R_left, _, P_left, P_right, *_ = cv2.stereoRectify(
        c.K_left, c.lens_left, c.K_right, c.lens_right, c.size, c.R, c.t.reshape(3, 1), flags=0
    )
    points = np.full((len(uv_left), 3), np.nan)
    known = np.isfinite(np.hstack([uv_left, uv_right])).all(axis=1)
    with np.errstate(all="ignore"):
        X = cv2.triangulatePoints(P_left, P_right, uv_left[known].T, uv_right[known].T)
        points[known] = (X[:3] / X[3]).T @ R_left
    return in_front(c, points)
