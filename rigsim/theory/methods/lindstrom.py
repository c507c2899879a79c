"""Maximum-likelihood triangulation of two pinhole views.

P. Lindstrom, "Triangulation made easy", CVPR 2010: the two image points are moved by the least amount
onto a pair of epipolar lines, by a fixed-point iteration on the lines' normals. Two steps, his
listing 3, are all that most points need; a block is stepped on until its points stand still, and the
few near an epipole that do not are finished by Gauss-Newton.
"""

from __future__ import annotations

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.pose import skew
from rigsim.rig.stereo import StereoRig
from rigsim.theory.blocks import blocks
from rigsim.theory.methods.refine import refine

# larger products wake the threads of the linear algebra library, which then fight over a busy machine
_BLOCK = 12288
_MOST_STEPS = 6
_STILL_PX = 1e-10


def triangulate_lindstrom(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    """Points (N, 3) m in the left camera's frame of pixels (N, 2); `rig` must be free of distortion.

    Minimises the pixel error in both images, also with unequal or non-square pixels. NaN where the
    best point lies behind a camera or at infinity.
    """
    kernel = _Kernel(rig, min(len(uv_left), _BLOCK))
    points = np.empty((3, len(uv_left))).T
    with np.errstate(all="ignore"):
        for block in blocks(len(points), _BLOCK):
            moving = block.start + kernel.solve(uv_left[block], uv_right[block], points[block])
            if moving.size:
                points[moving] = refine(rig, points[moving], uv_left[moving], uv_right[moving])
    return points


class _Kernel:
    """Constants of one rig and the buffers of one block.

    Both images are handled at once: x = (x, y, x', y') are the left and right pixel, counted from the
    principal points, and n = (n, n') = W x + w the normals of their epipolar lines.
    """

    def __init__(self, rig: StereoRig, size: int) -> None:
        left, right = self.left, self.right = rig.left, rig.right
        f_left, f_right = np.array([left.fx, left.fy, 1.0]), np.array([right.fx, right.fy, 1.0])
        R, t = rig.right_from_left.R, rig.right_from_left.t
        # (x, y, 1) F (x', y', 1)^T = 0
        F = (skew(t) @ R).T / f_left[:, None] / f_right
        self.F = F / np.abs(F).max()
        self.W = np.zeros((4, 4))
        self.W[:2, 2:], self.W[2:, :2] = self.F[:2, :2], self.F[:2, :2].T
        self.w = np.concatenate([self.F[:2, 2], self.F[2, :2]])[:, None]
        # the point at depth Z on the left ray is seen at Z A (x, y, 1) + b, homogeneous, on the right
        self.A = f_right[:, None] * R / f_left
        self.b = (f_right * t)[:, None]
        self.vectors = np.empty((5, 4, size))
        self.scalars = np.empty((5, size))

    def solve(self, uv_left: Array, uv_right: Array, points: Array) -> np.ndarray:
        """Fill `points` (n, 3), n <= size; return the indices of those that have not come to rest."""
        mul, add, sub, div = np.multiply, np.add, np.subtract, np.divide
        x, n0, n1, n2, t = self.vectors[:, :, : len(points)]
        a, b, c, d, e = self.scalars[:, : len(points)]
        W = self.W

        sub(uv_left[:, 0], self.left.cx, out=x[0])
        sub(uv_left[:, 1], self.left.cy, out=x[1])
        sub(uv_right[:, 0], self.right.cx, out=x[2])
        sub(uv_right[:, 1], self.right.cy, out=x[3])
        add(np.matmul(W, x, out=n0), self.w, out=n0)
        # c = x F x', how far the pixels are from meeting the epipolar constraint
        _dot(x[:2], n0[:2], out=c)
        for value, factor in zip(x[2:], self.F[2, :2], strict=True):
            add(c, mul(value, factor, out=t[0]), out=c)
        add(c, self.F[2, 2], out=c)

        # first step, along n0; it need not meet the constraint exactly, the next ones do
        np.matmul(W, n0, out=n1)
        s = div(c, _dot(n0, n0, out=b), out=b)
        sub(n0, mul(n1, s, out=n1), out=n1)

        moving = np.empty(0, dtype=np.intp)
        now, then = n1, n2
        for step in range(2, _MOST_STEPS + 1):
            # s, the step along `now` that meets the constraint: smaller root of a s^2 - 2 b s + c = 0
            np.matmul(W, now, out=then)
            _dot(now[:2], then[:2], out=a)
            mul(_dot(now, n0, out=b), 0.5, out=b)
            sub(mul(b, b, out=t[0]), mul(a, c, out=a), out=a)
            s = div(c, add(b, np.sqrt(a, out=a), out=b), out=b)
            # the normals where that step ends, and how far the pixels would still move;
            # only the change across the normals counts, their length does not
            sub(n0, mul(then, s, out=then), out=then)
            sub(then, now, out=t)
            div(_dot(t, now, out=a), _dot(now, now, out=d), out=d)
            sub(_dot(t, t, out=e), mul(a, d, out=a), out=a)
            mul(a, mul(s, s, out=d), out=a)
            furthest = a.max()
            if np.isnan(furthest):
                furthest = np.fmax.reduce(a)
            if not furthest > _STILL_PX**2:
                break
            if step == _MOST_STEPS:
                moving = np.flatnonzero(a > _STILL_PX**2)
                break
            now, then = then, now
        sub(x, mul(now, s, out=t), out=x)
        self._intersect(x, (n0, n1, n2), points)
        return moving

    def _intersect(self, x: Array, buffers: tuple[Array, Array, Array], points: Array) -> None:
        """Depth of corrected pixels, whose rays meet: ``Z a + b`` is parallel to (x', y', 1)."""
        mul, add, sub = np.multiply, np.add, np.subtract
        a, e, g = buffers[0][:3], buffers[1][:2], buffers[2][:2]
        z, w, t = buffers[0][3], buffers[1][2], buffers[1][3]
        b, left = self.b, self.left
        add(np.matmul(self.A[:, :2], x[:2], out=a), self.A[:, 2:], out=a)
        sub(mul(x[2:], a[2], out=e), a[:2], out=e)
        sub(b[:2], mul(x[2:], b[2], out=g), out=g)
        np.divide(_dot(e, g, out=z), _dot(e, e, out=w), out=z)
        add(mul(a[2], z, out=w), b[2], out=w)
        mul(x[0], mul(z, 1 / left.fx, out=t), out=points[:, 0])
        mul(x[1], mul(z, 1 / left.fy, out=t), out=points[:, 1])
        points[:, 2] = z
        # one look at the whole block: a NaN or an infinity anywhere makes it fail
        if not (z.min() > 0 and w.min() > 0 and np.isfinite(points[:, 0].sum())):
            good = (z > 0) & (w > 0) & np.isfinite(points).all(axis=1)
            points[~good] = np.nan


def _dot(one: Array, other: Array, out: Array) -> Array:
    """Column by column scalar product of (k, n) with (k, n)."""
    return np.asarray(np.einsum("ij,ij->j", one, other, out=out))
