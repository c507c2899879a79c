"""`rigsim.sweep`: many rigs in one scene, predicted, simulated and measured."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from rigsim.api import rendering
from rigsim.api.plain import takes
from rigsim.api.result import Result
from rigsim.api.rigs import RigLike, Several, Sizes, Told, read_rig, rig_file, rig_for, told_of
from rigsim.api.sensors import TYPICAL_NOISE_GREY, SensorOptions, sensor_labels
from rigsim.errors import InvalidRange
from rigsim.rig import given
from rigsim.rig.perturbation import Perturbation
from rigsim.rig.remark import Remark
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig
from rigsim.study.scene.plan import Plan, RigGrid, Triangulator
from rigsim.study.sweep.result import SweepResult

if TYPE_CHECKING:
    from rigsim.interop.documents.base import Written
    from rigsim.present.kit.types import Figure, Table
    from rigsim.present.sweep.words import Verdict

Rigs = RigGrid | RigLike | Iterable[StereoRig]


@dataclass(frozen=True, slots=True)
class SweepOptions:
    """The arguments of `sweep`, which says what they mean."""

    rigs: Rigs | None = None
    plan: Plan | None = None
    _: KW_ONLY
    rig: RigLike | None = None
    baselines_mm: Several = ()
    focals_px: Several = ()
    hfovs_deg: Several = ()
    resolutions_px: Sizes = ()
    vergences_deg: Several = ()
    noises_px: Several = 0.25
    scene: str | os.PathLike[str] = "boards"
    mount: str | None = None
    assume: RigLike | None = None
    perturbation: Perturbation | None = None
    range_m: tuple[float, float] | None = None
    points: int = 2000
    trials: int = 100
    measure: str = "auto"
    sensor: str | Sensor | None = None
    blur_px: float | None = None
    image_noises_grey: Several = ()
    full_well_e: float | None = None
    read_noise_e: float | None = None
    triangulators: Triangulator | Sequence[Triangulator] = "optimal"
    seed: int = 0
    renderer: str = "auto"
    supersample: int = 2
    jobs: int = 1
    progress: Callable[[int], None] | None = None
    command: str = ""

    def said(self) -> tuple[str, ...]:
        """The arguments that were given, of those that a plan has as well or that make the rigs."""
        other = ("rigs", "plan", "jobs", "progress", "command")
        return tuple(
            field.name
            for field in fields(self)
            if field.name not in other and not _same(getattr(self, field.name), field.default)
        )


@dataclass(frozen=True, slots=True, eq=False)
class Sweep(SweepResult, Result):
    """A `SweepResult` with its table, figures, files and document."""

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

        return {**present.sweep_files(self), **sweep_files(self, spelled)}

    def document(self, written: Written | None = None) -> Mapping[str, Any]:
        """The whole sweep; docs/reference/sweep.md says what the keys mean."""
        from rigsim.interop.documents.sweep import sweep_document
        from rigsim.present.sweep import words

        return sweep_document(self, words, written)

    def print(self, folder: Path | None = None) -> None:
        """Print the verdict, the best rows and what is flagged."""
        from rigsim import present

        present.print_sweep(self, folder)


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
        noises_px: Standard deviations of the noise of one pixel coordinate, px.
        scene: A bundled scene's name, or the path of an MJCF file.
        mount: Where the rig sits: ``body:NAME``, ``site:NAME`` or ``camera:NAME``.
        assume: The rig that triangulates, where it is another than the true one, which projects.
        perturbation: How the built rig differs from the one that is swept; excludes `assume`.
        range_m: Nearest and farthest depth of the truth points, m.
        points: Truth points of each rig.
        trials: Noisy repetitions of each point.
        measure: What is measured in the pictures: auto, none, corners, patches or dense.
        sensor: A sensor, or the name of one, as ``IMX477``.
        blur_px: Standard deviation of the lens's point spread, px.
        image_noises_grey: White noise of the pictures, grey levels of 255; 2 where nothing else is said.
        full_well_e: Electrons that make full scale.
        read_noise_e: Read noise, electrons.
        triangulators: Names, ``package.module:function``, or callables.
        seed: Seed of every random number.
        renderer: auto, egl, osmesa or rays.
        supersample: Samples along each side of a drawn pixel: 1, 2 or 4.
        jobs: Processes; the numbers do not depend on it.
        progress: Is called with the number of rigs done. When it or a worker is interrupted, the result
            holds what is done by then.
        command: What the files and the document name as the command that made them.

    Raises:
        InvalidRange: A value is out of bounds, or two say the same thing.
        InvalidRig, OutputError: As `read_rig`.
        InvalidScene: The scene cannot be used, or no rig sees anything with both cameras.
        TriangulatorError: A triangulator is unknown, raises or returns the wrong thing.
        RenderUnavailable: The renderer asked for does not work here.

    Example:
        >>> import rigsim
        >>> found = rigsim.sweep(
        ...     rig="oak-d", baselines_mm=[50, 100], resolutions_px=(160, 100), points=100, trials=10,
        ...     renderer="rays",
        ... )
        >>> found.table["baseline_mm"].tolist()
        [50.0, 100.0]
        >>> bool(found.table["depth_rmse_mm"].iloc[0] > found.table["depth_rmse_mm"].iloc[1])
        True
    """
    from rigsim.study.sweep.run import sweep as run

    said = options.said()
    remarks: tuple[Remark, ...] = ()
    if options.plan is not None:
        if said:
            raise InvalidRange(f"a plan and {', '.join(said)} both given: the plan says it all, give one")
        rigs, plan = _swept(options), options.plan
    elif not said and not isinstance(options.rigs, str | os.PathLike):
        rigs, plan = _swept(options), Plan()
    else:
        rigs = _swept(options)
        plan, remarks = _plan(options)
    if options.command:
        plan = replace(plan, extra={**plan.extra, "command": options.command})
    result = run(cast(Any, rigs), plan, jobs=options.jobs, progress=options.progress)
    values = {field.name: getattr(result, field.name) for field in fields(result)}
    return Sweep(**{**values, "remarks": (*remarks, *result.remarks)})


def rig_grid(
    rig: RigLike | None = None,
    scene: str = "",
    *,
    baselines_mm: Several = (),
    focals_px: Several = (),
    hfovs_deg: Several = (),
    resolutions_px: Sizes = (),
    vergences_deg: Several = (),
) -> RigGrid:
    """All rigs that a rig and its axes make; arguments as those of `sweep`.

    Raises:
        InvalidRange: a value is none, or two axes say the same thing.
    """
    return RigGrid(
        rig_for(rig, scene),
        baselines_m=tuple(mm / 1e3 for mm in given.reals(baselines_mm, "baselines_mm")),
        focals_px=given.reals(focals_px, "focals_px"),
        hfovs_deg=given.reals(hfovs_deg, "hfovs_deg"),
        resolutions_px=cast(Any, resolutions_px),
        vergences_deg=given.reals(vergences_deg, "vergences_deg"),
    )


_AXES = ("baselines_mm", "focals_px", "hfovs_deg", "resolutions_px", "vergences_deg")


def _swept(options: SweepOptions) -> object:
    """The rigs to sweep."""
    rigs, said = options.rigs, options.said()
    if isinstance(rigs, str | os.PathLike):
        if options.rig is not None:
            raise InvalidRange("rigs and rig both given: they say the same thing, give one")
        return rig_grid(rigs, **{axis: getattr(options, axis) for axis in _AXES})
    if rigs is None:
        if not said:
            raise InvalidRange("no rig to sweep: give one, as in rig='oak-d', or a RigGrid")
        axes = {axis: getattr(options, axis) for axis in _AXES}
        return rig_grid(options.rig, str(options.scene), **axes)
    both = [name for name in said if name == "rig" or name in _AXES]
    if both:
        raise InvalidRange(f"rigs and {', '.join(both)} both given: they say the same thing, give one")
    return rigs


def _plan(options: SweepOptions) -> tuple[Plan, tuple[Remark, ...]]:
    """The plan that the words say, and what is odd about this machine."""
    rig = options.rigs if isinstance(options.rigs, str | os.PathLike) else options.rig
    told = told_of(rig)
    assumed, perturbation = _assumed(options, rig, told)
    sensors = _sensors(options, told)
    renderer, measure, remarks = rendering.choose(options.renderer, options.measure)
    plan = Plan(
        scene=cast(str, options.scene),
        mount=options.mount,
        noises=cast(Any, options.noises_px),
        triangulators=cast(Any, options.triangulators),
        range_m=options.range_m,
        n_points=options.points,
        n_trials=options.trials,
        seed=options.seed,
        renderer=renderer,
        supersample=options.supersample,
        measure=measure,
        assumed=assumed,
        perturbation=perturbation,
        sensors=sensors,
    )
    return plan, remarks


def _sensors(options: SweepOptions, told: Told) -> dict[str, Sensor]:
    """The sensors asked for, by the names they have in tables."""
    levels = given.reals(options.image_noises_grey, "image_noises_grey")
    if not levels and options.sensor is None and options.full_well_e is None and told.sensor is None:
        levels = (TYPICAL_NOISE_GREY,)
    asked = SensorOptions(options.sensor, options.blur_px, levels, options.full_well_e, options.read_noise_e)
    sensors = asked.all(told.sensor)
    return dict(zip(sensor_labels(sensors, asked.name), sensors, strict=True))


def _assumed(
    options: SweepOptions, rig: RigLike | None, told: Told
) -> tuple[StereoRig | None, Perturbation | None]:
    """The rig that triangulates, or how the built rig differs from the one swept; None where nothing says."""
    assume, perturbation = options.assume, options.perturbation or told.perturbation
    if assume is None:
        return None, perturbation
    name = rig_file(assume)
    if perturbation is not None:
        raise InvalidRange(
            f"--assume {name}: {rig_file(rig)} has a [perturbation] already, which says the same thing; "
            "give one"
        )
    if told_of(assume).perturbation is not None:
        raise InvalidRange(
            f"--assume {name}: its [perturbation] says what the built rig is, and so does --rig; "
            f"take it out, or give this file by --rig alone"
        )
    return read_rig(assume), None


def _same(value: object, default: object) -> bool:
    """Whether an argument is as if it had not been given."""
    return value is default or (isinstance(value, type(default)) and bool(value == default))
