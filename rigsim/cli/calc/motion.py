"""`rigsim calc motion`: cameras that are not triggered at once, with something that moves."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rigsim.api.calc.fact import Fact, values
from rigsim.cli.kit.answer import print_remarks
from rigsim.cli.kit.facts import Form, print_facts, show_facts
from rigsim.cli.kit.golden import GoldenWords
from rigsim.cli.kit.options import (
    Csv,
    DisparityNoise,
    Json,
    Markdown,
    Noise,
    takes,
    takes_rig,
)
from rigsim.errors import InvalidRange
from rigsim.typed import quantity
from rigsim.typed.noise import pixel_noise
from rigsim.typed.rigs import RigOptions, single_rig

if TYPE_CHECKING:
    from rigsim.rig.motion import Motion
    from rigsim.study.calc.motion import MotionAt

_SPEED = quantity.QuantityKind("speed", "m/s", quantity.SPEEDS)
_VERTICAL_SPEED = quantity.QuantityKind("vertical speed", "m/s", quantity.SPEEDS)


@dataclass(frozen=True, slots=True)
class MotionWords:
    """The options of `rigsim calc motion`, as typed."""

    z: Annotated[
        str, typer.Option("--z", metavar="LENGTH", help="Distance Z along the left optical axis: 3m.")
    ]
    time_offset: Annotated[
        str, typer.Option(metavar="TIME", help="How much later the right picture is taken: 2ms, 500us.")
    ]
    speed: Annotated[
        str,
        typer.Option(
            metavar="SPEED", help="Along the baseline, from the left camera to the right one: 1m/s, 5km/h."
        ),
    ] = "0"
    forward_speed: Annotated[str, typer.Option(metavar="SPEED", help="Straight ahead: 10m/s.")] = "0"
    vertical_speed: Annotated[
        str,
        typer.Option(
            metavar="SPEED",
            help="Across the rows, down the pictures: 4m/s; negative is up. Of cameras that look down, with "
            "the baseline across the flight, it is the speed of the flight.",
        ),
    ] = "0"
    turn_rate: Annotated[
        str,
        typer.Option(
            metavar="DEG/S",
            help="How fast the rig turns to the right, about the middle of its baseline: 30, 1rad/s; "
            "negative is to the left.",
        ),
    ] = "0"
    moving: Annotated[
        str | None,
        typer.Option(metavar="WHAT", help="What the speeds are of, to be said with any: rig or object."),
    ] = None
    noise: Noise = None
    disparity_noise: DisparityNoise = None
    as_json: Json = False
    as_csv: Csv = False
    as_markdown: Markdown = False


@takes_rig
@takes(MotionWords)
@takes(GoldenWords)
def motion(options: RigOptions, words: MotionWords, golden: GoldenWords) -> None:
    """Tell what a time offset between the cameras does to a distance while the rig or an object moves.

    The shift is of the point in the right picture, against one taken at once.
    """
    form = Form(words.as_json, words.as_csv, words.as_markdown)
    golden.check("calc motion")
    rig = single_rig(options, None)
    moved = _motion(words)
    depth_mm, *more = quantity.distances(words.z)
    if more:
        raise InvalidRange(f"depth {words.z}: {1 + len(more)} distances; give one")
    noise = pixel_noise(words.noise, words.disparity_noise)

    import numpy as np

    from rigsim.present.kit.motion import motion_in_words, motion_sentence
    from rigsim.study.calc import motion as study
    from rigsim.study.calc import sight
    from rigsim.theory.uncertainty import predict_depth_std

    on_axis = np.array([0.0, 0.0, depth_mm / 1e3])
    seen = sight.sight_of_point(rig, on_axis, sized=options.has_size)
    found = study.motion_at(rig, moved, depth_mm / 1e3, noise, sized=options.has_size)
    std_mm = float(predict_depth_std(rig, on_axis[None], noise)[0]) * 1e3
    facts = [
        Fact("seen_by", "seen by", seen.seen_by, "", "which cameras see the point on the left optical axis"),
        Fact("z", "Z", depth_mm, "mm", "depth, when the left picture is taken"),
        *_facts(found, seen.by_both, noise.std_px),
        Fact(
            "depth_std", "depth std", std_mm if seen.by_both else math.nan, "mm", "of noise alone, beside it"
        ),
    ]
    remarks = [
        *options.mode_remarks(rig),
        *sight.rig_remarks(rig, sized=options.has_size),
        *seen.remarks,
        *study.motion_remarks(found, depth_mm / 1e3),
    ]

    says = motion_sentence(found, moved, depth_mm, seen.by_both)

    def document() -> dict[str, Any]:
        from rigsim.interop.documents.calc import motion_document

        return motion_document(values(facts), moved, remarks, says)

    print_remarks(remarks)
    title = f"Motion: {motion_in_words(moved)}"
    print_facts(
        facts,
        title=title,
        form=form,
        document=document,
        golden=golden,
        show=lambda: show_facts(facts, title, form, says),
    )


def _motion(words: MotionWords) -> Motion:
    from rigsim.rig.motion import Motion

    speed_m_s = quantity.value(words.speed, _SPEED)
    forward_m_s = quantity.value(words.forward_speed, quantity.FORWARD_SPEED)
    vertical_m_s = quantity.value(words.vertical_speed, _VERTICAL_SPEED)
    if words.moving is None and (speed_m_s or forward_m_s or vertical_m_s):
        raise InvalidRange("--moving is missing: does the rig move, or the object? Write rig or object")
    return Motion(
        quantity.value(words.time_offset, quantity.TIME_OFFSET) / 1e3,
        speed_m_s,
        forward_m_s,
        math.radians(quantity.value(words.turn_rate, quantity.TURN_RATE)),
        words.moving or "rig",
        vertical_m_s,
    )


def _facts(found: MotionAt, seen: bool, noise_px: float) -> list[Fact]:
    from rigsim.study.calc.motion import KEPT_ROWS_PX

    def told(value: float) -> float:
        return value if seen else math.nan

    depth_mm, most_mm = found.depth_error_m * 1e3, found.most_depth_error_m * 1e3
    largest = "the largest in the image that both see"
    return [
        Fact("along_px", "shift along rows", told(found.along_px), "px", "on the axis; + is right"),
        Fact("across_px", "shift across rows", told(found.across_px), "px", "on the axis; + is down"),
        Fact("depth_error", "depth error", told(depth_mm), "mm", "depth found, minus the true one"),
        Fact("most_along_px", "most along rows", found.most_along_px, "px", largest),
        Fact("most_across_px", "most across rows", found.most_across_px, "px", largest),
        Fact("most_depth_error", "most depth error", most_mm, "mm", largest),
        Fact(
            "allowed_ms",
            "allowed",
            found.allowed_s * 1e3,
            "ms",
            f"time offset whose largest shift is as large as a disparity's noise, {noise_px * 2**0.5:.3g} px",
        ),
        Fact(
            "allowed_rows_ms",
            "allowed by rows",
            found.allowed_rows_s * 1e3,
            "ms",
            f"time offset with which no point is more than {KEPT_ROWS_PX:g} px off its row",
        ),
    ]
