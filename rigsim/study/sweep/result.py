"""What a sweep hands to those who draw and write it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import pandas as pd

from rigsim.rig.remark import Remark
from rigsim.study.agreement.agreement import flagged
from rigsim.study.agreement.fault import Fault
from rigsim.study.scene.plan import Held
from rigsim.study.scene.showcase import Showcase
from rigsim.study.sweep.limits import Limit
from rigsim.study.sweep.requirement import RowsHeld


@dataclass(frozen=True, slots=True, eq=False)
class SweepResult:
    """Tables, pictures and findings of one sweep.

    Example:
        >>> import rigsim
        >>> rig = rigsim.StereoRig.rectified(rigsim.Intrinsics.from_focal(80, 60, 70.0), 0.06)
        >>> found = rigsim.sweep(rig, rigsim.Plan(n_points=50, n_trials=5, renderer="rays", supersample=1))
        >>> isinstance(found, rigsim.SweepResult), len(found.rows), found.best
        (True, 1, (0,))
    """

    rows: pd.DataFrame
    """One row a configuration; `ROW_COLUMNS`."""
    by_depth: pd.DataFrame
    """One row a configuration and bin of depth; `DEPTH_COLUMNS`."""
    swept: tuple[str, ...]
    """The axes that were varied, as columns of `AXES`; dependent ones (focal_px when the resolution
    grows behind a fixed lens) are left out."""
    best: tuple[int, ...]
    """Places in `rows` of the best configurations, best first; where something is required, first of all the
    one that meets it, or comes nearest."""
    limits: tuple[Limit, ...]
    """What limits each row, in the order of `rows`: "pixel noise", "overlap", ..."""
    lens_held: Held
    """What stayed between resolutions."""
    showcase: Showcase
    """The best configuration in detail."""
    provenance: dict[str, object] = field(default_factory=dict)
    """Versions, renderer, seed, command: JSON values only."""
    far_limit_m: float = math.inf
    """Depth beyond which truth was left out because no rig reaches it, m; infinite where nothing was."""
    beyond_fraction: float = 0.0
    """Most of a left image that shows what was left out."""
    has_two_rigs: bool = False
    """Whether the rig that triangulates is not the true one."""
    remarks: tuple[Remark, ...] = ()
    """What is odd about the scene or the rigs' place in it, each said once."""
    faults: tuple[Fault | None, ...] = ()
    """What is off in each row, in the order of `rows`; None where nothing is flagged or found."""
    broken: str = ""
    """How many rows have no result as their triangulator broke, and its error, one line; empty for none."""
    complete: bool = True
    """False when the run was interrupted and holds only the rigs done until then."""
    requirements: tuple[RowsHeld, ...] = ()
    """The rows held to each depth error that was asked for."""

    @property
    def agrees(self) -> bool:
        """Whether no row is flagged."""
        return not flagged(self.rows).any()
