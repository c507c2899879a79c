"""The sentences of a planned calibration."""

from __future__ import annotations

import math

from rigsim.present.calibrate.witness_words import agreement_words as agreement_words
from rigsim.present.calibrate.witness_words import true_sentence as true_sentence
from rigsim.present.calibrate.words import board_words, pictures
from rigsim.present.calibrate.words import holding_words as holding_words
from rigsim.present.calibrate.words import parameter as parameter
from rigsim.present.kit.format import length, plain
from rigsim.study.calibrate.enough import NOTICED, chosen_depth, chosen_places, enough
from rigsim.study.calibrate.holding import holdings
from rigsim.study.calibrate.plan.odd import FEW
from rigsim.study.calibrate.plan.result import CalibrationPlan
from rigsim.theory.calibration.boards import BoardPoses

_SHOWN = (2, 3, 5, 8, 12, 20, 30, 50, 80, 120, 200)
_NOTED = 1.1
_WORSE = 1.2
_MOST_PAIRS = 4


def headline(plan: CalibrationPlan) -> str:
    """The answer in one sentence."""
    row, goal, needed = chosen_depth(plan), plan.asked.goal, plan.needed
    verb = "gives" if len(plan.poses) == 1 else "give"
    said = (
        f"{pictures(len(plan.poses))} of the {board_words(plan.asked.board)} {verb} {length(row.joint_m)} of"
        f" depth std at {plain(plan.asked.chosen_for_m)} m on the axis: {length(row.calibration_m)} by"
        f" calibration, {length(row.observation_m)} by pixel noise"
    )
    if goal is None:
        return f"{said}."
    wanted = f"{plain(goal.error_m * 1e3)} mm"
    if needed.count is None:
        least = enough(plan)
        more = "" if least is None else f", and more than {pictures(least)} hardly help"
        return f"{said}; no number of pictures gives {wanted}{more}."
    if needed.count > len(plan.poses):
        return f"{said}; it takes {needed.count} for {wanted}."
    if needed.count == len(plan.poses):
        return f"{said}; it takes all of them for {wanted}."
    return f"{said}; {needed.count} are enough for {wanted} there{_all_the_same(needed.count)}."


def _all_the_same(count: int) -> str:
    """What to take in practice of a number that would do."""
    return f", but take {FEW}, so that a bad picture shows" if count < FEW else ""


def sentences(plan: CalibrationPlan) -> list[str]:
    """What else there is to say, the most important first."""
    said = (hindrance_sentence, corner_sentence, enough_sentence, gain_sentence)
    return [sentence for sentence in (say(plan) for say in said) if sentence]


def hindrance_sentence(plan: CalibrationPlan) -> str:
    """What stands in the way of the goal, and the way out; empty where nothing does."""
    asked, needed = plan.asked, plan.needed
    if asked.goal is None or not needed.hindrance:
        return ""
    if needed.hindrance == "observation":
        alone = chosen_depth(plan).observation_m
        most = asked.noise_px * asked.goal.error_m / alone if alone > 0 else math.nan
        return (
            f"In the way: pixel noise of {plain(asked.noise_px)} px alone makes {length(alone)}. It takes"
            f" matches good to {plain(most, 2)} px (`--noise`), a longer baseline, or a longer focal length."
        )
    said = f"In the way: {_hindrance(plan, needed.hindrance)}"
    if not needed.remedies:
        return f"{said}."
    joint_m = needed.remedies[0].joint_m
    if joint_m <= asked.goal.error_m:
        return f"{said}: that gives up to {length(joint_m)}."
    return f"{said}: that helps the most, but gives {length(joint_m)} at best."


def _hindrance(plan: CalibrationPlan, code: str) -> str:
    asked = plan.asked
    reach, board = asked.reach, asked.board
    larger = f"{board.cols}x{board.rows}@{plain(board.square_m * 2e3)}mm"
    half = plain(asked.corner_noise_px / 2)
    said = {
        "tilt": f"boards are tilted {plain(math.degrees(reach.tilt_rad), 3)}° at most; tilt them farther"
        " (`--tilt 45deg`)",
        "board": f"the board is too small; take a larger one (`--board {larger}`)",
        "range": f"the board is never nearer than {plain(reach.near_m)} m; hold it nearer"
        f" (`--range {plain(reach.near_m / 2)}:{plain(reach.far_m)}m`)",
        "corner_noise": f"corners are found to {plain(asked.corner_noise_px)} px only; take sharper pictures,"
        f" or several of each pose (`--corner-noise {half}`)",
        "flatness": f"the board is flat to {length(asked.flatness_m)} only; take a flatter one, or let the"
        " calibration find its warp (`--warp`)",
    }
    return said[code]


def corner_sentence(plan: CalibrationPlan) -> str:
    """What is left off the axis; empty where it is much the same."""
    axis, goal = chosen_depth(plan), plan.asked.goal
    # a goal that the axis meets may be missed elsewhere
    wanted = goal.error_m if goal is not None and axis.joint_m <= goal.error_m else math.inf
    least = min(_WORSE * axis.joint_m, wanted)
    off = [row for row in chosen_places(plan) if row.place != "axis" and row.joint_m > least]
    if not off:
        return ""
    more = f", above {plain(wanted * 1e3)} mm"
    parts = " and ".join(
        f"{length(row.joint_m)} at the picture's {row.place} ({length(row.calibration_m)} by calibration"
        f"{more if row.joint_m > wanted else ''})"
        for row in off
    )
    return f"That is on the left camera's axis; at the same distance it is {parts}."


def enough_sentence(plan: CalibrationPlan) -> str:
    """From how many pictures on more do not pay; empty where none of the curve is, or a goal says how many
    it takes."""
    count = enough(plan)
    if count is None or plan.asked.goal is not None:
        return ""
    least = plan.curve[0].pictures
    when = f"From {pictures(count)} on" if count > least else f"Already with {pictures(count)}"
    share = plain(100 * (NOTICED - 1), 2)
    said = f"{when} calibration adds less than {share} % to what pixel noise makes on the axis"
    return f"{said}{_all_the_same(count)}."


def gain_sentence(plan: CalibrationPlan) -> str:
    """What choosing the poses is worth, or would be where they were given; empty where that is nothing."""
    point = next((one for one in plan.curve if one.pictures == len(plan.poses)), None)
    if point is None or not math.isfinite(point.random_m) or not point.calibration_m > 0:
        return ""
    times = point.random_m / point.calibration_m
    said = f"As many poses at random would leave {length(point.random_m)} of calibration error in the median"
    if isinstance(plan.asked.poses, int):
        return f"{said}, {plain(times, 2)} times as much."
    reach = plan.asked.reach
    where = (
        f"{plain(reach.near_m)} to {plain(reach.far_m)} m away and tilted up to"
        f" {plain(math.degrees(reach.tilt_rad), 3)}°"
    )
    return f"{said}, {where}: better than these." if times * _NOTED < 1 else ""


def inseparable_sentence(plan: CalibrationPlan) -> str:
    """The pairs of parameters that the boards hardly tell apart; empty where there are none."""
    if not plan.inseparable:
        return ""
    pairs = (
        f"{parameter(one.first)} and {parameter(one.second)} ({_signed(one.correlation)})"
        for one in plan.inseparable[:_MOST_PAIRS]
    )
    more = len(plan.inseparable) - _MOST_PAIRS
    rest = f"; and {more} more" if more > 0 else ""
    return (
        f"Hardly told apart (correlation): {'; '.join(pairs)}{rest}. What one is off by the other makes up"
        " for: judge the depth, not their own std."
    )


def _signed(value: float) -> str:
    return f"{value:.3f}".replace("-", "−")


def frame_sentence(plan: CalibrationPlan) -> str:
    """What the column of the left camera means; empty where it is much the same."""
    if not has_frame(plan):
        return ""
    return (
        "Depths count against the boards, where what they measure stands; counted from the left camera's own"
        " centre (last column: what `rigsim tolerance` and `rigsim design` judge), where that centre lies is"
        " uncertain as well."
    )


def has_frame(plan: CalibrationPlan) -> bool:
    """Whether depths from the left camera differ from those against the boards by more than 10 %."""
    return any(
        not 1 / _NOTED <= (row.in_camera_m + 1e-15) / (row.calibration_m + 1e-15) <= _NOTED
        for row in plan.depths
    )


def next_sentence(plan: CalibrationPlan) -> str:
    """Where one more board does the most; empty where there is none."""
    found = plan.next_pose
    if found is None:
        return ""
    seen = plan.seen[:1].copy()
    seen[0] = found.seen
    (held,) = holdings(plan.asked.rig, plan.asked.board, BoardPoses.of([found.left_from_board]), seen)
    less = 100 * (1 - found.gain)
    if less < 1:
        return f"One more picture hardly changes that; it would do the most here: {holding_words(held)}."
    return (
        f"One more picture would do the most here: {holding_words(held)}; it takes {less:.2g} % off the"
        " calibration's error on the axis."
    )


def curve_shown(plan: CalibrationPlan) -> list[int]:
    """Places in the curve that a short table shows: round numbers, and those that the answer names."""
    named = {
        len(plan.poses),
        plan.needed.count,
        enough(plan),
        plan.curve[-1].pictures if plan.curve else None,
    }
    return [k for k, point in enumerate(plan.curve) if point.pictures in _SHOWN or point.pictures in named]


def order_sentence(plan: CalibrationPlan) -> str:
    """Whether one may stop early."""
    if not isinstance(plan.asked.poses, int):
        return "In the order of the file."
    least = max(plan.needed.count or 0, FEW)
    if least >= len(plan.poses) or (plan.asked.goal is not None and plan.needed.count is None):
        return "Best first."
    return f"Best first: after {least} of them you may stop; the curve says what the others add."


def held_words(plan: CalibrationPlan) -> str:
    """The parameters that are not estimated, by name; empty where all are."""
    parameters = plan.covariance.parameters
    free = set(parameters.free_names(plan.asked.rig))
    return ", ".join(parameter(name).removeprefix("the ") for name in parameters.names if name not in free)
