"""What was concluded of a measured pair, in sentences with numbers."""

from __future__ import annotations

import math
from collections.abc import Callable

from rigsim.present.kit.format import length, plain, to_error, with_error
from rigsim.rig.stereo import StereoRig
from rigsim.study.measure.result import Finding, RowFit
from rigsim.study.measure.rows import down, shift_words

_ROWS = {"agrees": "the rows fit", "flagged": "see the warning", "untold": "not enough to tell"}
_TRUST = "Do not trust depths and predicted accuracies: calibrate or rectify again."
_MISREAD = {
    "sign": "looks like u_right - u_left: change its sign",
    "doffs": "looks like a disparity with doffs added: subtract it",
    "metres": "looks like a depth in metres",
    "millimetres": "looks like a depth in millimetres",
    "other": "belongs to other pictures, or is no disparity u_left - u_right",
}


def sentence(finding: Finding, rig: StereoRig) -> str:
    """A finding in a sentence or two, with numbers."""
    if finding.key == "wrong_truth":
        return (
            f"{finding.numbers['outlier_pct']:.0f} % of the {finding.of} are more than 3 px off the truth: "
            f"it {_MISREAD[finding.form]}."
        )
    return _SAID[finding.key, finding.form](finding, rig)


def rows_in_short(finding: Finding) -> str:
    """A few words for a verdict on rows."""
    return _ROWS[finding.kind]


def _claimed(rig: StereoRig) -> str:
    return "rectified as the rig says" if rig.is_rectified else "as the rig says"


def _other_rows(finding: Finding, rig: StereoRig) -> str:
    shift = shift_words(finding.numbers["shift_px"], rig)
    return f"The pair is not {_claimed(rig)}: it matches on other rows. {shift} {_TRUST}"


def _off_lines(finding: Finding, rig: StereoRig) -> str:
    rows = _rows(finding)
    sign = "+" if rows.shift_px > 0 else ""
    return (
        f"The pair is not {_claimed(rig)}: matches lie {finding.numbers['epipolar_rms_px']:.2f} px (RMS) off "
        f"their epipolar lines, and {sign}{with_error(rows.shift_px, rows.shift_se_px)} px in the mean. "
        f"{_fault(rows, rig)}{_cause(rows, rig, finding.numbers['depth_m'])} {_TRUST}"
    )


def _rows(finding: Finding) -> RowFit:
    assert finding.rows is not None
    return finding.rows


def _fault(rows: RowFit, rig: StereoRig) -> str:
    """What kind of error the rows show."""
    said = []
    if rows.is_shifted:
        said.append(f"{abs(rows.shift_px):.2f} px too {down(rows.shift_px)}")
    if rows.is_tilted:
        turn = "clockwise" if rows.turn > 0 else "counter-clockwise"
        said.append(f"turned {turn} by about {math.degrees(abs(math.atan(rows.turn))):.2g} deg")
    if rows.is_scaled:
        said.append(
            f"{'larger' if rows.growth > 0 else 'smaller'} by about {plain(100 * abs(rows.growth), 2)} %"
        )
    if not said:
        return "They share no shift and no turn: wrong matches, or pictures not taken at the same moment."
    if rows.is_shifted and len(said) == 1:
        return shift_words(rows.shift_px, rig)
    return f"The right picture is {', '.join(said[:-1])}{' and ' if len(said) > 1 else ''}{said[-1]}."


def _cause(rows: RowFit, rig: StereoRig, depth_m: float) -> str:
    """What of the right camera would make such rows, and by how much: `rigsim.theory.rows`, on its axis."""
    said = []
    lens, focal_px = rig.right, rig.right.fy
    alone = not (rows.is_tilted or rows.is_scaled)
    # a turn and a scale are about the camera's axis, wherever the matches are
    shift_px = rows.shift_px if alone else rows.shift_at_px(lens.cx, lens.cy)
    if abs(shift_px) > rows.shift_limit_px:
        up, high = ("up", "higher") if shift_px > 0 else ("down", "lower")
        stands = f"stands {length(abs(shift_px) * depth_m / focal_px, 2)} {high}, at {length(depth_m)}"
        if alone:  # the rest is said before
            return f" A right camera that {stands}, makes such rows too." if math.isfinite(depth_m) else ""
        turn_deg = math.degrees(abs(shift_px) / focal_px)
        said.append(f"looks {up} by {turn_deg:.2g} deg more" + f" or {stands}" * math.isfinite(depth_m))
    if rows.is_tilted:
        way = "counter-clockwise" if rows.turn > 0 else "clockwise"
        said.append(f"is rolled {way} by {math.degrees(abs(math.atan(rows.turn))):.2g} deg")
    if rows.is_scaled:
        longer = "longer" if rows.growth > 0 else "shorter"
        said.append(f"has a focal length {abs(rows.growth) / (1 - rows.growth) * focal_px:.2g} px {longer}")
    return f" A right camera that {' and that '.join(said)} makes such rows." if said else ""


def _too_few_rows(finding: Finding, _: StereoRig) -> str:
    n, tried = (finding.numbers[name] for name in ("n", "n_tried"))
    return (
        f"It is not known whether the rows correspond: only {n:.0f} of {tried:.0f} {finding.of} tell, "
        "which may be chance."
    )


def _uncertain_rows(finding: Finding, _: StereoRig) -> str:
    rows = _rows(finding)
    return (
        f"It is not known whether the rows correspond: {rows.n} matches give the shift only to within "
        f"{3 * rows.shift_se_px:.2f} px."
    )


def _rows_fit(finding: Finding, _: StereoRig) -> str:
    rows = _rows(finding)
    return (
        f"The rows fit: the right picture is {with_error(abs(rows.shift_px), rows.shift_se_px)} px too "
        f"{down(rows.shift_px)}, which is not significant."
    )


def _squares(finding: Finding) -> str:
    found, true = (finding.numbers[name] for name in ("found_mm", "true_mm"))
    error = found * finding.numbers.get("off_se_pct", 0.0) / 100
    return (
        f"Squares measure {to_error(found, error) if error else f'{found:.4g}'} mm where {true:.4g} are true"
    )


def _squares_off(finding: Finding, _: StereoRig) -> str:
    off = finding.numbers["off_pct"]
    return (
        f"{_squares(finding)}: distances are {plain(abs(off), 2)} % too "
        f"{'large' if off > 0 else 'small'}. The "
        "baseline or the focal length is wrong by as much, or a picture is shifted along its rows by some "
        f"{finding.numbers['shift_px']:.2g} px."
    )


def _few(finding: Finding, _: StereoRig) -> str:
    n, tried, share = (finding.numbers[name] for name in ("n", "n_tried", "share_pct"))
    return (
        f"Only {n:.0f} of {tried:.0f} points ({share:.1f} %) found a match that can be trusted: is the "
        "pair rectified as the rig says, taken at the same moment, in focus, and of something with texture? "
        "The matches may be chance."
    )


def _dense_shift(finding: Finding, _: StereoRig) -> str:
    bias = finding.numbers["bias_px"]
    return (
        f"Half of the dense disparities are {_too(bias)} by {abs(bias):.2f} px or more, which matched "
        "patches are not: the matcher shifts, or takes a pixel's middle for its corner."
    )


def _shift(finding: Finding, _: StereoRig) -> str:
    bias = finding.numbers["bias_px"]
    hint = " Half a pixel is the difference between counting pixels from their middles and corners."
    return (
        f"Disparities of {finding.of} are {_too(bias)} by {abs(bias):.2f} px in the median: a picture is "
        "shifted along its rows, or the truth belongs to other pictures."
        + hint
        * (finding.form == "half-a-pixel")
    )


def _overconfident(finding: Finding, _: StereoRig) -> str:
    return (
        f"Only {finding.numbers['within_3_std_pct']:.0f} % of the {finding.of} lie within 3 of their "
        "predicted standard deviations of the truth: their predicted accuracy is too good to be true."
    )


def _too(bias: float) -> str:
    return "too large (too near)" if bias > 0 else "too small (too far)"


_SAID: dict[tuple[str, str], Callable[[Finding, StereoRig], str]] = {
    ("not_rectified", "other-rows"): _other_rows,
    ("not_rectified", "off-lines"): _off_lines,
    ("rows_untold", "too-few"): _too_few_rows,
    ("rows_untold", "too-uncertain"): _uncertain_rows,
    ("rows_fit", "fit"): _rows_fit,
    ("along_rows", "truth-off"): lambda *_: "Against the truth, disparities are off: see the warning.",
    ("along_rows", "truth-fits"): lambda *_: (
        "Against the truth, disparities are neither too large nor too small."
    ),
    ("along_rows", "open"): lambda *_: (
        "Rows do not show every error: a picture shifted along its rows, a wrong baseline or a wrong focal "
        "length leaves every match on its row but makes every depth wrong. Check with squares of a known "
        "side (--board with --square) or a true disparity (--truth)."
    ),
    ("along_rows", "no-board"): lambda *_: "No board was seen well enough to compare its squares.",
    ("along_rows", "squares-uncertain"): lambda finding, _: (
        f"{_squares(finding)}, +- {finding.numbers['off_se_pct']:.2g} %: too uncertain to tell."
    ),
    ("along_rows", "squares-fit"): lambda finding, _: (
        f"{_squares(finding)}, +- {finding.numbers['off_se_pct']:.2g} %: no shift along the rows, and the "
        "scale is right."
    ),
    ("scale", "squares-off"): _squares_off,
    ("no_patches", "corners-alone"): lambda finding, _: f"Only corners were measured. Patches: {finding.of}.",
    ("few_matches", "few"): _few,
    ("dense_not_judged", "not-rectified"): lambda *_: (
        "The rig is not rectified: dense disparities belong to the rectified pair, and the truth does not, "
        "so only matches are compared with it."
    ),
    ("dense_shift", "shifted"): _dense_shift,
    ("shift", "shifted"): _shift,
    ("shift", "half-a-pixel"): _shift,
    ("overconfident", "overconfident"): _overconfident,
}
