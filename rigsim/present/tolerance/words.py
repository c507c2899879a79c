"""What a tolerance study says, in sentences."""

from __future__ import annotations

import math

import numpy as np

from rigsim.digits import short
from rigsim.present.kit.format import sampled_percent
from rigsim.present.kit.motion import moves
from rigsim.rig.arrays import Mask
from rigsim.rig.motion import Motion
from rigsim.study.tolerance.inputs import QUANTITIES, UNITS
from rigsim.study.tolerance.joint.cause import CALIBRATION
from rigsim.study.tolerance.run import ToleranceResult


def interactions_sentence(result: ToleranceResult) -> str:
    """Whether quantities act on one another, by the Sobol indices of the depth error; empty without any."""
    found, at = result.interactions, f"{result.required.depth_m:g} m"
    if found is None:
        if np.isfinite(result.judged.built.build_mm).all():
            return ""
        return (
            f"No Sobol indices at {at}: some rigs have no depth at all there, so its error has no variance;"
            " judge the rigs at a nearer distance."
        )
    error = found.error
    if not error.noticed:
        return (
            "Each quantity acts on its own: no interaction beyond 1 % of the variance and the sampling error."
        )
    worst = sorted(error.noticed, key=lambda place: -error.together[place])
    named = ", ".join(
        f"{_name(found.keys[place])} ({100 * error.total[place]:.1f} % with others,"
        f" {100 * error.first[place]:.1f} % alone)"
        for place in worst[:3]
    )
    return f"Quantities act on one another: {named}. First-order shares leave that out."


def _name(key: str) -> str:
    return QUANTITIES.get(key, key)


def hopeless_sentence(result: ToleranceResult) -> str:
    """That noise alone exceeds what is required, where it does; empty otherwise."""
    required = result.required
    needed = np.array([item.needed_equal_share for item in result.sensitivities])
    if not result.noise_px or (needed[np.isfinite(needed)] != 0).any():
        return ""
    what = "the 95th percentile of the errors" if required.p95 else "the error"
    return (
        f"Pixel noise alone takes {what} at {required.depth_m:g} m to {short(result.judged.noise_mm)} mm, "
        f"{short(1e3 * required.error_m)} mm are asked for: no build meets that, and the table says none "
        "where a tolerance is needed. Less noise, a longer baseline or a longer lens would help."
    )


def yield_sentence(result: ToleranceResult) -> str:
    """How many rigs are good with their pixel noise, and by their build alone."""
    judged = result.judged
    with_noise = f", with pixel noise of {result.noise_px:g} px" if result.noise_px else ""
    says = f"{_percent(judged.built.good)} of the rigs meet the requirement as built"
    if judged.recalibrated is not None:
        says += f", {_percent(judged.recalibrated.good)} after recalibration"
    says += f"{with_noise}."
    if result.noise_px:
        says += f" By their build alone {_percent(judged.built.good_alone)}"
        if judged.recalibrated is not None:
            says += f" and {_percent(judged.recalibrated.good_alone)}"
        says += f" would; noise alone causes {short(judged.noise_mm)} mm of error."
    return says


def _percent(good: Mask) -> str:
    return f"{sampled_percent(int(good.sum()), good.size)} %"


def informed_sentence(result: ToleranceResult) -> str:
    """What a recalibration that knows the tolerances would leave; empty without a recalibration."""
    judged = result.judged
    if judged.recalibrated is None or judged.informed is None:
        return ""
    plain, informed = (float(np.median(rigs.build_mm)) for rigs in (judged.recalibrated, judged.informed))
    return (
        f"This recalibration does not use the tolerances: it leaves a build error of {short(plain)} mm in the"
        f" median rig. One that uses them would leave {short(informed)} mm, and"
        f" {_percent(judged.informed.good)} of the rigs would be good."
    )


def rows_sentence(result: ToleranceResult) -> str:
    """How far a point's right row is off its left one, and how many rigs keep what is asked of that."""
    worst, limit_px = result.rows_worst, result.required.row_px
    if not np.isfinite(worst.built.row_px).all():
        return "Rows: those of some rigs do not correspond at all, as they look along their baseline."
    says = (
        "Rows: rectified with the calibration that they were meant to have, pairs are"
        f" {worst.built.row_rms_px:.3g} px off (root mean square over rigs and image at {worst.depth_m:g} m,"
        " where it is most)"
    )
    if not result.rig.is_rectified:
        says += f", {worst.row_as_seen_px:.3g} px without rectification"
    if worst.recalibrated is not None:
        says += f", and {worst.recalibrated.row_rms_px:.2g} px after recalibration"
    if limit_px is None:
        return f"{says}."
    found = (result.rows_px("built"), result.rows_px("recalibrated"))
    kept = [_percent(rows <= limit_px) for rows in found if rows is not None]
    after = f", {kept[1]} after recalibration" if len(kept) > 1 else ""
    return (
        f"{says}.{_breaks_rows_first(result)} {kept[0]} of the rigs keep {limit_px:g} px at every distance"
        f" as built{after}; a good rig keeps it as well as its depth error."
    )


def _breaks_rows_first(result: ToleranceResult) -> str:
    """Which quantity takes the rows over their bound with the least part of its tolerance, and which next."""
    found = [item for item in result.sensitivities if 0 < item.needed_for_rows < math.inf]
    found.sort(key=lambda item: item.needed_for_rows / item.tolerance)
    if not found:
        return ""
    named = [
        f"{_name(item.key)} (over {'±' * result.tolerances.is_bound(item.key)}"
        f"{f'{short(item.needed_for_rows)} {UNITS[item.key]}'.rstrip()}, "
        + ("which it leaves" if item.key == CALIBRATION else f"the class has {short(item.tolerance)}")
        + ")"
        for item in found[:2]
    ]
    return f" What breaks them first, alone, is {', then '.join(named)}."


def calibration_sentence(result: ToleranceResult) -> str:
    """What the calibration leaves of a depth, and what it knows nothing of; empty without one."""
    calibration = result.tolerances.calibration
    if calibration is None:
        return ""
    in_camera, to_boards = (1e3 * value for value in result.calibration_axis_m)
    says = (
        f"{calibration.name}: on the left optical axis at {result.required.depth_m:g} m the calibration"
        f" leaves a standard deviation of {short(in_camera)} mm as the left camera counts depth, which rigs"
        f" are judged by here, and of {short(to_boards)} mm against its boards. A calibrated rig keeps its"
        " error, however often it measures."
    )
    if result.tolerances.temperature_k:
        return says
    return f"{says} It knows nothing of what changes later: --tolerance temperature=5K adds a warmer bar."


def recalibration_sentence(result: ToleranceResult) -> str:
    """What the recalibration has to work with, and that reality is worse; empty without one."""
    session = result.recalibration
    if session is None or not result.known_lengths_m:
        return ""
    near_m, middle_m, far_m, along_m = result.known_lengths_m
    return (
        f"Recalibration at its best: {session.features} features in {session.pictures} pictures,"
        f" {session.noise_px:g} px each, averaged to {session.averaged_px:.2g} px; lengths of"
        f" {near_m:.3g}, {middle_m:.3g} and {far_m:.3g} m across and {along_m:.3g} m along the depth known to"
        f" {session.length_std_mm:g} mm; no false match, no lens error but the"
        " tolerances' own."
    )


def motion_sentence(result: ToleranceResult) -> str:
    """What a time offset acts on; empty without one."""
    held = result.tolerances
    if not held.time_offset_ms:
        return ""
    motion = Motion(
        held.time_offset_ms / 1e3,
        held.speed_m_s,
        held.forward_speed_m_s,
        math.radians(held.turn_rate_deg_s),
        held.moving,
    )
    said = ", and ".join(moves(motion)) or "nothing moves"
    return f"During a time offset {said}."
