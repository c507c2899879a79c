"""What pictures of a board say of the rig that took them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from rigsim.pixels.calibration.stereo import FoundRig
from rigsim.rig.arrays import Mask
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.statistics import rms
from rigsim.study.calibrate.depths import DepthStd
from rigsim.study.calibrate.pictures.asked import PicturesAsked
from rigsim.study.calibrate.pictures.coverage import CornerCoverage
from rigsim.study.calibrate.pictures.fit import PicturesFit
from rigsim.study.calibrate.pictures.outliers import (
    LEAST_OFF_PX,
    OddPairReason,
    WithoutSuspects,
    baseline_std,
)
from rigsim.study.calibrate.pictures.pairs import PicturePair
from rigsim.study.calibrate.pictures.sightings import Sightings
from rigsim.study.calibrate.plan.result import NextPose
from rigsim.theory.calibration.covariance import CalibrationCovariance

PictureVerdict: TypeAlias = Literal[
    "good", "suspect", "one_camera", "outlier", "not_found", "several", "unreadable", "duplicate"
]
"""What became of a pair: it counts; it counts, but is hardly as the others predict; it counts for one
camera, the other shows no board; the others do not predict it; no board in either; two such boards; one of
its files is no picture; the same as an earlier one."""
PicturesVerdict: TypeAlias = Literal["agrees", "suspect", "flagged", "untold"]
"""Whether pictures predict one another: they do; all but a suspect that counts, or but for a board that is
clearly bent; an outlier was left out, or all together are off; too few to tell."""

KEPT: tuple[PictureVerdict, ...] = ("good", "suspect", "one_camera")
"""Verdicts of pairs that count."""
_LEAST_TOLD = 3
_MOST_RATIO = 1.25
"""Of all pictures together: honest corners, some hundred a picture, stay within 1.05."""
_CLEARLY_BENT = 1e-9
"""How often a flat board looks so bent: the rig's std says nothing of what such a bend does to it."""


@dataclass(frozen=True, slots=True)
class PictureCheck:
    """One pair of pictures."""

    name: str
    """What both files are called."""
    verdict: PictureVerdict
    """What became of it."""
    reason: OddPairReason
    """Why it is an outlier; empty where it is none."""
    corners: tuple[int, int]
    """Corners found in the left and the right picture."""
    rms_px: float
    """Root mean square distance of its corners from where they should be, px; NaN without any. An outlier's
    is with the others' rig."""
    ratio: float
    """Residual over what the others predict; NaN where they do not."""


@dataclass(frozen=True, slots=True)
class WarpCheck:
    """Whether the board is flat."""

    rise_m: tuple[float, float]
    """How far the middle of its sides along x and y rises over the ends, m."""
    std_m: tuple[float, float]
    """Standard deviations of these, m."""
    chance: float
    """How often a flat board looks as bent as this."""

    @property
    def significant(self) -> bool:
        """Whether it is told from flat: once in a thousand a flat board is."""
        return self.chance < 1e-3

    @property
    def clear(self) -> bool:
        """Whether it is bent beyond doubt."""
        return self.chance < _CLEARLY_BENT


@dataclass(frozen=True, slots=True, eq=False)
class CalibratedPictures:
    """A rig calibrated from pictures, and how good it is."""

    asked: PicturesAsked
    """What was asked."""
    sightings: Sightings
    """All corners, in one order."""
    pairs: tuple[PicturePair, ...]
    """The files of each pair, or what a corner file calls them."""
    kept: Mask
    """Which pairs the rig is made from, (n,)."""
    fit: PicturesFit
    """The rig, and the residuals of those pairs."""
    opencv: FoundRig
    """OpenCV's rig of the same pairs."""
    covariance: CalibrationCovariance
    """How far the rig may be off, at the corner noise that was found."""
    depths: tuple[DepthStd, ...]
    """What that does to depths."""
    pictures: tuple[PictureCheck, ...]
    """Every pair, in order."""
    coverage: CornerCoverage
    """Where the corners were."""
    warp: WarpCheck
    """Whether the board is flat."""
    without_suspects: WithoutSuspects | None
    """What leaving the suspects out changes; None without any."""
    next_pose: NextPose | None
    """Where one more board does the most; None where no place was looked for."""
    remarks: tuple[Remark, ...]
    """What is odd."""
    interrupted: bool = False
    """Whether the search was ended before the last pair."""

    @property
    def rig(self) -> StereoRig:
        """The calibrated rig."""
        return self.fit.adjusted.rig

    @property
    def ratio(self) -> float:
        """Root mean square of the kept pictures' ratios: 1 for honest corners."""
        ratios = np.array([each.ratio for each in self.pictures if each.verdict in KEPT])
        return rms(ratios[np.isfinite(ratios)])

    @property
    def pair_count(self) -> int:
        """How many pairs count that show the board in both pictures."""
        return int((self.kept & self.sightings.cameras.all(axis=1)).sum())

    @property
    def suspects(self) -> tuple[PictureCheck, ...]:
        """Pairs that count, but are hardly as the others predict."""
        return tuple(each for each in self.pictures if each.verdict == "suspect")

    @property
    def bent(self) -> bool:
        """Whether the board is bent beyond doubt, and the rig does not count it."""
        return self.warp.clear and not self.asked.warp

    @property
    def verdict(self) -> PicturesVerdict:
        """Whether the pictures predict one another: flagged where one is left out as an outlier, or where all
        together are off by a quarter, and by more than any board is true to; suspect where one that counts is
        hardly predicted, or the board is bent beyond doubt; untold of fewer than three pairs."""
        ratio = self.ratio
        if not np.isfinite(ratio) or self.pair_count < _LEAST_TOLD:
            return "untold"
        fits = 1 / _MOST_RATIO < ratio < _MOST_RATIO or self.fit.noise_px < LEAST_OFF_PX
        if not fits or any(each.verdict == "outlier" for each in self.pictures):
            return "flagged"
        return "suspect" if self.suspects or self.bent else "agrees"

    @property
    def baseline_std_m(self) -> float:
        """Standard deviation of the baseline, m."""
        return baseline_std(self.covariance)
