"""Calibrations that strangers published: what each is read as, how far off, in what time.

And one pair of cameras in two models. They are not part of the project: name their folder in the
environment variable RIGSIM_CALIBRATIONS.
"""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

from rigsim.errors import RigsimError
from rigsim.interop.formats.calibration import read
from rigsim.interop.formats.kit.reading import Reading, RigReading
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics

VARIABLE = "RIGSIM_CALIBRATIONS"


class Case(NamedTuple):
    """A calibration, and what is true of it."""

    place: str
    """File or folder."""
    baseline_mm: float | None
    """Known from elsewhere; None where it has to be refused."""
    says: str = ""
    """Words of the refusal, or codes of remarks, that must be there."""
    said: RigReading = RigReading()
    """What a person who knows the rig says beside it."""


CASES = (
    Case("kalibr_yaml_directive_comment", 49.961),
    Case("kalibr_T_imu_cam_only", 110.078),
    Case("kalibr_equidistant_tumvi", 101.087),
    Case("kalibr_omni", 110.0407),
    Case("kalibr_vertical_pair_limits_wrong", 222.635, "no_overlap"),
    Case("ros_swapped_pair", 70.0819, "swapped"),
    Case("ros_no_distortion_model", 60.2138),
    Case("opencv_sample_pair_mm_k5", None, "60.75 mm with --rig-unit mm"),
    Case("opencv_sample_pair_mm_k5", 60.747, "no_size", RigReading(unit="mm")),
    Case("opencv_sample_pair_rational14", 61.415, "fold", RigReading(unit="25mm", size_px=(1280, 720))),
    Case("opencv_sample_pair_swapped", None, "--rig-unit"),
    Case("opencv_sample_pair_swapped", 27.804, "swapped", RigReading(unit="mm")),
    Case("opencv_stereo_yml_no_size_swapped", 14.05, "swapped"),
    Case("opencv_xml_ros_pair", 88.327),
    Case("opencv_bad_calibration_padel", None, "70.24 mm with --rig-unit mm"),
    Case("orbslam2_stereo", 110.08),
    Case("oak_calib_json", 75.18),
    Case("basalt/euroc_ds_calib.json", 110.232),
    Case("basalt/euroc_eucm_calib.json", 110.232),
    Case("basalt/tumvi_512_ds_calib.json", 101.0),
    Case("kitti_raw_y_offset", 532.73),
    Case("kitti_odometry", 537.166, "no_size"),
    Case("nerfstudio_mono_trajectory", None, "one camera that moves"),
    Case("colmap_rigs_one_sensor", None, "camera that moves"),
)
"""Baselines: as their publishers tell them, or computed by hand from the numbers in the files."""


def run() -> None:
    """Print the tables."""
    folder = os.environ.get(VARIABLE)
    if folder is None:
        print(f"{VARIABLE} names no folder of calibrations: nothing to read")
        return
    root = Path(folder)
    print(
        f"{'calibration':36s} {'format':10s} {'baseline':>10s} {'off':>8s} {'time':>7s}  remarks, or refusal"
    )
    for case in CASES:
        print(_line(root, case))
    print(
        "\nOne pair of cameras as double sphere and as EUCM, every pixel unprojected          (under .1 px)"
    )
    pair = [read([root / "basalt" / f"euroc_{name}_calib.json"]).rig for name in ("ds", "eucm")]
    for side in ("left", "right"):
        largest_px, rms_px = _apart(getattr(pair[0], side), getattr(pair[1], side))
        print(f"  {side:6s} largest {largest_px:.3f} px, rms {rms_px:.3f} px")


def _line(root: Path, case: Case) -> str:
    # a calibration that was read is kept: the first time counts
    start = time.perf_counter()
    found = _read(root / case.place, case.said)
    took = f"{(time.perf_counter() - start) * 1e3:4.0f} ms"
    if isinstance(found, str):
        right = case.baseline_mm is None and case.says in found
        return (
            f"{case.place:36s} {'refused':10s} {'':>10s} {'' if right else 'WRONG':>8s} {took}  {found[:120]}"
        )
    baseline_mm = found.rig.baseline_m * 1e3
    codes = " ".join(dict.fromkeys(remark.code for remark in found.remarks))
    off = "WRONG" if case.baseline_mm is None else f"{100 * (baseline_mm / case.baseline_mm - 1):+.3f} %"
    missing = "" if case.says in codes else f"; MISSING {case.says}"
    return f"{case.place:36s} {found.format:10s} {baseline_mm:7.2f} mm {off:>8s} {took}  {codes}{missing}"


def _read(path: Path, said: RigReading) -> Reading | str:
    try:
        return read([path], said)
    except RigsimError as error:
        return str(error)


def _apart(one: Intrinsics, other: Intrinsics) -> tuple[float, float]:
    """How far the rays of one camera's pixels lie from them in the other, px: the largest, and rms."""
    u, v = np.meshgrid(np.arange(one.width), np.arange(one.height))
    uv: Array = np.stack([u, v], axis=-1).reshape(-1, 2).astype(np.float64)
    off = np.linalg.norm(other.project(one.ray(uv)) - uv, axis=1)
    return float(np.nanmax(off)), float(np.sqrt(np.nanmean(off**2)))
