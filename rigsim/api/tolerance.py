"""`rigsim.tolerance`: what must be held how tightly, and how many built rigs are good."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Mapping
from dataclasses import KW_ONLY, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rigsim.api.kit.asked import depth_errors
from rigsim.api.kit.calibrations import names_calibration, read_calibration_tolerance, rig_of_calibration
from rigsim.api.kit.golden import print_comparison
from rigsim.api.kit.plain import takes
from rigsim.api.result import Result
from rigsim.api.rigs import RigLike, read_rig
from rigsim.errors import InvalidRange
from rigsim.rig import given
from rigsim.rig.lens.distortion import are_brown
from rigsim.rig.noise import coordinate_noise_px
from rigsim.rig.quantity import NOISE_PX
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig

if TYPE_CHECKING:
    from rigsim.interop.documents.base import Written
    from rigsim.present.kit.types import Figure, Table
    from rigsim.study.golden.compare import GoldenReport
    from rigsim.study.tolerance.joint.cause import CalibrationTolerance
    from rigsim.study.tolerance.run import ToleranceResult
    from rigsim.study.tolerance.sensitivities import BuildRequirement, Tolerances

NO_CLASS = "none"
"""In place of a class: nothing is off but what is said."""


@dataclass(frozen=True, slots=True)
class ToleranceOptions:
    """The arguments of `tolerance`, which says what they mean."""

    rig: RigLike | None = None
    _: KW_ONLY
    depth_error_mm: float | None = None
    depth_error_pct: float | None = None
    at_m: float | None = None
    max_row_error_px: float | None = None
    range_m: tuple[float, float] = (1.0, 5.0)
    tolerance_class: str | os.PathLike[str] = "machined"
    tolerances: Mapping[str, float] | None = None
    bounds: Collection[str] = ()
    distribution: str = "normal"
    speed_m_s: float | None = None
    forward_speed_m_s: float = 0.0
    turn_rate_deg_s: float = 0.0
    moving: str = "object"
    expansion_ppm: float = 23.0
    recalibrate: bool = True
    recalibration_features: int = 60
    recalibration_pictures: int = 10
    noise_px: float | None = None
    disparity_noise_px: float | None = None
    length_std_mm: float = 0.5
    rigs: int = 10_000
    points: int = 500
    seed: int = 0


@dataclass(frozen=True, slots=True)
class Yields:
    """Shares of the built rigs that are good, 0 to 1."""

    as_built: float
    """As built, with pixel noise."""
    recalibrated: float | None
    """After a recalibration that knows nothing beforehand; None without one."""
    informed: float | None
    """After one that knows the tolerances beforehand; None without one."""


@dataclass(frozen=True, slots=True, eq=False)
class Toleranced(Result):
    """What each tolerance does to the depth, and how many built rigs are good."""

    result: ToleranceResult
    """The study."""
    remarks: tuple[Remark, ...] = ()
    """What is odd about what was asked."""
    golden: GoldenReport | None = None
    """How the numbers compare with golden results; None when it was not asked."""

    @property
    def table(self) -> Table:
        """One row a quantity, the worst first; the columns of tolerance.csv."""
        from rigsim.study.tolerance.table import tolerance_table

        return tolerance_table(self.result)

    @property
    def verdict(self) -> Yields:
        """How many of the built rigs are good."""
        result = self.result
        return Yields(result.yield_before, result.yield_after, result.yield_informed)

    @property
    def headline(self) -> str:
        """The answer in one sentence."""
        from rigsim.present.tolerance.console import headline

        return headline(self.result)

    @property
    def figures(self) -> Mapping[str, Callable[[], Figure]]:
        """``tolerance``: depth error against distance; ``places``: where in the image."""
        from rigsim.present.tolerance.console import tolerance_figure
        from rigsim.present.tolerance.places_figure import places_figure

        return {
            "tolerance": lambda: tolerance_figure(self.result),
            "places": lambda: places_figure(self.result),
        }

    def files(self) -> dict[str, bytes]:
        """tolerance.csv, tolerance.json, tolerance.png and places.png."""
        from rigsim.interop.files.tables import csv_bytes, json_bytes
        from rigsim.present.tolerance.console import tolerance_png
        from rigsim.present.tolerance.places_figure import places_png

        return {
            "tolerance.csv": csv_bytes(self.table),
            "tolerance.json": json_bytes(self.document()),
            "tolerance.png": tolerance_png(self.result),
            "places.png": places_png(self.result),
        }

    def document(self, written: Written | None = None) -> Mapping[str, Any]:
        """The study; docs/reference/tolerance.md says what the keys mean."""
        from rigsim.interop.documents.tolerance.document import tolerance_document
        from rigsim.present.tolerance import words

        return tolerance_document(self.result, words, self.remarks, self.golden)

    def print(self, folder: Path | None = None) -> None:
        """Print the ranked tables, the built rigs at each depth, and how many are good."""
        from rigsim.present.tolerance.console import print_tolerance

        print_tolerance(self.result, folder)
        print_comparison(self.golden)


@takes(ToleranceOptions)
def tolerance(options: ToleranceOptions) -> Toleranced:
    """Rank a rig's tolerances by what they do to the depth, and count the built rigs that are good.

    A rig is good when its own depth error, of its build and its pixel noise, meets the requirement.

    Args:
        rig: The rig as drawn: a preset's name, a calibration's path or text, or a rig. May be left out where
            `tolerance_class` names a calibration's covariance: it is the calibrated one.
        depth_error_mm: Largest root mean square depth error of one rig over the image and its noise, mm.
        depth_error_pct: The same in percent of the distance, instead; 1 where neither is given.
        at_m: Its distance, m; the far end by default.
        max_row_error_px: Largest row misalignment of one rig's rectified pair as well, root mean square over
            the image, at every distance of the range, px; any by default.
        range_m: Working range, (near, far), m.
        tolerance_class: printed, machined, calibrated, or none; or the path of a covariance.json, plan.json
            or calibration.json of `rigsim calibrate`: rigs are off by all of its parameters together, as
            their joint covariance says, and are not recalibrated.
        tolerances: Single tolerances in place of the class's, by name with unit, as ``{"yaw_deg": 0.05}``:
            one standard deviation each, in the unit that the name ends with.
        bounds: Names of those that are a bound, +-, instead.
        distribution: normal; or uniform, which makes a bound of every tolerance, evenly filled.
        speed_m_s: Speed along the baseline, m/s, for ``time_offset_ms``; 1 where no other motion is given.
        forward_speed_m_s: Speed straight ahead, m/s, for the same.
        turn_rate_deg_s: How fast the rig turns to the right, deg/s, for the same.
        moving: What the two speeds are of: object or rig.
        expansion_ppm: Expansion of the bar, ppm/K, for ``temperature_k``.
        recalibrate: Whether each rig is recalibrated on epipolar errors and known lengths as well.
        recalibration_features: Features that a recalibration sees in a picture.
        recalibration_pictures: Pictures it averages each of them over.
        noise_px: Standard deviation of the noise of one pixel coordinate, px; 0.25 unless said.
        disparity_noise_px: Standard deviation of a disparity, px, instead: sqrt(2) times as much.
        length_std_mm: Standard deviation of each known length, mm.
        rigs: How many are built.
        points: Points that each is judged by.
        seed: Seed of every random number.

    Raises:
        InvalidRange: A value is out of bounds, or a name is none.
        InvalidRig, OutputError: As `read_rig`.

    Example:
        >>> import rigsim
        >>> found = rigsim.tolerance(
        ...     "oak-d", tolerance_class="none", tolerances={"baseline_mm": 0.75}, range_m=(1, 3),
        ...     rigs=200, points=60,
        ... )
        >>> round(float(found.table["depth_error_at_3000_mm"].iloc[0]), 6)  # 1 % of 75 mm is 1 % of 3 m
        30.0
    """
    result = _run(options)
    return Toleranced(result, _remarks(options, result))


def _run(options: ToleranceOptions) -> ToleranceResult:
    from rigsim.study.tolerance.run import Build, Recalibration, run_tolerance

    near_m, far_m = _range(options.range_m)
    required = _required(options, far_m)
    calibration = _calibration(options.tolerance_class)
    if calibration is not None:
        rig = rig_of_calibration(options.rig, calibration)
    elif options.rig is None:
        raise InvalidRange("no rig: name one, or a calibration's covariance as the class")
    else:
        rig = read_rig(options.rig)
    held = _held(options, rig, calibration)
    noise_px = coordinate_noise_px(options.noise_px, options.disparity_noise_px)
    session = Recalibration(
        options.recalibration_features,
        options.recalibration_pictures,
        NOISE_PX if noise_px is None else given.real(noise_px, "noise_px"),
        given.real(options.length_std_mm, "length_std_mm"),
    )
    return run_tolerance(
        Build(rig, held, session.noise_px, session if options.recalibrate and calibration is None else None),
        required,
        (near_m, far_m),
        n_rigs=options.rigs,
        n_points=options.points,
        seed=options.seed,
    )


def _range(range_m: object) -> tuple[float, float]:
    ends = given.reals(range_m, "range_m")
    if len(ends) != 2:
        raise InvalidRange(f"range_m {given.shown(range_m)}: must be (near, far), m")
    return ends[0], ends[1]


def _required(options: ToleranceOptions, far_m: float) -> BuildRequirement:
    """What a rig is judged by."""
    from rigsim.study.tolerance.sensitivities import BuildRequirement

    pct = options.depth_error_pct
    if pct is None and options.depth_error_mm is None:
        pct = 1.0
    (asked,) = depth_errors(options.depth_error_mm, pct, options.at_m)
    if asked.pct is not None and not asked.pct < 100:
        raise InvalidRange(f"depth error {asked.pct:g} %: must be < 100 %")
    at_m = far_m if asked.at_m is None else asked.at_m
    row_px = options.max_row_error_px
    return BuildRequirement(
        asked.error_m(at_m), at_m, row_px=None if row_px is None else given.real(row_px, "max_row_error_px")
    )


def _calibration(name: str | os.PathLike[str]) -> CalibrationTolerance | None:
    """What the calibration that is named in place of a class leaves; None of a class."""
    from rigsim.study.tolerance.sensitivities import CLASSES

    if name in (*CLASSES, NO_CLASS):
        return None
    if not names_calibration(name):
        classes = ", ".join((*CLASSES, NO_CLASS))
        raise InvalidRange(
            f"class {name!r}: choose one of {classes}, or name a calibration's covariance.json"
        )
    return read_calibration_tolerance(name)


def _held(options: ToleranceOptions, rig: StereoRig, calibration: CalibrationTolerance | None) -> Tolerances:
    """The class's tolerances, or the calibration's, and those given in their place."""
    from rigsim.study.tolerance.sensitivities import CLASSES, QUANTITIES, Tolerances, with_values

    name = options.tolerance_class
    base = CLASSES[str(name)].tolerances(rig) if name in CLASSES else Tolerances(calibration=calibration)
    found = {key: given.real(value, key) for key, value in dict(options.tolerances or {}).items()}
    bounds = {options.bounds} if isinstance(options.bounds, str) else {str(key) for key in options.bounds}
    for key in (*found, *bounds):
        if key not in QUANTITIES:
            raise InvalidRange(f"tolerance {key!r}: choose one of {', '.join(QUANTITIES)}")
    # a bound of the class's stays one unless its value is replaced
    return with_values(
        base,
        {
            **found,
            "bounds": (base.bounds - set(found)) | bounds,
            "distribution": options.distribution,
            **_motion(options),
            "expansion_per_k": given.real(options.expansion_ppm, "expansion_ppm") * 1e-6,
        },
    )


def _motion(options: ToleranceOptions) -> dict[str, Any]:
    """What a time offset acts on."""
    forward = given.real(options.forward_speed_m_s, "forward_speed_m_s")
    turn = given.real(options.turn_rate_deg_s, "turn_rate_deg_s")
    speed = options.speed_m_s
    if speed is None:
        speed = 0.0 if forward or turn else 1.0
    return {
        "speed_m_s": given.real(speed, "speed_m_s"),
        "forward_speed_m_s": forward,
        "turn_rate_deg_s": turn,
        "moving": options.moving,
    }


def _remarks(options: ToleranceOptions, result: ToleranceResult) -> tuple[Remark, ...]:
    """Whether a motion was given that acts on nothing, and what a class has no tolerance of."""
    found: tuple[Remark, ...] = ()
    bent = next((lens for lens in (result.rig.left.lens, result.rig.right.lens) if not are_brown(lens)), None)
    calibration = result.tolerances.calibration
    if calibration is not None and options.recalibrate:
        text = f"{calibration.name} says what a calibration leaves: its rigs are not recalibrated once more"
        found = (Remark("not_recalibrated", text),)
    elif bent is not None and options.tolerance_class != NO_CLASS:
        text = f"a lens is a {bent.model}: the class's tolerances of k1 are Brown-Conrady's, and left out"
        found = (Remark("no_k1", text),)
    motion = _motion(options)
    given_motion = bool(options.speed_m_s or motion["forward_speed_m_s"] or motion["turn_rate_deg_s"])
    if not given_motion or result.tolerances.time_offset_ms:
        return found
    text = "a speed or a turn rate acts on a time offset alone: add --tolerance time=2ms, say"
    return (*found, Remark("no_time_offset", text))
