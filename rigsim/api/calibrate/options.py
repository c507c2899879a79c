"""What `rigsim.plan_calibration` is asked for, and what the study takes of it."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable
from dataclasses import KW_ONLY, dataclass, replace
from typing import TYPE_CHECKING, TypeAlias, cast

import numpy as np
import numpy.typing as npt

from rigsim.api.kit.asked import depth_errors
from rigsim.api.rigs import RigLike, read_rig
from rigsim.errors import InvalidRange
from rigsim.rig import given
from rigsim.rig.board import Board
from rigsim.rig.noise import coordinate_noise_px
from rigsim.rig.quantity import NOISE_PX
from rigsim.rig.remark import Remark

if TYPE_CHECKING:
    from rigsim.rig.lens.lens import Lens
    from rigsim.rig.stereo import StereoRig
    from rigsim.study.calibrate.plan.asked import DepthGoal, PlanAsked
    from rigsim.study.calibrate.plan.result import CalibrationPlan
    from rigsim.study.calibrate.witness.result import CalibrationWitness
    from rigsim.theory.calibration.boards import BoardPoses

BoardLike: TypeAlias = Board | str
"""A board, or its text: ``9x6@30mm``."""

PosesLike: TypeAlias = int | str | os.PathLike[str] | npt.ArrayLike
"""How many poses are to be chosen; a poses.json; or rotation vectors (rad) and translations (m), (n, 6)."""


@dataclass(frozen=True, slots=True)
class PlanOptions:
    """The arguments of `plan_calibration`, which says what they mean."""

    rig: RigLike
    _: KW_ONLY
    board: BoardLike = "9x6@30mm"
    poses: PosesLike = 20
    range_m: tuple[float, float] = (0.4, 1.2)
    tilt_deg: float = 40.0
    corner_noise_px: float = 0.1
    noise_px: float | None = None
    disparity_noise_px: float | None = None
    model: str | None = None
    fix: Iterable[str] = ()
    warp: bool = False
    flatness_mm: float = 0.0
    depth_error_mm: float | None = None
    depth_error_pct: float | None = None
    depth_error_at_m: float | None = None
    at_m: float | Iterable[float] = (1.0, 2.0, 3.0, 5.0)
    simulate: int = 0
    measure: int = 0
    true_model: RigLike | None = None
    true_warp_mm: float | tuple[float, float] = 0.0
    seed: int = 0
    command: str = ""
    progress: Callable[[str, int, int], None] | None = None


def as_board(board: object) -> Board:
    """A board as it is, or of its text.

    Raises:
        InvalidRange: it is neither.
    """
    if isinstance(board, str):
        return Board.of(board)
    return given.a(Board, board, "a Board, or its text as 9x6@30mm")


def plan_asked(options: PlanOptions, rig: StereoRig, board: Board) -> tuple[PlanAsked, tuple[Remark, ...]]:
    """What is to be planned, and what is odd about the lens model."""
    from rigsim.study.calibrate.plan.asked import PlanAsked, Reach
    from rigsim.study.calibrate.plan.free import estimated
    from rigsim.study.calibrate.plan.models import in_model, lens_model, own_model

    model = own_model(rig) if options.model is None else lens_model(str(options.model))
    modelled, remarks = in_model(rig, model)
    fix = (options.fix,) if isinstance(options.fix, str) else tuple(str(word) for word in options.fix)
    parameters, held = estimated(modelled, model, fix=fix, warped=bool(options.warp))
    near_m, far_m = _two(options.range_m, "range_m", "(near, far), m")
    noise_px = coordinate_noise_px(options.noise_px, options.disparity_noise_px)
    at_m = given.reals(options.at_m, "at_m")
    poses, recorded = _poses(options.poses, board)
    asked = PlanAsked(
        modelled,
        parameters,
        board,
        poses=poses,
        reach=Reach(near_m, far_m, math.radians(given.real(options.tilt_deg, "tilt_deg"))),
        corner_noise_px=given.real(options.corner_noise_px, "corner_noise_px"),
        noise_px=NOISE_PX if noise_px is None else given.real(noise_px, "noise_px"),
        flatness_m=given.real(options.flatness_mm, "flatness_mm") / 1e3,
        goal=_goal(options, at_m),
        at_m=tuple(sorted(at_m)),
        seed=options.seed,
    )
    return asked, (*remarks, *held, *recorded)


def _poses(poses: object, board: Board) -> tuple[BoardPoses | int, tuple[Remark, ...]]:
    """Where boards are held, or how many are; and a remark where that was recorded with another board."""
    from rigsim.interop.files.poses import read_recorded_poses
    from rigsim.theory.calibration.boards import BoardPoses

    if isinstance(poses, BoardPoses):
        return poses, ()
    if isinstance(poses, str | os.PathLike):
        path = given.path(poses, "poses")
        found, recorded = read_recorded_poses(path)
        if recorded is None or recorded.text == board.text:
            return found, ()
        text = (
            f"{path} was recorded with board {recorded.text}: its poses are of that one's first corner, and"
            f" {board.text} reaches elsewhere from there"
        )
        return found, (Remark("another_board", text),)
    if isinstance(poses, int | np.integer) and not isinstance(poses, bool):
        return int(poses), ()
    rows = BoardPoses.of(cast(npt.ArrayLike, poses))
    if not len(rows):
        raise InvalidRange("poses: there are none: give a number, a poses.json, or six numbers a board")
    return rows, ()


def _goal(options: PlanOptions, at_m: tuple[float, ...]) -> DepthGoal | None:
    from rigsim.study.calibrate.plan.asked import DepthGoal

    asked = depth_errors(options.depth_error_mm, options.depth_error_pct, options.depth_error_at_m)
    if not asked:
        return None
    (error,) = asked
    if error.pct is not None and not 0 < error.pct < 100:
        raise InvalidRange(f"depth error {error.pct:g} %: must be > 0 and < 100 %")
    z_m = max(at_m, default=math.nan) if error.at_m is None else error.at_m
    return DepthGoal(error.error_m(z_m), z_m)


def _count(value: object, name: str) -> int:
    count = given.real(value, name)
    if not (count.is_integer() and count >= 0):
        raise InvalidRange(f"{name} {count:g}: must be a whole number, 0 or more")
    return int(count)


def _two(values: object, name: str, wanted: str) -> tuple[float, float]:
    ends = given.reals(values, name)
    if len(ends) != 2:
        raise InvalidRange(f"{name} {given.shown(values)}: must be {wanted}")
    return ends[0], ends[1]


def whole_calibrations(
    options: PlanOptions, plan: CalibrationPlan, true_rig: StereoRig | None
) -> tuple[CalibrationWitness, ...]:
    """Whole calibrations, where they were asked for."""
    if not (options.simulate or options.measure):
        return ()
    from rigsim.study.calibrate.witness.run import run_witnesses

    return run_witnesses(
        plan,
        simulated=_count(options.simulate, "simulate"),
        measured=_count(options.measure, "measure"),
        true_rig=true_rig,
        true_board=_true_board(options.true_warp_mm, plan.asked.board),
        progress=options.progress,
    )


def true_rig_of(options: PlanOptions, asked: PlanAsked, rig: StereoRig) -> StereoRig | None:
    """The rig that the pictures are of; None where it is the plan's."""
    from rigsim.study.calibrate.plan.models import in_model, own_model

    true = rig
    if options.true_model is not None:
        lens = _lens_named(options.true_model)
        true = _true_file(options.true_model) if lens is None else in_model(rig, lens)[0]
    try:
        as_planned, remarks = in_model(true, own_model(asked.rig))
    except InvalidRange:  # the plan's model shows less
        return true
    # a lens that the plan's model holds exactly is no other lens
    return None if not remarks and as_planned == asked.rig else true


def _true_file(named: RigLike) -> StereoRig:
    try:
        return read_rig(named)
    except InvalidRange as error:
        raise InvalidRange(
            f"true model {given.shown(named)}: is no lens model, and no rig: {error}"
        ) from None


def _lens_named(word: object) -> type[Lens] | None:
    from rigsim.study.calibrate.plan.models import lens_model

    try:
        return lens_model(word) if isinstance(word, str) else None
    except InvalidRange:
        return None


def _true_board(warp_mm: object, board: Board) -> Board | None:
    """The board that is in the pictures; None where it is the plan's."""
    warps = given.reals(warp_mm, "true_warp_mm")
    if not any(warps):
        return None
    along, down = _two(warps * 2 if len(warps) == 1 else warps, "true_warp_mm", "one length, or two")
    return replace(board, warp_m=(along / 1e3, down / 1e3))
