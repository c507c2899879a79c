"""What each board does to the variance of a depth on the axis, and of two farther out in the picture.

A depth's error is ``c^T e + mean_i(g_i^T e + own_i)`` in the free parameters' errors e: c is how the
triangulated point moves, g_i and own_i how the frame of the boards follows the parameters and board i's own
noise (`CalibrationCovariance`). With A the sum of what the boards tell (A_i) its variance is
``(c + mean g)^T A^-1 (c + mean g) + sum s_i / n^2``, s_i that of own_i; a board's two warps that nobody
knows add ``f^2 |(c + mean g)^T A^-1 sum b_i + mean h_i|^2`` (`theory.calibration.flatness`). That does not
count where poses are chosen: some make it cancel, but nobody holds a board as exactly as that.
Everything is a sum over boards: what one more, or another one, does is a matter of adding.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array
from rigsim.study.calibrate.depths import PLACES, point_at
from rigsim.study.calibrate.plan.asked import PlanAsked
from rigsim.study.calibrate.plan.reach import ReachedPoses
from rigsim.theory.calibration.boards import Chosen
from rigsim.theory.calibration.covariance import CalibrationCovariance, about_camera
from rigsim.theory.calibration.flatness import with_warps, without_warps
from rigsim.theory.calibration.information import BoardInformation, board_information
from rigsim.theory.calibration.parameters import CAMERA

_TURN_RAD, _FOCAL, _PRINCIPAL, _BASELINE = 0.3, 0.3, 0.2, 1.0
"""Prior of what is not known yet: shares of the focal length, the picture's width, the baseline."""
_NEXT_TO_NOTHING, _TOLD = 1e-5, 0.05
"""A prior that is as much weaker may change a variance by that share, or boards leave it open."""
_OUTER = 0.3
"""What the depths at the edge and in the corner of the picture count beside the one on the axis: boards that
were chosen for the axis alone leave the rest of the picture to chance."""


@dataclass(frozen=True, slots=True, eq=False)
class Sums:
    """Sums over boards of their terms; or single boards' terms, with leading axes (k,)."""

    A: Array
    """Information (..., q, q), each free parameter in its own measure."""
    g: Array
    """(..., k, q), of k depths."""
    s: Array
    """(..., k) m^2."""
    b: Array
    """(..., q, 2)."""
    h: Array
    """(..., k, 2)."""
    n: Array
    """How many boards, (...,)."""

    def plus(self, other: Sums) -> Sums:
        """Both."""
        return self._combined(other, 1.0)

    def minus(self, other: Sums) -> Sums:
        """Without those."""
        return self._combined(other, -1.0)

    def chosen(self, which: Chosen | list[int] | int) -> Sums:
        """Those of some boards."""
        index = np.array(which, dtype=np.intp) if isinstance(which, list) else which
        return Sums(*(np.asarray(getattr(self, name)[index]) for name in self.__slots__))

    def total(self) -> Sums:
        """The sum over the first axis."""
        return Sums(*(np.asarray(getattr(self, name).sum(axis=0)) for name in self.__slots__))

    def running(self) -> Sums:
        """The sums of the first one, two, ..."""
        return Sums(*(np.asarray(getattr(self, name).cumsum(axis=0)) for name in self.__slots__))

    def times(self, often: float) -> Sums:
        """Each board as often."""
        return Sums(*(np.asarray(often * getattr(self, name)) for name in self.__slots__))

    def _combined(self, other: Sums, sign: float) -> Sums:
        return Sums(*(getattr(self, name) + sign * getattr(other, name) for name in self.__slots__))


@dataclass(frozen=True, slots=True, eq=False)
class DepthTerms:
    """The variance of one depth as a function of which boards are held."""

    boards: Sums
    """Of each candidate."""
    c: Array
    """How the triangulated depths move, (k, q) m in each free parameter's own measure; the first is on the
    axis."""
    weights: Array
    """What a variance of each depth counts, (k,) 1/m^2."""
    known: Array
    """Diagonal (q,) of the information there was beforehand: of a warp that is looked for."""
    prior: Array
    """Diagonal (q,) of a weak information that holds up what few boards leave open."""
    flatness_m: float
    """Standard deviation of the warps that nobody looks for; 0 if they are looked for."""
    measure: Array
    """Free parameters, each in its own measure, as parameters of the rig (p, q)."""
    frame: Array
    """How the depths follow the frame of the boards (k, 6)."""

    def axis_noise(self, sums: Sums) -> Array:
        """Variance (...,) m^2 of the depth on the axis from the corners' noise alone; infinite where the
        boards leave something open."""
        return self.noise(sums)[..., 0]

    def loss(self, sums: Sums) -> Array:
        """What is to be small (...,): the variances by the corners' noise, by their weights, with the
        prior."""
        return np.asarray(self._solved(sums, self.prior)[0] @ self.weights)

    def variances(self, sums: Sums) -> Array:
        """Variances (..., k) m^2 with the boards of `sums`, exactly where they are; infinite where they leave
        something open."""
        return np.asarray(self.noise(sums) + self.astray(sums))

    def noise(self, sums: Sums) -> Array:
        """What the corners' noise does to them (..., k) m^2; infinite where the boards leave something
        open."""
        with_prior, found = (
            self._solved(sums, prior)[0] for prior in (self.prior, _NEXT_TO_NOTHING * self.prior)
        )
        # what boards tell does not hang on what was known before
        told = np.abs(with_prior - found) <= _TOLD * found
        return np.where(told, found, np.inf)

    def astray(self, sums: Sums) -> Array:
        """What warps do that nobody looks for (..., k) m^2; 0 where there are none."""
        return self._solved(sums, _NEXT_TO_NOTHING * self.prior)[1]

    def _solved(self, sums: Sums, prior: Array) -> tuple[Array, Array]:
        """Variances (..., k) by the corners' noise, and by the warps."""
        A, n = sums.A + np.diag(self.known + prior), np.maximum(sums.n, 1)
        size = 1 / np.sqrt(np.einsum("...ii->...i", A))
        v = (self.c + sums.g / n[..., None, None]) * size[..., None, :]
        x = np.linalg.solve(A * size[..., None] * size[..., None, :], np.swapaxes(v, -1, -2))
        found = np.einsum("...kq,...qk->...k", v, x) + sums.s / n[..., None] ** 2
        if not self.flatness_m:
            return np.asarray(found), np.zeros_like(found)
        astray = np.swapaxes(x * size[..., None], -1, -2) @ sums.b + sums.h / n[..., None, None]
        return np.asarray(found), np.asarray(self.flatness_m**2 * np.sum(astray**2, axis=-1))


def depth_terms(asked: PlanAsked, reached: ReachedPoses, z_m: float) -> DepthTerms:
    """The terms of every pose that was reached, for depths on the left axis and farther out.

    Raises:
        InvalidRange: no rig like this sees the point.
    """
    rig, parameters = asked.rig, asked.parameters
    basis = parameters.basis(rig)
    empty = np.zeros((len(parameters.names) + 6,) * 2)
    nothing = CalibrationCovariance(rig, parameters, empty)
    moves = nothing.point_moves([point_at(nothing, z_m, place) for place in PLACES])[:, 2]
    moves = moves[np.isfinite(moves).all(axis=1) | (np.arange(len(moves)) == 0)]
    if not np.isfinite(moves[0]).all():
        raise InvalidRange(
            f"depth {z_m * 1e3:g} mm: the cameras do not both see the left one's axis there; ask for another"
        )
    scale = _scale(asked, basis)
    boards = board_terms(asked, reached, basis * scale, moves[:, -6:])
    known = np.zeros(len(parameters.names))
    if parameters.warped and asked.flatness_m:
        known[parameters.warp] = asked.flatness_m**-2
    terms = DepthTerms(
        boards=boards,
        c=moves[:, :-6] @ (basis * scale),
        weights=np.ones(len(moves)),
        known=((basis * scale) ** 2).T @ known,
        prior=np.ones(basis.shape[1]),
        flatness_m=0.0 if parameters.warped else asked.flatness_m,
        measure=basis * scale,
        frame=moves[:, -6:],
    )
    # each depth in the measure of what boards all over the place leave of it
    usual = replace(terms, weights=np.eye(len(moves))).loss(boards.total()) * len(reached)
    return replace(terms, weights=np.array([1.0, *[_OUTER] * (len(moves) - 1)]) / usual)


def plan_information(
    asked: PlanAsked, reached: ReachedPoses, *, rooted: bool
) -> tuple[BoardInformation, BoardInformation]:
    """What boards tell of the parameters, and of them and the warps (the same if those are parameters)."""
    wider = with_warps(asked.parameters) if asked.flatness_m else asked.parameters
    told = board_information(asked.rig, wider, asked.board, reached.poses, reached.seen, rooted=rooted)
    return (told if wider is asked.parameters else without_warps(told)), told


def board_terms(asked: PlanAsked, reached: ReachedPoses, basis: Array, frame: Array) -> Sums:
    """The terms of each board, as `DepthTerms.measure` and `frame` have depths and parameters."""
    told, warping = plan_information(asked, reached, rooted=False)
    n, noise, q = len(reached), asked.corner_noise_px, basis.shape[1]
    about = frame @ about_camera(reached.poses)  # (n, k, 6)
    reduced = basis.T @ told.reduced @ basis
    b, h = np.zeros((n, q, 2)), np.zeros((n, len(frame), 2))
    if asked.flatness_m and not asked.parameters.warped:
        b = basis.T @ warping.reduced[:, :-2, -2:] / noise**2
        h = -about @ warping.gain[:, :, -2:]
    return Sums(
        A=(reduced + reduced.transpose(0, 2, 1)) / (2 * noise**2),
        g=about @ told.gain @ basis,
        s=noise**2 * np.einsum("nki,nij,nkj->nk", about, told.pose_covariance, about),
        b=b,
        h=h,
        n=np.ones(n),
    )


def _scale(asked: PlanAsked, basis: Array) -> Array:
    """A measure (q,) of each free parameter: what is not known of it beforehand."""
    rig, parameters = asked.rig, asked.parameters
    sizes = np.ones(len(parameters.names))
    for side, camera in enumerate((rig.left, rig.right)):
        own = parameters.columns(side)
        pinhole = [_FOCAL * camera.fx, _FOCAL * camera.fy] + [_PRINCIPAL * camera.width] * 2
        sizes[own.start : own.start + len(CAMERA)] = pinhole
    sizes[parameters.pose] = [_TURN_RAD] * 3 + [_BASELINE * rig.baseline_m] * 3
    sizes[parameters.warp] = max(asked.board.size_m)
    return np.asarray(sizes[np.argmax(basis != 0, axis=0)])
