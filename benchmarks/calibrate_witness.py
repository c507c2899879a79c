"""Do whole calibrations bear a plan's covariance out, and does the verdict on them tell right from wrong?

Five random plans: the spread of depths, and of all parameters, over calibrations of simulated corners and of
rendered pictures, over what the covariance predicts at the same noise. Then the verdict: how often it flags
calibrations that are right, and how often it sees each of a list of mistakes that was written down before.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.board import Board
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.lens import Lens
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.witness.bench import CalibrationBench
from rigsim.study.calibrate.witness.conclude import Calibrated, Met, conclude
from rigsim.study.calibrate.witness.judge import SIMULATED
from rigsim.study.calibrate.witness.measured import calibrate_found, measure_calibrations
from rigsim.study.calibrate.witness.pictures import SENSOR, found_corners
from rigsim.study.calibrate.witness.result import CalibrationWitness
from rigsim.study.calibrate.witness.simulated import simulate_calibrations
from rigsim.theory.calibration.adjust import adjust
from rigsim.theory.calibration.boards import BoardPoses, whole
from rigsim.theory.calibration.parameters import RigParameters

PLANS, SIMULATIONS, MEASUREMENTS = 5, 300, 30
VERDICTS, WRONG, EACH = 200, 20, 20
MEASURED_VERDICTS = 5
LENSES: tuple[Lens | None, ...] = (
    BrownConrady(-0.1, 0.05, 1e-3, -5e-4, 0.01),
    None,
    BrownConrady(-0.2, 0.05),
    BrownConrady(0.05),
    None,
)
BOARDS = (Board(9, 6, 0.03), Board(10, 10, 0.03), Board(8, 5, 0.04), Board(7, 6, 0.05), Board(11, 8, 0.02))


def random_poses(rig: StereoRig, board: Board, count: int, rng: np.random.Generator) -> BoardPoses:
    """Boards at 0.5 to 1.2 m, turned away by up to 40 degrees, whole in both pictures."""
    kept: list[BoardPoses] = []
    while len(kept) < count:
        z_m, uv = rng.uniform(0.5, 1.2), rng.uniform([0, 0], [rig.left.width, rig.left.height])
        middle = np.append(rig.left.normalize(uv), 1.0) * z_m
        axis, tilt = rng.uniform(0, 2 * math.pi), math.radians(40) * math.sqrt(rng.uniform())
        R = Pose.from_rotvec([tilt * math.cos(axis), tilt * math.sin(axis), 0]).R
        R = R @ Pose.from_rotvec([0, 0, rng.uniform(-0.3, 0.3)]).R
        pose = BoardPoses(R[None], (middle - R @ board.points.mean(axis=0))[None])
        if whole(rig, pose.project(rig, board), 10.0).all():
            kept.append(pose)
    return BoardPoses(np.concatenate([one.R for one in kept]), np.concatenate([one.t for one in kept]))


def random_plan(seed: int) -> CalibrationBench:
    """A rig, a board and 8 to 25 poses; every parameter of Brown's model is looked for."""
    rng = np.random.default_rng((2026, seed))
    focal_px, baseline_m = rng.uniform(500, 1400), rng.uniform(0.05, 0.2)
    (cx_left, cy_left), (cx_right, cy_right) = rng.uniform([630, 390], [650, 410], (2, 2))
    left = Intrinsics(1280, 800, focal_px, focal_px, float(cx_left), float(cy_left), LENSES[seed % 5])
    right = replace(left, cx=float(cx_right), cy=float(cy_right))
    right_from_left = Pose.from_rotvec(rng.normal(0, 0.01, 3), [-baseline_m, *rng.normal(0, 0.002, 2)])
    rig, board, count = StereoRig(left, right, right_from_left), BOARDS[seed % 5], int(rng.integers(8, 26))
    return CalibrationBench(
        rig,
        RigParameters.of((BrownConrady, BrownConrady)),
        board,
        random_poses(rig, board, count, rng),
        np.ones((count, 2), dtype=bool),
        0.1,
        (1.0, 2.0, 3.0, 5.0),
    )


def run() -> None:
    """Print the tables."""
    ratios()
    verdicts()
    measured_verdicts()


def ratios() -> None:
    """Found over predicted, plan by plan."""
    for name in ("simulated", "measured"):
        print(
            f"{name}: depth std found over predicted at 1, 2, 3, 5 m; of all parameters; mean error in stds"
        )
        found: list[CalibrationWitness] = []
        for k in range(PLANS):
            begin, bench = time.perf_counter(), random_plan(k)
            if name == "simulated":
                one = simulate_calibrations(bench, count=SIMULATIONS, seed=k)
            else:
                one = measure_calibrations(bench, count=MEASUREMENTS, seed=k)
            found.append(one)
            print(
                f"  {bench.board.text:11} {one.boards:2} boards, noise {one.corner_noise_px:.4f} px: "
                + " ".join(f"{row.ratio:.3f}" for row in one.depths)
                + f"; {one.parameter_ratio:.3f} ({one.parameter_interval[0]:.3f} to"
                f" {one.parameter_interval[1]:.3f}); "
                + " ".join(f"{row.mean_m / row.predicted_m:+.2f}" for row in one.depths)
                + f"; misfit {one.misfit:.3f}; {one.agreement.kind} {one.agreement.reason};"
                f" {time.perf_counter() - begin:.0f} s",
                flush=True,
            )
        _pooled(found)


def _pooled(found: Sequence[CalibrationWitness]) -> None:
    """The root mean square of ratios over the plans, with 95 % of chance."""
    degrees = sum(one.calibrations - one.failed - 1 for one in found)
    chance = 1.96 / math.sqrt(2 * degrees)
    for k, row in enumerate(found[0].depths):
        pooled = math.sqrt(np.mean([one.depths[k].ratio ** 2 for one in found]))
        print(f"  all plans at {row.z_m:g} m: {pooled:.3f} +- {pooled * chance:.3f}")
    print(f"  all parameters: {math.sqrt(np.mean([one.parameter_ratio**2 for one in found])):.3f}")


Corners: TypeAlias = Callable[[CalibrationBench, np.random.Generator], Array]
"""Corners (n, 2, m, 2) of one calibration, without noise."""


def exact(bench: CalibrationBench, rng: np.random.Generator) -> Array:
    """Corners where they are."""
    return bench.exact


def unsynchronised(shift_m: float) -> Corners:
    """Boards that move between the left and the right shot."""

    def corners(bench: CalibrationBench, rng: np.random.Generator) -> Array:
        moved = BoardPoses(
            bench.poses.R, bench.poses.t + shift_m * rng.standard_normal((len(bench.poses), 3))
        )
        uv = bench.exact
        uv[:, 1] = moved.project(bench.truth, bench.held)[:, 1]
        return uv

    return corners


def knocked(angle_rad: float) -> Corners:
    """A right camera that yaws after half of the boards."""

    def corners(bench: CalibrationBench, rng: np.random.Generator) -> Array:
        yawed = Pose.from_rotvec([0, angle_rad, 0]) @ bench.truth.right_from_left
        uv, half = bench.exact, len(bench.poses) // 2
        uv[half:] = bench.poses.project(replace(bench.truth, right_from_left=yawed), bench.held)[half:]
        return uv

    return corners


def turned(bench: CalibrationBench, rng: np.random.Generator) -> Array:
    """One board's corners counted from the other end in the right picture."""
    uv = bench.exact
    uv[0, 1] = uv[0, 1, ::-1]
    return uv


def bent(k1: float) -> StereoRig:
    """The small bench's rig with lenses that are no pinholes."""
    rig = small_bench().rig
    left, right = (replace(camera, lens=BrownConrady(k1=k1)) for camera in (rig.left, rig.right))
    return replace(rig, left=left, right=right)


@dataclass(frozen=True, slots=True)
class Mistake:
    """Something that is wrong, and that nobody tells the verdict."""

    name: str
    corners: Corners = exact
    true_rig: StereoRig | None = None
    true_board: Board | None = None
    noise: float = 1.0
    """True noise over what is claimed."""

    def bench(self) -> CalibrationBench:
        """What is true of the small bench."""
        return replace(small_bench(), true_rig=self.true_rig, true_board=self.true_board)


def mistakes() -> tuple[Mistake, ...]:
    """Nothing, then all of them."""
    return (
        Mistake("none"),
        Mistake("twice the noise that is claimed", noise=2.0),
        Mistake("half more noise than is claimed", noise=1.5),
        Mistake("square 1 % larger than taken", true_board=Board(9, 6, 0.0303)),
        Mistake("square 0.2 % larger than taken", true_board=Board(9, 6, 0.03006)),
        Mistake("one board of ten counted from the other end", turned),
        Mistake("boards move 1 mm between the shots", unsynchronised(1e-3)),
        Mistake("boards move 0.2 mm between the shots", unsynchronised(2e-4)),
        Mistake("right camera knocked by 0.05 deg half-way", knocked(math.radians(0.05))),
        Mistake("board warped by 0.5 mm", true_board=Board(9, 6, 0.03, (5e-4, 5e-4))),
        Mistake("board warped by 0.1 mm", true_board=Board(9, 6, 0.03, (1e-4, 1e-4))),
        Mistake("k1 of -0.02 taken for a pinhole", true_rig=bent(-0.02)),
        Mistake("k1 of -0.002 taken for a pinhole", true_rig=bent(-0.002)),
    )


def small_bench() -> CalibrationBench:
    """Pinholes, ten boards of 9x6 corners."""
    rng = np.random.default_rng(5)
    camera = Intrinsics(1280, 800, 900.0, 900.0, 642.0, 396.0)
    rig = StereoRig.rectified(camera, 0.1)
    board = Board(9, 6, 0.03)
    poses = random_poses(rig, board, 10, rng)
    at_m = (1.0, 2.0, 3.0)
    return CalibrationBench(
        rig, RigParameters.of((None, None)), board, poses, np.ones((10, 2), dtype=bool), 0.1, at_m
    )


def verdicts() -> None:
    """How often simulated calibrations are flagged, by mistake."""
    print(
        f"verdicts on {EACH} simulated calibrations, ten boards, 0.1 px, {VERDICTS} times, {WRONG} if wrong:"
    )
    for mistake in mistakes():
        count = VERDICTS if mistake.name == "none" else WRONG
        _tell(mistake.name, [_verdict(mistake, seed) for seed in range(count)])


def _verdict(mistake: Mistake, seed: int) -> CalibrationWitness:
    bench, true = small_bench(), mistake.bench()
    done = []
    for k in range(EACH):
        rng = np.random.default_rng((seed, k))
        uv = mistake.corners(true, rng)
        uv = uv + mistake.noise * bench.corner_noise_px * rng.standard_normal(uv.shape)
        found = adjust(bench.rig, bench.parameters, bench.board, bench.poses, uv)
        if found.settled:
            done.append(Calibrated(bench.errors(found.rig, found.poses), found.rms_px, uv.size))
    predicted = bench.covariance(bench.corner_noise_px)
    return conclude(Met("simulated", EACH, bench.corner_noise_px, SIMULATED), done, bench, predicted)


def measured_verdicts() -> None:
    """The same of boards that are drawn, found and calibrated by OpenCV.

    What is wrong is added to corners that were found. The noise is what they are off the true ones: no claim
    of it can be wrong here, and what moves boards or cameras in between counts as noise.
    """
    print(f"verdicts on {EACH} measured calibrations, ten boards, {MEASURED_VERDICTS} times:")
    bench = small_bench()
    found = found_corners(bench, SENSOR, EACH * MEASURED_VERDICTS, 1)
    for mistake in mistakes():
        if mistake.noise != 1:
            continue
        true, rng = mistake.bench(), np.random.default_rng(7)
        wrong = np.stack([mistake.corners(true, rng) for _ in found])
        parts = np.split(found - bench.exact + wrong, MEASURED_VERDICTS)
        _tell(mistake.name, [calibrate_found(true, part) for part in parts])


def _tell(name: str, seen: Sequence[CalibrationWitness]) -> None:
    kinds = [one.agreement.kind for one in seen]
    why = sorted({one.agreement.quantity for one in seen if one.agreement.kind == "flagged"})
    misfit = float(np.median([one.misfit for one in seen]))
    print(
        f"  {name:45} flagged {kinds.count('flagged'):3} untold {kinds.count('untold'):3} agrees"
        f" {kinds.count('agrees'):3}; misfit {misfit:.2f}; {', '.join(why)}",
        flush=True,
    )
