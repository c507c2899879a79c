"""The words of a sweep, as a plan and its rigs."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, fields
from typing import Any, cast

from rigsim.api.kit import rendering
from rigsim.api.kit.asked import DepthError
from rigsim.api.kit.calibrations import read_calibration_tolerance
from rigsim.api.kit.sensors import TYPICAL_NOISE_GREY, SensorOptions, sensor_labels
from rigsim.api.rigs import RigLike, Several, Sizes, Told, read_rig, rig_file, rig_for, told_of
from rigsim.errors import InvalidRange
from rigsim.pixels.dense.views import view_of
from rigsim.rig import given
from rigsim.rig.noise import PixelNoise, as_noise, coordinate_noises_px
from rigsim.rig.perturbation import Perturbation
from rigsim.rig.quantity import NOISE_PX
from rigsim.rig.remark import Remark
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig
from rigsim.study.scene.axes import registry
from rigsim.study.scene.axes.axis import Axis
from rigsim.study.scene.plan import Plan, RigGrid, Triangulator

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
    noises_px: Several | None = None
    disparity_noises_px: Several | None = None
    more: Mapping[str, Several] | None = None
    scene: str | os.PathLike[str] = "boards"
    mount: str | None = None
    assume: RigLike | None = None
    perturbation: Perturbation | None = None
    calibration: str | os.PathLike[str] | None = None
    range_m: tuple[float, float] | None = None
    points: int = 2000
    trials: int = 100
    measure: str = "auto"
    rectify: str | None = None
    sensor: str | Sensor | None = None
    blur_px: float | None = None
    image_noise_grey: Several = ()
    full_well_e: float | None = None
    read_noise_e: float | None = None
    triangulators: Triangulator | Sequence[Triangulator] = "optimal"
    timeout_s: float = 60.0
    in_process: bool = False
    seed: int = 0
    renderer: str = "auto"
    supersample: int = 2
    jobs: int = 1
    progress: Callable[[int], None] | None = None
    command: str = ""
    require: DepthError | Sequence[DepthError] = ()
    title: str = ""
    note: str = ""
    logo: str | os.PathLike[str] | None = None

    def said(self) -> tuple[str, ...]:
        """The arguments that were given, of those that a plan has as well or that make the rigs."""
        other = ("rigs", "plan", "jobs", "progress", "command", "require", "title", "note", "logo")
        return tuple(
            field.name
            for field in fields(self)
            if field.name not in other
            and not _same(getattr(self, field.name), field.default)
            and not (field.name == "noises_px" and _same(self.noises_px, NOISE_PX))
        )


def _grid(rig: StereoRig, options: SweepOptions) -> RigGrid:
    """All rigs that a rig makes with the axes that were given.

    Raises:
        InvalidRange: a value is none, or two axes say the same thing.
    """
    return RigGrid(
        rig,
        baselines_m=tuple(mm / 1e3 for mm in given.reals(options.baselines_mm, "baselines_mm")),
        focals_px=given.reals(options.focals_px, "focals_px"),
        hfovs_deg=given.reals(options.hfovs_deg, "hfovs_deg"),
        resolutions_px=cast(Any, options.resolutions_px),
        vergences_deg=given.reals(options.vergences_deg, "vergences_deg"),
        more=_values(options.more, registry.OF_RIG),
    )


def _values(more: Mapping[str, Several] | None, axes: Sequence[Axis]) -> dict[str, tuple[float, ...]]:
    """Those of `more` that are of `axes`, as the axes take them.

    Raises:
        InvalidRange: there is no such axis.
    """
    more = dict(more or {})
    known = {axis.name for axis in (*registry.OF_RIG, *registry.OF_NOISE)}
    for name in more:
        if name not in known:
            raise InvalidRange(f"axis {name!r}: must be one of {', '.join(sorted(known))}")
    return {
        axis.name: tuple(value * axis.scale for value in given.reals(more[axis.name], axis.name))
        for axis in axes
        if axis.name in more
    }


_AXES = ("baselines_mm", "focals_px", "hfovs_deg", "resolutions_px", "vergences_deg")


def swept(options: SweepOptions) -> object:
    """The rigs to sweep."""
    rigs, said = options.rigs, options.said()
    if isinstance(rigs, str | os.PathLike):
        if options.rig is not None:
            raise InvalidRange("rigs and rig both given: they say the same thing, give one")
        return _grid(read_rig(rigs), options)
    if rigs is None:
        if not said:
            raise InvalidRange("no rig to sweep: give one, as in rig='oak-d', or a RigGrid")
        if options.rig is None and options.calibration is not None:
            return _grid(read_calibration_tolerance(options.calibration).covariance.rig, options)
        return _grid(rig_for(options.rig, str(options.scene)), options)
    both = [name for name in said if name == "rig" or name in _AXES]
    both += sorted({axis.name for axis in registry.OF_RIG} & set(options.more or {}))
    if both:
        raise InvalidRange(f"rigs and {', '.join(both)} both given: they say the same thing, give one")
    return rigs


def plan_of(options: SweepOptions) -> tuple[Plan, tuple[Remark, ...]]:
    """The plan that the words say, and what is odd about this machine."""
    rig = options.rigs if isinstance(options.rigs, str | os.PathLike) else options.rig
    told = told_of(rig)
    assumed, perturbation = _assumed(options, rig, told)
    sensors = _sensors(options, told)
    renderer, measure, remarks = rendering.choose(options.renderer, options.measure)
    plan = Plan(
        scene=cast(str, options.scene),
        mount=options.mount,
        noises=_noises(options),
        triangulators=cast(Any, options.triangulators),
        range_m=options.range_m,
        n_points=options.points,
        n_trials=options.trials,
        seed=options.seed,
        renderer=renderer,
        supersample=options.supersample,
        measure=measure,
        rectify=view_of(options.rectify),
        assumed=assumed,
        perturbation=perturbation,
        calibration=None if options.calibration is None else read_calibration_tolerance(options.calibration),
        timeout_s=None if options.in_process else options.timeout_s,
        asked=tuple(axis.columns[0].name for axis in registry.ALL if axis.name in (options.more or {})),
        sensors=sensors,
    )
    return plan, remarks


def _noises(options: SweepOptions) -> tuple[PixelNoise, ...]:
    """Every noise asked for; axes of the noise multiply."""
    said = coordinate_noises_px(options.noises_px, options.disparity_noises_px)
    plain = (NOISE_PX,) if said is None else said
    values = _values(options.more, registry.OF_NOISE)
    if not values:
        return tuple(as_noise(noise) for noise in plain)
    same = [name for name in values if "noise" in (name, registry.BY_NAME[name].instead_of)]
    if same and said is not None:
        word = "noises_px" if options.disparity_noises_px is None else "disparity_noises_px"
        raise InvalidRange(f"{word} and {same[0]} both given: they say the same thing, give one")
    if not same:
        values["noise"] = given.reals(plain, "noises_px")
    return registry.noises(values)


def _sensors(options: SweepOptions, told: Told) -> dict[str, Sensor]:
    """The sensors asked for, by the names they have in tables."""
    levels = given.reals(options.image_noise_grey, "image_noise_grey")
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
