"""Mistakes with lens distortion, in words."""

from __future__ import annotations

from rigsim.present.kit.sayings import Sentences

DISTORTION: Sentences = {
    "distortion-ignored": "Lens distortion is ignored in {side}.",
    "distortion-twice": "Distortion is undone twice in {side}: pixels were undistorted before.",
    "distortion-inverted": "Distortion is applied where it must be undone, in {side}: the model maps ideal "
    "to seen.",
    "distortion-sign": "The distortion coefficients have the wrong sign in {side}.",
    "distortion-swapped": "The two lenses' distortion coefficients are exchanged.",
    "distortion-swapped: left for both": "The left lens's distortion is used for both.",
    "distortion-swapped: right for both": "The right lens's distortion is used for both.",
    "distortion-p1-p2": "p1 and p2 are exchanged in {side}.",
    "distortion-tangential": "Tangential distortion (p1, p2) is ignored in {side}.",
    "distortion-k3": "k3 is ignored in {side}.",
    "distortion-k1-only": "Of the distortion only k1 is used in {side}.",
    "distortion-order": "k1, k2, p1, p2, k3 are read in another order in {side}: k3 comes last, after p1 and "
    "p2.",
    "distortion-k1-k2": "k1 and k2 are exchanged in {side}.",
    "distortion-k2": "k2 is ignored in {side}.",
    "distortion-tangential: sign": "Tangential distortion (p1, p2) has the wrong sign in {side}.",
    "undistortion-unfinished: opposite signs": "Undistortion in {side} is the model with opposite signs: "
    "right to first order only, iterate instead.",
    "undistortion-unfinished: fixed point": "Undistortion stops too early, after {steps} fixed-point steps: "
    "iterate until it stands still (OpenCV's default is 5).",
    "undistortion-unfinished: subtraction": "Undistortion stops too early, after {steps} steps of "
    "subtraction: iterate until it stands still.",
    "undistortion-unfinished: Newton": "Undistortion stops too early, after {steps} Newton steps: iterate "
    "until it stands still.",
}
"""How a lens bends."""
