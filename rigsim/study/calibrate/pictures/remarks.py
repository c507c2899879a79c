"""What is odd about a calibration from pictures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from rigsim.digits import short
from rigsim.rig.remark import Remark
from rigsim.study.calibrate.pictures.pairs import Paired

if TYPE_CHECKING:
    from rigsim.study.calibrate.pictures.result import CalibratedPictures

_NOISIER = 1.5
"""Corner noise over what the finder claims, above which something else than noise is in the residuals."""
_FEW_PAIRS = 8
_COVERED = 0.6
_DIFFERS = 0.1
"""Of a standard deviation: OpenCV and the adjustment of the same corners differ by less."""
_LOOSE = 0.01
"""Standard deviation of a focal length, as a share of it, from which the boards' tilts are too alike."""
_NAMED = 6
_CHANGES = 3.0
"""Times what honest pairs, left out, change a rig by in the mean."""
_HARMS = 1.0
"""Standard deviations that the rig moves by, from which that matters."""
_LEAST_BASELINE_M, _MOST_BASELINE_M = 1e-3, 5.0
"""Baselines beyond are told: the board's unit is in question."""
_OVER_HEAD_RAD = np.radians(150.0)
"""A roll beyond is a camera upside down."""


def remarks_of(result: CalibratedPictures, turned: Sequence[str]) -> tuple[Remark, ...]:
    """One each; `turned` are pairs whose right corners were counted the other way round."""
    return tuple(_remarks(result, turned))


def pairing_remarks(found: Paired) -> tuple[Remark, ...]:
    """What is odd about how pictures were paired."""
    remarks = []
    if found.alone:
        text = (
            f"{len(found.alone)} picture(s) without one of the other camera, left out: {_listed(found.alone)}"
        )
        remarks.append(Remark("unpaired", text))
    if found.by_order:
        first = found.pairs[0]
        text = (
            f"nothing in the names pairs the pictures: by their order, {first.left} with {first.right}, ..."
        )
        remarks.append(Remark("paired_by_order", text))
    return tuple(remarks)


def _remarks(result: CalibratedPictures, turned: Sequence[str]) -> Iterator[Remark]:
    yield from _left_out(result)
    if turned:
        text = (
            f"corners of the right picture were counted the other way round than of the left one:"
            f" {_listed(turned)}; set right by where the right camera stands in the other pairs"
        )
        yield Remark("order_turned", text)
    yield from _numbers(result)
    yield from _rig(result)
    yield from _board(result)
    if result.interrupted:
        count = len(result.pictures)
        yield Remark(
            "interrupted", f"interrupted: the first {count} pairs count, those after them were not searched"
        )


def _left_out(result: CalibratedPictures) -> Iterator[Remark]:
    for verdict, code, says in (
        ("not_found", "not_found", "show no board, and are left out"),
        ("several", "several_boards", "show more than one such board, and are left out: cover the others"),
        ("duplicate", "duplicate", "are the same as an earlier one, and count once"),
        ("one_camera", "one_camera", "show the board in one picture alone: they count for that camera"),
    ):
        names = [each.name for each in result.pictures if each.verdict == verdict]
        if names:
            yield Remark(code, f"{len(names)} of {len(result.pictures)} pairs {says}: {_listed(names)}")
    names = [each.name for each in result.pictures if each.verdict == "outlier"]
    if names:
        text = f"{len(names)} of {len(result.pictures)} pairs are not as the others predict, and are left out"
        yield Remark("outliers", f"{text}: {_listed(names)}")
    yield from _suspects(result)


def _suspects(result: CalibratedPictures) -> Iterator[Remark]:
    suspects, without = result.suspects, result.without_suspects
    if not suspects:
        return
    text = (
        f"{len(suspects)} suspect of {len(result.pictures)} pairs, which counts"
        if len(suspects) == 1
        else f"{len(suspects)} suspects of {len(result.pictures)} pairs, which count"
    )
    text += ": " + _listed([f"{each.name} ({short(each.ratio)} times as predicted)" for each in suspects])
    if without is None:
        yield Remark(
            "suspects", f"{text}; too few others are left to tell what it changes: take more pictures"
        )
        return
    before, after = (short(1e3 * std, 3) for std in without.depth_std_m)
    text += (
        f"; without, the baseline is {short(1e3 * without.baseline_m, 5)} mm"
        f" ({short(abs(without.baseline_stds), 2)} std away), depths at {short(without.z_m)} m differ by"
        f" {short(abs(1e3 * without.depth_shift_m), 2)} mm ({short(abs(without.depth_shift_stds), 2)} std),"
        f" and their std from the calibration is {after} in the place of {before} mm"
    )
    harm = max(abs(without.baseline_stds), abs(without.depth_shift_stds))
    if without.beyond_chance > _CHANGES and harm > _HARMS:
        text += f"; that is {short(without.beyond_chance, 2)} times what honest pairs do"
        few = result.pair_count - len(suspects) < _FEW_PAIRS
        text += ": " + (
            "the others are too few to tell which is right, take more"
            if few
            else "leave out what was not of one moment, and calibrate again"
        )
    yield Remark("suspects", text)


def _numbers(result: CalibratedPictures) -> Iterator[Remark]:
    pairs = result.pair_count
    if pairs < _FEW_PAIRS:
        yield Remark(
            "few_pairs",
            f"{pairs} pairs of pictures: the corner noise, and every std from it, is rough; some"
            f" {_FEW_PAIRS} to 20 are worth having",
        )
    claimed, found = result.fit.sightings.claimed_rms_px, result.fit.noise_px
    if np.isfinite(claimed) and found > _NOISIER * claimed:
        text = (
            f"corners are {short(found / claimed, 2)} times as far off ({short(found)} px) as their fits"
            f" claim ({short(claimed)} px): more than noise is left, as of a board that is not flat or"
            " squares that are not true, a lens that the model does not reach, or motion; every std here is"
            " at what was found"
        )
        yield Remark("noisier_than_claimed", text)


def _rig(result: CalibratedPictures) -> Iterator[Remark]:
    yield from _stands(result)
    std = result.covariance.std
    focal, names = result.rig.left.fx, result.covariance.names
    loose = max(std[names.index("left.fx")], std[names.index("right.fx")])
    if loose > _LOOSE * focal:
        text = (
            f"the pictures hardly tell the focal length, {short(focal, 4)} +- {short(loose, 2)} px: tilt the"
            " board some 30 degrees both ways, and bring it near"
        )
        yield Remark("focal_loose", text)
    for side, found, other in (
        ("left", result.rig.left, result.opencv.rig.left),
        ("right", result.rig.right, result.opencv.rig.right),
    ):
        found_by = result.fit.sightings.found
        alike = (result.fit.sightings.weights == 1).all() and (found_by[:, 0] == found_by[:, 1]).all()
        same_words = not result.asked.warp and not any("." in word for word in result.asked.fix)
        for name in ("fx", "fy", "cx", "cy"):
            k = result.covariance.names.index(f"{side}.{name}")
            off = abs(getattr(found, name) - getattr(other, name))
            if alike and same_words and std[k] > 0 and off > _DIFFERS * std[k]:
                text = (
                    f"OpenCV's {side} {name}, {short(getattr(other, name), 6)} px, differs by"
                    f" {short(off / std[k], 2)}"
                    " standard deviations from the adjustment of the same corners, which is what counts here"
                )
                yield Remark("opencv_differs", text)
    shares = result.coverage.shares
    if min(shares) < _COVERED:
        text = (
            f"corners reached {short(100 * shares[0], 2)} % of the left and {short(100 * shares[1], 2)} % of"
            " the right picture: elsewhere the lens is extrapolated; hold the board there too"
        )
        yield Remark("coverage", text)


def _stands(result: CalibratedPictures) -> Iterator[Remark]:
    """What is odd about where the right camera stands."""
    pose, baseline_m = result.rig.right_from_left, result.rig.baseline_m
    roll = float(np.arctan2(pose.R[1, 0], pose.R[0, 0]))
    if abs(roll) > _OVER_HEAD_RAD:
        text = (
            f"the right camera is rolled by {abs(np.degrees(roll)):.0f} deg against the left one: one of the"
            " two is upside down, or its pictures are turned by half a turn"
        )
        yield Remark("upside_down", text)
    elif pose.inverse.t[0] < 0:
        text = (
            "the right camera stands to the left of the left one: are the two swapped, both upside down, or"
            " both mirrored?"
        )
        yield Remark("swapped", text)
    if not _LEAST_BASELINE_M <= baseline_m <= _MOST_BASELINE_M:
        square_m = result.asked.board.square_m
        text = (
            f"a baseline of {short(baseline_m if baseline_m > 1 else 1e3 * baseline_m, 4)}"
            f" {'m' if baseline_m > 1 else 'mm'} comes of a square of {short(1e3 * square_m, 4)} mm: is that"
            " the unit of --board? Every length scales with it"
        )
        yield Remark("board_unit", text)


def _board(result: CalibratedPictures) -> Iterator[Remark]:
    warp = result.warp
    if warp.significant:
        rise = " and ".join(
            f"{short(1e3 * value, 2)} +- {short(1e3 * std, 2)} mm"
            for value, std in zip(warp.rise_m, warp.std_m, strict=True)
        )
        if result.asked.warp:
            text = (
                f"the board is not flat: its sides' middle rises by {rise} along x and y; the rig counts it"
            )
        else:
            text = (
                f"the board may not be flat: the middle of its sides would rise by {rise} along x and y;"
                " --warp counts it, a stiff board is better"
            )
        yield Remark("warp", text)


def _listed(names: Sequence[str]) -> str:
    more = len(names) - _NAMED
    return ", ".join(names[:_NAMED]) + (f" and {more} more" if more > 0 else "")
