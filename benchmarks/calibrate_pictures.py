"""A calibration of real pictures: each pair as the others predict it, and what the rig comes to.

OpenCV's samples have 13 pairs of 640 x 480 px, left01.jpg to right14.jpg, of a board of 9x6 inner corners
(Debian's opencv-doc). They are not part of the project: name their folder in the environment variable
RIGSIM_STEREO_PICTURES.
"""

from __future__ import annotations

import os
import time
from pathlib import Path

import numpy as np

from rigsim.rig.board import Board
from rigsim.study.calibrate.pictures.asked import PicturesAsked
from rigsim.study.calibrate.pictures.held_out import held_out
from rigsim.study.calibrate.pictures.look import look
from rigsim.study.calibrate.pictures.pairs import paired
from rigsim.study.calibrate.pictures.result import CalibratedPictures
from rigsim.study.calibrate.pictures.run import calibrate_pictures

VARIABLE = "RIGSIM_STEREO_PICTURES"
BOARD = Board(9, 6, 0.025)
PATTERNS = ("left[0-9][0-9].jpg", "right[0-9][0-9].jpg")


def run() -> None:
    """Calibrate in several models, and print what the pictures say of each other."""
    place = os.environ.get(VARIABLE)
    if not place:
        print(f"no pictures: name their folder in {VARIABLE} (left01.jpg, right01.jpg, ...)")
        return
    left, right = (sorted(str(path) for path in Path(place).glob(pattern)) for pattern in PATTERNS)
    begin = time.perf_counter()
    looked = look(BOARD, paired([left, right]).pairs)
    print(f"{len(looked.pairs)} pairs searched in {time.perf_counter() - begin:.1f} s")
    for name, asked in {
        "brown": PicturesAsked(BOARD),
        "brown, k3 held": PicturesAsked(BOARD, fix=("k3",)),
        "brown, warp": PicturesAsked(BOARD, warp=True),
        "rational": PicturesAsked(BOARD, "rational"),
    }.items():
        begin = time.perf_counter()
        result = calibrate_pictures(asked, looked)
        _print(name, result, time.perf_counter() - begin)


def _print(name: str, result: CalibratedPictures, seconds: float) -> None:
    ratios = [check.ratio for check in result.pictures]
    anew = [held_out(result.fit, k).ratio for k in range(len(result.fit.sightings))]
    at_3_m = next(row for row in result.depths if row.place == "axis" and row.z_m == 3.0)
    opencv = result.opencv.rig.baseline_m / result.rig.baseline_m - 1
    print(
        f"{name}: baseline {1e3 * result.rig.baseline_m:.3f} +- {1e3 * result.baseline_std_m:.3f} mm (OpenCV"
        f" {opencv:+.1e}), rms {result.fit.rms_px:.3f} px, corner noise {result.fit.noise_px:.3f} px (claimed"
        f" {result.fit.sightings.claimed_rms_px:.3f}), depth std at 3 m from calibration"
        f" {1e3 * at_3_m.calibration_m:.1f} mm; {seconds:.1f} s"
    )
    print(
        f"  observed over predicted {result.ratio:.2f} rms, {min(ratios):.2f} to {max(ratios):.2f};"
        " calibrated anew"
        f" without each: within {np.abs(np.array(ratios)[result.kept] / anew - 1).max():.1%}"
    )
    for check in result.pictures:
        if check.verdict != "good":
            print(f"  {check.name}: {check.verdict} {check.reason}, {check.ratio:.2f}")
