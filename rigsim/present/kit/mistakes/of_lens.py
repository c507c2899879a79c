"""Mistakes with pixels, principal points, focal lengths and number formats, in words."""

from __future__ import annotations

from rigsim.present.kit.sayings import Sentences

LENS: Sentences = {
    "image-centre-for-principal-point": "The middle of the picture, (W-1)/2, stands for the principal point "
    "in {side}: the calibrated cx, cy are not used.",
    "image-centre-for-principal-point: W/2": "W/2 stands for the principal point in {side}: half a pixel too "
    "much, and the calibrated cx, cy are not used.",
    "principal-point-missing": "The principal point is not subtracted in {side}: pixels count from the "
    "corner.",
    "intrinsics-missing": "Pixels are taken for rays in {side}: K is not undone.",
    "flipped-v": "v is counted from the bottom: rows are flipped (H - 1 - v) in both images.",
    "flipped-v: axis": "y has the wrong sign: cy - v stands for v - cy, an axis that points up.",
    "flipped-u": "u is counted from the right: columns are flipped in both images.",
    "flipped-u: axis": "x has the wrong sign: cx - u stands for u - cx.",
    "row-column-exchanged": "u and v are exchanged: (row, column) is given where (column, row) is meant.",
    "row-column-exchanged: cx and cy": "cx and cy are exchanged.",
    "fx-fy-exchanged": "fx and fy are exchanged in {side}.",
    "fx-for-fy": "fx is used for fy in {side}: pixels are taken to be square.",
    "normalised-twice": "Normalised rays are given where pixels are meant: K^-1 was applied already, and "
    "K[R|t] projects to pixels; use [R|t] with rays, K[R|t] with pixels.",
    "fy-for-fx": "fy is used for fx in {side}.",
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
    "half-pixel": "The principal point is {px:g} px {way} than it is in {side}: W/2 stands for (W-1)/2, or "
    "pixels are counted from the image's corner.",
    "half-pixel: along an axis": "The principal point is {px:g} px {way} than it is in {side}: W/2 stands "
    "for (W-1)/2, or pixels are counted from the image's corner (along {axis} alone).",
    "pixels-from-one": "The principal point is {px:g} px {way} than it is in {side}: pixels are counted from "
    "1.",
    "pixels-from-one: along an axis": "The principal point is {px:g} px {way} than it is in {side}: pixels "
    "are counted from 1 (along {axis} alone).",
    "doffs-ignored": "The principal points' difference (doffs = cx_right - cx_left) is ignored: Z = f B / (d "
    "+ doffs).",
    "doffs-sign": "The principal points' difference (doffs = cx_right - cx_left) is subtracted where it must "
    "be added.",
    "doffs-twice": "The principal points' difference (doffs = cx_right - cx_left) is added twice.",
    "flipped-v: one image": "v is counted from the bottom in the {image} image alone.",
    "image-scale": "Pixels are scaled by {scale:g} against the calibration, as after resizing the pictures.",
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
"""Where a pixel is, and how many digits it has."""
