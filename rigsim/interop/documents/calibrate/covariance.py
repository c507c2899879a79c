"""A calibration's covariance as a file of its own, covariance.json, or as a part of a larger document.

Other commands compute with it, so its numbers keep every digit (`rigsim.interop.documents.text`).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from pydantic import Field

from rigsim.interop.documents.base import Part
from rigsim.interop.documents.text import COVARIANCE
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig
from rigsim.theory.calibration.covariance import FRAME, CalibrationCovariance
from rigsim.theory.calibration.parameters import CAMERA


class CovarianceSource(Part):
    """What a covariance comes from."""

    of: Literal["plan", "pictures"]
    """Whether it is predicted of planned pictures, or is that of pictures that were taken."""
    board: str
    """The board, as 9x6@30mm."""
    pictures: int = Field(ge=1)
    """Pictures by each camera."""
    corner_noise_px: float = Field(ge=0, allow_inf_nan=False)
    """Standard deviation of one coordinate of a corner, px."""


class CovarianceLens(Part):
    """A lens that bends light."""

    model: str
    """Its model, as rig.toml calls it."""
    coefficients: dict[str, float]
    """Its coefficients by name."""


class CovarianceCamera(Part):
    """One camera, in full."""

    width_px: int = Field(ge=1)
    """Image width, px."""
    height_px: int = Field(ge=1)
    """Image height, px."""
    fx_px: float
    """Focal length along u, px."""
    fy_px: float
    """The same along v, px."""
    cx_px: float
    """Principal point u, px; integers are pixel centres."""
    cy_px: float
    """Principal point v, px."""
    lens: CovarianceLens | None
    """Its lens; null of a pinhole, and of a lens that bends nothing."""


class CovarianceRig(Part):
    """The rig as it was calibrated, or is planned: what the parameters are off from."""

    left: CovarianceCamera
    right: CovarianceCamera
    rotation: list[list[float]]
    """R of right_from_left, x_right = R x_left + t; three rows of three."""
    t_m: list[float]
    """Its t, m; three numbers."""


class CovarianceParameters(Part):
    """What was estimated."""

    lens_models: list[str | None] = Field(min_length=2, max_length=2)
    """Lens models of the left and the right camera; null has no coefficients."""
    free: list[bool]
    """Which of the parameters were estimated; the others were held."""
    square_pixels: list[bool] = Field(min_length=2, max_length=2)
    """Whether fy followed fx, of each camera."""
    warped: bool
    """Whether the board's two warps are among the parameters."""


class CovarianceDocument(Part):
    """How far a calibrated rig may be off: the joint covariance of all its parameters."""

    kind: Literal["calibration-covariance"]
    """What this is."""
    source: CovarianceSource
    rig: CovarianceRig
    parameters: CovarianceParameters
    names: list[str]
    """What the rows and columns of the matrix are: the rig's parameters, then the six of the boards' motion
    in the left camera's frame."""
    unit: list[str]
    """The unit of each of them; empty for a plain number."""
    matrix: list[list[float]]
    """Covariance, in products of those units; 0 where a parameter was held."""


def covariance_document(covariance: CalibrationCovariance, source: Mapping[str, Any]) -> dict[str, Any]:
    """The document, with every digit; `source` has the keys of `CovarianceSource`."""
    return covariance_part(covariance, source).model_dump()


def covariance_part(covariance: CalibrationCovariance, source: Mapping[str, Any]) -> CovarianceDocument:
    """The same as a part for another document, whose key it is to be under is ``covariance``."""
    parameters = covariance.parameters
    return CovarianceDocument(
        kind=COVARIANCE,
        source=CovarianceSource(**source),
        rig=_rig(covariance.rig),
        parameters=CovarianceParameters(
            lens_models=[None if lens is None else lens.model for lens in parameters.lenses],
            free=parameters.free.tolist(),
            square_pixels=list(parameters.square_pixels),
            warped=parameters.warped,
        ),
        names=list(covariance.names),
        unit=[unit_of(name) for name in covariance.names],
        matrix=covariance.matrix.tolist(),
    )


def _rig(rig: StereoRig) -> CovarianceRig:
    return CovarianceRig(
        left=camera_part(rig.left),
        right=camera_part(rig.right),
        rotation=rig.right_from_left.R.tolist(),
        t_m=rig.right_from_left.t.tolist(),
    )


def camera_part(camera: Intrinsics) -> CovarianceCamera:
    """A camera, in full."""
    lens = camera.lens
    return CovarianceCamera(
        width_px=camera.width,
        height_px=camera.height,
        fx_px=camera.fx,
        fy_px=camera.fy,
        cx_px=camera.cx,
        cy_px=camera.cy,
        lens=None
        if lens is None
        else CovarianceLens(
            model=lens.model, coefficients={name: getattr(lens, name) for name in lens.names()}
        ),
    )


def unit_of(name: str) -> str:
    """The unit of a parameter; empty for a plain number."""
    side, _, own = name.rpartition(".")
    if own in CAMERA:
        return "px"
    return "" if side and name not in FRAME else name.rpartition("_")[2]
