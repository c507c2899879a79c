"""Rigid transforms, named by what they map: `right_from_left` maps left to right."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidRig
from rigsim.rig.arrays import Array, frozen

_ORTHONORMAL_TOLERANCE = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """Maps a to b as ``x_b = R x_a + t``; hold it in a name ``b_from_a``.

    Example:
        >>> import rigsim
        >>> right_from_left = rigsim.Pose(t=[-0.1, 0, 0])  # the right camera is 100 mm to the right
        >>> right_from_left.apply([[0, 0, 2.0]]).tolist()
        [[-0.1, 0.0, 2.0]]
        >>> right_from_left.inverse.t.tolist()[0]
        0.1
    """

    R: Array = field(default_factory=lambda: np.eye(3))
    """Rotation, (3, 3)."""
    t: Array = field(default_factory=lambda: np.zeros(3))
    """Translation, (3,), m."""

    def __post_init__(self) -> None:
        try:
            R, t = frozen(self.R, (3, 3)), frozen(self.t, (3,))
        except (TypeError, ValueError) as error:
            raise InvalidRig(f"pose: R must be 3x3 and t must have 3 numbers ({error})") from None
        if not (np.isfinite(R).all() and np.isfinite(t).all()):
            raise InvalidRig("pose: every number of R and t must be finite")
        deviation = float(np.abs(R @ R.T - np.eye(3)).max())
        if deviation > _ORTHONORMAL_TOLERANCE or np.linalg.det(R) < 0:
            raise InvalidRig(
                f"pose: R is no rotation (|R R^T - 1| = {deviation:.2g}, det = {np.linalg.det(R):.3g}): "
                "rows must be orthonormal and right-handed"
            )
        object.__setattr__(self, "R", R)
        object.__setattr__(self, "t", t)

    @classmethod
    def from_rotvec(cls, rotvec_rad: npt.ArrayLike, t: npt.ArrayLike = (0.0, 0.0, 0.0)) -> Pose:
        """Pose of a rotation vector (axis times angle, rad) and a translation (m)."""
        try:
            turn = frozen(rotvec_rad, (3,))
        except (TypeError, ValueError):
            raise InvalidRig("pose: a rotation vector must have 3 numbers, rad") from None
        return cls(rotation_from_rotvec(turn), np.asarray(t))

    @property
    def inverse(self) -> Pose:
        """The pose that maps b back to a."""
        return Pose(self.R.T, -self.R.T @ self.t)

    @property
    def rotvec_rad(self) -> Array:
        """Rotation vector (axis times angle), (3,), rad."""
        return rotvec_from_rotation(self.R)

    def __matmul__(self, other: Pose) -> Pose:
        return Pose(self.R @ other.R, self.R @ other.t + self.t)

    def apply(self, points_a: npt.ArrayLike) -> Array:
        """Map points (..., 3) m from a to b."""
        return np.asarray(points_a, dtype=np.float64) @ self.R.T + self.t

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Pose):
            return NotImplemented
        return bool(np.array_equal(self.R, other.R) and np.array_equal(self.t, other.t))

    def __hash__(self) -> int:
        return hash((self.R.tobytes(), self.t.tobytes()))


def skew(vector: Array) -> Array:
    """The matrix ``[v]x`` with ``[v]x w = v x w``, (3, 3)."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def rotation_from_rotvec(rotvec_rad: Array) -> Array:
    """Rodrigues' formula: rotation (3, 3) of a rotation vector (3,), rad."""
    angle = float(np.linalg.norm(rotvec_rad))
    k = skew(rotvec_rad)
    # np.sinc keeps both factors finite and exact at angle 0
    a = np.sinc(angle / np.pi)
    b = 0.5 * np.sinc(angle / (2 * np.pi)) ** 2
    return np.asarray(np.eye(3) + a * k + b * (k @ k))


def rotvec_from_rotation(R: Array) -> Array:
    """Rotation vector (3,), rad, of a rotation (3, 3); the angle lies in [0, pi]."""
    # quaternion by Shepperd's method: stable at every angle, pi included
    trace = np.trace(R)
    candidates = np.array([trace, R[0, 0], R[1, 1], R[2, 2]])
    i = int(np.argmax(candidates))
    if i == 0:
        q = np.array([1 + trace, R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    else:
        j, k = i % 3, (i + 1) % 3
        i = i - 1
        q = np.empty(4)
        q[0] = R[k, j] - R[j, k]
        q[1 + i] = 1 + R[i, i] - R[j, j] - R[k, k]
        q[1 + j] = R[j, i] + R[i, j]
        q[1 + k] = R[k, i] + R[i, k]
    q /= np.linalg.norm(q)
    if q[0] < 0:
        q = -q
    sine = float(np.linalg.norm(q[1:]))
    if sine == 0.0:
        return np.zeros(3)
    return np.asarray(q[1:] * (2 * np.arctan2(sine, q[0]) / sine))
