"""`rigsim.plan_calibration`: which board, held where, how many times, and what that leaves of the depth."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rigsim.api.calibrate.options import PlanOptions, as_board, plan_asked, true_rig_of, whole_calibrations
from rigsim.api.kit.plain import takes
from rigsim.api.result import Result
from rigsim.api.rigs import read_rig
from rigsim.rig.remark import Remark

if TYPE_CHECKING:
    from rigsim.interop.documents.base import Written
    from rigsim.present.kit.types import Figure, Table
    from rigsim.study.calibrate.plan.result import CalibrationPlan
    from rigsim.study.calibrate.witness.result import CalibrationWitness
    from rigsim.theory.calibration.boards import BoardPoses


@dataclass(frozen=True, slots=True, eq=False)
class PlannedCalibration(Result):
    """Where the board is held, how many times, and what that leaves of the depth."""

    plan: CalibrationPlan
    """Everything that was worked out."""
    witnesses: tuple[CalibrationWitness, ...] = ()
    """What whole calibrations say, simulated and measured; empty where none were asked for."""
    command: str = ""
    """What the page names as the command that made it."""
    remarks: tuple[Remark, ...] = ()
    """What is odd about what was asked, and about the plan."""
    complete: bool = True
    """Whether all witnesses that were asked for are there; False after Ctrl-C."""

    @property
    def table(self) -> Table:
        """One row a distance and place: the columns of ``depth_std_places``."""
        from rigsim.present.kit.types import table

        return table(self.document()["depth_std_places"])

    @property
    def verdict(self) -> int | None:
        """The fewest pictures that meet the depth error; None where no number does, or none was asked for."""
        return self.plan.needed.count

    @property
    def headline(self) -> str:
        """The answer in one sentence, and another where witnesses met another lens or board."""
        from rigsim.present.calibrate.plan_words import headline, true_sentence

        true = true_sentence(self.plan, self.witnesses).replace("`", "")
        return f"{headline(self.plan)} {true}".rstrip()

    @property
    def poses(self) -> BoardPoses:
        """Where the board is held, best first unless it was said."""
        return self.plan.poses

    @property
    def figures(self) -> Mapping[str, Callable[[], Figure]]:
        """``plan``: how many pictures; ``poses``: the board in both; ``projection``: how sure pixels are."""
        from rigsim.present.calibrate.plan_figures import curve_figure
        from rigsim.present.calibrate.poses_figure import poses_figure
        from rigsim.present.calibrate.projection_figure import projection_figure

        return {
            "plan": lambda: curve_figure(self.plan),
            "poses": lambda: poses_figure(self.plan),
            "projection": lambda: projection_figure(self.plan),
        }

    def files(self) -> dict[str, bytes]:
        """plan.html, plan.json, poses.json, covariance.json, plan.png, poses.png and projection.png."""
        from rigsim.interop.documents.calibrate.covariance import covariance_document
        from rigsim.interop.documents.calibrate.plan import covariance_source
        from rigsim.interop.files.poses import poses_document
        from rigsim.interop.files.tables import json_bytes
        from rigsim.present.calibrate.plan_page import plan_html
        from rigsim.present.kit.style import to_png

        plan, document = self.plan, self.document()
        says = [pose["says"] for pose in document["poses"]]
        page = plan_html(plan, self.witnesses, self.command, self.remarks)
        return {
            "plan.html": page.encode(),
            "plan.json": json_bytes(document),
            "poses.json": json_bytes(poses_document(plan.asked.board, plan.poses, says)),
            "covariance.json": json_bytes(covariance_document(plan.covariance, covariance_source(plan))),
            **{f"{name}.png": to_png(draw()) for name, draw in self.figures.items()},
        }

    def document(self, written: Written | None = None) -> Mapping[str, Any]:
        """The plan; docs/reference/calibrate.md says what the keys mean."""
        from rigsim.interop.documents.calibrate.plan import PlanTold, plan_document
        from rigsim.present.calibrate import plan_words

        told = PlanTold(self.command, self.witnesses, self.remarks, self.complete, written)
        return plan_document(self.plan, plan_words, told)

    def print(self, folder: Path | None = None) -> None:
        """Print the answer, the depth at each distance, how many pictures it takes, and what to do next."""
        from rigsim.present.calibrate.plan_console import print_plan

        print_plan(self.plan, self.witnesses, self.command, folder)


@takes(PlanOptions)
def plan_calibration(options: PlanOptions) -> PlannedCalibration:
    """Plan a stereo calibration: how many pictures of a board, held where, and what they leave of the depth.

    Args:
        rig: The rig that is to be calibrated: a preset's name, a calibration's path or text, or a rig.
        board: The board, or its text: inner corners and a square's side.
        poses: How many poses are to be chosen, 2 to 200; or a poses.json, or numbers (n, 6): rotation vector,
            rad, and translation, m, of left_from_board.
        range_m: How near and how far the board can be held, m.
        tilt_deg: Most that it is turned out of the picture's plane, deg.
        corner_noise_px: Standard deviation of one coordinate of a found corner, px.
        noise_px: Standard deviation of one pixel coordinate when the rig measures, px; 0.25 unless said.
        disparity_noise_px: Standard deviation of a disparity, px, instead: sqrt(2) times as much.
        model: Lens model that the calibration estimates: brown, rational, fisheye, ...; the rig's own by
            default, brown where it has none.
        fix: What it does not estimate: k3, aspect, right.p1, tangential, ...
        warp: Whether it estimates the board's warp.
        flatness_mm: Standard deviation of each of the board's two warps, mm.
        depth_error_mm: Largest standard deviation of a depth on the axis, mm, by calibration and noise.
        depth_error_pct: The same in percent of the distance, instead.
        depth_error_at_m: Its distance, m; the largest of `at_m` by default.
        at_m: Depths that are told, m.
        simulate: How many whole calibrations are simulated beside the prediction.
        measure: How many are made of rendered pictures.
        true_model: The true lens where it is another: a model's name, or a rig as `rig`.
        true_warp_mm: True warp of the board along its rows and columns, mm; one number is of both.
        seed: Of all random numbers.
        command: What the page names as the command that made it.
        progress: Told what things, how many are done, of how many.

    Raises:
        InvalidRange: A value is out of bounds, a name is none, or the board fits nowhere.
        CalibrationUndetermined: The boards leave the rig open; its `reason` says why.
        InvalidRig, OutputError: As `read_rig`.

    Example:
        >>> import rigsim
        >>> found = rigsim.plan_calibration("oak-d", board="9x6@30mm", poses=6, depth_error_mm=25, at_m=2)
        >>> found.verdict <= 6, found.poses.rows.shape
        (True, (6, 6))
    """
    from rigsim.study.calibrate.plan.run import run_plan

    rig, board = read_rig(options.rig), as_board(options.board)
    asked, odd = plan_asked(options, rig, board)
    met = true_rig_of(options, asked, rig) if options.simulate or options.measure else None
    plan = run_plan(asked)
    witnesses = whole_calibrations(options, plan, met)
    wanted = [count for count in (options.simulate, options.measure) if count]
    complete = [one.calibrations for one in witnesses] == wanted
    return PlannedCalibration(plan, witnesses, options.command, (*odd, *plan.remarks), complete)
