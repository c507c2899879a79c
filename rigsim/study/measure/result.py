"""What `rigsim.study.measure.run` hands to those who print and write it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from rigsim.pixels.dense.quality import DepthQuality
from rigsim.pixels.dense.views import RowView
from rigsim.rig.arrays import AnyImage, Array, Ids, Image, Mask
from rigsim.rig.stereo import StereoRig
from rigsim.statistics import rms
from rigsim.study.measure.truth import DenseErrors, MatchErrors

_SHIFT_PX = 0.1
_TILT_PX = 0.15
_CERTAIN = 5.0

Target = tuple[int, int, int, int]
"""A rectangle of pixels: first column, first row, width and height."""


@dataclass(frozen=True, slots=True)
class RowFit:
    """Residuals of matches fitted by ``shift + turn u + growth v`` about their middle."""

    n: int
    """Matches that tell."""
    shift_px: float
    """Mean residual, px; positive is too low in the right picture."""
    shift_se_px: float
    """Its standard error, px."""
    turn: float
    """Change along the row, px/px, which is an angle in radians; positive is clockwise."""
    growth: float
    """Change along the column, px/px; positive is larger in the right picture."""
    half_width_px: float
    """Half of the matches' extent along the row, px."""
    half_height_px: float
    """Half of their extent along the column, px."""
    middle_px: tuple[float, float] = (0.0, 0.0)
    """Their middle in the right picture, px."""

    def shift_at_px(self, u: float, v: float) -> float:
        """The shift at a place of the right picture, px."""
        return self.shift_px + self.turn * (u - self.middle_px[0]) + self.growth * (v - self.middle_px[1])

    @property
    def tilt_limit_px(self) -> float:
        """The turn or growth at the matches' border that is taken for one, px."""
        return max(_TILT_PX, _CERTAIN * math.sqrt(3) * self.shift_se_px)

    @property
    def is_shifted(self) -> bool:
        """Whether the shift is more than chance and more than nothing."""
        return abs(self.shift_px) > self.shift_limit_px

    @property
    def shift_limit_px(self) -> float:
        """What a shift is more than when it is more than chance and more than nothing, px."""
        return max(_SHIFT_PX, _CERTAIN * self.shift_se_px)

    @property
    def is_tilted(self) -> bool:
        """Whether the right picture is turned."""
        return abs(self.turn) * self.half_width_px > self.tilt_limit_px

    @property
    def is_scaled(self) -> bool:
        """Whether the right picture is larger or smaller."""
        return abs(self.growth) * self.half_height_px > self.tilt_limit_px


FindingKind = Literal["agrees", "flagged", "untold"]


@dataclass(frozen=True, slots=True)
class Finding:
    """What was concluded of one question, and the numbers behind it."""

    key: str
    """Its reason, a name for machines."""
    form: str
    """Which of its forms, likewise: `rigsim.present.measure.words` has a sentence for each."""
    kind: FindingKind = "flagged"
    """agrees, flagged (something should make one doubt the numbers), or untold: not enough to tell."""
    numbers: Mapping[str, float] = field(default_factory=dict)
    """What it goes by, units in the names."""
    of: str = ""
    """What was matched, patches or corners; or the reason why nothing was."""
    rows: RowFit | None = None
    """The residuals that tell of the rows."""


@dataclass(frozen=True, slots=True, eq=False)
class PairMatches:
    """Trusted matches of one kind; one row a match."""

    kind: str
    """patches or corners."""
    n_tried: int
    """How many points were looked for."""
    uv_left: Array
    """Position in the left picture, (N, 2), px."""
    uv_right: Array
    """Position in the right picture, (N, 2), px."""
    disparity_std_px: Array
    """Predicted standard deviation of the disparity, (N,), px."""
    epipolar_px: Array
    """How far below its epipolar line the match lies, (N,), px; NaN where the patch does not tell."""
    score: Array
    """Correlation of the patches, -1 to 1, (N,); NaN for corners."""
    points_left: Array
    """Triangulated, (N, 3), m; NaN where the rays do not meet in front of both cameras."""
    depth_std_m: Array
    """Predicted standard deviation of the depth, (N,), m."""
    board: Ids
    """Which board, (N,), counted from the left; -1 for patches."""
    corner: Ids
    """Which corner of its board, (N,), row-major; -1 for patches."""
    truth_px: Array
    """True disparity there, (N,), px; NaN where it is not known."""
    depth_error_m: Array
    """Depth minus the depth that the true disparity gives, (N,), m; NaN where it is not known."""
    errors: MatchErrors | None
    """How wrong the disparities are; None without a truth."""

    @property
    def n(self) -> int:
        """How many matches there are."""
        return len(self.uv_left)

    @property
    def disparity_px(self) -> Array:
        """``u_left - u_right`` of the pictures as they are, (N,), px."""
        return np.asarray(self.uv_left[:, 0] - self.uv_right[:, 0])

    @property
    def epipolar_rms_px(self) -> float:
        """Root mean square of `epipolar_px`; NaN when no match tells."""
        known = self.epipolar_px[np.isfinite(self.epipolar_px)]
        return rms(known)

    @property
    def epipolar_median_px(self) -> float:
        """Median of `epipolar_px`; NaN when no match tells."""
        known = self.epipolar_px[np.isfinite(self.epipolar_px)]
        return float(np.median(known)) if len(known) else math.nan

    @property
    def epipolar_typical_px(self) -> float:
        """Median of the absolute `epipolar_px`, which wrong matches do not move; NaN when no match tells."""
        known = self.epipolar_px[np.isfinite(self.epipolar_px)]
        return float(np.median(np.abs(known))) if len(known) else math.nan

    @property
    def predicted_std_px(self) -> float:
        """Median of `disparity_std_px`."""
        return float(np.median(self.disparity_std_px))

    @property
    def noise_px(self) -> float:
        """The noise of one pixel coordinate that makes disparities as uncertain as these are, px: from their
        scatter about the truth (outliers of 3 px left out) when there is one, else from what is predicted."""
        known = self.errors is not None and self.errors.inlier_std_px > 0
        std = self.errors.inlier_std_px if self.errors is not None and known else self.predicted_rms_px
        return std / math.sqrt(2)

    @property
    def predicted_rms_px(self) -> float:
        """Root mean square of `disparity_std_px`."""
        return rms(self.disparity_std_px)


@dataclass(frozen=True, slots=True)
class BoardFit:
    """What triangulated corners of one board say about themselves: no truth is needed."""

    board: int
    """Which board, counted from the left."""
    n: int
    """Corners found in both pictures."""
    distance_m: float
    """Median depth of the corners, m."""
    square_m: float
    """Mean distance of neighbouring corners, m: compare it with a ruler."""
    square_std_m: float
    """Its standard deviation from corner to corner, m."""
    flatness_rms_m: float
    """RMS distance from the plane that fits best, m."""


@dataclass(frozen=True, slots=True, eq=False)
class DenseMap:
    """A disparity for every pixel of the rectified left picture."""

    matcher: str
    """Who found it."""
    disparity: Array
    """``u_left - u_right``, (H, W), px; NaN unknown."""
    rig: StereoRig
    """The rectified rig it belongs to: the one given, unless that is not rectified."""
    rectified: bool
    """Whether the pictures had to be rectified first."""
    view: RowView
    """What they were rectified to: rows of a perspective picture, or half planes about the baseline."""
    image_left: AnyImage
    """Left picture on the disparity's pixels."""
    image_right: AnyImage
    """Right picture, rectified like the left one."""
    left_from_rectified: Array
    """Rotation (3, 3) from the frame of `rig`'s left camera to the left camera as it is."""
    errors: DenseErrors | None
    """How wrong the disparities are; None without a truth for these pixels."""

    @property
    def image_fill_pct(self) -> float:
        """Share of all pixels with a disparity, percent."""
        return 100.0 * float(np.isfinite(self.disparity).mean())

    def points_left(self) -> tuple[Array, Mask]:
        """Points (N, 3) m of the left camera's frame, and the pixels (H, W) they belong to."""
        if self.view != "perspective":
            return self._points_about_baseline()
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = self.rig.left.fx * self.rig.baseline_m / (self.disparity + self.rig.doffs_px)
            known = np.asarray(np.isfinite(depth) & (depth > 0), dtype=np.bool_)
        v, u = np.nonzero(known)
        xy = self.rig.left.normalize(np.column_stack([u, v]))
        points = np.column_stack([xy, np.ones(len(xy))]) * depth[known][:, None]
        return points @ self.left_from_rectified.T, known

    def _points_about_baseline(self) -> tuple[Array, Mask]:
        """As `points_left`, where the two pixels' rays lie in one half plane through the baseline.

        They meet at a distance ``b / (tan a_left - tan a_right)`` from it, a the angles from across it.
        """
        v, u = np.nonzero(np.isfinite(self.disparity))
        found = self.disparity[v, u]
        ray, other = (
            camera.ray(np.column_stack([column, v]))
            for camera, column in ((self.rig.left, u), (self.rig.right, u - found))
        )
        off = np.hypot(ray[:, 1], ray[:, 2])
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = self.rig.baseline_m / (
                ray[:, 0] / off - other[:, 0] / np.hypot(other[:, 1], other[:, 2])
            )
        meets = np.isfinite(distance) & (distance > 0)
        known = np.zeros(self.disparity.shape, dtype=np.bool_)
        known[v[meets], u[meets]] = True
        points = ray[meets] * (distance / off)[meets, None]
        return points @ self.left_from_rectified.T, known


@dataclass(frozen=True, slots=True, eq=False)
class PairMeasurement:
    """All that was measured of one pair."""

    rig: StereoRig
    """The calibration that was believed."""
    image_left: AnyImage
    """Left picture as it was given."""
    image_right: AnyImage
    """Right picture as it was given."""
    patches: PairMatches | None
    """Matched patches; None when there were none, which `findings` then says."""
    corners: PairMatches | None
    """Board corners; None when none were asked for."""
    boards: tuple[BoardFit, ...]
    """Each board's own consistency."""
    dense: DenseMap | None
    """Dense disparities; None when none were asked for."""
    truth: Array | None
    """True disparity, (H, W), px; NaN unknown."""
    target: Target | None
    """Pixels of a flat target."""
    target_quality: DepthQuality | None
    """Dense disparities of the target judged as the Depth Quality Tool does."""
    findings: tuple[Finding, ...] = ()
    """What should make one doubt the numbers."""
    verdicts: tuple[Finding, ...] = ()
    """Whether rows correspond as the rig says, and whether what rows cannot tell is right."""
    provenance: dict[str, object] = field(default_factory=dict)
    """Where pictures and numbers come from: JSON values only."""

    @property
    def matches(self) -> tuple[PairMatches, ...]:
        """Patches and corners, those that were measured."""
        return tuple(matches for matches in (self.patches, self.corners) if matches is not None)

    @property
    def best_matches(self) -> PairMatches:
        """The patches; the corners when there are no patches."""
        return self.matches[0]


def eight_bit(image: AnyImage) -> Image:
    """A picture of any type as one to look at, (H, W, 3); floats are taken for 0 to 255, or to their
    brightest pixel."""
    largest = float(np.iinfo(image.dtype).max) if image.dtype.kind == "u" else max(255.0, float(image.max()))
    levels = np.clip(np.round(image * (255.0 / largest)), 0, 255).astype(np.uint8)
    if levels.ndim == 2 or levels.shape[2] == 1:
        return np.repeat(levels.reshape(*levels.shape[:2], 1), 3, axis=2)
    return levels[..., :3]
