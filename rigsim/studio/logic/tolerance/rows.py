"""The pictures that the built rig takes, and the row of the right one that belongs to a left one's."""

from __future__ import annotations

import numpy as np

from rigsim.present.kit.format import number, plain
from rigsim.present.live.built import row_guide
from rigsim.studio.draw.request import PairRequest
from rigsim.studio.logic.tolerance.built import BuiltFound

_WIDTH_PX = 640
_LEAST_PX = 0.005


def pair_wanted(found: BuiltFound, scene: str, *, coarse: bool) -> PairRequest | None:
    """The pair that belongs to the numbers; None for no rig."""
    if found.shown is None or found.answer is None:
        return None
    rig = found.shown.rig
    width = min(_WIDTH_PX, rig.left.width)
    size = None if coarse else (width, max(1, round(width * rig.left.height / rig.left.width)))
    return PairRequest(rig, scene, size, coarse, noise_px=found.shown.noise.std_px, built=found.answer.rig)


def row_apart_px(found: BuiltFound, share: float) -> float:
    """How far below a left row its points lie in the right picture at the judged distance, px of the rig.

    Args:
        found: the answer.
        share: the row, from 0 at the top to 1 at the bottom.

    Returns:
        The mean over the row; NaN where both cameras see none of it.
    """
    if found.answer is None:
        return float("nan")
    where = found.answer.map
    row = where.row_px[min(int(share * len(where.v_px)), len(where.v_px) - 1)]
    known = row[np.isfinite(row)]
    return float(known.mean()) if len(known) else float("nan")


def guide(found: BuiltFound, share: float, drawn: tuple[int, int], *, right: bool) -> str:
    """The marked row over a picture of `drawn` width and height, px."""
    apart = row_apart_px(found, share)
    known = right and found.shown is not None and np.isfinite(apart)
    return row_guide(share, apart / found.shown.rig.left.height if known and found.shown else None, drawn)


def guide_words(found: BuiltFound, share: float) -> str:
    """What the marked row says."""
    apart = row_apart_px(found, share)
    if found.answer is None or not np.isfinite(apart):
        return "Both cameras see nothing of this row."
    at = f"at {plain(found.answer.map.depth_m)} m"
    if abs(apart) < _LEAST_PX:
        return f"Points of the marked row lie on the same row of the right picture, {at}."
    side = "lower" if apart > 0 else "higher"
    return (
        f"Points of the marked row (white) lie {number(abs(apart))} px {side} in the right picture (orange), "
        f"{at}; move over a picture to mark another row."
    )
