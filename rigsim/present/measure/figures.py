"""A measured pair as figures, and in a sentence."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
from matplotlib.figure import Figure
from PIL import Image as PillowImage

from rigsim.present.kit.picture_figure import picture_figure
from rigsim.present.measure.console import pair_pictures
from rigsim.present.measure.words import sentence
from rigsim.study.measure.result import PairMeasurement, eight_bit


def headline(result: PairMeasurement) -> str:
    """What was concluded of the rows, and of what they cannot tell."""
    return " ".join(sentence(verdict, result.rig) for verdict in result.verdicts)


def pair_figures(result: PairMeasurement) -> Mapping[str, Callable[[], Figure]]:
    """``disparity``, ``left`` and ``right``."""
    return {
        "disparity": partial(_disparity, result),
        "left": lambda: picture_figure(eight_bit(result.image_left), "left picture"),
        "right": lambda: picture_figure(eight_bit(result.image_right), "right picture"),
    }


def _disparity(result: PairMeasurement) -> Figure:
    with PillowImage.open(io.BytesIO(pair_pictures(result)["disparity.png"])) as picture:
        return picture_figure(np.asarray(picture.convert("RGB")), "disparity, px")
