"""What can be drawn and measured on this machine, where nobody said what to use."""

from __future__ import annotations

import importlib.util

from rigsim.rig.remark import Remark

NO_GL = Remark("no_gl", "no GL library works here: using rays, which measure nothing (see `rigsim doctor`)")
NO_OPENCV = Remark("no_opencv", "OpenCV is not installed: nothing is measured (pip install 'rigsim[vision]')")


def choose(renderer: str, measure: str) -> tuple[str, str, tuple[Remark, ...]]:
    """The renderer and the measurement in place of "auto", and a remark where one of them is poor."""
    remarks: list[Remark] = []
    if renderer == "auto":
        from rigsim.sim import backend

        renderer = backend.choose()
        if renderer == "rays":
            remarks.append(NO_GL)
    if measure == "auto" and importlib.util.find_spec("cv2") is None:
        measure = "none"
        remarks.append(NO_OPENCV)
    return renderer, measure, tuple(remarks)
