"""Calibrations as robots' and SLAM's programs keep them, all of one rig: sets of files, by name."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

_ODOMETRY = ((0.0, 0.0, 0.0), (-0.083, 0.0, 0.0), (0.06, -0.001, 0.004), (-0.02, 0.002, 0.003))
"""Where the first camera stands in each one's frame, m."""


def robots(rig: StereoRig, terms: str = "0.01, -0.02, 0.003, 0.001") -> dict[str, Mapping[str, bytes]]:
    """The forms of `rig`'s two cameras; `terms` are four coefficients of each lens."""
    body_from_left = Pose.from_rotvec([0.3, -1.2, 0.4], [0.11, 0.07, -0.02])
    body_from_right = body_from_left @ rig.right_from_left.inverse
    body = (_matrix(body_from_left), _matrix(body_from_right))
    texts = {
        "openvins": {"chain.yaml": _chain(rig, body, terms)},
        "ros, messages": _messages(rig, terms),
        "euroc": {f"cam{i}.yaml": _sensor(rig, i, body[i], terms) for i in (0, 1)},
        "vins": _vins(rig, body, terms),
        "orbslam": {"settings.yaml": _orbslam(rig, terms)},
        "kitti, odometry": {"calib.txt": _odometry()},
    }
    return {form: {name: text.encode() for name, text in files.items()} for form, files in texts.items()}


def _matrix(pose: Pose) -> np.ndarray:
    return np.vstack([np.hstack([pose.R, pose.t[:, None]]), [0.0, 0.0, 0.0, 1.0]])


def _numbers(values: np.ndarray) -> str:
    return ", ".join(repr(float(value)) for value in values.ravel())


def _opencv(name: str, M: np.ndarray) -> str:
    return f"{name}: !!opencv-matrix\n   rows: 4\n   cols: 4\n   dt: d\n   data: [{_numbers(M)}]\n"


def _ends(rig: StereoRig, i: int) -> tuple[float, float, float, float]:
    camera = (rig.left, rig.right)[i]
    return camera.fx, camera.fy, camera.cx, camera.cy


def _chain(rig: StereoRig, body: tuple[np.ndarray, np.ndarray], terms: str) -> str:
    text = "%YAML:1.0 # as OpenVINS keeps it\n\n"
    for i, M in enumerate(body):
        rows = "".join(f"    - [{_numbers(row)}]\n" for row in M)
        text += (
            f"cam{i}:\n  T_imu_cam:\n{rows}  cam_overlaps: [{1 - i}]\n  camera_model: pinhole\n"
            f"  distortion_coeffs: [{terms}]\n  distortion_model: equidistant\n"
            f"  intrinsics: {list(_ends(rig, i))}\n  resolution: [1280, 720]\n"
        )
    return text


def _messages(rig: StereoRig, terms: str) -> dict[str, str]:
    fx, _, cx, cy = _ends(rig, 0)
    return {
        f"{side}.txt": (
            f"header:\n  frame_id: camera\nheight: 720\nwidth: 1280\n"
            f"distortion_model: equidistant\nD: [{terms}]\n"
            f"K: [{fx}, 0.0, {cx}, 0.0, {fx}, {cy}, 0.0, 0.0, 1.0]\n"
            "R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\n"
            f"P: [{fx}, 0.0, {cx}, {-fx * offset}, 0.0, {fx}, {cy}, 0.0, 0.0, 0.0, 1.0, 0.0]\n---\n"
        )
        for side, offset in (("left", 0.0), ("right", rig.baseline_m))
    }


def _sensor(rig: StereoRig, i: int, M: np.ndarray, terms: str) -> str:
    return (
        f"sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [{_numbers(M)}]\nrate_hz: 20\n"
        f"resolution: [1280, 720]\ncamera_model: pinhole\nintrinsics: {list(_ends(rig, i))}\n"
        f"distortion_model: radial-tangential\ndistortion_coefficients: [{terms}]\n"
    )


def _vins(rig: StereoRig, body: tuple[np.ndarray, np.ndarray], terms: str) -> dict[str, str]:
    files = {
        "vins.yaml": '%YAML:1.0\n\nnum_of_cam: 2\ncam0_calib: "one.yaml"\ncam1_calib: "two.yaml"\n'
        + _opencv("body_T_cam0", body[0])
        + _opencv("body_T_cam1", body[1])
    }
    k1, k2, p1, p2 = terms.split(", ")
    for i, name in enumerate(("one", "two")):
        fx, fy, cx, cy = _ends(rig, i)
        files[f"{name}.yaml"] = (
            "%YAML:1.0\n---\nmodel_type: MEI\ncamera_name: camera\nimage_width: 1280\nimage_height: 720\n"
            "mirror_parameters:\n   xi: 1.2\n"
            f"distortion_parameters:\n   k1: {k1}\n   k2: {k2}\n   p1: {p1}\n   p2: {p2}\n"
            f"projection_parameters:\n   gamma1: {fx}\n   gamma2: {fy}\n   u0: {cx}\n   v0: {cy}\n"
        )
    return files


def _orbslam(rig: StereoRig, terms: str) -> str:
    text = '%YAML:1.0\n\nCamera.type: "KannalaBrandt8"\nCamera.width: 1280\nCamera.height: 720\n'
    for i in (0, 1):
        for key, value in zip(("fx", "fy", "cx", "cy"), _ends(rig, i), strict=True):
            text += f"Camera{i + 1}.{key}: {value}\n"
        for key, term in zip(("k1", "k2", "k3", "k4"), terms.split(", "), strict=True):
            text += f"Camera{i + 1}.{key}: {term}\n"
    return text + _opencv("Stereo.T_c1_c2", _matrix(rig.right_from_left.inverse))


def _odometry() -> str:
    K = np.array([[718.856, 0.0, 607.2], [0.0, 718.856, 185.2], [0.0, 0.0, 1.0]])
    lines = (np.hstack([K, (K @ place)[:, None]]) for place in _ODOMETRY)
    return "".join(f"P{i}: {' '.join(f'{value:.12e}' for value in P.ravel())}\n" for i, P in enumerate(lines))
