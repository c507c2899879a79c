"""What `rigsim calibrate plan --json` prints and plan.json holds: the keys."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from rigsim.interop.documents.base import Part, RemarkPart, SeenRig, Written
from rigsim.interop.documents.calibrate.covariance import CovarianceDocument


class PlanBoard(Part):
    """The board."""

    text: str
    """As the command line has it: 9x6@30mm."""
    columns: int
    """Inner corners along its rows."""
    rows: int
    """Inner corners along its columns."""
    square_mm: float
    """Side of a square, mm."""


class PlanRequest(Part):
    """What was asked for."""

    poses: int | None
    """How many poses were to be chosen; null where they were given."""
    near_mm: float
    """Nearest that the board can be held, mm from the left camera."""
    far_mm: float
    """Farthest, mm."""
    tilt_deg: float
    """Most that it is turned out of the picture's plane, deg."""
    corner_noise_px: float
    """Standard deviation of one coordinate of a found corner, px."""
    noise_px: float
    """Standard deviation of one coordinate of a match when the rig measures, px."""
    flatness_mm: float
    """Standard deviation of each of the board's two warps, mm."""
    depth_error_mm: float | None
    """Largest depth std wanted, mm; null where none was."""
    at_m: float
    """Depth that it is wanted at, or that poses are chosen for, m."""
    lens_models: list[str | None]
    """Lens models of the left and the right camera that are estimated."""
    held: list[str]
    """Parameters that are not estimated."""
    seed: int
    """Of the random numbers."""


class PlanDepth(Part):
    """Depth std on the left optical axis."""

    z_m: float
    """Depth, m."""
    calibration_mm: float
    """From the calibration alone, against the boards, mm."""
    observation_mm: float
    """From the pixel noise of a match alone, mm."""
    joint_mm: float
    """From both, mm."""


class PlanDepthPlace(PlanDepth):
    """Depth std at one place of the picture."""

    place: Literal["axis", "edge", "corner"]
    """The left optical axis; half way down the shared part of the picture at its outer end; its corner."""
    calibration_from_camera_mm: float
    """From the calibration alone as the left camera counts it: where its lens's centre lies counts too."""


class PlanCurve(Part):
    """What so many pictures leave, at the depth that poses are chosen for, on the axis."""

    pictures: int
    """Pictures by each camera."""
    calibration_mm: float | None
    """From the calibration alone, with the plan's first so many poses, mm; null where they leave it open."""
    random_mm: float | None
    """The same with as many poses at random, the median of several draws, mm."""
    joint_mm: float | None
    """With the pixel noise of a match, of the plan's poses, mm."""


class PlanRemedy(Part):
    """One change of what was asked for, and the depth std with it and the most pictures."""

    change: Literal["tilt", "board", "range", "corner_noise", "flatness"]
    """A tilt of 45 deg, a board twice as large, half the nearest distance or corner noise, a flat board."""
    joint_mm: float
    """With the pixel noise of a match, mm."""


class PlanWitnessDepth(Part):
    """The depth error of one point over many calibrations, against the boards."""

    z_m: float
    """Depth on the left optical axis, m."""
    predicted_mm: float | None
    """Std that the covariance predicts, at the corner noise that was met, mm."""
    std_mm: float | None
    """Std over the calibrations, mm."""
    mean_mm: float | None
    """Mean error, mm: what a lens model that is too lean, or a warped board, leaves."""
    ratio: float | None
    """Std over predicted."""
    ratio_low: float | None
    """Lower end of its 95 % interval."""
    ratio_high: float | None
    """Upper end."""


class PlanTrueDepth(Part):
    """The depth error at the distance asked for with the lens and the board that are in the pictures."""

    z_m: float
    """Depth on the left optical axis, m."""
    mean_mm: float
    """Mean error, mm: no number of pictures lessens it."""
    rms_mm: float
    """Root mean square of the mean error, the calibrations' spread and the noise of a match, mm."""
    met: bool | None
    """Whether that meets the depth error wanted; null where none was wanted."""
    true_lens: str
    """Model of the true lens; empty where it is the plan's."""
    true_board: bool
    """Whether the true board is another than the plan's."""


class PlanWitness(Part):
    """Another witness of the plan: whole calibrations, simulated, or rendered and measured."""

    name: Literal["simulated", "measured"]
    """Whether corners had noise added, or were found in rendered pictures."""
    calibrations: int
    """How many were made."""
    failed: int
    """How many of them found no rig."""
    corner_noise_px: float | None
    """Std of one coordinate of a corner: drawn, or found against the truth, px."""
    rms_px: float | None
    """Median over the calibrations of the root mean square residual of one coordinate, px; OpenCV tells
    sqrt(2) times that."""
    misfit: float | None
    """Residuals over what corner noise alone leaves: 1 where the model can say what is true."""
    parameter_ratio: float | None
    """Spread of all parameters together over the predicted one; null where the model cannot say what is
    true."""
    parameter_ratio_low: float | None
    """Lower end of its 95 % interval."""
    parameter_ratio_high: float | None
    """Upper end."""
    boards: int
    """Places of the board that each was made from."""
    unfound: int
    """Pictures, of those of one calibration, in which no board was found."""
    by_opencv: bool
    """Whether OpenCV calibrated; else rigsim's own least squares did."""
    depths: list[PlanWitnessDepth]
    """One a distance."""
    agreement: Literal["agrees", "flagged", "untold"]
    """What it comes to."""
    says: str
    """Why; empty where it agrees."""


class PlanPose(Part):
    """Where the board is held for one picture."""

    left_from_board: list[float]
    """Rotation vector, rad, and translation, m: x_left = R x_board + t; six numbers."""
    seen: list[bool]
    """Whether the left and the right camera see the board whole."""
    distance_mm: float
    """From the left camera to the board's middle, mm."""
    across: float
    """Where its middle is in the picture of the left camera (the right one where that alone sees it): 0 left,
    1 right."""
    down: float
    """0 top, 1 bottom."""
    tilt_deg: float
    """How far it is turned out of the picture's plane, deg."""
    away: str
    """The edge or corner of the board that is farther away, as the picture shows it."""
    turn_deg: float
    """How far its rows are turned clockwise in the picture, deg."""
    says: str
    """All that in words."""


class PlanNext(PlanPose):
    """Where one more board does the most."""

    gain: float
    """Depth std from the calibration with it over the one without."""


class PlanParameter(Part):
    """One number that the calibration finds."""

    name: str
    """Its name: left.fx, right.k1, ry_rad, tx_m."""
    says: str
    """In words."""
    value: float
    """What it is in the rig."""
    std: float
    """Standard deviation."""
    unit: str
    """Of both; empty for a lens's coefficient."""


class PlanInseparable(Part):
    """Two parameters that the boards hardly tell apart."""

    first: str
    """Name of the one."""
    second: str
    """Name of the other."""
    correlation: float
    """Of their errors, -1 to 1."""


class PlanProjection(Part):
    """How sure a camera's projection is over its picture: std in the worst direction."""

    camera: Literal["left", "right"]
    """Whose picture."""
    distance_m: float | None
    """Of the points from that camera, m; null is infinitely far."""
    least_px: float | None
    """Where it is least, px."""
    median_px: float | None
    """Over half of the picture, px."""
    largest_px: float | None
    """Where it is most, px."""


class PlanDriftDepth(Part):
    """The depth error of one change at one distance."""

    z_m: float
    """Distance, m."""
    axis_mm: float
    """On the left optical axis, mm; positive is too far."""
    image_mm: float | None
    """Root mean square over the part of the image that both cameras see, mm; null where they share none."""


class PlanDrift(Part):
    """One change after the calibration, of a size that people meet; errors are in proportion to it."""

    cause: Literal["bar_warmer", "lenses_warmer", "knock", "refocus"]
    """The bar that holds the cameras is warmer; both lenses are; the right camera is turned; the right lens
    is focused anew."""
    amount: float
    """How large it is."""
    unit: str
    """Of the amount: K, deg, or % of the focal length."""
    source: str
    """Where the size comes from: aluminium, estimate, or a class of the tolerance study."""
    depths: list[PlanDriftDepth]
    """One a distance."""


class PlanDocument(Part):
    """A planned calibration: what its pictures leave of the depth, how many it takes, where to hold it."""

    command: str
    """What made it."""
    headline: str
    """The answer in one sentence, and in another what `true_depth` comes to."""
    sentences: list[str]
    """What else there is to say."""
    rig: SeenRig
    """The rig."""
    board: PlanBoard
    asked: PlanRequest
    depth_std: list[PlanDepth]
    """On the left optical axis, one row a distance."""
    depth_std_places: list[PlanDepthPlace]
    """The same at the axis, the edge and the corner of what both cameras see."""
    pictures: int
    """Pictures by each camera that all these numbers are for."""
    pictures_needed: int | None
    """The fewest that meet the depth error wanted; null where no number does, or none was wanted."""
    hindrance: Literal["", "observation", "tilt", "board", "range", "corner_noise", "flatness"]
    """What stands in its way: pixel noise alone, or the first of the remedies; empty where nothing does."""
    remedies: list[PlanRemedy]
    """What was tried where no number of pictures is enough, the most helpful first."""
    pictures_enough: int | None
    """The fewest whose calibration adds less than 5 % to what pixel noise makes; null where none of the curve
    does."""
    curve: list[PlanCurve]
    """How the depth follows the number of pictures."""
    best_first: bool
    """Whether the poses stand in the order in which they do most; false where they were given."""
    poses: list[PlanPose]
    """Where the board is held."""
    next_pose: PlanNext | None
    """Where one more does the most; null where no place can be reached."""
    parameters: list[PlanParameter]
    """What the calibration finds, and how well."""
    inseparable: list[PlanInseparable]
    """Pairs that are hardly told apart, the strongest first."""
    projection: list[PlanProjection]
    """At the depth that poses are chosen for, and infinitely far."""
    witnesses: list[PlanWitness]
    """Simulated and measured calibrations beside the prediction; empty without --verify."""
    true_depth: PlanTrueDepth | None
    """What the worst found of those that met another lens or board, or were off on average; null: none."""
    complete: bool
    """Whether all of them are there; false after Ctrl-C."""
    drift: list[PlanDrift]
    """What changes after the calibration, and is in none of these numbers."""
    covariance: CovarianceDocument
    """The joint covariance of all parameters: what `rigsim tolerance`, `design` and `sweep` read."""
    remarks: list[RemarkPart]
    """What is odd about it; also on standard error."""
    written: Written | None
    """The files; null without --out."""


class UndeterminedDocument(Part):
    """What `rigsim calibrate --json` prints instead when the boards leave the rig open; exit code 1."""

    error: str
    """Why, in one line, and the way out."""
    reason: str = Field(pattern="[a-z_]+")
    """The same for programs: no_tilt, one_pose, no_poses, middle, one_camera, open."""
