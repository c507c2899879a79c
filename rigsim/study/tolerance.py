"""How far a built rig may be off: tolerances, and what each does to the depth, to first order."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array, Mask
from rigsim.rig.perturbation import NAMES
from rigsim.rig.stereo import StereoRig
from rigsim.theory.sensitivity import depth_sensitivity

DISTRIBUTIONS = ("normal", "uniform")
"""normal: a tolerance is one standard deviation. uniform: it is a bound, +-."""
_CANDIDATES = 64
# Roberts' R2 sequence: even cover of a square, the same for every run
_R2 = (0.7548776662466927, 0.5698402909980532)


@dataclass(frozen=True, slots=True)
class Tolerances:
    """Standard deviations, or +- bounds, of what a built rig is off by; 0 is exact.

    The first ten are those of `rigsim.rig.perturbation.Perturbation`. The others come after a calibration
    and move the baseline: an object that passes at `speed_m_s` moves on by ``speed x time offset`` between
    the two pictures, and the bar between the cameras grows by ``baseline x expansion x temperature``.
    """

    yaw_deg: float = 0.0
    pitch_deg: float = 0.0
    roll_deg: float = 0.0
    baseline_mm: float = 0.0
    axial_mm: float = 0.0
    vertical_mm: float = 0.0
    right_focal_px: float = 0.0
    right_cx_px: float = 0.0
    right_k1: float = 0.0
    both_k1: float = 0.0
    time_offset_ms: float = 0.0
    temperature_k: float = 0.0
    speed_m_s: float = 1.0
    """Speed of the object along the baseline, m/s: no tolerance, but what a time offset acts on."""
    expansion_per_k: float = 23e-6
    """Relative growth of the baseline per kelvin: aluminium's by default."""
    distribution: str = "normal"
    """One of `DISTRIBUTIONS`."""

    def __post_init__(self) -> None:
        if self.distribution not in DISTRIBUTIONS:
            raise InvalidRange(
                f"distribution {self.distribution!r}: choose one of {', '.join(DISTRIBUTIONS)}"
            )
        for item in fields(self):
            value = getattr(self, item.name)
            if item.name != "distribution" and not (math.isfinite(value) and value >= 0):
                raise InvalidRange(f"tolerance {item.name} {value:g}: must be a finite number >= 0")

    @property
    def std_over_value(self) -> float:
        """Standard deviation of a quantity whose tolerance is 1."""
        return 1.0 if self.distribution == "normal" else 1 / math.sqrt(3)


QUANTITIES: Mapping[str, str] = MappingProxyType(
    {
        "yaw_deg": "yaw",
        "pitch_deg": "pitch",
        "roll_deg": "roll",
        "baseline_mm": "baseline",
        "axial_mm": "axial shift",
        "vertical_mm": "vertical shift",
        "right_focal_px": "right focal length",
        "right_cx_px": "right principal point",
        "right_k1": "right k1",
        "both_k1": "k1 of both",
        "time_offset_ms": "time offset",
        "temperature_k": "temperature",
    }
)
"""What may be off, with its name for people; the unit is the end of the key."""
UNITS: Mapping[str, str] = MappingProxyType(
    {key: key.rpartition("_")[2].replace("k1", "") for key in QUANTITIES} | {"temperature_k": "K"}
)
"""Unit of each quantity."""


@dataclass(frozen=True, slots=True)
class ToleranceClass:
    """Tolerances that suit any rig: lens and sensor in shares of focal length and image width."""

    about: str
    """What is meant, one line."""
    angle_deg: float
    """Yaw, pitch and roll of one camera against the other."""
    shift_mm: float
    """Baseline, axial and vertical shift."""
    focal_share: float
    """Right focal length, of itself."""
    principal_share: float
    """Right principal point, of the image width."""
    k1: float
    """k1, of the right camera alone and of both."""

    def tolerances(self, rig: StereoRig) -> Tolerances:
        """The class's standard deviations for `rig`."""
        return Tolerances(
            yaw_deg=self.angle_deg,
            pitch_deg=self.angle_deg,
            roll_deg=self.angle_deg,
            baseline_mm=self.shift_mm,
            axial_mm=self.shift_mm,
            vertical_mm=self.shift_mm,
            right_focal_px=self.focal_share * rig.right.fx,
            right_cx_px=self.principal_share * rig.right.width,
            right_k1=self.k1,
            both_k1=self.k1,
        )


CLASSES: Mapping[str, ToleranceClass] = MappingProxyType(
    {
        "printed": ToleranceClass(
            "plastic bracket, lens figures of the data sheet", 0.5, 0.3, 0.01, 0.01, 0.02
        ),
        "machined": ToleranceClass("milled bar, lenses of one batch", 0.1, 0.05, 0.005, 0.005, 0.005),
        "calibrated": ToleranceClass(
            "what a careful board calibration leaves", 0.01, 0.03, 3e-4, 3e-4, 0.001
        ),
    }
)
"""Classes by name; docs/tolerance.md gives the reasons."""


@dataclass(frozen=True, slots=True)
class Requirement:
    """Largest depth error at a distance: root mean square over the image, of one built rig."""

    error_m: float
    """Bound, m."""
    depth_m: float
    """Distance, m."""

    def __post_init__(self) -> None:
        for name, value in (("depth error", self.error_m), ("distance", self.depth_m)):
            if not (math.isfinite(value) and value > 0):
                raise InvalidRange(f"required {name} {value * 1e3:g} mm: must be > 0")
        if self.error_m >= self.depth_m:
            raise InvalidRange(
                f"required depth error {self.error_m * 1e3:g} mm: must be < its distance"
                f" {self.depth_m * 1e3:g} mm"
            )


@dataclass(frozen=True, slots=True, eq=False)
class Causes:
    """What is off, in `QUANTITIES`' units, and what that does to the ten quantities."""

    keys: tuple[str, ...]
    """Quantities whose tolerance is not zero."""
    values: Array
    """Their tolerances (q,), as given."""
    std: Array
    """Their standard deviations (q,)."""
    effect: Array
    """Change (q, 10) of `Perturbation`'s quantities per unit of each."""
    after_calibration: Mask
    """Which (q,) come after a calibration."""


def causes(rig: StereoRig, tolerances: Tolerances) -> Causes:
    """The quantities that are off at all.

    Raises:
        InvalidRange: none is.
    """
    keys = tuple(key for key in QUANTITIES if getattr(tolerances, key) > 0)
    if not keys:
        raise InvalidRange("tolerances: all are 0; give a class or at least one tolerance > 0")
    effect = np.array([_effect(rig, tolerances, key) for key in keys])
    values = np.array([getattr(tolerances, key) for key in keys], dtype=np.float64)
    after = np.array([key in ("time_offset_ms", "temperature_k") for key in keys])
    return Causes(keys, values, values * tolerances.std_over_value, effect, after)


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """One quantity alone, off by its standard deviation; first order. Depth errors in mm."""

    key: str
    """One of `QUANTITIES`."""
    tolerance: float
    """As given: standard deviation or bound, in the unit that the key ends with."""
    depth_rms_mm: tuple[float, ...]
    """Root mean square over the image at each depth."""
    common_mm: float
    """What the whole image shares at the judged depth; the sign is the depth error's when positive."""
    differing_mm: float
    """Standard deviation over the image of the rest."""
    share: float
    """Share of the variance at the judged depth."""
    needed_alone: float
    """Tolerance that just meets the requirement when nothing else is off; infinite without effect."""
    needed_equal_share: float
    """The same when every quantity that matters takes an equal share of the variance."""


def sensitivities(
    rig: StereoRig, off: Causes, planes: Mapping[float, Array], required: Requirement
) -> list[Sensitivity]:
    """The effect of each quantity, the worst first.

    `planes` maps depths, m, to points (m, 3); the requirement's depth is one of them.
    """
    per_plane = {depth: first_order(rig, off, points) for depth, points in planes.items()}
    rms = {depth: np.sqrt((errors**2).mean(axis=0)) for depth, errors in per_plane.items()}
    judged, judged_rms = per_plane[required.depth_m], rms[required.depth_m]
    # a quantity that moves no depth, such as a vertical shift, takes no share
    matters = judged_rms > 1e-9 * judged_rms.max()
    shares = judged_rms**2 / (judged_rms**2).sum()
    with np.errstate(divide="ignore"):
        alone = np.where(matters, required.error_m / judged_rms * off.values, math.inf)
    found = [
        Sensitivity(
            key=key,
            tolerance=float(off.values[i]),
            depth_rms_mm=tuple(float(values[i]) * 1e3 for values in rms.values()),
            common_mm=float(judged[:, i].mean()) * 1e3,
            differing_mm=float(judged[:, i].std()) * 1e3,
            share=float(shares[i]),
            needed_alone=float(alone[i]),
            needed_equal_share=float(alone[i] / math.sqrt(matters.sum())),
        )
        for i, key in enumerate(off.keys)
    ]
    return sorted(found, key=lambda item: -item.share)


def first_order(rig: StereoRig, off: Causes, points: Array) -> Array:
    """Depth error (m, q) m of each quantity, off by one standard deviation."""
    table = depth_sensitivity(rig, points)
    per_quantity = np.stack([table[name] for name in NAMES], axis=1)
    return np.asarray(per_quantity @ off.effect.T * off.std)


def shared_points(rig: StereoRig, depth_m: float, count: int) -> Array:
    """Up to `count` points (m, 3) m at one depth, evenly over the part of the left image that both see.

    Raises:
        InvalidRange: both cameras see nothing there.
    """
    points = _in_view(rig, np.full(_CANDIDATES * count, depth_m))[:count]
    if not len(points):
        raise InvalidRange(
            f"depth {depth_m * 1e3:g} mm: no point there is in both images; take a larger distance"
        )
    return points


def scattered_points(rig: StereoRig, near_m: float, far_m: float, count: int) -> Array:
    """Up to `count` points (m, 3) m that both see, evenly over image and inverse depth."""
    turn = (0.5 + np.arange(_CANDIDATES * count) * (math.sqrt(5) - 1) / 2) % 1
    return _in_view(rig, 1 / (1 / far_m + turn * (1 / near_m - 1 / far_m)))[:count]


def with_values(base: Tolerances, values: Mapping[str, Any]) -> Tolerances:
    """`base` with some fields replaced."""
    return replace(base, **values)


def _in_view(rig: StereoRig, z: Array) -> Array:
    turn = (0.5 + np.arange(1, len(z) + 1)[:, None] * _R2) % 1
    uv = turn * (rig.left.width, rig.left.height) - 0.5
    points = np.column_stack([rig.left.normalize(uv) * z[:, None], z])
    points = points[np.isfinite(points).all(axis=1)]
    return np.asarray(points[rig.right.contains(rig.project(points)[1])])


def _effect(rig: StereoRig, tolerances: Tolerances, key: str) -> Array:
    """Change (10,) of `Perturbation`'s quantities, in SI units, per unit of the quantity `key`."""
    name, factor = {
        "yaw_deg": ("yaw_rad", math.radians(1)),
        "pitch_deg": ("pitch_rad", math.radians(1)),
        "roll_deg": ("roll_rad", math.radians(1)),
        "baseline_mm": ("baseline_m", 1e-3),
        "axial_mm": ("axial_m", 1e-3),
        "vertical_mm": ("vertical_m", 1e-3),
        # the object moves on while the right camera waits: as if that one stood nearer
        "time_offset_ms": ("baseline_m", -1e-3 * tolerances.speed_m_s),
        "temperature_k": ("baseline_m", tolerances.expansion_per_k * rig.baseline_m),
    }.get(key, (key, 1.0))
    return np.array([factor if name == other else 0.0 for other in NAMES])
