"""What each case of a verification shows, and where the bounds of its checks come from."""

from __future__ import annotations

from rigsim.present.kit.sayings import Sentences

ABOUT: Sentences = {
    "rectified": "Parallel cameras, equal lenses: Z = f B / d, in the left camera's frame.",
    "doffs": "Rectified, but the principal points differ: doffs must be added to every disparity.",
    "off-centre": "The principal point is not the middle of the image.",
    "non-square": "Pixels that are not square: fx and fy differ.",
    "near": "So near that the disparity is half the image.",
    "far": "So far that the disparity is a tenth of a pixel: single precision and clamps show here.",
    "verged": "Cameras that toe in by 20 deg: rows do not correspond, and Z = f B / d does not hold.",
    "rolled": "The right camera turned about all axes and off the x axis: R, its transpose and its inverse "
    "differ.",
    "vertical": "One camera below the other: the parallax lies along v.",
    "forward": "The second camera ahead of the first: parallax grows away from the epipole in the picture.",
    "unequal": "Two different cameras: each pixel belongs with its own K.",
    "distorted": "Lenses that distort, each its own way: pixels are as they were seen and must be "
    "undistorted once.",
    "pincushion": "Lenses that bend outwards: the signs of all terms are the other way round.",
    "toe-out": "Cameras that turn away from each other: infinity has a disparity below zero.",
    "convergent": "Cameras that look at one place from two sides, turned by more than 50 deg against each "
    "other.",
    "from the side": "The second camera looks in from the left, at right angles.",
    "left-handed": "The right camera stands on the left side: disparities are negative, depths are not.",
    "upside-down": "The right camera hangs upside down: its pixels run the other way.",
    "on its side": "The right camera stands on its side, its pictures are upright.",
    "portrait": "Upright pictures with pixels that are not square.",
    "diagonal": "One camera above the other and beside it: the parallax lies along both axes.",
    "backward": "The second camera behind the first.",
    "alike": "Two lenses of one kind, 2 % apart, and cameras turned by less than a degree.",
    "wide": "A field of view of 116 deg: rays up to 63 deg off the axis.",
    "close-up": "A rig of 2 mm that looks at 12 to 50 mm: what is small in metres is not small here.",
    "aerial": "Pictures from two places of an aircraft, 42 m apart.",
    "remote": "Points kilometres away, seen by a rig of 3 m through long lenses.",
    "random": "A rig drawn at random: lenses, size, rotation and direction of the baseline.",
    "your rig": "The rig that was given.",
    "noisy": "{geometry} With {noise_px:g} px of noise in every coordinate, errors must be of the size that "
    "it causes.",
    "sweep": "Points of a sweep.",
    "behind": "Lines of sight that meet behind the cameras: there is no point to be seen.",
    "identical images": "The left image twice: parallel lines of sight meet at infinity.",
    "swapped images": "Left image given as the right one: every disparity is negative, so nothing lies in "
    "front.",
    "missing pixels": "Every third right pixel is NaN: those rows must be NaN, and the others must not move.",
    "no pixels": "No pixels at all: the answer has shape (0, 3).",
    "one pixel pair": "A single row: the answer has shape (1, 3).",
    "on the axes": "Pixels on a principal point, or in its row or column: x, y or both are 0 there.",
    "many rows": "So many rows that a triangulator may take them in pieces; the last one counts like the "
    "first.",
    "surfaces": "Surfaces of the scene {scene}, where both cameras see them; {hidden} of {points} points are "
    "hidden from the right camera and left out.",
    "surfaces: noisy": "Surfaces of the scene {scene}, where both cameras see them, with {noise_px:g} px of "
    "noise in every coordinate: errors must be of the size that it causes.",
    "pictures": "Pixels that were found in the rendered pictures of {scene} ({method}), with the errors that "
    "lens, sensor and matcher give them.",
}
"""What each case shows: its geometry, or what is odd about it."""

_DUE = (
    "over what the errors of these very pixels become in a least-squares triangulation; "
    "more than {worst:g} times it, or less than its inverse, is not their doing."
)
WHY: Sentences = {
    "shape": "The answer has shape ({rows}, 3).",
    "nowhere": "Rows without a point in front of both cameras must be NaN, behind a camera or infinitely "
    "far, and NaN where a pixel is; these came back as points.",
    "answered": "Every row has an answer in front of both cameras.",
    "answered: noisy": "{expected:.2g} rows are expected to be pushed beyond infinity by noise alone; a "
    "Poisson quantile of a fifth more bounds them, as that number is of first order.",
    "exact": "Largest distance to the true point over {rows} rows; allowed is 1e-9 of the distance (of a "
    "metre when nearer) and what rounding a pixel to double precision costs.",
    "size": "Root mean square pixel error over what the noise must cause (the Cramer-Rao bound): less than "
    "its chi-squared interval over {rows} rows is too good to be true, more than {worst:g} times it a "
    "triangulator that wastes what the pixels say.",
    "depth": "Root mean square depth error over its bound; at most {worst:g} times a chi-squared quantile.",
    "unbiased": "Mean error of {rows} rows in standard deviations of one: a chi-squared quantile, and the "
    "second order of the noise.",
    "efficient": "The same as size, against the chi-squared quantile alone: only least squares passes.",
    "size: measured": "Root mean square pixel error of the points, " + _DUE,
    "depth: measured": "Root mean square depth error, " + _DUE,
}
"""Where the bounds of each check come from, and what its value means."""
