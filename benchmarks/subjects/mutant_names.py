"""What a verification may name for each mutant, judged before any was tried.

A name, as `rigsim.study.verify.result.Diagnosis.mistake` has it, and after a space words that its
sentence must hold. None where no name of those that there were would lead to the mistake. `centre-exchanged`
and `own-noise` were judged by the sentences that came back, `file-four-digits` by a name that came later.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from benchmarks.subjects.mutant import Mutant
from rigsim.present.verify.words import says
from rigsim.study.verify.result import Diagnosis

NAMES: Mapping[str, tuple[str, ...]] = {
    "swapped-pixels": ("swapped-images",),
    "corner-origin": ("half-pixel", "pixel-offset 0.5"),
    "middle-at-half-width": ("half-pixel", "pixel-offset 0.5"),
    "half-pixel-right": ("half-pixel right", "pixel-offset 0.5"),
    "rows-from-below": ("flipped-v",),
    "rows-for-columns": ("row-column-exchanged",),
    "whole-pixels": ("rounded-pixels whole",),
    "sixteenths": (
        "rounded-pixels 16",
        "rounded-pixels 0.0625",
        "rounded-disparity 16",
        "rounded-disparity 0.0625",
    ),
    "cameras-exchanged": ("swapped-intrinsics",),
    "one-camera-matrix": ("left-intrinsics-for-both",),
    "no-doffs": ("doffs-ignored",),
    "centred-cameras": ("image-centre-for-principal-point",),
    "square-pixels": ("fx-for-fy",),
    "centre-exchanged": ("row-column-exchanged cx and cy are exchanged",),
    "long-focal": ("focal-scale",),
    "half-resolution": ("image-scale",),
    "transposed-rotation": ("transposed-rotation",),
    "inverse-pose": ("inverse-pose",),
    "negated-baseline": ("baseline-sign",),
    "translation-as-centre": ("centre-for-translation",),
    "no-rotation": ("rotation-ignored",),
    "radians-as-degrees": ("degrees-for-radians",),
    "rotvec-as-euler": ("euler-order",),
    "sideways-baseline": ("baseline-along-x-only",),
    "never-rectified": ("treated-as-rectified",),
    "no-undistortion": ("distortion-ignored both",),
    "distorted-again": ("distortion-inverted",),
    "undistorted-twice": ("distortion-twice",),
    "right-lens-forgotten": ("distortion-ignored right",),
    "tangential-exchanged": ("distortion-p1-p2",),
    "k3-third": ("distortion-order",),
    "impatient-newton": ("undistortion-unfinished",),
    "right-frame": ("right-frame",),
    "rig-frame": ("rig-frame",),
    "rectified-frame": ("rectified-frame",),
    "ros-axes": ("ros-axes",),
    "opengl-axes": ("opengl-axes",),
    "y-up": ("flipped-y",),
    "millimetres": ("millimetres",),
    "metres-for-millimetres": ("metres-per-thousand",),
    "ray-length": ("ray-length-for-depth",),
    "depth-along-ray": ("ray-length-for-depth",),
    "sixteen-bits": ("rounded-answers",),
    "single-precision": ("single-precision",),
    "half-precision": ("half-precision", "rounded-answers"),
    "clamped-disparity": ("disparity-clamped", "small-disparities-wrong"),
    "absolute-disparity": ("behind-in-front", "points-made-up"),
    "zero-beyond-20-m": ("far-points-zero", "small-disparities-zero"),
    "zero-for-nan": ("nan-answered", "points-made-up"),
    "prior": ("shrunk-depth",),
    "sorted-rows": ("rows-reordered",),
    "dropped-rows": ("rows-dropped",),
    "first-row-everywhere": ("constant-answer",),
    "next-rows-pixel": (),
    "eager-filter": ("rows-missing", "far-points-missing"),
    "stale": ("stale-rig first",),
    "own-noise": ("inefficient noise", "random-errors random numbers"),
    "wasteful": ("inefficient",),
    "file-baseline-negated": ("baseline-sign",),
    "file-rotation-by-columns": ("transposed-rotation",),
    "file-pose-inverted": ("inverse-pose",),
    "file-baseline-in-mm": ("millimetres",),
    "file-cameras-exchanged": ("swapped-intrinsics",),
    "file-distortion-dropped": ("distortion-ignored both",),
    "file-k3-dropped": ("distortion-k3",),
    "file-k3-third": ("distortion-order",),
    "file-corner-origin": ("half-pixel", "pixel-offset 0.5"),
    "file-four-digits": ("rounded-calibration",),
    "file-projections-of-raw-pixels": ("treated-as-rectified", "rectified-matrices"),
    # those on condition, judged before the diagnosis knew of conditions
    "transposed-beyond-40": ("transposed-rotation",),
    "toe-out-as-toe-in": ("transposed-rotation", "rotation-angle"),
    "always-to-the-right": ("baseline-sign",),
    "small-angle-rotation": ("small-angle",),
    "small-turns-ignored": ("rotation-ignored",),
    "small-z-dropped": ("baseline-component-lost z",),
    "folded-roll": ("rotation-angle", "rotation-folded"),
    "long-baseline-in-mm": ("metres-per-thousand",),
    "short-baseline-in-m": ("millimetres",),
    "like-lenses-taken-as-equal": ("left-intrinsics-for-both",),
    "portrait-exchanged": ("fx-fy-exchanged",),
    "barrel-alone": ("distortion-ignored",),
    "normalised-with-k": ("normalised-twice",),
    "rectified-matrices-raw-pixels": ("rectified-matrices",),
    "single-k": ("single-precision camera matrices",),
    "single-r": ("single-precision rotation",),
    "mirrored-u": ("flipped-u",),
    "thousandths": ("rounded-pixels 1/1000", "rounded-pixels 0.001"),
    "last-piece-empty": ("late-rows-zero",),
    "nan-on-the-axis": ("inner-points-missing", "axis-points-missing"),
    "one-row-squeezed": ("wrong-shape", "single-row"),
    "kept-by-size": ("stale-rig",),
    "nothing-beyond-2-km": ("far-points-missing",),
    "nothing-within-30-mm": ("near-points-missing",),
    "wide-rays-dropped": ("outer-points-missing",),
    "y-sign-lost-on-the-left": ("left-half-wrong",),
    "patient-but-not-enough": ("undistortion-unfinished",),
}


def named_right(mutant: Mutant, named: Sequence[Diagnosis]) -> bool:
    """Whether the diagnosis that comes first says what is wrong."""
    if not named:
        return False
    return any(
        named[0].mistake == name and word in says(named[0])
        for name, _, word in (allowed.partition(" ") for allowed in NAMES[mutant.name])
    )
