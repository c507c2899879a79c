"""Image pairs whose every grey value is a formula: the exact truth about where a point went."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig


@dataclass(frozen=True)
class Waves:
    """A band-limited random texture: the sum of plane waves, evaluated exactly anywhere."""

    fx: Array
    fy: Array
    phase: Array
    amplitude: float

    @classmethod
    def random(cls, seed: int, *, waves: int = 150, highest: float = 0.25, contrast: float = 40.0) -> Waves:
        """Up to `highest` cycles per unit, spread evenly over the disc; `contrast` is the std in grey."""
        rng = np.random.default_rng(seed)
        frequency = 2 * np.pi * np.sqrt(rng.uniform(0.01**2, highest**2, waves))
        angle = rng.uniform(0, np.pi, waves)
        return cls(
            frequency * np.cos(angle),
            frequency * np.sin(angle),
            rng.uniform(0, 2 * np.pi, waves),
            contrast * np.sqrt(2 / waves),
        )

    def at(self, x: Array, y: Array) -> Array:
        """Grey at (x, y), 128 on average."""
        value = np.full(np.broadcast_shapes(x.shape, y.shape), 128.0)
        for fx, fy, phase in zip(self.fx, self.fy, self.phase, strict=True):
            value += self.amplitude * np.cos(fx * x + fy * y + phase)
        return value

    def slope_at(self, x: Array, y: Array) -> Array:
        """Derivative of `at` with respect to x."""
        value = np.zeros(np.broadcast_shapes(x.shape, y.shape))
        for fx, fy, phase in zip(self.fx, self.fy, self.phase, strict=True):
            value -= self.amplitude * fx * np.sin(fx * x + fy * y + phase)
        return value


@dataclass(frozen=True)
class Pair:
    """A rectified pair with ``disparity = d + a u + b v`` at the left image's pixels."""

    left: Array
    right: Array
    disparity: Array
    slope: Array
    rig: StereoRig


def affine_pair(
    seed: int,
    *,
    width: int = 320,
    height: int = 240,
    d: float = 20.0,
    a: float = 0.0,
    b: float = 0.0,
    highest: float = 0.25,
    doffs: float = 0.0,
) -> Pair:
    """A plane seen by a rectified rig: the right image is the left one, sheared along its rows."""
    waves = Waves.random(seed, highest=highest)
    u, v = np.arange(width, dtype=float), np.arange(height, dtype=float)[:, None]
    # u_right = u - d - a u - b v, solved for u
    seen = (u + d + b * v) / (1 - a)
    left = Intrinsics.from_focal(width, height, 400.0)
    right = Intrinsics.from_focal(width, height, 400.0, cx=left.cx + doffs)
    return Pair(
        waves.at(u, v),
        waves.at(seen, v),
        d + a * u + b * v,
        waves.slope_at(u, v),
        StereoRig.rectified(left, 0.1, right=right),
    )


def plane_pair(
    rig: StereoRig, seed: int, *, normal: tuple[float, float, float], distance_m: float
) -> tuple[Array, Array]:
    """Both images of the plane ``normal . x = distance`` of the left camera's frame, by exact ray casting."""
    waves = Waves.random(seed, highest=0.2)
    n = np.asarray(normal) / np.linalg.norm(normal)
    scale = rig.left.fx / distance_m  # texture units are about px
    center_right = rig.right_from_left.inverse.t

    def image(lens: Intrinsics, left_from_camera: Array, center: Array) -> Array:
        v, u = np.mgrid[: lens.height, : lens.width].astype(float)
        xy = lens.normalize(np.stack([u, v], axis=-1))
        rays = np.concatenate([xy, np.ones((*xy.shape[:2], 1))], axis=-1) @ left_from_camera.T
        points = center + rays * ((distance_m - center @ n) / (rays @ n))[..., None]
        return waves.at(points[..., 0] * scale, points[..., 1] * scale)

    return (
        image(rig.left, np.eye(3), np.zeros(3)),
        image(rig.right, rig.right_from_left.R.T, center_right),
    )


def plane_truth(
    rig: StereoRig, uv_left: Array, *, normal: tuple[float, float, float], distance_m: float
) -> Array:
    """Where the plane's points at `uv_left` (N, 2) lie in the right image, (N, 2)."""
    n = np.asarray(normal) / np.linalg.norm(normal)
    rays = np.concatenate([rig.left.normalize(uv_left), np.ones((len(uv_left), 1))], axis=1)
    return rig.project(rays * (distance_m / (rays @ n))[:, None])[1]


def noisy(image: Array, std: float, seed: int) -> Array:
    """A copy with Gaussian noise of `std` grey."""
    return image + std * np.random.default_rng(seed).standard_normal(image.shape)
