"""A calibration from pictures in sentences."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from rigsim.present.calibrate.words import holding_words
from rigsim.present.kit.format import length, number, plain, with_error
from rigsim.study.calibrate.holding import holdings
from rigsim.study.calibrate.pictures.outliers import OddPairReason
from rigsim.study.calibrate.pictures.result import CalibratedPictures, PictureCheck, PictureVerdict
from rigsim.theory.calibration.boards import BoardPoses

VERDICTS: Mapping[PictureVerdict, str] = MappingProxyType(
    {
        "good": "good",
        "suspect": "suspect",
        "one_camera": "one camera alone",
        "outlier": "left out",
        "not_found": "no board",
        "several": "several boards",
        "unreadable": "unreadable",
        "duplicate": "same as before",
    }
)
"""What became of a pair, in a word or two."""
_NAMED = 3
"""Suspects in the headline."""
_REASONS: Mapping[OddPairReason, str] = MappingProxyType(
    {
        "": "",
        "moved": "each camera alone explains it, not both: the board moved between the two shots",
        "mixed_up": "puts the right camera elsewhere: not of one moment, or the wrong pair",
        "hidden": "a few corners are wrong: something in front of them, or a reflection",
        "blurred": "far less sharp than the others: out of focus, or moved",
        "bent": "the board was bent in it",
        "unexplained": "does not fit the others",
    }
)


def headline(result: CalibratedPictures) -> str:
    """The answer in one sentence."""
    pairs, alone = result.pair_count, int(result.kept.sum()) - result.pair_count
    more = f" and {alone} picture{'s' if alone > 1 else ''} of one camera" if alone else ""
    baseline = with_error(1e3 * result.rig.baseline_m, 1e3 * result.baseline_std_m)
    return (
        f"Rig from {pairs} pairs{more}: baseline {baseline} mm, corners {number(result.fit.rms_px)} px rms"
        f" from where they should be; {_predicted(result)}."
    )


def _predicted(result: CalibratedPictures) -> str:
    if result.verdict == "untold":
        return "too few pairs to tell whether they predict one another"
    said = f"each pair is {number(result.ratio)} times as far off as the others predict"
    if result.verdict == "agrees":
        return said + ", as it should be"
    out = sum(each.verdict == "outlier" for each in result.pictures)
    if out:
        said += f", without {out} that {'is' if out == 1 else 'are'} left out"
    elif result.verdict == "flagged":
        said += ", and should be 1"
    if suspects := result.suspects:
        named = ", ".join(f"{each.name} {number(each.ratio)} times" for each in suspects[:_NAMED])
        named += ", ..." if len(suspects) > _NAMED else ""
        said += f", but {len(suspects)} suspect{'s' if len(suspects) > 1 else ''}: {named}"
    return said + ("; the board looks bent" if result.bent else "")


def picture_words(check: PictureCheck) -> str:
    """What there is to say of one pair; empty where it is good."""
    return _REASONS[check.reason]


def noise_sentence(result: CalibratedPictures) -> str:
    """The corner noise, found and claimed."""
    claimed = result.fit.sightings.claimed_rms_px
    beside = f"; their own fits claim {number(claimed)} px" if math.isfinite(claimed) else ""
    return (
        f"Corner noise {number(result.fit.noise_px)} px a coordinate, from the residuals with what was"
        f" estimated taken off{beside}. Every std is at that noise."
    )


def opencv_sentence(result: CalibratedPictures) -> str:
    """OpenCV's rig beside it."""
    found = result.opencv
    return (
        f"OpenCV's own calibration of the same pairs: rms {number(found.rms_px)} px, baseline"
        f" {length(found.rig.baseline_m, 5)}."
    )


def depth_sentence(result: CalibratedPictures) -> str:
    """The depth std at the farthest distance asked for."""
    rows = [row for row in result.depths if row.place == "axis"]
    if not rows:
        return ""
    row = rows[-1]
    return (
        f"At {plain(row.z_m)} m on the axis the calibration leaves {length(row.calibration_m)} of depth std,"
        f" pixel noise of {plain(result.asked.noise_px)} px {length(row.observation_m)}, both together"
        f" {length(row.joint_m)}."
    )


def next_words(result: CalibratedPictures) -> str:
    """Where one more board does the most; empty where no place was found."""
    found = result.next_pose
    if found is None:
        return ""
    less = f"the calibration's depth std becomes {number(found.gain)} times what it is"
    return f"Hold the board next: {holding_of(result)}; {less}."


def holding_of(result: CalibratedPictures) -> str:
    """How the board is held there, in words."""
    found = result.next_pose
    if found is None:
        return ""
    poses = BoardPoses.of([found.left_from_board])
    (held,) = holdings(result.rig, result.asked.board, poses, np.array([found.seen]))
    return holding_words(held)
