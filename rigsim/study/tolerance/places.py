"""What each quantity does at every place of the image, which no one number says."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.study.tolerance.run import ToleranceResult
from rigsim.study.tolerance.sensitivities import causes, first_order, on_plane

_COLUMNS = 64


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """Depth errors over the left image at the judged depth, first order; NaN where only one camera sees."""

    u_px: Array
    """Columns (n,), px."""
    v_px: Array
    """Rows (m,), px."""
    keys: tuple[str, ...]
    """The worst quantities, the worst first."""
    alone_mm: Array
    """Depth error (q, m, n) when each is off by its standard deviation, mm; signed. Of a calibration, whose
    parameters are off together: its standard deviation."""
    together_mm: Array
    """Root mean square over rigs (m, n) of all quantities together, mm."""


def places(result: ToleranceResult, most: int = 5) -> Places:
    """The maps of up to `most` quantities that move the depth, and of all of them."""
    rig = result.rig
    off = causes(rig, result.tolerances)
    rows = max(2, round(_COLUMNS * rig.left.height / rig.left.width))
    u = (np.arange(_COLUMNS) + 0.5) / _COLUMNS * rig.left.width - 0.5
    v = (np.arange(rows) + 0.5) / rows * rig.left.height - 0.5
    z = result.required.depth_m
    uv = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    points = on_plane(rig, uv, np.full(len(uv), z))
    seen = np.asarray(np.isfinite(points).all(axis=1))
    seen[seen] = rig.right.contains(rig.project(points[seen])[1])
    errors_mm = np.full((len(uv), len(off.even_numbers)), np.nan)
    errors_mm[seen] = 1e3 * first_order(rig, off, points[seen])
    keys = tuple(item.key for item in result.sensitivities if item.share > 1e-12)[:most]
    chosen = np.array([_alone(errors_mm[:, off.groups[off.names.index(key)]]) for key in keys])
    return Places(
        u,
        v,
        keys,
        chosen.reshape(len(keys), rows, _COLUMNS),
        np.sqrt((errors_mm**2).sum(axis=1)).reshape(rows, _COLUMNS),
    )


def _alone(errors: Array) -> Array:
    """The error (m,) of one quantity by those (m, r) of its independent numbers."""
    return errors[:, 0] if errors.shape[1] == 1 else np.sqrt((errors**2).sum(axis=1))
