"""The rig that is shown as files: its calibration, its numbers, its picture."""

from __future__ import annotations

import csv
import io
import math

from rigsim.api.draw import rig_figure
from rigsim.interop.documents.text import DIGITS, clean
from rigsim.interop.formats.rig_toml import write_rig
from rigsim.rig.stereo import StereoRig
from rigsim.studio.logic.numbers import PLACES, RigNumbers


def rig_toml(found: RigNumbers) -> bytes:
    """The rig's own file; empty where there is none."""
    return b"" if found.shown is None else write_rig(found.shown.rig, "rigsim studio").encode()


def numbers_csv(found: RigNumbers) -> bytes:
    """Every number at near end, distance and far end, a line each, at full precision; empty for none.

    Lengths are in mm, as a last field ``unit`` says.
    """
    if not found.places:
        return b""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["place", *found.places["at"], *found.of_rig, "unit"])
    for place in PLACES:
        facts = (*found.places[place].values(), *found.of_rig.values())
        writer.writerow([place, *(_cell(fact.value) for fact in facts), "mm"])
    return text.getvalue().encode()


def plan_png(rig: StereoRig, at_m: float, noise_px: float) -> bytes:
    """The rig from above with a point on its axis and lines of equal error, as the reports draw it."""
    from rigsim.present.kit.style import to_png

    return to_png(rig_figure(rig, [[0.0, 0.0, at_m]], noise_px=noise_px))


def _cell(value: float | str) -> str:
    if isinstance(value, str):
        return value
    return repr(clean(value, DIGITS)) if math.isfinite(value) else ""
