"""Mistakes with pixels, principal points and focal lengths, in words."""

from __future__ import annotations

from rigsim.present.kit.sayings import Sentences

PIXELS: Sentences = {
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
}
"""Where a pixel is."""
