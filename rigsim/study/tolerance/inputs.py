"""What a built rig may be off by: the quantities, their tolerances, and what they do to the rig."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from rigsim.errors import InvalidRange, InvalidRig
from rigsim.rig.arrays import Array, Mask
from rigsim.rig.lens.distortion import are_brown
from rigsim.rig.motion import MOVING
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance.batch import PARAMETERS
from rigsim.study.tolerance.joint.cause import CALIBRATION, CalibrationTolerance, JointCause, JointDraw

DISTRIBUTIONS = ("normal", "uniform")
"""normal: a tolerance is one standard deviation. uniform: it is a bound, +-."""
GIVEN = "given"
"""Source of a tolerance that is no class's."""
ESTIMATE = "estimate"
"""Source of a tolerance that is nobody's measurement."""

QUANTITIES: Mapping[str, str] = MappingProxyType(
    {
        "yaw_deg": "yaw",
        "pitch_deg": "pitch",
        "roll_deg": "roll",
        "baseline_mm": "baseline",
        "axial_mm": "axial shift",
        "vertical_mm": "vertical shift",
        "right_focal_px": "right focal length",
        "both_focal_px": "focal length of both",
        "right_cx_px": "right principal point u",
        "right_cy_px": "right principal point v",
        "right_k1": "right k1",
        "both_k1": "k1 of both",
        "left_focal_px": "left focal length",
        "left_cx_px": "left principal point u",
        "left_cy_px": "left principal point v",
        "left_k1": "left k1",
        "time_offset_ms": "time offset",
        "temperature_k": "temperature",
    }
)
"""What may be off, with its name for people; the unit is the end of the key."""
UNITS: Mapping[str, str] = MappingProxyType(
    {key: key.rpartition("_")[2].replace("k1", "") for key in QUANTITIES}
    | {"temperature_k": "K", CALIBRATION: "×"}
)
"""Unit of each quantity; of a calibration as a whole: so many times what it leaves."""


@dataclass(frozen=True, slots=True)
class Tolerances:
    """Standard deviations, or +- bounds, of what a built rig is off by; 0 is exact.

    Most are those of `rigsim.rig.perturbation.Perturbation`; more are of the lenses: the right principal
    point's v, a focal length that both cameras share, in px of the left one (the right one grows in
    proportion), and what is off in the left camera alone. The last two come after a calibration
    and move the right camera: rig or object move on by ``speed x time offset`` between the two pictures
    (`rigsim.rig.motion.Motion`), and the bar between the cameras grows by ``baseline x expansion x
    temperature``.
    """

    yaw_deg: float = 0.0
    pitch_deg: float = 0.0
    roll_deg: float = 0.0
    baseline_mm: float = 0.0
    axial_mm: float = 0.0
    vertical_mm: float = 0.0
    right_focal_px: float = 0.0
    both_focal_px: float = 0.0
    right_cx_px: float = 0.0
    right_cy_px: float = 0.0
    right_k1: float = 0.0
    both_k1: float = 0.0
    left_focal_px: float = 0.0
    left_cx_px: float = 0.0
    left_cy_px: float = 0.0
    left_k1: float = 0.0
    time_offset_ms: float = 0.0
    temperature_k: float = 0.0
    speed_m_s: float = 1.0
    """Speed along the baseline, m/s: no tolerance, but what a time offset acts on, as the next three."""
    forward_speed_m_s: float = 0.0
    """Speed straight ahead, m/s."""
    turn_rate_deg_s: float = 0.0
    """How fast the rig turns to the right, deg/s."""
    moving: str = "object"
    """What the speeds are of: ``object`` or ``rig``."""
    expansion_per_k: float = 23e-6
    """Relative growth of the baseline per kelvin: aluminium's by default."""
    distribution: str = "normal"
    """One of `DISTRIBUTIONS`; uniform makes a bound of every tolerance."""
    bounds: frozenset[str] = frozenset()
    """Keys whose tolerance is a bound even when the others are standard deviations."""
    sources: tuple[tuple[str, str], ...] = ()
    """Key and source of tolerances that were not given but taken from a class."""
    calibration: CalibrationTolerance | None = None
    """What a calibration leaves, all of its parameters together; beside the quantities above."""

    def __post_init__(self) -> None:
        if self.distribution not in DISTRIBUTIONS:
            raise InvalidRange(
                f"distribution {self.distribution!r}: choose one of {', '.join(DISTRIBUTIONS)}"
            )
        unknown = sorted({*self.bounds, *(key for key, _ in self.sources)} - set(QUANTITIES))
        if unknown:
            raise InvalidRange(f"tolerance {unknown[0]!r}: choose one of {', '.join(QUANTITIES)}")
        if self.moving not in MOVING:
            raise InvalidRange(f"moving {self.moving!r}: choose one of {', '.join(MOVING)}")
        for item in fields(self):
            value = getattr(self, item.name)
            signed = item.name in ("forward_speed_m_s", "turn_rate_deg_s") and math.isfinite(value)
            if isinstance(value, (int, float)) and not (signed or (math.isfinite(value) and value >= 0)):
                raise InvalidRange(f"tolerance {item.name} {value:g}: must be a finite number >= 0")

    def is_bound(self, key: str) -> bool:
        """Whether the tolerance of `key` is a bound."""
        return key != CALIBRATION and (self.distribution == "uniform" or key in self.bounds)

    def title(self, key: str) -> str:
        """The name of the quantity `key` for people."""
        if key == CALIBRATION and self.calibration is not None:
            return f"{CALIBRATION} ({self.calibration.name})"
        return QUANTITIES[key]

    def std(self, key: str) -> float:
        """Standard deviation of the quantity `key`, in its unit; evenly within a bound."""
        if key == CALIBRATION:
            return 1.0
        value = float(getattr(self, key))
        return value / math.sqrt(3) if self.is_bound(key) else value

    def source(self, key: str) -> str:
        """Where the tolerance of `key` comes from."""
        if key == CALIBRATION and self.calibration is not None:
            return self.calibration.source
        return dict(self.sources).get(key, GIVEN)


def with_values(base: Tolerances, values: Mapping[str, Any]) -> Tolerances:
    """`base` with some fields replaced; the quantities among them are given ones from then on."""
    kept = tuple((key, source) for key, source in base.sources if key not in values)
    bounds = values.get("bounds", base.bounds - set(values))
    return replace(base, **{"sources": kept, **values, "bounds": frozenset(bounds)})


@dataclass(frozen=True, slots=True)
class BuildRequirement:
    """Largest depth error of one built rig at a distance, over the image and its pixel noise, and maybe the
    largest row misalignment."""

    error_m: float
    """Bound, m."""
    depth_m: float
    """Distance, m."""
    p95: bool = False
    """Whether 95 of 100 errors are to stay under the bound; else it is their root mean square."""
    row_px: float | None = None
    """Largest row misalignment, px, root mean square over the image at every distance of the range, of the
    pair that the rig's calibration rectifies; None for any."""

    def __post_init__(self) -> None:
        for name, value in (("depth error", self.error_m), ("distance", self.depth_m)):
            if not (math.isfinite(value) and value > 0):
                raise InvalidRange(f"required {name} {value * 1e3:g} mm: must be > 0")
        if self.row_px is not None and not (math.isfinite(self.row_px) and self.row_px > 0):
            raise InvalidRange(f"required row misalignment {self.row_px:g} px: must be > 0")
        if self.error_m >= self.depth_m:
            raise InvalidRange(
                f"required depth error {self.error_m * 1e3:g} mm: must be < its distance"
                f" {self.depth_m * 1e3:g} mm"
            )


@dataclass(frozen=True, slots=True, eq=False)
class Causes:
    """What is off, in `QUANTITIES`' units, and what that does to a rig's parameters."""

    keys: tuple[str, ...]
    """Quantities whose tolerance is not zero."""
    values: Array
    """Their tolerances (q,), as given."""
    std: Array
    """Their standard deviations (q,)."""
    even: Mask
    """Which (q,) lie evenly within a bound; the others are normal."""
    effect: Array
    """Change (q, p) of `PARAMETERS` per unit of each."""
    after_calibration: Mask
    """Which (q,) come after a calibration."""
    joint: JointCause | None = None
    """What a calibration leaves, whose parameters are off together; the last of the causes."""

    @property
    def names(self) -> tuple[str, ...]:
        """Keys of all causes (c,)."""
        return self.keys if self.joint is None else (*self.keys, CALIBRATION)

    @property
    def amounts(self) -> Array:
        """Their tolerances (c,): `values`, and once what a calibration leaves."""
        return self.values if self.joint is None else np.append(self.values, 1.0)

    @property
    def groups(self) -> tuple[slice, ...]:
        """Which independent numbers each cause is drawn by: one, or a calibration's r."""
        count = len(self.keys)
        own = tuple(slice(place, place + 1) for place in range(count))
        return own if self.joint is None else (*own, slice(count, count + len(self.joint.factor)))

    @property
    def even_numbers(self) -> Mask:
        """Which of the independent numbers lie evenly within a bound; the others are normal."""
        if self.joint is None:
            return self.even
        return np.append(self.even, np.zeros(len(self.joint.factor), dtype=bool))

    def summed(self, per_number: Array) -> Array:
        """Sums (c,) over the independent numbers of each cause."""
        return np.array([per_number[group].sum() for group in self.groups])

    def thetas(self, deviations: Array) -> Array:
        """Changes (n, p) of `PARAMETERS` of rigs by their independent numbers, in standard deviations."""
        return np.asarray(deviations[:, : len(self.keys)] * self.std @ self.effect)

    def together(self, deviations: Array) -> JointDraw | None:
        """What a calibration leaves of the same rigs; None without one."""
        return None if self.joint is None else self.joint.drawn(deviations[:, len(self.keys) :])


def causes(rig: StereoRig, tolerances: Tolerances) -> Causes:
    """The quantities that are off at all.

    Raises:
        InvalidRange: none is.
        InvalidRig: a k1 is, and a lens of the rig has none.
    """
    keys = tuple(key for key in QUANTITIES if getattr(tolerances, key) > 0)
    for key in keys:
        for lens in (rig.left.lens, rig.right.lens):
            if key.endswith("k1") and lens is not None and not are_brown(lens):
                what = f"tolerance of {QUANTITIES[key]} {getattr(tolerances, key):g}"
                raise InvalidRig(f"{what}: is of Brown-Conrady lenses, one is a {lens.model}: leave it out")
    calibration = tolerances.calibration
    if not keys and calibration is None:
        raise InvalidRange("tolerances: all are 0; give a class or at least one tolerance > 0")
    return Causes(
        keys,
        np.array([getattr(tolerances, key) for key in keys], dtype=np.float64),
        np.array([tolerances.std(key) for key in keys], dtype=np.float64),
        np.array([tolerances.is_bound(key) for key in keys], dtype=bool),
        np.array([_effect(rig, tolerances, key) for key in keys]).reshape(-1, len(PARAMETERS)),
        np.array([key in ("time_offset_ms", "temperature_k") for key in keys], dtype=bool),
        None if calibration is None else calibration.cause(rig),
    )


def _effect(rig: StereoRig, tolerances: Tolerances, key: str) -> Array:
    """Change (p,) of `PARAMETERS`, in SI units, per unit of the quantity `key`."""
    changes: dict[str, float] = {
        "yaw_deg": {"yaw_rad": math.radians(1)},
        "pitch_deg": {"pitch_rad": math.radians(1)},
        "roll_deg": {"roll_rad": math.radians(1)},
        "baseline_mm": {"baseline_m": 1e-3},
        "axial_mm": {"axial_m": 1e-3},
        "vertical_mm": {"vertical_m": 1e-3},
        # the left camera alone: both, and the right one back again
        "left_focal_px": {"both_focal_px": 1.0, "right_focal_px": -rig.right.fx / rig.left.fx},
        "left_k1": {"both_k1": 1.0, "right_k1": -1.0},
        # principal points that are off alike turn the whole rig: only their difference moves depths
        "left_cx_px": {"right_cx_px": -rig.right.fx / rig.left.fx},
        "left_cy_px": {"right_cy_px": -rig.right.fy / rig.left.fy},
        "time_offset_ms": _late(rig, tolerances),
        "temperature_k": {"baseline_m": tolerances.expansion_per_k * rig.baseline_m},
    }.get(key, {key: 1.0})
    return np.array([changes.get(name, 0.0) for name in PARAMETERS])


def _late(rig: StereoRig, tolerances: Tolerances) -> dict[str, float]:
    """What a right picture that is one ms late does to the right camera, to first order in the time.

    An object that moves on while it waits is as if it stood nearer; a rig that moves carries it on.
    """
    way, second = 1.0 if tolerances.moving == "rig" else -1.0, 1e-3
    rig_from_left, left_from_right = rig.rig_from_left, rig.right_from_left.inverse
    along, down, ahead = left_from_right.t / rig.baseline_m, np.eye(3)[1], np.eye(3)[2]
    found = {"baseline_m": way * second * tolerances.speed_m_s}
    if tolerances.forward_speed_m_s or tolerances.turn_rate_deg_s:
        turn = rig_from_left.R.T @ down * (second * math.radians(tolerances.turn_rate_deg_s))
        # about the middle of the baseline
        swing = np.cross(turn, left_from_right.t / 2)
        forward = rig_from_left.R.T @ ahead * (way * second * tolerances.forward_speed_m_s)
        parts = np.linalg.lstsq(np.column_stack([along, down, ahead]), swing + forward, rcond=None)[0]
        pitch, yaw, roll = left_from_right.R.T @ turn
        found["baseline_m"] += float(parts[0])
        found |= {"vertical_m": float(parts[1]), "axial_m": float(parts[2])}
        found |= {"pitch_rad": float(pitch), "yaw_rad": float(yaw), "roll_rad": float(roll)}
    return found
