"""Tolerances by how a rig is made: published bounds where there are any, estimates that say so elsewhere."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from rigsim.rig.lens.distortion import are_brown
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance.inputs import ESTIMATE, Tolerances

SEAT_MM = 30.0
"""Side of the seat that a camera is screwed to: its tolerance tilts and shifts the camera."""
_ISO_2768_M_MM = ((6.0, 0.1), (30.0, 0.2), (120.0, 0.3), (400.0, 0.5), (1000.0, 0.8), (2000.0, 1.2))
_ISO_2768_M_LONGEST_MM = 2.0


def iso_2768_m_mm(length_mm: float) -> float:
    """ISO 2768-1, class m: the bound, +- mm, on a length without its own tolerance."""
    return next((bound for to, bound in _ISO_2768_M_MM if length_mm <= to), _ISO_2768_M_LONGEST_MM)


def printed_mm(length_mm: float) -> float:
    """Fused filament: +-0.3 mm, over 100 mm +-0.5 % of the length."""
    return 0.3 if length_mm <= 100 else 0.005 * length_mm


@dataclass(frozen=True, slots=True)
class Amount:
    """A tolerance and where it comes from."""

    value: float
    """Standard deviation, or bound."""
    source: str = ESTIMATE
    """A few words; docs/reference/tolerance.md has the rest."""
    bound: bool = False
    """Whether it is a bound, +-."""


@dataclass(frozen=True, slots=True)
class ToleranceClass:
    """Tolerances that suit any rig: lens and sensor in shares of focal length and image size."""

    about: str
    """What is meant, one line."""
    angle_deg: Amount
    """Yaw, pitch and roll of one camera against the other."""
    length_mm: Callable[[float], Amount]
    """Tolerance of a length, mm: of the baseline by its own, of the other shifts by the seat's."""
    right_focal_share: Amount
    """Right focal length against the left one, of itself; of each camera on its own if `each`."""
    both_focal_share: Amount | None
    """Focal length that both share, of itself; None where they share none."""
    principal_share: Amount
    """Right principal point against the left one, of the image's sides; of each if `each`."""
    k1: Amount
    """k1, of the right camera alone and of both; of each if `each`."""
    each: bool = False
    """Whether lenses' figures are one camera's, each off on its own: two differ by sqrt(2) more."""

    def tolerances(self, rig: StereoRig) -> Tolerances:
        """The class's tolerances for `rig`; those of k1 are of Brown-Conrady lenses alone."""
        shift = self.length_mm(SEAT_MM)
        amounts: dict[str, tuple[Amount, float]] = {
            "yaw_deg": (self.angle_deg, 1.0),
            "pitch_deg": (self.angle_deg, 1.0),
            "roll_deg": (self.angle_deg, 1.0),
            "baseline_mm": (self.length_mm(rig.baseline_m * 1e3), 1.0),
            "axial_mm": (shift, 1.0),
            "vertical_mm": (shift, 1.0),
            "right_focal_px": (self.right_focal_share, rig.right.fx),
            "right_cx_px": (self.principal_share, rig.right.width),
            "right_cy_px": (self.principal_share, rig.right.height),
            "right_k1": (self.k1, 1.0),
        }
        if self.both_focal_share is not None:
            amounts["both_focal_px"] = (self.both_focal_share, rig.left.fx)
        if self.each:
            amounts["left_focal_px"] = (self.right_focal_share, rig.left.fx)
            amounts["left_cx_px"] = (self.principal_share, rig.left.width)
            amounts["left_cy_px"] = (self.principal_share, rig.left.height)
            amounts["left_k1"] = (self.k1, 1.0)
        else:
            amounts["both_k1"] = (self.k1, 1.0)
        if not are_brown(rig.left.lens, rig.right.lens):
            amounts = {key: amount for key, amount in amounts.items() if not key.endswith("k1")}
        values: dict[str, Any] = {key: amount.value * factor for key, (amount, factor) in amounts.items()}
        return Tolerances(
            **values,
            bounds=frozenset(key for key, (amount, _) in amounts.items() if amount.bound),
            sources=tuple((key, amount.source) for key, (amount, _) in amounts.items()),
        )


def _tilt_deg(bound_mm: float) -> float:
    """Tilt of a seat whose one end is off by `bound_mm`."""
    return math.degrees(math.atan(bound_mm / SEAT_MM))


_ISO = "ISO 2768-m"
_FILAMENT = "printing service, filament"
_LENS = "M12 lens sheet, ±5 %"
_BOARD = "MATLAB example calibration"

CLASSES: Mapping[str, ToleranceClass] = MappingProxyType(
    {
        "printed": ToleranceClass(
            "plastic bracket, lens figures of the data sheet",
            Amount(_tilt_deg(printed_mm(SEAT_MM)), _FILAMENT, bound=True),
            lambda length_mm: Amount(printed_mm(length_mm), _FILAMENT, bound=True),
            Amount(0.01),
            Amount(0.05, _LENS, bound=True),
            Amount(0.01),
            Amount(0.02),
        ),
        "machined": ToleranceClass(
            "milled bar to the general tolerance, lenses of one batch",
            Amount(0.5, _ISO, bound=True),
            lambda length_mm: Amount(iso_2768_m_mm(length_mm), _ISO, bound=True),
            Amount(0.005),
            Amount(0.05, _LENS, bound=True),
            Amount(0.005),
            Amount(0.005),
        ),
        "calibrated": ToleranceClass(
            "what a careful board calibration leaves",
            Amount(0.01),
            lambda _: Amount(0.03),
            Amount(6.3e-4, _BOARD),
            None,
            Amount(2.7e-4, _BOARD),
            Amount(8e-4, _BOARD),
            each=True,
        ),
    }
)
"""Classes by name; docs/reference/tolerance.md gives derivations and addresses."""
