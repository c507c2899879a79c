"""What is asked of pictures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from rigsim.errors import InvalidRange
from rigsim.rig.board import Board
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.rational import Rational
from rigsim.theory.calibration.parameters import RigParameters

MODELS: Mapping[str, type[Lens] | None] = MappingProxyType(
    {
        "pinhole": None,
        "brown": BrownConrady,
        "rational": Rational,
        "fisheye": KannalaBrandt,
        "kannala_brandt": KannalaBrandt,
    }
)
"""Lens models by the words for them."""
_RATIONAL_HELD = ("s1", "s2", "s3", "s4", "tau_x", "tau_y")
"""OpenCV's rational model of eight terms, as `cv2.CALIB_RATIONAL_MODEL` alone has it."""


@dataclass(frozen=True, slots=True)
class PicturesAsked:
    """How pictures are to be calibrated, and what is to be told."""

    board: Board
    """What they show."""
    model: str = "brown"
    """Lens model of both cameras, one of `MODELS`."""
    fix: tuple[str, ...] = ()
    """What is held, as of `RigParameters.of`."""
    at_m: tuple[float, ...] = (1.0, 2.0, 3.0, 5.0)
    """Depths that are told, m."""
    noise_px: float = 0.25
    """Standard deviation of one coordinate of a match when the rig measures, px."""
    warp: bool = False
    """Whether the board's two warps are looked for."""
    following: bool = True
    """Whether the best next pose is looked for."""

    def __post_init__(self) -> None:
        if self.model not in MODELS:
            raise InvalidRange(f"lens model {self.model!r}: choose one of {', '.join(MODELS)}")
        if not self.noise_px > 0:
            raise InvalidRange(f"noise {self.noise_px:g} px: must be > 0")
        if not (self.at_m and all(z_m > 0 for z_m in self.at_m)):
            raise InvalidRange("depths: must be at least one, and > 0")
        _ = self.parameters  # words that hold nothing are told at once

    @property
    def middle_m(self) -> float:
        """The middle one of the depths that are told, m."""
        return sorted(self.at_m)[len(self.at_m) // 2]

    @property
    def lens(self) -> type[Lens] | None:
        """The lens model."""
        return MODELS[self.model]

    @property
    def held(self) -> tuple[str, ...]:
        """`fix`, and the prism and the tilt of a rational lens."""
        more = _RATIONAL_HELD if self.model == "rational" else ()
        return (*self.fix, *(word for word in more if word not in self.fix))

    @property
    def parameters(self) -> RigParameters:
        """What is looked for."""
        return RigParameters.of((self.lens, self.lens), fix=self.held, warped=self.warp)
