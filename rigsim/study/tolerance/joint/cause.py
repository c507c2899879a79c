"""A calibration as a cause of error: its parameters are off together, as its covariance says."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig
from rigsim.theory.calibration.covariance import CalibrationCovariance, pixel_slopes
from rigsim.theory.calibration.parameters import RigParameters

CALIBRATION = "calibration"
"""Key of the quantity that a calibration is among all that is off."""
_SAME = 1e-6
"""By which numbers of one rig may differ that went through files of text."""


@dataclass(frozen=True, slots=True, eq=False)
class CalibrationTolerance:
    """What a calibration leaves of a rig, in place of a class of tolerances."""

    name: str
    """What people call it: its file's name."""
    source: str
    """What it comes from, in a few words."""
    covariance: CalibrationCovariance
    """The joint covariance of all that it found."""

    def cause(self, rig: StereoRig) -> JointCause:
        """What it does to `rig`.

        Raises:
            InvalidRig: it is the calibration of another rig.
        """
        check_rig(self.covariance.rig, rig, self.name)
        # a calibration is too large by what the true rig is too small
        covariance = self.covariance.of_rig
        std = np.sqrt(np.diagonal(covariance))
        scale = np.divide(1.0, std, out=np.zeros_like(std), where=std > 0)
        values, vectors = np.linalg.eigh(covariance * scale[:, None] * scale)
        factor = -(vectors * np.sqrt(np.maximum(values, 0.0))).T * std
        return JointCause(self.covariance.parameters, factor[values > 0])


@dataclass(frozen=True, slots=True, eq=False)
class JointCause:
    """Parameters of a rig that are off together: sums of independent normal numbers."""

    parameters: RigParameters
    """What they are."""
    factor: Array
    """Change (r, p) of the true rig's parameters per unit of each of r normal numbers."""

    def drawn(self, latent: Array) -> JointDraw:
        """Rigs by their normal numbers (n, r)."""
        return JointDraw(self.parameters, latent @ self.factor)

    def pixel_moves(self, rig: StereoRig, points: Array) -> Array:
        """Move (m, 4, r) px of (u_left, v_left, u_right, v_right) of points (m, 3) m per unit of each."""
        return np.asarray(pixel_slopes(rig, self.parameters, points) @ self.factor.T)


@dataclass(frozen=True, slots=True, eq=False)
class JointDraw:
    """Rigs whose parameters are off together."""

    parameters: RigParameters
    """What the columns of `changes` are."""
    changes: Array
    """By which the true rigs' parameters are greater, (n, p)."""

    def chosen(self, which: slice) -> JointDraw:
        """Some of them."""
        return JointDraw(self.parameters, self.changes[which])


def check_rig(of: StereoRig, rig: StereoRig, name: str) -> None:
    """Refuse a calibration `of` another rig.

    Raises:
        InvalidRig: the two differ by more than files of text round.
    """
    if is_same(of, rig):
        return
    raise InvalidRig(
        f"{name}: is the calibration of another rig ({_short(of)}, not {_short(rig)}): leave the rig out,"
        " which takes the calibrated one, or calibrate this one"
    )


def is_same(one: StereoRig, other: StereoRig) -> bool:
    """Whether two rigs are the same but for what files of text round."""
    cameras = zip((one.left, one.right), (other.left, other.right), strict=True)
    poses = one.right_from_left, other.right_from_left
    return (
        all(_same_camera(a, b) for a, b in cameras)
        and np.allclose(poses[0].R, poses[1].R, rtol=0, atol=_SAME)
        and np.allclose(poses[0].t, poses[1].t, rtol=0, atol=_SAME * one.baseline_m)
    )


def _same_camera(one: Intrinsics, other: Intrinsics) -> bool:
    if (one.width, one.height, type(one.lens)) != (other.width, other.height, type(other.lens)):
        return False
    off_px = np.array([one.fx - other.fx, one.fy - other.fy, one.cx - other.cx, one.cy - other.cy])
    off_lens = [
        getattr(one.lens, name) - getattr(other.lens, name) for name in (one.lens.names() if one.lens else ())
    ]
    return bool(np.abs(off_px).max() <= _SAME * one.fx) and all(abs(off) <= _SAME for off in off_lens)


def _short(rig: StereoRig) -> str:
    return f"{rig.left.width}x{rig.left.height} px, f {rig.left.fx:.4g} px, {rig.baseline_m * 1e3:.4g} mm"
