"""A planned calibration: against mrcal, chosen poses against random ones, what is refused, how long it takes.

mrcal's numbers are not part of the project: name the file of them in the environment variable
RIGSIM_CALIBRATION_REFERENCE. A scenario there is a rig, boards' poses, and what mrcal says of depths.
"""

from __future__ import annotations

import json
import math
import os
import time
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import rigsim
from rigsim.errors import CalibrationUndetermined
from rigsim.rig.arrays import Array
from rigsim.rig.board import Board
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.depths import PLACES, point_at
from rigsim.study.calibrate.plan.asked import PlanAsked, Reach
from rigsim.study.calibrate.plan.models import in_model, own_model, seldom_estimated
from rigsim.study.calibrate.plan.reach import ReachedPoses, random_poses
from rigsim.study.calibrate.plan.run import plan_covariance, run_plan
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.parameters import RigParameters
from rigsim.theory.uncertainty import predict_depth_std
from rigsim.typed.board import board

VARIABLE = "RIGSIM_CALIBRATION_REFERENCE"
_COUNT, _DRAWS, _DEPTH_M = 15, 21, 2.0
_BENT = BrownConrady(-0.28, 0.09, 0.0005, -0.0008, -0.01)


def rigs() -> Iterator[tuple[str, PlanAsked]]:
    """Ten rigs, each with a board and a reach that suit it."""
    for name, words, reach in (
        ("oak-d", "9x6@30mm", Reach()),
        ("d435", "9x6@30mm", Reach()),
        ("zed-2i", "10x7@40mm", Reach(0.5, 1.5)),
        ("d405", "9x6@10mm", Reach(0.12, 0.4)),
        ("corridor", "11x8@60mm", Reach(1.0, 3.0)),
        ("artifact", "12x9@12mm", Reach(0.3, 0.6)),
        ("bin", "9x6@25mm", Reach(0.4, 1.2, math.radians(25))),
    ):
        yield name, asked(rigsim.preset(name).rig, board(words), reach)
    bent = Intrinsics(1280, 960, 1000.0, 1004.0, 650.0, 470.0, _BENT)
    yield "verged, bent", asked(StereoRig.verged(bent, 0.2, 12.0), board("9x6@40mm"), Reach(0.5, 1.5))
    wide = Intrinsics(1280, 1024, 380.0, 380.0, 640.0, 512.0, KannalaBrandt(0.01, -0.003, 0.0005, -0.0001))
    yield "fisheye", asked(StereoRig.rectified(wide, 0.1), board("9x6@40mm"), Reach(0.25, 0.8))
    long = Intrinsics(2448, 2048, 7000.0, 7000.0, 1223.5, 1023.5)
    yield "telephoto", asked(StereoRig.verged(long, 0.5, 9.5), board("14x9@20mm"), Reach(2.0, 4.0))


def asked(rig: StereoRig, held: Board, reach: Reach) -> PlanAsked:
    """A plan for a rig in its own lens model."""
    model = own_model(rig)
    made, _ = in_model(rig, model)
    parameters = RigParameters.of((model, model), fix=seldom_estimated(made, model))
    return PlanAsked(made, parameters, held, _COUNT, reach, at_m=(_DEPTH_M,))


def run() -> None:
    """Print the tables."""
    _against_mrcal()
    _chosen_over_random()
    _times()


def _against_mrcal() -> None:
    print("Depth std over mrcal's, the farthest from 1 of all distances            (0.97 to 1.03)")
    file = os.environ.get(VARIABLE)
    if file is None:
        print(f"{VARIABLE} names no file: nothing to compare with")
        return
    reference = json.loads(Path(file).read_text())
    for scenario in reference["scenarios"]:
        ratios = _ratios(reference, scenario)
        words = ", ".join(f"{name} {each[np.argmax(np.abs(each - 1))]:.5f}" for name, each in ratios.items())
        print(
            f"  baseline {scenario['B'] * 1e3:3.0f} mm, {scenario['N']:3d} boards at {scenario['r']:.1f} m,"
            f" tilt {scenario['tilt']:2d} deg: {words}"
        )


def _ratios(reference: Mapping[str, Any], scenario: Mapping[str, Any]) -> dict[str, Array]:
    """Depth std over the reference's, by what it comes of, at each distance."""
    left, right = (
        Intrinsics(*reference["image"], *row[:4], BrownConrady(*row[4:8])) for row in reference["intrinsics"]
    )
    rig = StereoRig(left, right, Pose(t=np.array([-scenario["B"], 0.0, 0.0])))
    parameters = RigParameters.of((BrownConrady, BrownConrady), fix=("k3",))
    noise = float(reference["q_calibration_px"])
    poses = BoardPoses.of(scenario["poses_rt"])
    plan = PlanAsked(rig, parameters, Board(10, 10, 0.03), poses, corner_noise_px=noise)
    covariance = plan_covariance(plan, ReachedPoses(poses, np.ones((len(poses), 2), dtype=bool)))
    axis = np.array([[0.0, 0.0, row["z_m"]] for row in scenario["figures"]])
    calibration = covariance.depth_std(axis) * 1e3
    observation = predict_depth_std(rig, axis, float(reference["q_observation_px"])) * 1e3
    found = {"cal": calibration, "obs": observation, "joint": np.hypot(calibration, observation)}
    return {
        name: values / np.array([row[f"{name}_mm"] for row in scenario["figures"]])
        for name, values in found.items()
    }


def _chosen_over_random() -> None:
    print(
        f"\n{_COUNT} chosen poses: calibration's depth std at {_DEPTH_M:g} m over the median of {_DRAWS} draws of"
        f" random ones (axis: at most .7 in the median), and parallel boards"
    )
    print(
        f"{'rig':14s} {'board':12s} {'axis':>6s} {'edge':>6s} {'corner':>6s} {'chosen':>10s} {'next':>6s}  tilt 0"
    )
    found = []
    for name, plan in rigs():
        chosen = run_plan(plan)
        pool = random_poses(plan, _COUNT * _DRAWS, np.random.default_rng(99))
        places = np.array([point_at(chosen.covariance, _DEPTH_M, place) for place in PLACES])
        draws = []
        for draw in range(_DRAWS):
            which = np.random.default_rng(draw).choice(len(pool), _COUNT, replace=False)
            draws.append(plan_covariance(plan, pool.chosen(which)).depth_std(places))
        stds = chosen.covariance.depth_std(places)
        ratios = stds / np.median(draws, axis=0)
        found.append(ratios)
        gain = math.nan if chosen.next_pose is None else chosen.next_pose.gain
        print(
            f"{name:14s} {plan.board.text:12s} {ratios[0]:6.2f} {ratios[1]:6.2f} {ratios[2]:6.2f}"
            f" {stds[0] * 1e3:7.2f} mm {gain:6.3f}  {_parallel(plan)}"
        )
    axis, edge, corner = np.nanmedian(found, axis=0)
    print(f"{'median':27s} {axis:6.2f} {edge:6.2f} {corner:6.2f}")


def _parallel(plan: PlanAsked) -> str:
    """What becomes of boards that are all parallel to the pictures."""
    try:
        made = run_plan(replace(plan, reach=replace(plan.reach, tilt_rad=0.0)))
    except CalibrationUndetermined as error:
        return f"refused: {error.reason}"
    std = made.covariance.depth_std([[0.0, 0.0, _DEPTH_M]])[0] * 1e3
    return f"{std:.2f} mm" + "".join(f", {remark.code}" for remark in made.remarks)


def _times() -> None:
    print("\n50 poses of a board of 10x10 corners")
    plan = replace(asked(rigsim.preset("oak-d").rig, board("10x10@30mm"), Reach()), poses=50)
    start = time.perf_counter()
    made = run_plan(plan)
    print(f"  chosen among 550, covariance, curve, next {time.perf_counter() - start:6.2f} s   (15 s)")
    start = time.perf_counter()
    run_plan(replace(plan, poses=made.poses))
    print(f"  given: covariance, curve, next of 550     {time.perf_counter() - start:6.2f} s   (15 s)")
    start = time.perf_counter()
    covariance = plan_covariance(plan, ReachedPoses(made.poses, made.seen))
    covariance.depth_std([[0.0, 0.0, _DEPTH_M]])
    print(f"  given: covariance and depth               {time.perf_counter() - start:6.2f} s   (3 s)")
