"""What `rigsim calibrate pictures --json` prints and calibration.json holds: the keys."""

from __future__ import annotations

from pydantic import Field

from rigsim.interop.documents.base import Part, RemarkPart, Written
from rigsim.interop.documents.calibrate.covariance import CovarianceCamera, CovarianceDocument
from rigsim.interop.documents.calibrate.plan_models import PlanDepth, PlanDepthPlace
from rigsim.study.calibrate.pictures.outliers import OddPairReason
from rigsim.study.calibrate.pictures.result import PicturesVerdict, PictureVerdict


class CalibratedCamera(CovarianceCamera):
    """One calibrated camera."""

    std: dict[str, float]
    """Standard deviation of each of its numbers: fx, fy, cx, cy (px) and its lens's coefficients; 0 where one
    was held."""
    coverage_pct: float
    """Share of its picture that corners reached, in cells of an eighth of the longer side, percent."""


class CalibratedPose(Part):
    """Where the right camera stands."""

    rotvec_deg: list[float]
    """Rotation vector of right_from_left, deg; three numbers."""
    t_mm: list[float]
    """Its translation, mm: x_right = R x_left + t."""
    rotvec_std_deg: list[float]
    """Standard deviation of a turn about the right camera's x, y and z axis, deg."""
    t_std_mm: list[float]
    """The same of the translation, mm."""


class CalibrationPicture(Part):
    """One pair of pictures."""

    name: str
    """What both files are called."""
    rms_px: float | None
    """Root mean square distance of its corners from where they should be, px; null without corners. An
    outlier's is with the others' rig."""
    leave_one_out_ratio: float | None
    """Its residual over what a rig calibrated from the others predicts for it: 1 for honest corners; null
    where the others leave the rig open."""
    verdict: PictureVerdict
    """good; suspect: counts, but is over 1.5 times as far off as the others predict; one_camera: counts for
    one camera, the other shows no board; outlier: left out, the others do not predict it; not_found,
    several, unreadable, duplicate: left out."""
    reason: OddPairReason
    """Why it is an outlier, or suspect: moved, mixed_up, hidden, blurred, bent, unexplained; empty where it
    is none."""
    says: str
    """The same in words; empty where there is nothing to say."""
    corners: list[int] = Field(min_length=2, max_length=2)
    """Corners found in the left and the right picture."""


class CalibrationWarp(Part):
    """Whether the board is flat."""

    rise_mm: list[float | None]
    """How far the middle of its sides along x and y rises over their ends, mm; null where corners do not
    tell."""
    std_mm: list[float | None]
    """Standard deviations, mm."""
    chance: float
    """How often a flat board looks as bent as this."""
    estimated: bool
    """Whether the rig counts it (--warp)."""


class CalibrationWithoutSuspects(Part):
    """The rig without the suspect pairs, against the one with them."""

    names: list[str]
    """The suspects."""
    baseline_mm: float
    """Baseline without them, mm."""
    baseline_shift_std: float
    """How far that is from the one with them, in the latter's standard deviations."""
    z_m: float
    """The middle one of the depths asked for, m."""
    depth_shift_mm: float
    """How much farther a point there, on the left optical axis, is without them, mm."""
    depth_shift_std: float
    """The same in the standard deviation that the calibration with them leaves in the left camera's frame."""
    calibration_mm: float
    """Depth std from the calibration there without them, mm."""
    beyond_chance: float
    """The larger of both shifts over the standard deviation that it has for honest pairs."""


class CalibrationNextPose(Part):
    """Where one more board does the most."""

    left_from_board: list[float]
    """Rotation vector, rad, and translation, m: x_left = R x_board + t; six numbers."""
    seen: list[bool]
    """Whether the left and the right camera see the board whole."""
    gain: float
    """Depth std from the calibration with it over the one without."""
    says: str
    """How the board is held, in words."""


class OpencvRig(Part):
    """What OpenCV's own calibration of the same pairs says."""

    rms_px: float
    """As cv2.stereoCalibrate returns it, px."""
    baseline_mm: float
    """Distance between the cameras, mm."""
    focal_px: list[float]
    """fx of the left and the right camera, px."""


class PicturesDocument(Part):
    """A rig calibrated from pictures, and how good it is."""

    command: str
    """What made it."""
    headline: str
    """The answer in one sentence."""
    verdict: PicturesVerdict
    """Whether the pictures predict one another: agrees; suspect: all but one that counts, or but for a board
    that is clearly bent; flagged: an outlier is left out, or all are off; untold: too few."""
    board: str
    """As the command line has it: 9x6@25mm."""
    model: str
    """The lens model."""
    held: list[str]
    """Parameters that were not estimated."""
    rms_px: float
    """Root mean square distance of a corner from where it should be, px, of the pairs that count."""
    corner_noise_px: float
    """Standard deviation of one coordinate of a corner that the residuals show, degrees of freedom counted,
    px. Every std here is at this noise."""
    claimed_noise_px: float | None
    """The same as the corners' own fits claim it; null where they claim nothing."""
    leave_one_out_ratio: float | None
    """Root mean square of the ratios of the pairs that count."""
    baseline_mm: float
    """Distance between the cameras, mm."""
    baseline_std_mm: float
    """Its standard deviation, mm."""
    left: CalibratedCamera
    right: CalibratedCamera
    right_from_left: CalibratedPose
    pictures: list[CalibrationPicture]
    """Every pair, in order."""
    depth_std: list[PlanDepth]
    """On the left optical axis, one row a distance."""
    depth_std_places: list[PlanDepthPlace]
    """The same at the axis, the edge and the corner of what both cameras see."""
    warp: CalibrationWarp
    opencv: OpencvRig
    without_suspects: CalibrationWithoutSuspects | None
    """What leaving the suspects out changes; null without any."""
    next_pose: CalibrationNextPose | None
    """null where no place can be reached."""
    covariance: CovarianceDocument
    """The joint covariance of all parameters: what `rigsim tolerance`, `design` and `sweep` read."""
    remarks: list[RemarkPart]
    """What is odd about it; also on standard error."""
    written: Written | None
    """The files; null without --out."""
