"""What `rigsim render --json` prints."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from rigsim.interop.documents.base import Part, Provenance, RemarkPart, SeenRig, Written, seen_rig
from rigsim.interop.documents.text import clean
from rigsim.rig.arrays import Array
from rigsim.study.scene.snapshot import Snapshot

_SINGLE = 7  # digits of the single-precision arrays that are written


class Spread(Part):
    """A quantity over the pixels that have it."""

    smallest: float | None
    """The smallest value; null where no pixel has one."""
    median: float | None
    """The median."""
    largest: float | None
    """The largest value."""


class RenderDocument(Part):
    """A stereo pair with its truth."""

    command: str
    """The command that was typed."""
    scene: str
    """Name of the scene."""
    rig: SeenRig
    depth_left_mm: Spread
    """True depth of the left pixels, mm."""
    disparity_px: Spread
    """True disparity of the left pixels that the right camera sees, px."""
    visible_fraction: float | None
    """Those, as a share of the left pixels with a depth."""
    remarks: list[RemarkPart]
    """What is odd about the scene or the rig's place in it; also on standard error."""
    provenance: Provenance
    written: Written
    """The pictures and arrays."""


def render_document(snapshot: Snapshot, written: Written) -> dict[str, Any]:
    """What was rendered, in a few numbers."""
    provenance = dict(snapshot.provenance)
    depth_mm = 1e3 * np.asarray(snapshot.frame.left.depth, dtype=np.float64)
    seen, hit = np.isfinite(snapshot.disparity), np.isfinite(depth_mm)
    document = RenderDocument.model_validate(
        {
            "command": provenance.pop("command", ""),
            "scene": snapshot.scene,
            "rig": seen_rig(snapshot.rig),
            "depth_left_mm": _spread(depth_mm),
            "disparity_px": _spread(snapshot.disparity),
            "visible_fraction": float(seen.sum() / hit.sum()) if hit.any() else None,
            "remarks": [asdict(remark) for remark in snapshot.remarks],
            "provenance": provenance,
            "written": written,
        }
    )
    return document.model_dump()


def _spread(values: Array) -> Spread:
    known = values[np.isfinite(values)]
    if not known.size:
        return Spread(smallest=None, median=None, largest=None)
    smallest, median, largest = (clean(float(f(known)), _SINGLE) for f in (np.min, np.median, np.max))
    return Spread(smallest=smallest, median=median, largest=largest)
