"""`StereoRig.figure`: a rig drawn from above."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from rigsim.api.rigs import RigLike, read_rig
from rigsim.rig.noise import as_noise, coordinate_noise_px
from rigsim.rig.quantity import NOISE_PX

if TYPE_CHECKING:
    from rigsim.present.kit.types import Figure


def rig_figure(
    rig: RigLike,
    points_left: npt.ArrayLike = (),
    *,
    noise_px: float | None = None,
    disparity_noise_px: float | None = None,
    title: str = "",
) -> Figure:
    """Draw a rig from above, with its views and the lines of equal predicted depth error.

    Args:
        rig: a rig, a preset's name, or a calibration's path or text.
        points_left: points (N, 3) m in the left camera's frame, with their lines of sight when few.
        noise_px: standard deviation of one pixel coordinate, px, for the lines; 0.25 unless said, 0 draws
            none.
        disparity_noise_px: standard deviation of a disparity, px, instead: sqrt(2) times as much.
        title: heading.

    Returns:
        A matplotlib Figure.

    Example:
        >>> import rigsim
        >>> figure = rigsim.rig_figure("oak-d", [[0, 0, 2.0]])
        >>> figure.axes[0].get_xlabel()
        'to the right, m'
    """
    from rigsim.present.kit.topdown import topdown_figure

    points = np.asarray(points_left, dtype=np.float64).reshape(-1, 3)
    said = coordinate_noise_px(noise_px, disparity_noise_px)
    noise = as_noise(NOISE_PX if said is None else said)
    return topdown_figure(read_rig(rig), points, noise=noise, rays=len(points) > 0, title=title)
