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
    """Median root mean square residual of the calibrations, as their user sees it, px."""
    depths: tuple[WitnessedDepth, ...]
    """One a distance."""
    agreement: Agreement
    """What it comes to."""
