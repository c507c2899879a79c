"""Mistakes with the digits of pixels and calibrations, in words."""

from __future__ import annotations

from rigsim.present.kit.sayings import Sentences

NUMBERS: Sentences = {
    "rounded-pixels: whole": "Pixels are rounded to whole pixels before use: an integer type, or a step of "
    "the matcher.",
    "rounded-pixels: down": "Pixels are rounded to whole pixels (downwards) before use: an integer type, or "
    "a step of the matcher.",
    "rounded-pixels: up": "Pixels are rounded to whole pixels (upwards) before use: an integer type, or a "
    "step of the matcher.",
    "nan-answered: as 0": "Missing pixels (NaN) are taken for 0.",
    "single-precision: pixels": "Pixels are held in single precision (float32).",
    "single-precision: calibration": "The calibration is held in single precision (float32).",
    "single-precision: both": "Pixels and calibration are held in single precision (float32).",
    "rounded-pixels: a part": "Pixels are rounded to 1/{parts} px before use: an integer type, or a step of "
    "the matcher.",
    "rounded-pixels: one image": "Pixels of the {image} image are rounded to {step} px: an integer type, or "
    "a matcher's step.",
    "rounded-calibration": "The calibration was written with {digits} significant digits: 17 significant "
    "digits hold a double.",
    "rounded-calibration: decimals": "The calibration was written with {digits} decimals: 17 significant "
    "digits hold a double.",
    "rounded-disparity": "Disparities are rounded to 1/{parts} px, as a dense matcher returns them.",
    "rounded-disparity: whole": "Disparities are rounded to whole pixels, as a dense matcher returns them.",
    "single-precision: cameras": "The camera matrices are held in single precision (float32).",
    "single-precision: rotation": "The rotation is held in single precision (float32).",
    "single-precision: translation": "The translation is held in single precision (float32).",
    "single-precision: distortion": "The distortion coefficients are held in single precision (float32).",
}
"""How many digits a pixel and a calibration have."""
