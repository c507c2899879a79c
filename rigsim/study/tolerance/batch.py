"""Many rigs at once, each a little different from one assumed rig: projection, epipolar error, triangulation.

What `Perturbation.apply`, `StereoRig.project` and `optimal` do for one rig, as arrays (n rigs, m points).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.lens.lens import Lens
from rigsim.rig.perturbation import NAMES
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance.lenses import distort, slopes, undistort, with_k1

PARAMETERS = (*NAMES, "right_cy_px", "both_focal_px")
"""What a rig of a batch may be off by: `Perturbation`'s ten quantities, the right principal point's v, px,
and a focal length that both cameras share, px of the left one's fx: every other grows in proportion."""
_PIXELS = 2
_NEAR_STEPS = 4
_NEAR_PX = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Rays:
    """Both ideal image positions (x/z, y/z) of observed points as the assumed rig reads them, (n, m)."""

    left: tuple[Array, Array]
    """Left camera."""
    right: tuple[Array, Array]
    """Right camera."""


class RigBatch:
    """`rig` changed by each row of `thetas` (n, 12), the quantities of `PARAMETERS` in their order.

    Everything is (n, m): n rigs, m points.
    """

    def __init__(self, rig: StereoRig, thetas: Array) -> None:
        value = dict(zip(PARAMETERS, np.asarray(thetas, dtype=np.float64).T, strict=True))
        self.rig = rig
        left_from_right = rig.right_from_left.inverse
        along = left_from_right.t / rig.baseline_m
        centers = left_from_right.t + value["baseline_m"][:, None] * along
        centers[:, 1] += value["vertical_m"]
        centers[:, 2] += value["axial_m"]
        turns = rotations(np.stack([value["pitch_rad"], value["yaw_rad"], value["roll_rad"]], axis=1))
        self.R = (left_from_right.R @ turns).transpose(0, 2, 1)
        self.t = -np.einsum("nij,nj->ni", self.R, centers)
        longer = 1 + value["both_focal_px"][:, None] / rig.left.fx
        longer_right = value["right_focal_px"][:, None]
        self.left_fx, self.left_fy = rig.left.fx * longer, rig.left.fy * longer
        self.fx, self.fy = rig.right.fx * longer + longer_right, rig.right.fy * longer + longer_right
        self.cx = rig.right.cx + value["right_cx_px"][:, None]
        self.cy = rig.right.cy + value["right_cy_px"][:, None]
        both_k1, right_k1 = value["both_k1"][:, None], value["right_k1"][:, None]
        self.more_k1 = both_k1, both_k1 + right_k1
        self._d_left, self._k1_left = with_k1(rig.left.lens, both_k1)
        self._d_right, self._k1_right = with_k1(rig.right.lens, both_k1 + right_k1)
        self._distorts_left = rig.left.lens is not None or bool(self._k1_left.any())
        self._distorts_right = rig.right.lens is not None or bool(self._k1_right.any())

    def project(self, points_left: Array) -> Array:
        """Pixels (4, n, m): u, v left, u, v right of points (m, 3) m; NaN behind a camera or past the
        radius where a lens folds."""
        left = self.rig.left
        pixels = np.empty((4, len(self.R), len(points_left)))
        with np.errstate(all="ignore"):
            x, y = (points_left[:, :2] / np.where(points_left[:, 2:] > 0, points_left[:, 2:], np.nan)).T
            if self._distorts_left:
                x, y = distort(x[None], y[None], self._k1_left, self._d_left)
            pixels[0], pixels[1] = self.left_fx * x + left.cx, self.left_fy * y + left.cy
            seen = self.R @ points_left.T
            seen += self.t[:, :, None]
            z = seen[:, 2]
            z[~(z > 0)] = np.nan
            x, y = seen[:, 0] / z, seen[:, 1] / z
            if self._distorts_right:
                x, y = distort(x, y, self._k1_right, self._d_right)
            np.add(np.multiply(x, self.fx, out=pixels[2]), self.cx, out=pixels[2])
            np.add(np.multiply(y, self.fy, out=pixels[3]), self.cy, out=pixels[3])
        return pixels

    def rays(self, pixels: Array, start: Rays, steps: int = 3) -> Rays:
        """Ideal positions of `pixels` (4, n, m) as these rigs read them.

        `start` is how rigs with nearly these lenses read them; Newton takes `steps` from there.
        """
        return Rays(self.rays_left(pixels, start, steps), self.rays_right(pixels, start, steps))

    def rays_left(self, pixels: Array, start: Rays, steps: int = 3) -> tuple[Array, Array]:
        """The left half of `rays`."""
        left = self.rig.left
        x, y = (pixels[0] - left.cx) / self.left_fx, (pixels[1] - left.cy) / self.left_fy
        if not self._distorts_left:
            return x, y
        return undistort(x, y, start.left, self._k1_left, self._d_left, steps)

    def rays_right(self, pixels: Array, start: Rays, steps: int = 3) -> tuple[Array, Array]:
        """The right half of `rays`."""
        x, y = (pixels[2] - self.cx) / self.fx, (pixels[3] - self.cy) / self.fy
        if not self._distorts_right:
            return x, y
        return undistort(x, y, start.right, self._k1_right, self._d_right, steps)

    def epipolar_error_px(self, rays: Rays) -> Array:
        """Signed distance (n, m) px from the epipolar constraint, to first order (Sampson): its standard
        deviation is that of one pixel coordinate."""
        error, gradients = self._epipolar(rays)
        with np.errstate(all="ignore"):
            return np.asarray(error / np.sqrt(_squares(gradients)))

    def triangulate(self, rays: Rays) -> tuple[Array, Array, Array]:
        """X, Y, Z (n, m) m in the left camera's frame; NaN where Z <= 0.

        One step of Lindstrom's (CVPR 2010) towards the nearest pixels whose rays meet, then their
        intersection: maximum likelihood but for terms of second order in the epipolar error. Nearest
        is meant in the pixels as they were seen: a lens that distorts weighs the directions differently.
        """
        error, (per_ul, per_vl, per_ur, per_vr) = self._epipolar(rays)
        lens_left = (self._k1_left, self._d_left) if self._distorts_left else None
        lens_right = (self._k1_right, self._d_right) if self._distorts_right else None
        with np.errstate(all="ignore"):
            aspect_left, aspect_right = self.left_fy / self.left_fx, self.fy / self.fx
            move_ul, move_vl = _steepest(per_ul, per_vl, aspect_left, rays.left, lens_left)
            move_ur, move_vr = _steepest(per_ur, per_vr, aspect_right, rays.right, lens_right)
            step = error / (per_ul * move_ul + per_vl * move_vl + per_ur * move_ur + per_vr * move_vr)
            xl, yl = (
                rays.left[0] - step * move_ul / self.left_fx,
                rays.left[1] - step * move_vl / self.left_fy,
            )
            xr, yr = rays.right[0] - step * move_ur / self.fx, rays.right[1] - step * move_vr / self.fy
            R, t = self.R[:, :, :, None], self.t[:, :, None]
            ax, ay, az = (R[:, i, 0] * xl + R[:, i, 1] * yl + R[:, i, 2] for i in range(3))
            ex, ey = (xr * az - ax) * self.fx, (yr * az - ay) * self.fy
            gx, gy = (t[:, 0] - xr * t[:, 2]) * self.fx, (t[:, 1] - yr * t[:, 2]) * self.fy
            z = (ex * gx + ey * gy) / (ex * ex + ey * ey)
            z = np.where(z > 0, z, np.nan)
        return xl * z, yl * z, z

    def _epipolar(self, rays: Rays) -> tuple[Array, tuple[Array, Array, Array, Array]]:
        """The constraint's value, and its slopes in the four pixels."""
        (xl, yl), (xr, yr) = rays.left, rays.right
        x, y, z = self.t.T
        zero = np.zeros_like(x)
        cross = np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).transpose(2, 0, 1)
        E = (cross @ self.R)[:, :, :, None]
        with np.errstate(all="ignore"):
            lx, ly, lw = (E[:, i, 0] * xl + E[:, i, 1] * yl + E[:, i, 2] for i in range(3))
            mx, my = (E[:, 0, i] * xr + E[:, 1, i] * yr + E[:, 2, i] for i in range(2))
            error = xr * lx + yr * ly + lw
            gradients = (mx / self.left_fx, my / self.left_fy, lx / self.fx, ly / self.fy)
        return np.asarray(error), gradients


def read_rays(rig: StereoRig, pixels: Array) -> Rays:
    """Ideal positions of `pixels` (4, n, m) as `rig` itself reads them."""
    found = []
    for camera, (u, v) in ((rig.left, pixels[:_PIXELS]), (rig.right, pixels[_PIXELS:])):
        if camera.lens is None:
            found.append(((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy))
        else:
            ideal = camera.normalize(np.stack([u, v], axis=-1))
            found.append((ideal[..., 0], ideal[..., 1]))
    return Rays(*found)


def read_rays_near(rig: StereoRig, pixels: Array, points_left: Array) -> Rays:
    """The same for `pixels` (4, n, m) that nearly are those of `points_left` (m, 3) m, several times faster.

    Newton starts at the points' own positions; what it does not bring back to its pixel is NaN.
    """
    exact = RigBatch(rig, np.zeros((1, len(PARAMETERS))))
    found = []
    for camera, place, points, read in (
        (rig.left, 0, points_left, exact.rays_left),
        (rig.right, _PIXELS, rig.right_from_left.apply(points_left), exact.rays_right),
    ):
        start = (points[:, 0] / points[:, 2], points[:, 1] / points[:, 2])
        x, y = read(pixels, Rays(start, start), _NEAR_STEPS)
        if camera.lens is not None:
            with np.errstate(all="ignore"):
                lens, k1 = with_k1(camera.lens, np.zeros(1))
                seen_x, seen_y = distort(x, y, k1, lens)
                off_x = seen_x * camera.fx + camera.cx - pixels[place]
                off_y = seen_y * camera.fy + camera.cy - pixels[place + 1]
                lost = ~(off_x * off_x + off_y * off_y < _NEAR_PX**2)
            x[lost] = y[lost] = np.nan
        found.append((x, y))
    return Rays(*found)


def _steepest(
    per_u: Array,
    per_v: Array,
    aspect: Array | float,
    ideal: tuple[Array, Array],
    lens: tuple[Array, Lens] | None,
) -> tuple[Array, Array]:
    """Move of the ideal pixel when the seen one follows the constraint's slope: ``D^-1 D^-T`` times
    that slope in ideal pixels, D the lens's derivative and `aspect` fy over fx."""
    if lens is None:
        return per_u, per_v
    xx, yy, xy, yx = slopes(*ideal, *lens)
    # D in pixels: d u / d v ideal is xy fx / fy, d v / d u ideal is yx fy / fx
    uv, vu = xy / aspect, yx * aspect
    det = xx * yy - xy * yx
    seen_u, seen_v = (yy * per_u - vu * per_v) / det, (xx * per_v - uv * per_u) / det
    return (yy * seen_u - uv * seen_v) / det, (xx * seen_v - vu * seen_u) / det


def _squares(values: tuple[Array, ...]) -> Array:
    total = values[0] * values[0]
    for value in values[1:]:
        total = total + value * value
    return total


def rotations(rotvecs: Array) -> Array:
    """Rodrigues' formula for rotation vectors (n, 3) rad: (n, 3, 3)."""
    angle = np.linalg.norm(rotvecs, axis=1)[:, None, None]
    x, y, z = rotvecs.T
    k = np.zeros((len(rotvecs), 3, 3))
    k[:, 0, 1], k[:, 0, 2], k[:, 1, 2] = -z, y, -x
    k[:, 1, 0], k[:, 2, 0], k[:, 2, 1] = z, -y, x
    return np.asarray(
        np.eye(3) + np.sinc(angle / np.pi) * k + 0.5 * np.sinc(angle / (2 * np.pi)) ** 2 * k @ k
    )
