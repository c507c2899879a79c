"""What answers show without a mistake being made again, in words."""

from __future__ import annotations

from collections.abc import Sequence

from rigsim.present.kit.sayings import Sentences


def numbers(values: Sequence[float]) -> str:
    """Numbers to three digits."""
    return ", ".join(f"{value:.3g}" for value in values)


SYMPTOMS: Sentences = {
    "times-out": "It does not come back in time.",
    "wrong-type": "{error}.",
    "raises": "{error}.",
    "broken": "{error}.",
    "transposed-answer": "The answer is (3, N), a column a point: return its transpose.",
    "homogeneous-answer": "The answer has four columns: divide by the last and drop it.",
    "homogeneous-answer: transposed": "The answer is (4, N), homogeneous as triangulatePoints gives it: "
    "divide by the last row and transpose.",
    "depth-missing": "The answer has two columns: the depth is missing.",
    "depth-alone": "The answer has one number a point: x and y are missing.",
    "rows-dropped": "Rows without an answer are left out: they must be NaN.",
    "rows-dropped: counted": "{rows} rows came back for {of}: each needs its own, NaN if need be.",
    "extra-dimension": "The answer has shape {shape}: it has an axis too many.",
    "wrong-shape": "The answer has shape {shape}: must be ({rows}, 3).",
    "inefficient": "Right, but with noise errors are {times:.3g} times what they need be: part of what the "
    "pixels say is wasted, as one image's rows or one of two rays.",
    "inefficient: with noise": "Exact pixels are answered exactly, but with noise errors are {times:.3g} "
    "times what they must be: part of what the pixels say is wasted, as one image's rows or one of two rays, "
    "or noise is added.",
    "too-good": "With noise, errors are {times:.3g} times what they must be at least: rows are smoothed or "
    "averaged, or the truth leaks in.",
    "biased": "With noise, answers lean by {sigmas:.3g} standard deviations to one side.",
    "rows-missing: with noise": "{rows:.0f} rows with an answer come back as NaN once there is noise.",
    "nothing-found": "Not one point comes back: every row is NaN, as if all lay behind a camera.",
    "zeros": "Every answer is (0, 0, 0).",
    "disparity-clamped: nowhere": "Pixels that meet nowhere get the depth {depth_m:.6g} m: disparities are "
    "kept above a least one.",
    "disparity-clamped": "No {what} exceeds {limit_m:.6g} m in '{case}' (a disparity of {disparity_px:.3g} "
    "px): small disparities are clamped, or depths are capped.",
    "depth-clamped-near": "No {what} is less than {limit_m:.6g} m in '{case}' (a disparity of "
    "{disparity_px:.3g} px): large disparities are clamped.",
    "nan-spreads": "A NaN pixel in one row makes other rows NaN: a sum or a fit over all rows.",
    "nan-answered": "Rows with a NaN pixel come back as points: they must be NaN.",
    "nan-answered: by zeros": "Rows without an answer come back as (0, 0, 0): they must be NaN.",
    "points-made-up": "Pixels that belong to no point come back as points in '{case}': look at what a "
    "disparity <= 0, or a point behind a camera, becomes.",
    "rows-repeated": "Rows hold other rows' points, some of them more than once.",
    "rows-shifted": "Every row holds the point of the row {rows} after it.",
    "rows-shifted: before": "Every row holds the point of the row {rows} before it.",
    "rows-reordered": "The right points come back in another order: row i must answer row i.",
    "rows-reordered: by depth": "The right points come back in another order sorted by depth: row i must "
    "answer row i.",
    "rows-reordered: reverse": "The right points come back in reverse order.",
    "rounded-answers": "Answers have {digits} significant digits: write more (17 hold a double).",
    "rounded-answers: decimals": "Answers have {digits} decimals, steps of {step_m:g} m: write more digits "
    "(17 hold a double).",
    "rounded-answers: of depths": "Depths have {digits} decimals, steps of {step_m:g} m: write more digits "
    "(17 hold a double).",
    "single-precision: answers": "What comes back are float32 numbers: the work is done, or stored, with too "
    "few digits; use float64 from the pixels on.",
    "half-precision": "What comes back are float16 numbers: the work is done, or stored, with too few "
    "digits; use float64 from the pixels on.",
    "constant-answer": lambda answer_m: f"All rows have the same answer ({numbers(answer_m)} m).",
}
"""Errors, digits, limits and order."""

_FOUND = {"missing": "NaN", "zero": "(0, 0, 0)", "wrong": "wrong"}
_WHERE = {
    "far-points": "beyond {at:.4g} m",
    "near-points": "nearer than {at:.4g} m",
    "large-disparities": "with a disparity above {at:.3g} px",
    "small-disparities": "with a disparity below {at:.3g} px",
    "late-rows": "after row {at:.0f}",
    "early-rows": "before row {at:.0f}",
    "outer-points": "farther than {at:.3g} focal lengths from the principal point",
    "inner-points": "nearer than {at:.3g} focal lengths to the principal point",
    "right-half": "right of x = {at:.3g} m",
    "left-half": "left of x = {at:.3g} m",
    "lower-half": "below y = {at:.3g} m",
    "upper-half": "above y = {at:.3g} m",
}
ROWS: Sentences = {
    **{
        f"{place}-{kind}": f"Points {where} come back {found}, the others are right ('{{case}}')."
        for place, where in _WHERE.items()
        for kind, found in _FOUND.items()
    },
    **{
        f"{place}-{kind}: in all cases": f"Points {_WHERE[place]} come back as {_FOUND[kind]}."
        for place in ("far-points", "near-points")
        for kind in ("missing", "zero")
    },
    **{
        f"rows-{kind}": f"{{rows}} of {{of}} rows come back {found} in '{{case}}', the others are right."
        for kind, found in _FOUND.items()
    },
}
"""Which rows are missing, zero or wrong, where others are right."""
