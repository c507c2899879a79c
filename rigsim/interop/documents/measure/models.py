"""The parts of measure.json: what its keys mean. Keys stand in the order in which they are written."""

from __future__ import annotations

from typing import Literal, TypeAlias

from pydantic import Field

from rigsim.interop.documents.base import Part, Written
from rigsim.study.measure.result import FindingKind

RegionName: TypeAlias = Literal["all", "non-occluded", "occluded", "textureless", "near-discontinuity"]
WarningKey: TypeAlias = Literal[
    "few_matches",
    "not_rectified",
    "shift",
    "overconfident",
    "wrong_truth",
    "dense_shift",
    "dense_not_judged",
    "no_patches",
    "scale",
]
VerdictKey: TypeAlias = Literal["rows_fit", "rows_untold", "not_rectified", "along_rows", "scale"]


class BelievedRig(Part):
    """The rig that the pair was measured with."""

    width_px: int = Field(gt=0)
    """Image width, px."""
    height_px: int = Field(gt=0)
    """Image height, px."""
    focal_px: float = Field(gt=0)
    """Focal length of the left camera, px."""
    baseline_mm: float = Field(gt=0)
    """Distance between the cameras, mm."""
    doffs_px: float
    """``cx_right - cx_left``, px."""
    rectified: bool
    """Whether it is rectified."""


class Wrong(Part):
    """Errors ``disparity - truth``; null without a truth."""

    bad_0_5_pct: float | None
    """Share wrong by more than 0.5 px, percent."""
    bad_1_pct: float | None
    """Share wrong by more than 1 px, percent."""
    bad_2_pct: float | None
    """Share wrong by more than 2 px, percent."""
    bad_4_pct: float | None
    """Share wrong by more than 4 px, percent."""
    d1_pct: float | None
    """KITTI's D1: share wrong by more than 3 px and more than 5 % of the true disparity, percent."""
    epe_px: float | None
    """Mean absolute error, px."""
    rms_px: float | None
    """Root mean square error, px."""
    mean_px: float | None
    """Mean error, px: positive is too near."""
    median_abs_px: float | None
    """Median absolute error, px."""
    nmad_px: float | None
    """1.4826 times the median absolute deviation from the median error, px."""


class Judged(Part):
    """How many pixels of a region are judged."""

    n: int | None
    """Pixels with ground truth."""
    invalid_pct: float | None
    """Share of them without a disparity, percent."""


class Region(Wrong, Judged):
    """Errors of the dense disparities over one region."""

    fill_pct: float | None
    """Share of them with a disparity, percent; without a truth, of all pixels."""


class Found(Part):
    """How many matches there are, and what they claim."""

    n: int
    """How many there are."""
    n_tried: int
    """How many points were looked for."""
    valid_pct: float
    """The one as a share of the other, percent."""
    epipolar_rms_px: float | None
    """RMS distance from the epipolar line, px; null where no match tells."""
    predicted_std_px: float | None
    """Median standard deviation that the matches claim for their disparity, px."""
    predicted_rms_px: float | None
    """Root mean square of it, px."""
    noise_px: float | None
    """The --noise that their disparities correspond to, px."""
    depth_median_mm: float | None
    """Median depth, mm."""
    predicted_depth_std_mm: float | None
    """Median standard deviation that they claim for their depth, mm."""
    n_truth: int | None
    """Matches whose truth is known; null without a truth."""


class Matches(Wrong, Found):
    """Trusted matches of one kind."""

    outlier_pct: float | None
    """Share more than 3 px off, percent."""
    inlier_std_px: float | None
    """Standard deviation of the errors of the others, px."""
    within_3_std_pct: float | None
    """Share within three of the standard deviations that they claim, percent."""


class Board(Part):
    """One checker board's own consistency; no truth is needed."""

    board: int
    """Which board, counted from the left."""
    n: int
    """Corners found in both pictures."""
    distance_mm: float | None
    """Median depth, mm."""
    square_mm: float | None
    """Mean distance of neighbouring corners, mm."""
    square_std_mm: float | None
    """Its standard deviation, mm."""
    flatness_rms_mm: float | None
    """RMS distance from the plane that fits best, mm."""


class Corners(Matches):
    """Board corners."""

    boards: list[Board]
    """Each board by itself."""


class Phase(Part):
    """Dense errors against the fraction of a pixel, in 16 bins."""

    amplitude_px: float | None
    """Amplitude of the sine of one period a pixel that fits the errors best, px."""
    phase_px: list[float]
    """Middle of each bin, px."""
    mean_error_px: list[float | None]
    """Mean error in it, px."""
    count: list[int]
    """Pixels whose true disparity falls into it."""
    measured_count: list[int]
    """Pixels whose measured disparity falls into it."""


class DenseDepth(Part):
    """Dense errors as depths."""

    z_accuracy_pct: float | None
    """Median of depth minus true depth over true depth, percent; positive is too far."""
    rms_mm: float | None
    """RMS depth error without 0.5 % at either end, mm."""
    rms_pct: float | None
    """The same for errors over true depth, percent."""


class Matched(Part):
    """Who found the dense disparities, and how many."""

    matcher: str
    """Who found it."""
    rectified_first: bool
    """Whether the pictures had to be rectified first."""
    view: str
    """Whose rows they are: a perspective picture's, or half planes about the baseline: cylinder, latlong."""
    image_fill_pct: float
    """Share of all pixels with a disparity, percent."""


class Dense(Region, Matched):
    """A disparity for every pixel."""

    inlier_std_px: float | None
    """Standard deviation of the errors of at most 3 px, px."""
    noise_px: float | None
    """The --noise that this corresponds to, px."""
    regions: dict[RegionName, Region] | None
    """Errors by Middlebury's region; null without a truth."""
    phase: Phase | None
    """Null without a truth."""
    depth: DenseDepth | None
    """Null without a truth."""


class Target(Part):
    """A flat target judged as the Depth Quality Tool does."""

    pixels: tuple[int, int, int, int]
    """First column, first row, width and height."""
    fill_rate_pct: float | None
    """Share of its pixels with a depth, percent."""
    distance_mm: float | None
    """Depth at which the plane meets the middle of the picture, mm."""
    plane_fit_rms_mm: float | None
    """RMS distance from the plane, mm."""
    plane_fit_rms_pct: float | None
    """The same as a share of the distance, percent."""
    subpixel_rms_px: float | None
    """RMS disparity error against the plane, px."""
    z_accuracy_pct: float | None
    """Median error against the true distance, percent; null without a truth."""


class Warned(Part):
    """Something that should make one doubt the numbers."""

    key: WarningKey
    """What it is."""
    says: str
    """The same in a sentence or two."""
    kind: FindingKind
    """Whether it was found wrong, or could not be told."""


class Verdict(Part):
    """What was concluded of one question."""

    key: VerdictKey
    """Its reason: rows_* and not_rectified of the rows, along_rows and scale of what rows cannot tell."""
    says: str
    """The same in a sentence or two, with numbers."""
    kind: FindingKind
    """untold: not enough to tell."""


class MeasureDocument(Part):
    """What the pixels of a pair say."""

    n_matches: int
    """Trusted matches, corners included."""
    epipolar_rms_px: float | None
    """Residual of the patches (of the corners without any), px."""
    epipolar_median_px: float | None
    """Its median, px; positive is too low in the right picture."""
    rig: BelievedRig
    patches: Matches | None
    """Matched patches; null when there are none, which warnings say."""
    corners: Corners | None
    """Board corners; null without --board."""
    dense: Dense | None
    """Null with --no-dense."""
    target: Target | None
    """Null without --target."""
    verdicts: list[Verdict]
    """Whether the rows fit, and whether what rows cannot tell is right."""
    warnings: list[Warned]
    """What should make one doubt the numbers."""
    written: Written | None
    """Pictures, points and tables; null without --out."""
