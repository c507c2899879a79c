"""A planned calibration as a page for the bench: how to hold the board, and what that gives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from rigsim.present.calibrate.board_shapes import shape
from rigsim.present.calibrate.drift_words import (
    DRIFT_SAYS,
    DRIFT_TITLE,
    drift_heads,
    drift_numeric,
    drift_rows,
)
from rigsim.present.calibrate.plan_console import (
    CURVE_HEADS,
    curve_rows,
    depth_heads,
    depth_rows,
    parameter_rows,
)
from rigsim.present.calibrate.plan_figures import curve_figure
from rigsim.present.calibrate.plan_words import (
    frame_sentence,
    headline,
    held_words,
    inseparable_sentence,
    next_sentence,
    order_sentence,
    sentences,
)
from rigsim.present.calibrate.projection_figure import projection_figure
from rigsim.present.calibrate.witness_words import (
    WITNESS_HEADS,
    WITNESS_NUMERIC,
    true_sentence,
    witness_rows,
    witness_sentences,
)
from rigsim.present.calibrate.words import (
    distance_words,
    pictures,
    place_words,
    seen_words,
    tilt_words,
    turn_words,
)
from rigsim.present.kit import style
from rigsim.present.kit.page import Cover, fill
from rigsim.rig.arrays import Array
from rigsim.rig.remark import Remark
from rigsim.study.calibrate.drift import drift
from rigsim.study.calibrate.holding import Holding, holdings
from rigsim.study.calibrate.plan.result import CalibrationPlan
from rigsim.study.calibrate.witness.result import CalibrationWitness

_PAGE_MM, _CARDS_MM, _TEXT_MM = 186.0, 234.0, 14.5
"""Width of the page's text, what is left of its height for cards, and the height of a card's words, mm."""


@dataclass(frozen=True, slots=True)
class PoseCard:
    """One pose on the sheet."""

    where: str
    """How far, and where in the picture."""
    turned: str
    """How it is tilted and turned."""
    only: str
    """Which camera sees it, where not both do."""
    left: Markup
    """The left picture."""
    right: Markup
    """The right one."""


def plan_html(
    plan: CalibrationPlan,
    witnesses: Sequence[CalibrationWitness] = (),
    command: str = "",
    remarks: Sequence[Remark] = (),
) -> str:
    """The sheet for the bench and the numbers behind it as one page, without scripts, links or network."""
    curve = style.to_svg(curve_figure(plan), "curve", "Depth error by the number of pictures")
    projection = style.to_svg(projection_figure(plan), "projection", "Uncertainty over both pictures")
    heads, changes = depth_heads(plan), drift(plan.asked.rig, plan.asked.at_m)
    return fill(
        "plan.html",
        title=f"Calibration plan, {plan.asked.board.text}",
        cover=Cover(),
        headline=headline(plan),
        with_truth=true_sentence(plan, witnesses),
        bench=bench_sentences(plan),
        cards=cards(plan),
        columns=_columns(plan),
        sentences=[each for each in (*sentences(plan), next_sentence(plan)) if each],
        remarks=[remark.text for remark in remarks],
        curve=Markup(curve),
        curve_heads=CURVE_HEADS,
        curve_rows=curve_rows(plan),
        depth_heads=[head.replace("-\n", "").replace("\n", " ") for head in heads],
        depth_rows=depth_rows(plan),
        depth_numeric=[True, False, *[True] * (len(heads) - 2)],
        frame=frame_sentence(plan),
        witnesses=witness_rows(witnesses),
        witness_heads=[head.replace("\n", " ") for head in WITNESS_HEADS],
        witness_numeric=WITNESS_NUMERIC,
        witness_says=witness_sentences(witnesses, plan),
        projection=Markup(projection),
        inseparable=inseparable_sentence(plan),
        parameters=parameter_rows(plan),
        held=held_words(plan),
        drift_rows=drift_rows(changes),
        drift_heads=drift_heads(changes),
        drift_numeric=drift_numeric(changes),
        drift_title=DRIFT_TITLE,
        drift_says=DRIFT_SAYS,
        command=command,
    )


def bench_sentences(plan: CalibrationPlan) -> list[str]:
    """What somebody at the bench has to know."""
    held = holdings(plan.asked.rig, plan.asked.board, plan.poses, plan.seen)
    distances = [one.distance_m for one in held]
    near, far = distance_words(min(distances)), distance_words(max(distances))
    return [
        f"Take {pictures(len(plan.poses))} with both cameras at the same moment, {near} to {far} away: board"
        " and rig still, all of the board sharp and in the picture. Do not touch focus, zoom or the mount"
        " afterwards.",
        "Hold it as the pictures show it: the blue one is what the left camera sees, the orange one what the"
        " right camera sees. A hand's breadth and 10° are near enough, but the whole board must stay in the"
        " picture.",
        order_sentence(plan),
    ]


def cards(plan: CalibrationPlan) -> list[PoseCard]:
    """One card a pose, in their order."""
    held = holdings(plan.asked.rig, plan.asked.board, plan.poses, plan.seen)
    return [_card(plan, which, one) for which, one in enumerate(held)]


def _columns(plan: CalibrationPlan) -> int:
    """Cards beside each other on paper: as few as let all of them stand on one A4 page."""
    camera = plan.asked.rig.left
    for columns in (3, 4, 5):
        height_mm = (_PAGE_MM / columns / 2 - 3) * camera.height / camera.width + _TEXT_MM
        if height_mm * -(-len(plan.poses) // columns) <= _CARDS_MM:
            return columns
    return columns


def _card(plan: CalibrationPlan, which: int, held: Holding) -> PoseCard:
    turned = ", ".join(word for word in (tilt_words(held), turn_words(held)) if word)
    return PoseCard(
        f"{distance_words(held.distance_m)}, {place_words(held.across, held.down)}",
        turned[:1].upper() + turned[1:],
        seen_words(held),
        view_svg(plan, 0, which),
        view_svg(plan, 1, which),
    )


def view_svg(plan: CalibrationPlan, side: int, which: int) -> Markup:
    """What the left (0) or right (1) camera shows of pose `which`, as an ``<svg>`` element."""
    camera = (plan.asked.rig.left, plan.asked.rig.right)[side]
    found = shape(plan.asked.rig, side, plan.asked.board, plan.poses, which)
    color = (style.LEFT, style.RIGHT)[side] if plan.seen[which, side] else style.GREY
    decimals = 0 if camera.width >= 600 else 1
    thirds = "".join(
        f"M{camera.width * k / 3:.0f} 0V{camera.height}M0 {camera.height * k / 3:.0f}H{camera.width}"
        for k in (1, 2)
    )
    rim = _path(found.rim, decimals) if len(found.rim) > 2 else ""
    dark = "".join(_path(square, decimals) for square in found.dark)
    says = f"{('Left', 'Right')[side]} picture of pose {which + 1}"
    width = camera.width / 90
    return Markup(
        f'<svg viewBox="-0.5 -0.5 {camera.width} {camera.height}" role="img" aria-label="{says}">'
        f'<path d="{thirds}" stroke="#c9ced6" stroke-width="{width / 2:.1f}" fill="none"/>'
        f'<path d="{rim}" fill="#fff" stroke="{color}" stroke-width="{width:.1f}"/>'
        f'<path d="{dark}" fill="{color}"/></svg>'
    )


def _path(points: Array, decimals: int) -> str:
    rounded = np.round(points, decimals) + 0.0
    return "M" + "L".join(f"{u:.{decimals}f} {v:.{decimals}f}" for u, v in rounded) + "Z"
