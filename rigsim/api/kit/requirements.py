"""The words of a design, as what a rig has to do."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, replace

from rigsim.api.kit.asked import DepthError, depth_errors
from rigsim.api.kit.calibrations import read_calibration_tolerance
from rigsim.api.rigs import Several, Sizes
from rigsim.errors import InvalidRange
from rigsim.rig import given
from rigsim.rig.noise import coordinate_noise_px
from rigsim.study.calibrate.counted import counted, design_calibration
from rigsim.study.design.buildable import Builder, judged_by
from rigsim.study.design.solve import PRIOR_NOISE_PX, Specification, specify
from rigsim.study.saying import saying
from rigsim.study.tolerance.sensitivities import Tolerances, with_values
from rigsim.theory.inverse import Requirement
from rigsim.theory.inverse_error import P95_OVER_STD


@dataclass(frozen=True, slots=True)
class DesignOptions:
    """The arguments of `design`, which says what they mean."""

    range_m: tuple[float, float]
    _: KW_ONLY
    depth_error_mm: Several | None = None
    depth_error_pct: Several | None = None
    at_m: Several | None = None
    p95: bool = False
    errors: Sequence[DepthError] = ()
    fov_deg: float | None = None
    vfov_deg: float | None = None
    cover_mm: float | tuple[float, float] | None = None
    cover_at_m: float | None = None
    max_baseline_mm: float | None = None
    min_baseline_mm: float | None = None
    body_width_mm: float | None = None
    max_disparity_px: float | None = None
    max_pixels: float | None = None
    min_overlap: Several = ()
    min_overlap_at_m: Several | None = None
    nearest_focus_m: float = 0.0
    calibration: str | os.PathLike[str] | None = None
    noise_px: float | None = None
    disparity_noise_px: float | None = None
    build_share: float = 0.5
    max_row_error_px: float | None = None
    resolutions_px: Sizes = ()
    sensors: str | Sequence[str] = ()
    lenses_mm: Several = ()
    lenses_px: Several = ()
    lenses_deg: Several = ()
    pixel_pitch_um: float | None = None
    sensor_width_mm: float | None = None
    crop_px: tuple[int, int] | None = None
    binning: int = 1
    prefer: str = "buildable"
    scene: str | os.PathLike[str] = "auto"
    proof: bool = True
    measure: str = "auto"
    blur_px: float | None = None
    image_noise_grey: Several = ()
    full_well_e: float | None = None
    read_noise_e: float | None = None
    tolerance_class: str = "machined"
    tolerances: Mapping[str, float] | None = None
    bounds: Collection[str] = ()
    seed: int = 0
    renderer: str = "auto"
    command: str = ""
    title: str = ""
    note: str = ""
    logo: str | os.PathLike[str] | None = None
    ready: Callable[[], object] | None = None


def specified(options: DesignOptions) -> Specification:
    """What a rig has to do."""
    ends = given.reals(options.range_m, "range_m")
    if len(ends) != 2:
        raise InvalidRange(f"range_m {given.shown(options.range_m)}: must be (near, far), m")
    near_m, far_m = ends
    noise_px = coordinate_noise_px(options.noise_px, options.disparity_noise_px)
    specification = specify(
        near_m,
        far_m,
        [*_errors(options, far_m), *_others(options, near_m, far_m), *_overlaps(options, near_m)],
        noise_px=PRIOR_NOISE_PX if noise_px is None else given.real(noise_px, "noise_px"),
        nearest_focus_m=given.real(options.nearest_focus_m, "nearest_focus_m"),
        build_share=given.real(options.build_share, "build_share"),
    )
    specification = replace(specification, builder=_builder(options))
    if options.calibration is not None:
        calibration = design_calibration(read_calibration_tolerance(options.calibration))
        held = tuple(counted(asked, calibration) for asked in specification.requirements)
        specification = replace(specification, requirements=held, calibration=calibration)
    if options.max_row_error_px is not None:
        row_px = given.real(options.max_row_error_px, "max_row_error_px")
        specification = replace(specification, row_px=row_px)
        judged_by(specification)  # refuses what cannot be
    if noise_px is not None:
        return specification
    return replace(specification, noise_source="assumed", noise_from=saying("assumed: none-given"))


def _builder(options: DesignOptions) -> Builder:
    named = {str(key): given.real(value, str(key)) for key, value in dict(options.tolerances or {}).items()}
    with_values(Tolerances(), {**named, "bounds": frozenset(options.bounds)})  # refuses what cannot be
    return Builder(options.tolerance_class, tuple(named.items()), frozenset(options.bounds))


def _errors(options: DesignOptions, far_m: float) -> Iterator[Requirement]:
    asked = depth_errors(
        options.depth_error_mm, options.depth_error_pct, options.at_m, options.p95, options.errors
    )
    if not asked:
        raise InvalidRange("no depth error is asked for: give depth_error_mm or depth_error_pct")
    for error in asked:
        at_m = far_m if error.at_m is None else error.at_m
        if error.pct is not None and error.pct > 100:
            raise InvalidRange(f"depth error {error.pct:g}%: must be <= 100 % of the distance")
        per_std = P95_OVER_STD if error.p95 else 1.0
        yield Requirement("depth_error", error.error_m(at_m), at_m, per_std)


def _others(options: DesignOptions, near_m: float, far_m: float) -> Iterator[Requirement]:
    if options.fov_deg is not None:
        yield Requirement("fov", math.radians(options.fov_deg))
    if options.vfov_deg is not None:
        yield Requirement("vfov", math.radians(options.vfov_deg))
    if options.cover_mm is not None:
        at_m = far_m if options.cover_at_m is None else options.cover_at_m
        sides = given.reals(options.cover_mm, "cover_mm")
        if len(sides) not in (1, 2):
            raise InvalidRange(
                f"cover_mm {given.shown(options.cover_mm)}: must be a width, or (width, height)"
            )
        yield Requirement("cover", sides[0] / 1e3, at_m)
        if len(sides) == 2:
            yield Requirement("cover_height", sides[1] / 1e3, at_m)
    if options.max_baseline_mm is not None:
        yield Requirement("max_baseline", options.max_baseline_mm / 1e3)
    apart = [one for one in (options.min_baseline_mm, options.body_width_mm or None) if one is not None]
    if apart:
        yield Requirement("min_baseline", max(apart) / 1e3)
    if options.max_disparity_px is not None:
        yield Requirement("max_disparity", options.max_disparity_px, near_m)
    if options.max_pixels is not None:
        yield Requirement("pixels", options.max_pixels)


def _overlaps(options: DesignOptions, near_m: float) -> Iterator[Requirement]:
    shares = given.reals(options.min_overlap, "min_overlap")
    at_m = options.min_overlap_at_m
    distances = (near_m,) * len(shares) if at_m is None else given.reals(at_m, "min_overlap_at_m")
    if len(distances) != len(shares):
        raise InvalidRange(f"min_overlap_at_m: {len(distances)} distances for {len(shares)} shares")
    for share, distance in zip(shares, distances, strict=True):
        yield Requirement("overlap", share, distance)
