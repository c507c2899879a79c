"""How wrong a disparity map is, in the numbers stereo benchmarks print.

Every share is of the pixels whose true disparity is known in the region, and pixels without a
disparity count as invalid, not as bad (Middlebury's evaluation, version 3: bad and invalid add up).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidImage
from rigsim.rig.arrays import Array, Mask
from rigsim.statistics import nmad, rms

_LOCKING_LIMIT_PX = 1.0


@dataclass(frozen=True, slots=True)
class DisparityErrors:
    """Errors ``disparity - truth`` over one region; NaN where the region holds no pixel to judge."""

    n: int
    """Pixels whose truth is known."""
    invalid_pct: float
    """Share without a disparity, percent."""
    bad_0_5_pct: float
    """Share wrong by more than 0.5 px, percent."""
    bad_1_pct: float
    """Share wrong by more than 1 px, percent."""
    bad_2_pct: float
    """Share wrong by more than 2 px, percent."""
    bad_4_pct: float
    """Share wrong by more than 4 px, percent."""
    d1_pct: float
    """KITTI's D1: share wrong by more than 3 px and by more than 5 % of the true disparity, percent."""
    epe_px: float
    """Mean absolute error (end-point error), px."""
    rms_px: float
    """Root mean square error, px."""
    mean_px: float
    """Mean error, px: positive is too near."""
    median_abs_px: float
    """Median absolute error, px."""
    nmad_px: float
    """1.4826 times the median absolute deviation from the median error, px: a standard deviation that
    outliers do not move."""

    @property
    def fill_pct(self) -> float:
        """Share with a disparity, right or wrong, percent."""
        return 100.0 - self.invalid_pct


def disparity_errors(disparity: Array, truth: Array, region: Mask | None = None) -> DisparityErrors:
    """Compare a disparity map (H, W) with the true one (H, W), NaN unknown in both, over `region` (H, W).

    Raises:
        InvalidImage: their sizes differ.
    """
    check_same_shape(disparity, truth)
    judged = np.isfinite(truth) if region is None else np.isfinite(truth) & region
    n = int(judged.sum())
    error = (disparity - truth)[judged]
    true = truth[judged]
    known = np.isfinite(error)
    error, true = error[known], true[known]
    size = np.abs(error)

    def share(pixels: Mask) -> float:
        return 100.0 * float(pixels.sum()) / n if n else float("nan")

    empty = not len(error)
    return DisparityErrors(
        n=n,
        invalid_pct=share(~known),
        bad_0_5_pct=share(size > 0.5),
        bad_1_pct=share(size > 1.0),
        bad_2_pct=share(size > 2.0),
        bad_4_pct=share(size > 4.0),
        d1_pct=share((size > 3.0) & (size > 0.05 * np.abs(true))),
        epe_px=float("nan") if empty else float(size.mean()),
        rms_px=rms(size),
        mean_px=float("nan") if empty else float(error.mean()),
        median_abs_px=float("nan") if empty else float(np.median(size)),
        nmad_px=nmad(error),
    )


def errors_by_region(
    disparity: Array, truth: Array, regions: Mapping[str, Mask]
) -> dict[str, DisparityErrors]:
    """`disparity_errors` over each region of `rigsim.pixels.dense.regions.regions`."""
    return {name: disparity_errors(disparity, truth, region) for name, region in regions.items()}


@dataclass(frozen=True, slots=True, eq=False)
class PhaseErrors:
    """Errors against the fraction of a pixel; a matcher that locks to whole pixels shows a wave."""

    phase_px: Array
    """Middle of each bin of the disparity's fraction, (bins,), 0 to 1."""
    count: Array
    """Pixels whose true disparity falls into the bin, (bins,)."""
    mean_error_px: Array
    """Their mean error, (bins,), px; NaN where there are none."""
    measured_count: Array
    """Pixels whose measured disparity falls into the bin, (bins,): peaks at 0 are pixel locking."""
    amplitude_px: float
    """Amplitude of the sine of one period a pixel that fits the errors best, px."""


def phase_errors(
    disparity: Array, truth: Array, region: Mask | None = None, *, bins: int = 16
) -> PhaseErrors:
    """Mean error against the true disparity's fraction of a pixel, from two arrays of one shape.

    Errors beyond 1 px belong to wrong matches, not to interpolation, and are left out.

    Raises:
        InvalidImage: the shapes differ.
    """
    check_same_shape(disparity, truth)
    error = disparity - truth
    with np.errstate(invalid="ignore"):
        judged = np.abs(error) <= _LOCKING_LIMIT_PX
    if region is not None:
        judged &= region
    error, phase, measured = error[judged], truth[judged] % 1.0, disparity[judged] % 1.0

    def bin_of(fraction: Array) -> np.ndarray[tuple[int, ...], np.dtype[np.intp]]:
        return np.minimum((fraction * bins).astype(np.intp), bins - 1)

    count = np.bincount(bin_of(phase), minlength=bins).astype(np.float64)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.bincount(bin_of(phase), weights=error, minlength=bins) / count
    amplitude = float("nan")
    if len(error) >= 3:
        angle = 2 * np.pi * phase
        wave = np.stack([np.ones_like(angle), np.cos(angle), np.sin(angle)], axis=1)
        amplitude = float(np.hypot(*np.linalg.lstsq(wave, error, rcond=None)[0][1:]))
    return PhaseErrors(
        phase_px=(np.arange(bins) + 0.5) / bins,
        count=count,
        mean_error_px=mean,
        measured_count=np.bincount(bin_of(measured), minlength=bins).astype(np.float64),
        amplitude_px=amplitude,
    )


def check_same_shape(disparity: Array, truth: Array) -> None:
    """Check that a disparity and its truth belong together.

    Raises:
        InvalidImage: their shapes differ.
    """
    if disparity.shape != truth.shape:
        raise InvalidImage(
            f"truth of shape {truth.shape}: the disparity has {disparity.shape}; they must be of one size"
        )
