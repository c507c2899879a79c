"""What a sweep hands to those who draw and write it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import pandas as pd

from rigsim.rig.remark import Remark
from rigsim.study.scene.showcase import Showcase
from rigsim.study.sweep.symptoms import Fault


@dataclass(frozen=True, slots=True)
class Verdict:
    """The answer in words, with numbers."""

    headline: str
    """One sentence: the answer."""
    sentences: tuple[str, ...]
    """What else must be known, a sentence each: what limits the rig, what was flagged."""
    agrees: bool
    """Whether no row was flagged."""


@dataclass(frozen=True, slots=True, eq=False)
class SweepResult:
    """Tables, pictures and words of one sweep."""

    rows: pd.DataFrame
    """One row a configuration; `ROW_COLUMNS`."""
    by_depth: pd.DataFrame
    """One row a configuration and bin of depth; `DEPTH_COLUMNS`."""
    swept: tuple[str, ...]
    """The axes that were varied, as columns of `AXES`; dependent ones (focal_px when the resolution
    grows behind a fixed lens) are left out."""
    best: tuple[int, ...]
    """Places in `rows` of the best configurations, best first."""
    limits: tuple[str, ...]
    """What limits each row, in the order of `rows`: "noise", "overlap", ..."""
    lens_note: str
    """What stayed and what changed between resolutions: the lens or the focal length in px."""
    showcase: Showcase
    """The best configuration in detail."""
    verdict: Verdict
    """The answer in words."""
    provenance: dict[str, object] = field(default_factory=dict)
    """Versions, renderer, seed, command: JSON values only."""
    far_limit_m: float = math.inf
    """Depth beyond which truth was left out because no rig reaches it, m; infinite where nothing was."""
    remarks: tuple[Remark, ...] = ()
    """What is odd about the scene or the rigs' place in it, each said once."""
    faults: tuple[Fault | None, ...] = ()
    """What is off in each row, in the order of `rows`; None where nothing is flagged or found."""
    complete: bool = True
    """False when the run was interrupted and holds only the rigs done until then."""
