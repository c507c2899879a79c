"""Whether two witnesses agree: a value, of which `rigsim.present` makes the words."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import pandas as pd

from rigsim.rig.arrays import Mask
from rigsim.study.agreement.fault import Fault
from rigsim.study.scene import columns as col

AgreementKind: TypeAlias = Literal["agrees", "flagged", "untold"]
Witness: TypeAlias = Literal["simulated", "measured", ""]
Reason: TypeAlias = Literal[
    "",
    # flagged
    "all-failed",
    "some-failed",
    "not-exact",
    "spread",
    "mean",
    "outliers",
    "worse-than-claimed",
    # untold
    "no-points",
    "triangulator-failed",
    "nothing-shared",
    "too-far",
    "exact",
    "correlated",
    "calibration",
    "too-few-trials",
    "nothing-measured",
    "too-few-measured",
    "claims-nothing",
    "many-astray",
    "too-cautious",
    "unclear",
]
"""Why an agreement is no plain one; `Agreement` tells which number goes with which."""

_ORDER: tuple[AgreementKind, ...] = ("flagged", "untold", "agrees")


@dataclass(frozen=True, slots=True)
class AgreementPlace:
    """Where in the scene or the picture something differs."""

    of: Literal["depth", "region", "column"]
    """Between two depths, in a ninth of the left image, or in a fifth of its columns."""
    at: tuple[float, ...]
    """Nearest and farthest depth in m; row and column of the ninth; the column; all from 0."""


@dataclass(frozen=True, slots=True)
class Agreement:
    """What one comparison came to."""

    kind: AgreementKind
    """agrees, flagged (they differ), or untold (there is not enough to tell)."""
    witness: Witness = ""
    """Whom it speaks of: the simulation, the measurement, or neither alone."""
    reason: Reason = ""
    """Why; empty when they agree."""
    quantity: str = ""
    """What differs: depth spread, position spread, mean depth, ..."""
    ratio: float | None = None
    """Found over expected, where the quantity has such a ratio; a share of failures or outliers."""
    interval: tuple[float, float] | None = None
    """Of the ratio, where one is known."""
    sigmas: float | None = None
    """How many standard errors a mean is from the prediction."""
    size_px: float | None = None
    """Of an error where none is predicted."""
    count: tuple[int, int] | None = None
    """How many there are of how many: matches astray of those found; too few of those it takes."""
    place: AgreementPlace | None = None
    """Where it differs; None for everywhere."""
    cause: str = ""
    """The message of the error that left nothing to compare."""
    fault: Fault | None = None
    """What is off, when it was looked for."""


AGREES = Agreement("agrees")
"""Nothing differs."""


def worst(found: Iterable[Agreement]) -> Agreement:
    """The one that counts of several: flagged before untold before agrees, the first of its kind."""
    return min(found, key=lambda one: _ORDER.index(one.kind), default=AGREES)


def kinds(table: pd.DataFrame) -> pd.Series:
    """The kind of each row's agreement."""
    return pd.Series([one.kind for one in table[col.AGREEMENT]], index=table.index, dtype=object)


def flagged(table: pd.DataFrame) -> Mask:
    """Whether each row is flagged, (N,)."""
    return np.array([one.kind == "flagged" for one in table[col.AGREEMENT]], dtype=bool)


def blamed(table: pd.DataFrame, witness: Witness) -> Mask:
    """Whether each row is flagged for what this witness says, (N,)."""
    return np.array(
        [one.kind == "flagged" and one.witness == witness for one in table[col.AGREEMENT]], dtype=bool
    )


def finite(value: float) -> float | None:
    """A number that is one; None for NaN, which would differ from itself."""
    return None if math.isnan(value) else float(value)
