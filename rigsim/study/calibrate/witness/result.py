"""What the other witnesses of a calibration say."""

from __future__ import annotations

from dataclasses import dataclass

from rigsim.study.agreement.agreement import Agreement


@dataclass(frozen=True, slots=True)
class WitnessedDepth:
    """The depth error of one point over many calibrations, against the boards."""

    z_m: float
    """Depth, m, on the left optical axis."""
    predicted_m: float
    """Standard deviation that the covariance predicts, at the corner noise that was met, m."""
    std_m: float
    """Standard deviation over the calibrations, m."""
    mean_m: float
    """Mean error, m: a lean model's, or a warped board's, lies here."""
    interval: tuple[float, float]
    """95 % of the ratio std over predicted."""

    @property
    def ratio(self) -> float:
        """Found over predicted."""
        return self.std_m / self.predicted_m if self.predicted_m > 0 else float("nan")


@dataclass(frozen=True, slots=True)
class CalibrationWitness:
    """One witness of a planned calibration."""

    name: str
    """``simulated`` or ``measured``."""
    calibrations: int
    """How many were made."""
    failed: int
    """How many of them did not settle, or found no rig."""
    corner_noise_px: float
    """Standard deviation of one coordinate of a corner: drawn, or found against the truth, px."""
    rms_px: float
    """Median over the calibrations of the root mean square residual of one coordinate, px: OpenCV's number
    for its user, which is of a corner's distance, is sqrt(2) times it."""
    misfit: float
    """Residuals over what noise alone would leave of them: 1 where the calibration's model can say what is
    true; more says that it cannot."""
    depths: tuple[WitnessedDepth, ...]
    """One a distance."""
    parameter_ratio: float
    """Spread of all parameters together, found over predicted, whitened by the covariance: of the same thing
    as the depths' ratios, and surer; NaN where the model cannot say what is true."""
    parameter_interval: tuple[float, float]
    """95 % of it; NaN likewise."""
    agreement: Agreement
    """What it comes to."""
    boards: int = 0
    """Places of the board that each calibration was made from."""
    unfound: int = 0
    """Pictures, of those of one calibration, in which the detector found no board."""
    true_lens: str = ""
    """Model of the lens in the pictures where it is another than the plan's; ``pinhole`` of none, empty
    where it is the plan's."""
    true_board: bool = False
    """Whether the board in the pictures is another than the plan's, as a warped one."""
    by_opencv: bool = False
    """Whether OpenCV calibrated; else rigsim's own least squares did."""
