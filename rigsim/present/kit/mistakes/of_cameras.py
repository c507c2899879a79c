"""Mistakes with images, cameras and their rectification, in words."""

from __future__ import annotations

from rigsim.present.kit.sayings import Sentences

CAMERAS: Sentences = {
    "swapped-images": "Answers are what swapped images give: uv_left and uv_right are exchanged somewhere.",
    "swapped-cameras: both lenses": "Answers are what exchanged cameras give: left and right calibration are "
    "mixed up with the images (both lenses).",
    "swapped-cameras: lenses and pose": "Answers are what exchanged cameras give: left and right calibration "
    "are mixed up with the images (lenses and pose).",
    "swapped-cameras: pose": "Answers are what exchanged cameras give: left and right calibration are mixed "
    "up with the images (pose).",
    "swapped-intrinsics": "The left lens is used for the right image and the right one for the left: the two "
    "K are exchanged.",
    "left-intrinsics-for-both: K alone": "The left camera's K is used for the right image as well.",
    "left-intrinsics-for-both": "The left camera's K and distortion are used for the right image as well.",
    "right-intrinsics-for-both: K alone": "The right camera's K is used for the left image as well.",
    "right-intrinsics-for-both": "The right camera's K and distortion are used for the left image as well.",
    "swapped-intrinsics: K alone": "The two K are exchanged, the distortions are not.",
    "treated-as-rectified": "Z = f B / d is used for rigs that are not rectified: rotate and rectify first, "
    "or solve for two rays.",
    "treated-as-rectified: no doffs": "Z = f B / d is used for rigs that are not rectified, and without "
    "doffs: rotate and rectify first, or solve for two rays.",
    "rectified-matrices": "P1 and P2 of a rectification (stereoRectify) are used with pixels that are not "
    "rectified: undistort and rectify them first, or use K[R|t].",
    "rectified-matrices: rotated back": "P1 and P2 of a rectification (stereoRectify) are used with pixels "
    "that are not rectified: undistort and rectify them first, or use K[R|t]. The points were rotated back "
    "by R1.",
    "in-both": "both images",
    "in-left": "the left image alone",
    "in-right": "the right image alone",
}
"""Which camera is which, and which images they are."""
