"""What a calibration leaves of a disparity, and how it is carried over to rigs of another size.

Everything that a calibration leaves moves pixels. Scale a rig, its boards and their distances by the same
factor, and the pixels and what corners' noise leaves of them stay: an error of so many px at a distance of so
many baselines. Likewise with more pixels across the same field of view, as corners are found to so many px.
So the disparity error of one calibrated rig, by distance over baseline, is that of a rig of any size whose
calibration pictures look the same. A depth follows from a disparity as ever, ``Z^2 / (f B)`` of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array


@dataclass(frozen=True, slots=True, eq=False)
class CalibrationDisparity:
    """Standard deviation of a disparity from the calibration alone, by distance."""

    baselines: Array
    """Distances over the baseline, (n,), growing."""
    std_px: Array
    """What is left there, root mean square over the image, (n,) px."""

    def at(self, baselines: float) -> float:
        """The standard deviation, px, at a distance of so many baselines.

        Interpolated; beyond the farthest it stays, and nearer than the nearest it goes with one over the
        distance, as what a length leaves does.
        """
        if baselines < self.baselines[0]:
            return float(self.std_px[0] * self.baselines[0] / baselines)
        return float(np.interp(np.log(baselines), np.log(self.baselines), self.std_px))
