"""What a lens and a sensor do to an ideal picture: blur, vignetting, mismatch, noise, grey levels."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig.arrays import Array
from rigsim.rig.lens.lens import Lens

Side = Literal["left", "right"]
_BITS = (0, 8, 10, 12, 16)


_MOST_ELECTRONS = 1e15  # beyond some 9e18 photons cannot be drawn, and far below they are no noise


@dataclass(frozen=True, slots=True)
class Sensor:
    """A lens and a sensor; the default is the ideal pinhole at 8 bits.

    Raises:
        InvalidRig: a number that cannot be; the message gives it and its bound.
    """

    blur_px: float = 0.0
    """Standard deviation of the lens's Gaussian point spread, px; the pixel's own square comes on top."""
    distortion: Lens | None = None
    """Lens distortion, for the camera that `optics` is given; None is none."""
    full_well_e: float = 0.0
    """Electrons that make full scale at gain 1; 0 is no photon noise."""
    read_noise_e: float = 0.0
    """Standard deviation of the read noise, electrons; needs `full_well_e`."""
    grey_noise: float = 0.0
    """Standard deviation of white noise on top, 1/255 of full scale: grey levels of an 8-bit picture."""
    gain: float = 1.0
    """Analogue gain: full scale is reached at `full_well_e` / `gain` electrons, so more gain means fewer
    electrons, and more noise, for the same picture."""
    bits: int = 8
    """Bits of the analogue-digital converter: 8, 10, 12 or 16; 0 neither rounds nor clips."""
    right_gain: float = 1.0
    """Brightness of the right picture over the left's."""
    right_offset: float = 0.0
    """Level of the right picture above the left's, share of full scale."""
    vignetting: float = 0.0
    """Loss of light in the picture's corners, 0 to 1: 1 - vignetting * (r / r_corner)^2."""
    black_level: float = 0.0
    """Mean level of a picture taken in the dark, 1/255 of full scale, that all light comes on top of; below
    some four standard deviations of the dark noise, the converter cuts part of that noise off at 0."""
    prnu_pct: float = 0.0
    """Standard deviation of the pixels' gains, percent of their mean (EMVA 1288: PRNU)."""
    dsnu_e: float = 0.0
    """Standard deviation of the pixels' dark levels, electrons (EMVA 1288: DSNU); needs `full_well_e`."""

    def __post_init__(self) -> None:
        for name, value, unit in (
            ("lens blur", self.blur_px, " px"),
            ("full well", self.full_well_e, " e-"),
            ("read noise", self.read_noise_e, " e-"),
            ("grey noise", self.grey_noise, ""),
            ("PRNU", self.prnu_pct, " %"),
            ("DSNU", self.dsnu_e, " e-"),
        ):
            if not (math.isfinite(value) and value >= 0):
                raise InvalidRig(f"sensor: {name} {value:g}{unit}: must be >= 0 and finite")
        for name, value in (("gain", self.gain), ("right gain", self.right_gain)):
            if not (math.isfinite(value) and value > 0):
                raise InvalidRig(f"sensor: {name} {value:g}: must be > 0 and finite")
        if not -1 < self.right_offset < 1:
            raise InvalidRig(f"sensor: right offset {self.right_offset:g}: must be between -1 and 1")
        if not 0 <= self.vignetting < 1:
            raise InvalidRig(f"sensor: vignetting {self.vignetting:g}: must be >= 0 and < 1")
        if not 0 <= self.black_level < 255:
            raise InvalidRig(
                f"sensor: black level {self.black_level:g}: must be >= 0 and < 255, which is full scale"
            )
        if self.bits not in _BITS:
            raise InvalidRig(f"sensor: {self.bits} bits: must be one of {', '.join(map(str, _BITS))}")
        for name, value in (("read noise", self.read_noise_e), ("DSNU", self.dsnu_e)):
            if value > 0 and self.full_well_e == 0:
                raise InvalidRig(
                    f"sensor: {name} {value:g} e- without a full well: give full_well_e, which says how many "
                    "electrons are full scale"
                )

        if self.full_well_e / self.gain > _MOST_ELECTRONS:
            raise InvalidRig(
                f"sensor: full well {self.full_well_e:g} e- at gain {self.gain:g}: at most "
                f"{_MOST_ELECTRONS:g} electrons can be counted; 0 is no photon noise"
            )

    def merged(self, across: float) -> Sensor:
        """With so many pixels across, and down, made one: signals add, and independent noise in squares."""
        return replace(
            self,
            full_well_e=self.full_well_e * across**2,
            read_noise_e=self.read_noise_e * across,
            dsnu_e=self.dsnu_e * across,
            prnu_pct=self.prnu_pct / across,
        )

    @property
    def full_scale(self) -> float:
        """Largest grey level: 255, 1023, 4095 or 65535; 1 without a converter."""
        return float(2**self.bits - 1) if self.bits else 1.0

    @property
    def grey_per_electron(self) -> float:
        """Grey levels an electron makes; 0 without a full well."""
        return self.full_scale * self.gain / self.full_well_e if self.full_well_e else 0.0

    def noise_std(self, level: Array | float) -> Array:
        """Standard deviation of a pixel from frame to frame, grey levels, where its mean is `level`.

        Rounding is included; the fixed pattern of PRNU and DSNU, which is no noise of time, is not, and
        neither is what the converter cuts off at either end.
        """
        k = self.grey_per_electron
        black = self.black_level / 255 * self.full_scale
        shot = k * np.maximum(np.asarray(level, dtype=np.float64) - black, 0.0)
        rounding = 1 / 12 if self.bits else 0.0
        white = (k * self.read_noise_e) ** 2 + (self.grey_noise / 255 * self.full_scale) ** 2
        return np.asarray(np.sqrt(shot + white + rounding))
