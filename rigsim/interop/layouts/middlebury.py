"""Middlebury 2014: a folder a frame, disparities as PFM."""

from __future__ import annotations

import numpy as np

from rigsim.interop.formats.middlebury import calib_text
from rigsim.interop.layouts.layout import Layout, mask, png, points
from rigsim.pixels.dense.pfm import pfm_bytes
from rigsim.study.scene.frames import DatasetFrame


def _frame(frame: DatasetFrame) -> dict[str, bytes]:
    place = f"{frame.index:06d}"
    disparity = frame.disparity(0)
    known = disparity[np.isfinite(disparity)]
    span = (float(known.min()), float(known.max()))
    return {
        f"{place}/calib.txt": calib_text(frame.rig, span).encode(),
        f"{place}/im0.png": png(frame.pictures.left),
        f"{place}/im1.png": png(frame.pictures.right),
        f"{place}/disp0.pfm": pfm_bytes(disparity),
        f"{place}/disp1.pfm": pfm_bytes(frame.disparity(1)),
        f"{place}/mask0nocc.png": mask(frame),
        f"{place}/points.ply": points(frame),
    }


LAYOUT = Layout(
    "middlebury",
    "``000000/``: im0.png, im1.png, disp0.pfm, disp1.pfm, mask0nocc.png, calib.txt, points.ply",
    _frame,
    calib_text,
)
