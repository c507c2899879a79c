"""Mistakes with a number in them, in words."""

from __future__ import annotations

from rigsim.present.kit.sayings import Sentences

_ALL = "All three coordinates are {size}: "

FITTED: Sentences = {
    "homogeneous-answer: undivided": "Homogeneous coordinates are not divided by the fourth.",
    "times-too-large": "{times:.6g} times too large",
    "of-what-they-must-be": "{times:.6g} of what they must be",
    "depth-scale": "z alone is {times:.6g} times what it must be; x and y are right.",
    "xy-scale": "x and y are {times:.6g} times what they must be; z is right.",
    "focal-scale": "Both focal lengths are {times:.6g} times what they must be: another resolution, or px "
    "and mm.",
    "baseline-scale": "The baseline is {times:.6g} times what it must be.",
    "shifted-points": "All points are shifted by the same ({shift_mm[0]:.4g}, {shift_mm[1]:.4g}, "
    "{shift_mm[2]:.4g}) mm.",
    "pixel-offset": "Answers fit pixels that are off by ({off_px[0]:+.3g}, {off_px[1]:+.3g}) px on the left "
    "and ({off_px[2]:+.3g}, {off_px[3]:+.3g}) px on the right, a disparity {disparity_px:+.3g} px too large, "
    "in every case.",
    "scale-by-rig": "Answers are {least:.4g} to {most:.4g} times too large, a factor for each rig: look for "
    "what scales with the rig (baseline, focal length, image size).",
    "other-frame": "Points have the right shape in another frame, turned by {turn_deg:.3g} deg and "
    "{away_mm:.4g} mm away: R or t is used where it is not meant, or is missing.",
    "stale-rig: first": "The rig of the first call is used: something computed from it is kept from call to "
    "call.",
    "stale-rig": "The rig of the call before is used: something computed from it is kept from call to call.",
    "stale-rig: kept": "The rig of an earlier call is used ('{case}' with that of '{of}'): something "
    "computed from it is kept under a key that other rigs share.",
    "shrunk-depth": "Points lie on their left rays, but 1/z is {slope:.3g} times the true one and a "
    "constant: depths are drawn towards one, as by a prior, or the disparity has an offset.",
    "stretched-depth": "Points lie on their left rays, but 1/z is {slope:.3g} times the true one and a "
    "constant: depths are drawn towards one, as by a prior, or the disparity has an offset.",
    "millimetres": _ALL + "millimetres come back for metres (or t is in millimetres).",
    "metres-per-thousand": _ALL + "metres are divided by 1000 once too often.",
    "centimetres": _ALL + "centimetres come back for metres.",
    "metres-per-hundred": _ALL + "metres are divided by 100 once too often.",
    "inches": _ALL + "inches come back for metres.",
    "feet": _ALL + "feet come back for metres.",
    "inches: taken for": _ALL + "metres are taken for inches.",
    "factor-two": _ALL + "twice the baseline, or half the disparity.",
    "factor-two: half": _ALL + "half the baseline, or twice the disparity.",
    "scale": _ALL + "a constant factor on t, on f or on the answer.",
}
"""By how much the answers are off."""
