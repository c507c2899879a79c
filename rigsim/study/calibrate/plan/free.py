"""What a calibration of a rig estimates."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigsim.rig.lens.lens import Lens
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.plan.models import seldom_estimated
from rigsim.theory.calibration.parameters import CAMERA, RigParameters

_SAME = 1e-9
"""Share of what a coefficient does that nothing before it does; below, it does nothing of its own."""
_GRID = (17, 13)


def estimated(
    rig: StereoRig, model: type[Lens], *, fix: Sequence[str] = (), warped: bool = False
) -> tuple[RigParameters, tuple[Remark, ...]]:
    """All parameters of a rig in `model` but what `fix` holds, what is seldom estimated, and coefficients
    that do nothing of their own, as k4 of a rational lens that bends nothing; a remark names the last ones.

    Raises:
        InvalidRange: a word of `fix` is no parameter.
    """
    held = (*fix, *seldom_estimated(rig, model))
    parameters = RigParameters.of((model, model), fix=held, warped=warped)
    idle = [name for side in (0, 1) for name in _idle(rig, parameters, side)]
    if not idle:
        return parameters, ()
    words = dict.fromkeys(name.partition(".")[2] for name in idle)
    said = f"{', '.join(words)} of the {model.title} model {'is' if len(words) == 1 else 'are'} held"
    remark = Remark(
        "held",
        f"{said}: around this rig's lenses other parameters do the same; give the real lens, if it bends, to count what is"
        " estimated there",
    )
    return RigParameters.of((model, model), fix=(*held, *idle), warped=warped), (remark,)


def _idle(rig: StereoRig, parameters: RigParameters, side: int) -> list[str]:
    """Free coefficients of one camera that do in its picture what those before them do."""
    camera = (rig.left, rig.right)[side]
    u = np.linspace(0, camera.width - 1, _GRID[0])
    v = np.linspace(0, camera.height - 1, _GRID[1])
    rays = camera.ray(np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2))
    moves = parameters.camera_slopes(rig, side, rays[np.isfinite(rays).all(axis=1)])
    columns = moves.reshape(-1, moves.shape[-1])
    columns = columns[np.isfinite(columns).all(axis=1)]
    own = parameters.columns(side)
    free, names = parameters.free[own], parameters.names[own]
    idle, before = [], columns[:, : len(CAMERA)][:, free[: len(CAMERA)]]
    for k in range(len(CAMERA), len(names)):
        column = columns[:, k : k + 1]
        if not free[k]:
            continue
        size = float(np.linalg.norm(column))
        rest = column - before @ np.linalg.lstsq(before, column, rcond=None)[0] if before.size else column
        if np.linalg.norm(rest) <= _SAME * size or size == 0:
            idle.append(names[k])
        else:
            before = np.hstack([before, column])
    return idle
