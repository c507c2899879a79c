"""Lens models: against OpenCV, backwards, their slopes, triangulation and its covariance, and their speed."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import cv2
import numpy as np
from scipy.optimize import least_squares

from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.double_sphere import DoubleSphere
from rigsim.rig.lens.eucm import Eucm
from rigsim.rig.lens.fov import FieldOfView
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.mei import Mei
from rigsim.rig.lens.rational import Rational
from rigsim.rig.noise import PixelNoise
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.theory.triangulation import triangulate
from rigsim.theory.uncertainty import predict_covariance

_TERMS = (-0.28, 0.08, 6e-4, -9e-4, -0.009, 0.05, 0.012, 0.002, 8e-4, -3e-4, -1.1e-3, 4e-4, 0.012, -0.02)
_FISHEYE = (0.012, -0.004, 7e-4, -1.3e-4)
_POSE = Pose.from_rotvec((0.01, -0.03, 0.02), (-0.12, 0.003, -0.004))
LENSES: dict[str, Intrinsics] = {
    "brown": Intrinsics(1280, 960, 820, 815, 633.2, 485.4, BrownConrady(*_TERMS[:5])),
    "rational, 8 terms": Intrinsics(1280, 960, 820, 815, 633.2, 485.4, Rational(*_TERMS[:8])),
    "rational, 14 terms": Intrinsics(1280, 960, 820, 815, 633.2, 485.4, Rational(*_TERMS)),
    "Kannala-Brandt, 190 deg": Intrinsics(1280, 1280, 386, 385, 641, 637, KannalaBrandt(*_FISHEYE)),
    "Mei, 190 deg": Intrinsics(1280, 1280, 1230, 1226, 641, 637, Mei(2.1, -0.02, 0.005, 3e-4, -4e-4)),
    "double sphere, 190 deg": Intrinsics(1280, 1280, 330, 329, 641, 637, DoubleSphere(-0.22, 0.59)),
    "EUCM, 160 deg": Intrinsics(1280, 1280, 470, 469, 641, 637, Eucm(0.61, 1.08)),
    "field of view": Intrinsics(1280, 960, 420, 419, 633.2, 485.4, FieldOfView(0.93)),
}
_TRIALS = 400_000


def run() -> None:
    """Print the tables."""
    print(f"Against OpenCV {cv2.__version__}, whole image, largest difference      (at most 1e-9 px)")
    for name, off_px, count in _against_opencv():
        print(f"  {name:28s} {off_px:.1e} px, {count:,} pixels")
    print("\nBackwards and slopes, every 2nd pixel                  (1e-9 of the ray; 1e-6 relative)")
    print(f"  {'':28s} {'ray':>8s}  {'slope':>8s}  shown")
    for name, camera in LENSES.items():
        back, slope, shown = _round_trip(camera)
        print(f"  {name:28s} {back:8.1e}  {slope:8.1e}  {shown:5.1%}")
    print("\nTriangulation, .02 px of noise                         (1 +- .01; 1e-8 m at .25 px)")
    print(f"  {'':28s} sqrt(NEES/3)  off least squares")
    for name, camera in LENSES.items():
        if name != "brown":
            nees, off_m = _triangulated(StereoRig(camera, camera, _POSE))
            print(f"  {name:28s} {nees:12.4f}  {off_m:.1e} m")
    print("\nProjecting 1,000,000 points, median of 7, OpenCV's time over ours in the same run     (>= 1)")
    for name in ("brown", "rational, 8 terms", "rational, 14 terms", "Kannala-Brandt, 190 deg"):
        ours_s, theirs_s = _speed(LENSES[name])
        print(f"  {name:28s} {theirs_s / ours_s:5.2f} x   ({ours_s * 1e3:.0f} and {theirs_s * 1e3:.0f} ms)")


def _opencv(camera: Intrinsics) -> Callable[[Array], Array]:
    assert camera.lens is not None
    D = np.array([getattr(camera.lens, name) for name in camera.lens.names()])
    module = cv2.fisheye if isinstance(camera.lens, KannalaBrandt) else cv2

    def project(points: Array) -> Array:
        found = module.projectPoints(points[:, None], np.zeros(3), np.zeros(3), camera.K, D)
        return np.asarray(found[0][:, 0])

    return project


def _against_opencv() -> Iterator[tuple[str, float, int]]:
    for terms in (5, 8, 12, 14):
        lens: Lens = BrownConrady(*_TERMS[:5]) if terms == 5 else Rational(*_TERMS[:terms])
        camera = Intrinsics(1280, 960, 820, 815, 633.2, 485.4, lens)
        yield f"projectPoints, {terms} terms", *_off(camera)
    yield "fisheye.projectPoints", *_off(LENSES["Kannala-Brandt, 190 deg"])


def _off(camera: Intrinsics) -> tuple[float, int]:
    rays = camera.ray(_pixels(camera, 1))
    # OpenCV divides by z
    rays = rays[rays[:, 2] > 1e-3]
    return float(np.abs(camera.project(rays) - _opencv(camera)(rays)).max()), len(rays)


def _pixels(camera: Intrinsics, step: int) -> Array:
    u, v = np.meshgrid(np.arange(0.0, camera.width, step), np.arange(0.0, camera.height, step))
    return np.stack([u, v], axis=-1).reshape(-1, 2)


def _round_trip(camera: Intrinsics) -> tuple[float, float, float]:
    """Largest difference of a ray after projection, of slopes, and the share of pixels shown."""
    rays = camera.ray(_pixels(camera, 2))
    shown = np.isfinite(rays[:, 0])
    rays = rays[shown]
    back = float(np.abs(camera.ray(camera.project(rays)) - rays).max())
    step = 1e-5
    ahead, behind = (np.stack([camera.project(rays + s * e) for e in np.eye(3)], -1) for s in (step, -step))
    numeric, analytic = (ahead - behind) / (2 * step), camera.jacobian(rays)
    off = np.abs(numeric - analytic).max(axis=(1, 2)) / np.abs(analytic).max(axis=(1, 2))
    return back, float(np.nanmax(off)), float(shown.mean())


def _triangulated(rig: StereoRig) -> tuple[float, float]:
    """sqrt(NEES / 3), and the largest distance to an independent least squares, m."""
    rng = np.random.default_rng(7)
    uv = rng.uniform((0, 0), (rig.left.width, rig.left.height), (4000, 2))
    points = rig.left.ray(uv) * rng.uniform(0.5, 3, (len(uv), 1))
    aside = np.abs(points @ rig.right_from_left.inverse.t) / np.linalg.norm(points, axis=1) / rig.baseline_m
    points = points[rig.right.contains(rig.project(points)[1]) & (aside < 0.9)][:1000]
    many = np.repeat(points, _TRIALS // len(points), axis=0)
    noisy = np.hstack(rig.project(many)) + 0.02 * rng.standard_normal((len(many), 4))
    error = triangulate(rig, noisy[:, :2], noisy[:, 2:]) - many
    weight = np.linalg.inv(predict_covariance(rig, points, PixelNoise(0.02)))
    nees = np.einsum("ni,nij,nj->n", error, np.repeat(weight, _TRIALS // len(points), axis=0), error)
    seen = np.hstack(rig.project(points[:50])) + 0.25 * rng.standard_normal((50, 4))
    found = triangulate(rig, seen[:, :2], seen[:, 2:])
    off = [
        np.linalg.norm(_least_squares(rig, pixels, start) - point)
        for pixels, start, point in zip(seen, points[:50], found, strict=True)
        if np.linalg.norm(start) < 2
    ]
    return float(np.sqrt(np.nanmean(nees) / 3)), float(np.max(off))


def _least_squares(rig: StereoRig, pixels: Array, start: Array) -> Array:
    best = least_squares(
        lambda X: np.hstack(rig.project(X[None]))[0] - pixels,
        start,
        jac=lambda X: rig.jacobian(X[None])[0],
        xtol=1e-15,
        ftol=1e-15,
        gtol=1e-15,
        method="lm",
    )
    return np.asarray(best.x)


def _speed(camera: Intrinsics) -> tuple[float, float]:
    rng = np.random.default_rng(1)
    points = rng.uniform((-1, -1, 1.5), (1, 1, 3), (1_000_000, 3))
    theirs = _opencv(camera)
    times = [(_timed(camera.project, points), _timed(theirs, points)) for _ in range(7)]
    ours_s, theirs_s = np.median(times, axis=0)
    return float(ours_s), float(theirs_s)


def _timed(function: Callable[[Array], Array], points: Array) -> float:
    start = time.perf_counter()
    function(points)
    return time.perf_counter() - start
