"""`rigsim.sweep`: many rigs in one scene, predicted, simulated and measured."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from rigsim.api.kit.asked import at_distances
from rigsim.api.kit.cover import cover
from rigsim.api.kit.golden import print_comparison
from rigsim.api.kit.plain import takes
from rigsim.api.kit.sweep_plan import SweepOptions, plan_of, swept
from rigsim.api.result import Result
from rigsim.errors import InvalidRange
from rigsim.rig.remark import Remark
from rigsim.study.scene.plan import Plan
from rigsim.study.sweep.result import SweepResult

if TYPE_CHECKING:
    from rigsim.interop.documents.base import Written
    from rigsim.present.kit.page import Cover
    from rigsim.present.kit.types import Figure, Table
    from rigsim.present.sweep.words import Verdict
    from rigsim.study.golden.compare import GoldenReport


@dataclass(frozen=True, slots=True, eq=False)
class Sweep(SweepResult, Result):
    """A `SweepResult` with its table, figures, files and document."""

    golden: GoldenReport | None = None
    """How the numbers compare with golden results; None when it was not asked."""
    cover: Cover | None = None
    """Title, note and logo of one's own report; None for none."""

    @property
    def table(self) -> Table:
        """One row a configuration, as in sweep.csv: `rows` with its agreements as words."""
        from rigsim.present.kit.agreement import spelled

        return spelled(self.rows)

    @property
    def verdict(self) -> Verdict:
        """The answer in words, with numbers."""
        from rigsim.present.sweep.words import verdict

        return verdict(self)

    @property
    def headline(self) -> str:
        """The answer in one sentence."""
        return self.verdict.headline

    @property
    def figures(self) -> Mapping[str, Callable[[], Figure]]:
        """``depth_error``, ``topdown``, and ``witnesses`` where something was measured."""
        from rigsim.present.sweep import files

        return files.figures(self)

    def files(self) -> dict[str, bytes]:
        """report.html, its pictures, sweep.csv, sweep_by_depth.csv, rig.toml and provenance.json."""
        from rigsim import present
        from rigsim.interop.files.tables import sweep_files
        from rigsim.present.sweep.words import spelled

        return {**present.sweep_files(self, self.cover), **sweep_files(self, spelled)}

    def document(self, written: Written | None = None) -> Mapping[str, Any]:
        """The whole sweep; docs/reference/json.md says what the keys mean."""
        from rigsim.interop.documents.sweep import sweep_document
        from rigsim.present.sweep import words

        return sweep_document(self, words, written, self.golden)

    def print(self, folder: Path | None = None) -> None:
        """Print the verdict, the best rows and what is flagged."""
        from rigsim import present

        present.print_sweep(self, folder)
        print_comparison(self.golden)


@takes(SweepOptions)
def sweep(options: SweepOptions) -> Sweep:
    """Predict, simulate and measure every rig in a scene, beside each other.

    Say the rigs in plain words (`rig` and the axes, which multiply), or give them with a `Plan`.

    Args:
        rigs: A `RigGrid`, or any rigs; excludes `rig` and the axes.
        plan: All that decides the numbers; excludes the words that it has as well.
        rig: The rig that is varied: a preset's name, a calibration's path or text, or a rig; by default the
            one that the scene is made for. A file's own sensor and perturbation count as well.
        baselines_mm: Distances between the cameras, mm.
        focals_px: Focal lengths, px; excludes `hfovs_deg`.
        hfovs_deg: Horizontal fields of view, deg.
        resolutions_px: (width, height), px.
        vergences_deg: Toe-in angles, deg.
        noises_px: Standard deviations of the noise of one pixel coordinate, px; 0.25 unless said.
        disparity_noises_px: Standard deviations of a disparity, px, instead: sqrt(2) times as much.
        more: Values of other axes, by name, as the command line calls them, in their column's unit.
        scene: A bundled scene's name, or the path of an MJCF file.
        mount: Where the rig sits: ``body:NAME``, ``site:NAME`` or ``camera:NAME``.
        assume: The rig that triangulates, where it is another than the true one, which projects.
        perturbation: How the built rig differs from the one that is swept; excludes `assume`.
        calibration: Path of a covariance.json, plan.json or calibration.json of `rigsim calibrate`: every
            trial is triangulated with another calibration of its rig, which is taken where none is named, and
            the prediction holds what that leaves. Excludes `assume` and `perturbation`.
        range_m: Nearest and farthest depth of the truth points, m.
        points: Truth points of each rig.
        trials: Noisy repetitions of each point.
        measure: What is measured in the pictures: auto, none, corners, patches or dense.
        rectify: What pictures of a rig that is not rectified are turned into before they are matched:
            perspective, cylinder or latlong; None chooses by what the lenses see.
        sensor: A sensor, or the name of one, as ``IMX477``.
        blur_px: Standard deviation of the lens's point spread, px.
        image_noise_grey: White noise of the pictures, grey levels of 255; 2 where nothing else is said.
        full_well_e: Electrons that make full scale.
        read_noise_e: Read noise, electrons.
        triangulators: Names, ``package.module:function``, which runs in a process of its own, or functions.
        timeout_s: For one call of such a function, a block of trials, s.
        in_process: Whether it is called in this process: faster, but if it crashes or hangs, so does this.
        seed: Seed of every random number.
        renderer: auto, egl, osmesa or rays.
        supersample: Samples along each side of a drawn pixel: 1, 2 or 4.
        jobs: Processes; the numbers do not depend on it.
        progress: Is called with the number of rigs done. When it or a worker is interrupted, the result
            holds what is done by then.
        command: What the files and the document name as the command that made them.
        require: Depth errors that rows are to keep, each a `DepthError` with its distance.
        title: Title of the report, in place of its own.
        note: A paragraph of the report.
        logo: Path of a picture at its head, PNG or SVG.

    Raises:
        InvalidRange: A value is out of bounds, or two say the same thing.
        InvalidRig, OutputError: As `read_rig`.
        InvalidScene: The scene cannot be used, or no rig sees anything with both cameras.
        TriangulatorError: A triangulator is unknown; or all of them raise or return the wrong thing.
        RenderUnavailable: The renderer asked for does not work here.

    Example:
        >>> import rigsim
        >>> found = rigsim.sweep(
        ...     rig="oak-d", baselines_mm=[50, 100], resolutions_px=(160, 100), points=100, trials=10,
        ...     renderer="rays", supersample=1,
        ... )
        >>> found.table["baseline_mm"].tolist()
        [50.0, 100.0]
        >>> bool(found.table["depth_rmse_mm"].iloc[0] > found.table["depth_rmse_mm"].iloc[1])
        True
    """
    return _run(options)


def _run(options: SweepOptions) -> Sweep:
    from rigsim.study.sweep.requirement import DepthRequirement
    from rigsim.study.sweep.run import sweep as run

    require = at_distances(options.require)
    head = cover(options.title, options.note, options.logo)
    rigs, plan, remarks = _asked(options)
    if options.command:
        plan = replace(plan, extra={**plan.extra, "command": options.command})
    asked = [
        DepthRequirement((one.at_m or 0) * 1e3, one.error_m(one.at_m or 0) * 1e3, one.p95, one.pct)
        for one in require
    ]
    result = run(cast(Any, rigs), plan, jobs=options.jobs, progress=options.progress, require=asked)
    values = {field.name: getattr(result, field.name) for field in fields(result)}
    values |= {"remarks": (*remarks, *result.remarks), "cover": head}
    return Sweep(**values)


def _asked(options: SweepOptions) -> tuple[object, Plan, tuple[Remark, ...]]:
    """The rigs, what is done with them, and what is odd about this machine."""
    said = options.said()
    remarks: tuple[Remark, ...] = ()
    if options.plan is not None:
        if said:
            raise InvalidRange(f"a plan and {', '.join(said)} both given: the plan says it all, give one")
        rigs, plan = swept(options), options.plan
    elif not said and not isinstance(options.rigs, str | os.PathLike):
        rigs, plan = swept(options), Plan()
    else:
        rigs = swept(options)
        plan, remarks = plan_of(options)
    return rigs, plan, remarks
