"""Exact pictures of checker corners, made without the code under test."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter
from scipy.special import ndtr, owens_t

Array = np.ndarray


def blurred_saddle(x: Array, y: Array, angle_1: float, angle_2: float, blur: float) -> Array:
    """sign(n1 p) sign(n2 p) blurred by an isotropic Gaussian, exactly: a bivariate normal's quadrants.

    `angle_1`, `angle_2` are the directions of the two edges' normals, rad.
    """
    a = (x * np.cos(angle_1) + y * np.sin(angle_1)) / blur
    b = (x * np.cos(angle_2) + y * np.sin(angle_2)) / blur
    rho = np.cos(angle_1 - angle_2)
    return 4 * _bivariate_cdf(a, b, rho) - 2 * ndtr(a) - 2 * ndtr(b) + 1


def _bivariate_cdf(h: Array, k: Array, rho: float) -> Array:
    """P(X < h, Y < k) of standard normals with correlation rho (Owen 1956)."""
    h = np.where(h == 0, 1e-12, h)
    k = np.where(k == 0, 1e-12, k)
    root = np.sqrt(1 - rho * rho)
    crossed = 0.5 * ((h * k < 0) | ((h * k == 0) & (h + k < 0)))
    return (
        0.5 * (ndtr(h) + ndtr(k))
        - owens_t(h, (k / h - rho) / root)
        - owens_t(k, (h / k - rho) / root)
        - crossed
    )


def saddle_windows(
    centers: Array,
    angles: Array,
    *,
    half: int = 5,
    blur: float = 0.5,
    offset: float = 128.0,
    contrast: float = 65.0,
    nodes: int = 10,
) -> Array:
    """Pixels (N, 2 half + 1, 2 half + 1), each the mean over its square, of corners at `centers` (N, 2)
    from the middle pixel, px; `angles` (N, 2) rad, `contrast` half the step from dark to bright."""
    node, weight = np.polynomial.legendre.leggauss(nodes)
    node, weight = node / 2, weight / 2
    grid = np.arange(-half, half + 1, dtype=float)
    windows = np.zeros((len(centers), grid.size, grid.size))
    for window, (cx, cy), (angle_1, angle_2) in zip(windows, centers, angles, strict=True):
        for dx, wx in zip(node, weight, strict=True):
            for dy, wy in zip(node, weight, strict=True):
                x, y = np.meshgrid(grid + dx - cx, grid + dy - cy)
                window += wx * wy * blurred_saddle(x, y, angle_1, angle_2, blur)
    return offset + contrast * windows


def board_homography(center: tuple[float, float], square: float, *, roll: float, tilt: float) -> Array:
    """Image from board (3, 3): squares of `square` px at the middle, rolled (rad), with a perspective of
    relative strength `tilt` per square."""
    c, s = np.cos(roll), np.sin(roll)
    similar = np.array(
        [[square * c, -square * s, center[0]], [square * s, square * c, center[1]], [0, 0, 1.0]]
    )
    perspective = np.array([[1 - abs(tilt) * 3, 0, 0], [0, 1, 0], [tilt, tilt / 2, 1.0]])
    return similar @ perspective


def board_corners(homography: Array, rows: int, cols: int) -> Array:
    """Inner corners (rows * cols, 2) px, row-major; the board's middle is its origin."""
    row, col = np.mgrid[0:rows, 0:cols]
    board = np.stack([col - (cols - 1) / 2, row - (rows - 1) / 2, np.ones_like(col)], axis=-1).reshape(-1, 3)
    image = board @ homography.T
    return image[:, :2] / image[:, 2:]


def board_image(
    boards: list[tuple[Array, int, int]],
    shape: tuple[int, int],
    *,
    blur: float = 0.5,
    dark: float = 60.0,
    bright: float = 190.0,
    supersample: int = 8,
) -> Array:
    """A picture (H, W) of checker boards, each (homography, rows, cols of inner corners), with a bright
    margin of one square.

    Sampled `supersample` times finer, with edges smoothed by half a fine pixel so that they land between
    its samples, then blurred to `blur` px in all (the pixel's own square not counted) and averaged.
    """
    k = supersample
    v, u = np.mgrid[0 : shape[0] * k, 0 : shape[1] * k]
    points = np.stack([(u + 0.5) / k - 0.5, (v + 0.5) / k - 0.5, np.ones(u.shape)], axis=-1)
    smooth = 0.7 / k
    fine = np.full(u.shape, 0.5 * (dark + bright))
    for homography, rows, cols in boards:
        inverse = np.linalg.inv(homography)
        w = points @ inverse[2]
        cell = [points @ inverse[i] / w for i in range(2)]
        gradient = [
            np.hypot(inverse[i, 0] - cell[i] * inverse[2, 0], inverse[i, 1] - cell[i] * inverse[2, 1])
            / np.abs(w)
            for i in range(2)
        ]
        wave = [
            _square_wave(cell[i] + count / 2 - 0.5, gradient[i] * smooth)
            for i, count in enumerate((cols, rows))
        ]
        pattern = 0.5 * (dark + bright) + 0.5 * (bright - dark) * wave[0] * wave[1]
        reach = [np.abs(cell[i]) - (count + 1) / 2 for i, count in enumerate((cols, rows))]
        inside = (reach[0] < 0) & (reach[1] < 0)
        margin = (reach[0] < 1) & (reach[1] < 1) & ~inside
        fine = np.where(inside, pattern, np.where(margin, bright, fine))
    fine = gaussian_filter(fine, np.sqrt(max(blur**2 - smooth**2, 0.0)) * k, mode="nearest")
    return fine.reshape(shape[0], k, shape[1], k).mean(axis=(1, 3))


def _square_wave(cell: Array, smooth: Array) -> Array:
    """+-1 changing sign at every whole number, with Gaussian-smoothed steps."""
    nearest = np.round(cell)
    step = 2 * ndtr((cell - nearest) / smooth) - 1
    return np.where(nearest % 2 == 0, step, -step)


def cramer_rao_px(center: Array, angles: Array, noise: float, **options: object) -> Array:
    """Cramer-Rao bound (2,) px on the std of x and y: seven parameters, white noise, the exact picture."""
    base = np.array([center[0], center[1], angles[0], angles[1], options.pop("blur", 0.5)])
    columns = []
    for i, step in enumerate((1e-3, 1e-3, 1e-3, 1e-3, 1e-3)):
        pair = []
        for sign in (1, -1):
            p = base.copy()
            p[i] += sign * step
            pair.append(saddle_windows(p[None, :2], p[None, 2:4], blur=p[4], **options)[0].ravel())
        columns.append((pair[0] - pair[1]) / (2 * step))
    shape = saddle_windows(base[None, :2], base[None, 2:4], blur=base[4], **options)[0].ravel()
    columns += [np.ones_like(shape), shape - shape.mean()]
    J = np.stack(columns, axis=1)
    return noise * np.sqrt(np.diag(np.linalg.inv(J.T @ J))[:2])
