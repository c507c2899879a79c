"""Board corners: against the Cramer-Rao bound and OpenCV, on exact and on rendered pictures; the limits
stand beside the figures."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from functools import lru_cache

import cv2
import numpy as np

from benchmarks.subjects.checker_images import (
    board_corners,
    board_homography,
    board_image,
    cramer_rao_px,
    saddle_windows,
)
from benchmarks.subjects.corners import refine_corners
from rigsim.pixels.corners import saddle
from rigsim.pixels.corners.corners import fit_corners
from rigsim.pixels.corners.pairing import BoardMatches, match_sizes
from rigsim.pixels.images import grey
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.presets import preset
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig
from rigsim.sim.exposure import digitise, optics
from rigsim.sim.lens import distort_image, rectify_image, wider_intrinsics

_HALF = 5


def run() -> None:
    """Print the four tables."""
    print("exact corners, 11 x 11 px, contrast 130 grey: rms px               (limits: / bound 1.5, aim 1.1;")
    print(
        "blur noise     bound   erf saddle    cv2   saddle/bound cv2/bound   sqrt(NEES/2) 1 +- 0.1, aim 0.03)"
    )
    for blur, noise in ((0.3, 0.0), (0.5, 1.0), (0.5, 3.0), (1.0, 1.0), (1.0, 3.0)):
        bound, ours, theirs, nees = exact_corners(blur, noise)
        print(
            f"{blur:4.1f} {noise:5.1f} {bound:9.5f} {ours:12.5f} {theirs:6.4f} {ours / bound:14.3f} "
            f"{theirs / bound:9.2f} {nees:14.3f}"
        )

    print(
        "boards, 1280 x 720 px, rendered: rms px against the projected truth (limit 0.010, aim 0.003 without"
    )
    print("supersample blur noise  boards corners    rms    rms/bound sqrt(NEES/2)  depth measured/predicted")
    for supersample, blur, noise in (
        (1, 0.0, 0.0),
        (2, 0.0, 0.0),
        (2, 0.5, 1.0),
        (2, 0.5, 3.0),
        (2, 1.0, 1.0),
        (2, 1.0, 3.0),
        (4, 0.0, 0.0),
        (4, 0.5, 1.0),
    ):
        seen = rendered_boards(supersample, Sensor(blur_px=blur, grey_noise=noise))
        print(
            f"{supersample:11d} {blur:4.1f} {noise:5.1f} {seen.boards:7d} {seen.corners:7d} "
            f"{seen.rms_px:7.4f} {seen.over_bound:10.2f} {seen.nees:13.3f} {seen.depth_ratio:18.3f}"
        )

    print("rendered, distorted (k1 -0.25), rectified: rms px                       (limit 0.02, aim 0.005)")
    for blur in (0.05, 0.3, 0.5, 0.8):
        distorted, rectified = distortion(blur)
        print(f"  lens blur {blur:4.2f} px: distorted {distorted:7.4f}, rectified {rectified:7.4f}")

    ours, theirs = speed()
    print("1000 corners                                                              (limit 1 s, aim 0.1 s)")
    print(f"  saddle fit {ours:.3f} s, cv2.cornerSubPix {theirs:.3f} s")


def exact_corners(
    blur: float, noise: float, n: int = 40, repeats: int = 40
) -> tuple[float, float, float, float]:
    """Bound, rms of the saddle fit and of cv2.cornerSubPix (px), and sqrt(NEES/2)."""
    rng = np.random.default_rng(1)
    centers = rng.uniform(-0.5, 0.5, (n, 2))
    first = rng.uniform(0, np.pi, n)
    angles = np.stack([first, first + np.radians(rng.uniform(60, 120, n))], axis=1)
    grey_std = np.sqrt(noise**2 + 1 / 12)
    bounds = [cramer_rao_px(c, a, grey_std, blur=blur) for c, a in zip(centers, angles, strict=True)]
    # cv2 looks a pixel further than its window
    clean = saddle_windows(centers, angles, half=_HALF + 2, blur=blur)
    size = 2 * _HALF + 5
    middles = np.stack([np.arange(n) * size + size // 2, np.full(n, size // 2)], axis=1).astype(float)
    truth = middles + centers
    ours, theirs, nees = [], [], []
    criteria = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_MAX_ITER, 100, 1e-4)
    for _ in range(repeats):
        noisy = np.concatenate(list(clean), axis=1) + noise * rng.standard_normal((size, n * size))
        image = np.clip(np.rint(noisy), 0, 255).astype(np.uint8)
        found = refine_corners(image, middles, half_window=_HALF)
        error = (found.uv - truth)[found.valid]
        ours.append(error)
        nees.append(np.einsum("ni,nij,nj->n", error, np.linalg.inv(found.cov[found.valid]), error))
        start = np.ascontiguousarray(middles[:, None], dtype=np.float32)
        refined = cv2.cornerSubPix(image, start, (_HALF, _HALF), (-1, -1), criteria)
        theirs.append(refined[:, 0] - truth)
    return (
        float(np.sqrt(np.mean(np.square(bounds)))),
        float(np.sqrt(np.mean(np.concatenate(ours) ** 2))),
        float(np.sqrt(np.mean(np.concatenate(theirs) ** 2))),
        float(np.sqrt(np.mean(np.concatenate(nees)) / 2)),
    )


@dataclass(frozen=True, slots=True)
class Seen:
    """What was measured in a rendered pair."""

    boards: int
    corners: int
    rms_px: float
    over_bound: float
    nees: float
    depth_ratio: float


def rendered_boards(supersample: int, sensor: Sensor) -> Seen:
    """Measure the scene `boards` and compare with its projected corners."""
    rig = preset("boards").rig
    pictures, truth = _render(supersample)
    rng = np.random.default_rng(3)
    pair = [
        digitise(optics(picture, sensor, side, supersample=supersample), sensor, rng)
        for picture, side in zip(pictures, ("left", "right"), strict=True)
    ]
    matches = match_sizes(*pair, sorted({key[1:] for key in truth}), rig=rig)
    good = matches.observations.valid
    exact = _truth_of(matches, truth)
    measured = np.stack([matches.observations.uv_left, matches.observations.uv_right], axis=1)
    error = (measured - exact)[good]
    cov = np.stack([matches.cov_left, matches.cov_right], axis=1)[good]
    bound = _bound_px(pair, matches, exact, sensor.grey_noise**2 + 1 / 12)
    focal_baseline = rig.left.fx * rig.baseline_m
    disparity, true_disparity = (uv[good, 0, 0] - uv[good, 1, 0] for uv in (measured, exact))
    depth = focal_baseline / true_disparity
    predicted = depth**2 / focal_baseline * np.sqrt(cov[:, 0, 0, 0] + cov[:, 1, 0, 0])
    rms = float(np.sqrt(np.mean(error**2)))
    return Seen(
        len(matches.sizes),
        int(good.sum()),
        rms,
        rms / bound,
        float(np.sqrt(np.mean(np.einsum("nsi,nsij,nsj->ns", error, np.linalg.inv(cov), error)) / 2)),
        float(np.sqrt(np.mean((focal_baseline / disparity - depth) ** 2) / np.mean(predicted**2))),
    )


def _bound_px(pair: list[Array], matches: BoardMatches, exact: Array, grey_var: float) -> float:
    """rms (px) that white noise of `grey_var` alone would leave on these windows."""
    variances = []
    for board, (rows, cols) in enumerate(matches.sizes.tolist()):
        here = matches.board == board
        for side, image in enumerate(pair):
            uv = exact[here, side]
            grid = uv.reshape(rows, cols, 2)
            steps = np.stack([np.gradient(grid, axis=1), np.gradient(grid, axis=0)], axis=-2).reshape(
                -1, 2, 2
            )
            _, parameters = fit_corners(image.astype(float), grey_var, uv, _HALF, steps)
            good = matches.observations.valid[here]
            x, y = saddle.pixel_grid(2 * _HALF + 1)
            for p in parameters[good]:
                J = _derivatives(p, x, y)
                variances.append(np.diag(np.linalg.inv(J.T @ J))[saddle.U : saddle.V + 1])
    return float(np.sqrt(np.mean(variances) * grey_var))


def _derivatives(parameters: Array, x: Array, y: Array) -> Array:
    """Derivatives (P, 7) of a corner's pixels, by differences."""
    step = 1e-4
    parameters = parameters.copy()
    parameters[saddle.BLUR_VAR] = max(parameters[saddle.BLUR_VAR], 1e-3)
    plus, minus = parameters + step * np.eye(7), parameters - step * np.eye(7)
    return (saddle.model(plus, x, y) - saddle.model(minus, x, y)).T / (2 * step)


@lru_cache(maxsize=1)
def _render(k: int) -> tuple[list[Array], dict[tuple[str, int, int], Array]]:
    """Left and right picture (k H, k W) in linear light, and each board's corners (N, 2 sides, 2) px."""
    import mujoco

    from rigsim.sim.simulator import Simulator

    rig = preset("boards").rig
    lens = rig.left
    fine = Intrinsics(
        lens.width * k,
        lens.height * k,
        lens.fx * k,
        lens.fy * k,
        lens.cx * k + (k - 1) / 2,
        lens.cy * k + (k - 1) / 2,
    )
    truth = {}
    with Simulator("boards") as simulator:
        simulator.place(StereoRig.rectified(fine, rig.baseline_m))
        frame = simulator.render(1)  # the fine pixels as they are
        scene = simulator.scene
        for name, board in scene.boards.items():
            rows, cols, square = int(board["rows"]), int(board["cols"]), board["square_mm"] / 1e3
            geom = mujoco.mj_name2id(scene.model, mujoco.mjtObj.mjOBJ_GEOM, name)
            row, col = np.mgrid[0:rows, 0:cols]
            local = np.stack(
                [
                    (col - (cols - 1) / 2) * square,
                    ((rows - 1) / 2 - row) * square,
                    np.full(row.shape, scene.model.geom_size[geom][2]),
                ],
                axis=-1,
            ).reshape(-1, 3)
            world = local @ scene.data.geom_xmat[geom].reshape(3, 3).T + scene.data.geom_xpos[geom]
            cameras = [scene.world_from_camera(side).inverse.apply(world) for side in (0, 1)]
            truth[name, rows, cols] = np.stack([lens.project(points) for points in cameras], axis=1)
        # one channel: three with noise of their own would average it
        pictures = [grey(view.image) / 255.0 for view in (frame.left, frame.right)]
    return pictures, truth


def _truth_of(matches: BoardMatches, truth: dict[tuple[str, int, int], Array]) -> Array:
    """Projected corners (N, 2 sides, 2) in the order of the matches."""
    parts = []
    for board, size in enumerate(matches.sizes.tolist()):
        uv = matches.observations.uv_left[matches.board == board]
        candidates = [
            corners[::step] for key, corners in truth.items() if list(key[1:]) == size for step in (1, -1)
        ]
        parts.append(min(candidates, key=lambda c: float(np.nanmean(np.abs(c[:, 0] - uv)))))
    return np.concatenate(parts)


def distortion(blur: float) -> tuple[float, float]:
    """rms px of the corners in a distorted picture, and in that picture rectified."""
    camera = Intrinsics(640, 480, 450.0, 452.0, 318.2, 241.7, BrownConrady(-0.25, 0.08, 0.001, -0.0008))
    plain = replace(camera, lens=None)
    wide = wider_intrinsics(camera, 2)
    shapes = [
        board_homography(place, square, roll=roll, tilt=0.0)
        for place, square, roll in (
            ((-0.45, -0.3), 0.06, 0.2),
            ((0.35, 0.25), 0.07, -0.4),
            ((0.4, -0.35), 0.045, 0.7),
        )
    ]
    picture = board_image(
        [(wide.K @ h, 5, 6) for h in shapes], (wide.height, wide.width), blur=2 * blur, supersample=4
    )
    distorted = distort_image(picture, wide, camera)
    return (
        _rms_at(distorted, [camera.denormalize(board_corners(h, 5, 6)) for h in shapes]),
        _rms_at(
            rectify_image(distorted, camera, plain),
            [plain.denormalize(board_corners(h, 5, 6)) for h in shapes],
        ),
    )


def _rms_at(image: Array, boards: list[Array]) -> float:
    errors = []
    for exact in boards:
        grid = exact.reshape(5, 6, 2)
        steps = np.stack([np.gradient(grid, axis=1), np.gradient(grid, axis=0)], axis=-2).reshape(-1, 2, 2)
        errors.append(refine_corners(image, exact, steps=steps).uv - exact)
    return float(np.sqrt(np.nanmean(np.concatenate(errors) ** 2)))


def speed() -> tuple[float, float]:
    """Seconds for 1000 corners: the saddle fit, and cv2.cornerSubPix; the best of five."""
    rng = np.random.default_rng(0)
    first = rng.uniform(0, np.pi, 25)
    clean = saddle_windows(rng.uniform(-0.5, 0.5, (25, 2)), np.stack([first, first + 1.6], axis=1), half=7)
    strip = np.concatenate(list(clean), axis=1)
    image = np.concatenate([strip] * 40, axis=0)
    image = np.clip(np.rint(image + rng.standard_normal(image.shape)), 0, 255).astype(np.uint8)
    v, u = np.mgrid[7 : image.shape[0] : 15, 7 : image.shape[1] : 15]
    start = np.stack([u.ravel(), v.ravel()], axis=1).astype(float)
    criteria = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_MAX_ITER, 100, 1e-4)
    window = (_HALF, _HALF)
    ours, theirs = [], []
    for _ in range(5):
        begin = time.perf_counter()
        refine_corners(image, start)
        ours.append(time.perf_counter() - begin)
        begin = time.perf_counter()
        cv2.cornerSubPix(image, np.ascontiguousarray(start[:, None], np.float32), window, (-1, -1), criteria)
        theirs.append(time.perf_counter() - begin)
    return min(ours), min(theirs)
