"""The table of the rig on show: its geometry, its noise, and the lens and sensor of its pictures."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from rigsim.present.kit.footprint import footprint
from rigsim.present.kit.format import count, length, number, percent, plain
from rigsim.present.sweep.tables import PageTable, TableRow
from rigsim.rig.arrays import Array
from rigsim.rig.noise import PixelNoise
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig
from rigsim.study.scene import columns as col
from rigsim.study.sweep.result import SweepResult

Entry: TypeAlias = tuple[str, str, str, str]
"""Parameter, value, unit, meaning."""

_SAME_POSE = 1e-9


def rig_table(result: SweepResult) -> PageTable:
    """Parameter, value, unit and meaning of the rig on show."""
    show, row = result.showcase, result.rows.iloc[result.showcase.row]
    entries = [
        *_geometry(show.rig),
        *_noise(show.noise, str(row[col.TRIANGULATOR])),
        *_depths(show.rig, show.points_left[show.visible, 2]),
    ]
    sample = f"{count(row[col.N_POINTS])} × {count(row[col.N_TRIALS])}"
    entries.append(("Sample", sample, "", "truth points × noisy trials of each"))
    entries += sensor_entries(show.sensor, str(row[col.SENSOR]))
    headings = (("Parameter", ""), ("Value", ""), ("Unit", ""), ("Meaning", ""))
    return PageTable(headings, (False, True, False, False), tuple(TableRow(entry) for entry in entries))


def _geometry(rig: StereoRig) -> list[Entry]:
    entries: list[Entry] = [
        ("Baseline", plain(rig.baseline_m * 1e3), "mm", "distance between the two camera centres"),
        ("Image size", f"{rig.left.width} × {rig.left.height}", "px", "of each camera"),
        ("Focal length", plain(rig.left.fx), "px", "of the left camera, along the image rows"),
        (
            "Field of view",
            f"{plain(rig.left.hfov_deg, 3)} × {plain(rig.left.vfov_deg, 3)}",
            "°",
            "horizontal × vertical, across the full image",
        ),
        (
            "Vergence",
            plain(round(rig.vergence_deg, 6) + 0.0),
            "°",
            "angle between the two optical axes; 0 is parallel",
        ),
    ]
    entries += _right_camera(rig)
    if rig.doffs_px:
        entries.append(
            (
                "Principal offset",
                plain(rig.doffs_px),
                "px",
                "right minus left principal point, along the rows",
            )
        )
    return entries


def _right_camera(rig: StereoRig) -> list[Entry]:
    """Where the right camera stands and looks, where baseline and vergence do not say it all."""
    pose = rig.right_from_left
    plain_pose = StereoRig.verged(rig.left, rig.baseline_m, rig.vergence_deg, right=rig.right).right_from_left
    off_m = float(np.abs(pose.t - plain_pose.t).max())
    if float(np.abs(pose.R - plain_pose.R).max()) < _SAME_POSE and off_m < _SAME_POSE * rig.baseline_m:
        return []
    there = pose.inverse
    turns = ", ".join(plain(round(float(np.degrees(there.rotvec_rad[i])), 6) + 0.0) for i in (1, 0, 2))
    shifts = ", ".join(plain(round(float(there.t[i]) * 1e3, 6) + 0.0) for i in (1, 2))
    return [
        ("Right camera turned", turns, "°", "yaw, pitch, roll: + is right, up, clockwise"),
        ("Right camera shifted", shifts, "mm", "vertical, forward: + is down, forward"),
    ]


def _noise(noise: PixelNoise, triangulator: str) -> list[Entry]:
    return [
        (
            "Pixel noise",
            plain(noise.std_px),
            "px",
            "standard deviation of each simulated image coordinate",
        ),
        (
            "Disparity noise",
            number(noise.disparity_std_px),
            "px",
            "what that makes of the difference between left and right",
        ),
        ("Triangulator", triangulator, "", "how two image points become one point in space"),
    ]


def _depths(rig: StereoRig, depth: Array) -> list[Entry]:
    """Where the points lie, `depth` (N,) m."""
    entries: list[Entry] = []
    nearest = footprint(rig).nearest
    if nearest is not None:
        value, unit = length(nearest[1]).split(" ")
        entries.append(("Nearest overlap", value, unit, "closer than this, no point is seen by both cameras"))
    if len(depth):
        entries.append(
            (
                "Depth of the points",
                f"{number(depth.min())} to {number(depth.max())}",
                "m",
                f"of the truth points that both cameras see, median {number(float(np.median(depth)))} m",
            )
        )
        if rig.is_rectified:
            middle = float(np.median(depth))
            value, unit = length(middle**2 / (rig.left.fx * rig.baseline_m)).split(" ")
            entries.append(
                (
                    "Depth of one pixel",
                    value,
                    unit,
                    "depth that one pixel of disparity stands for at the median depth",
                )
            )
    return entries


def sensor_entries(sensor: Sensor, name: str) -> list[Entry]:
    """What lens and sensor of a name do to the pictures; numbers that do nothing are left out."""
    depth = f"{sensor.bits} bit" if sensor.bits else "not rounded"
    what = "lens and sensor that the pictures were taken with"
    if sensor == Sensor(bits=sensor.bits):
        return [("Sensor", f"ideal pinhole, {depth}", "", what)]
    entries: list[Entry] = [("Sensor", f"{name}, {depth}", "", what)]
    if sensor.blur_px:
        entries.append(
            (
                "Lens blur",
                plain(sensor.blur_px),
                "px",
                "standard deviation of the point spread; pixels add theirs",
            )
        )
    lens = sensor.distortion
    if lens is not None:
        said = ", ".join(
            f"{name} {plain(getattr(lens, name))}" for name in lens.names() if getattr(lens, name)
        )
        entries.append(
            ("Lens distortion", said or "0", "", f"{lens.title}, taken out again before measuring")
        )
    entries += _electrons(sensor)
    if sensor.grey_noise:
        entries.append(
            (
                "Image noise",
                plain(sensor.grey_noise),
                "grey",
                "white noise on top, in levels of an 8-bit picture",
            )
        )
    if sensor.vignetting:
        entries.append(("Vignetting", percent(sensor.vignetting), "%", "light lost in the corners"))
    if sensor.right_gain != 1 or sensor.right_offset:
        value = f"× {plain(sensor.right_gain)}"
        if sensor.right_offset:
            sign = "−" if sensor.right_offset < 0 else "+"
            value += f" {sign} {plain(abs(100 * sensor.right_offset))} %"
        entries.append(("Right picture", value, "", "brightness over the left one's; offset of full scale"))
    return entries


def _electrons(sensor: Sensor) -> list[Entry]:
    """What becomes of the light in the pixels."""
    entries: list[Entry] = []
    if sensor.full_well_e:
        entries.append(
            ("Full well", plain(sensor.full_well_e), "e⁻", "electrons that fill a pixel at gain 1")
        )
        entries.append(("Read noise", plain(sensor.read_noise_e), "e⁻", "beside the photons' own shot noise"))
    for label, size, unit, meaning in (
        (
            "Pixels' gains",
            sensor.prnu_pct,
            "%",
            "scatter from pixel to pixel, the same in every frame (PRNU)",
        ),
        ("Pixels' dark levels", sensor.dsnu_e, "e⁻", "scatter from pixel to pixel (DSNU)"),
        ("Black level", sensor.black_level, "grey of 255", "a picture's level in the dark"),
    ):
        if size:
            entries.append((label, plain(size), unit, meaning))
    if sensor.gain != 1:
        entries.append(("Gain", plain(sensor.gain), "×", "so many times fewer electrons are full scale"))
    return entries
