"""Covariances of calibrations from files: covariance.json, or what else of `rigsim calibrate` holds one."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NoReturn

import numpy as np
from pydantic import ValidationError

from rigsim import foreign
from rigsim.errors import InvalidRange, OutputError, RigsimError
from rigsim.interop.documents.calibrate.covariance import (
    CovarianceCamera,
    CovarianceDocument,
    CovarianceRig,
    unit_of,
)
from rigsim.interop.documents.text import COVARIANCE
from rigsim.rig.arrays import Array, frozen
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.registry import BY_NAME
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.plan.explain import focal_openness
from rigsim.theory.calibration.covariance import FRAME, CalibrationCovariance
from rigsim.theory.calibration.parameters import RigParameters

_WHAT = "a covariance.json, plan.json or calibration.json of rigsim calibrate"
_BYTES = 20_000_000
MOST_OPEN = 0.2
"""Largest standard deviation of a focal length or of the baseline, as a share of it: a draw in a million is 5
of them off, where there is no rig."""
_BOUND = f"must be <= {100 * MOST_OPEN:g} %; draws beyond are no rigs: check units, or calibrate anew"
_ROUNDING = 1e-9
"""Of a correlation: by how much a matrix may miss its mirror image."""
_NOT_POSITIVE = -1e-7
"""Least eigenvalue of the correlations that rounding may leave."""


@dataclass(frozen=True, slots=True, eq=False)
class SourcedCovariance:
    """A covariance, and what its file says of where it comes from."""

    covariance: CalibrationCovariance
    """The covariance."""
    of: str
    """``plan`` or ``pictures``."""
    board: str
    """The board, as ``9x6@30mm``."""
    pictures: int
    """Pictures by each camera."""
    corner_noise_px: float
    """Standard deviation of one coordinate of a corner, px."""


def read_covariance(path: str | Path) -> CalibrationCovariance:
    """The covariance in a covariance.json, or in a plan.json or calibration.json under ``covariance``.

    Raises:
        OutputError: it cannot be read, is too large, or is no such file.
        InvalidRange: its numbers are no covariance.
        InvalidRig: its rig cannot exist.
    """
    return read_sourced(path).covariance


def read_sourced(path: str | Path) -> SourcedCovariance:
    """The same with its source.

    Raises:
        OutputError, InvalidRange, InvalidRig: as `read_covariance`.
    """
    document = _document(path)
    try:
        rig, parameters = _rig(document.rig), _parameters(document)
        covariance = CalibrationCovariance(rig, parameters, _matrix(document.matrix, parameters))
        for side in (0, 1):
            parameters.lens(rig, side)
        _check_sizes(covariance)
    except RigsimError as error:
        raise type(error)(f"{path}: {error}") from None
    source = document.source
    return SourcedCovariance(covariance, source.of, source.board, source.pictures, source.corner_noise_px)


def _document(path: str | Path) -> CovarianceDocument:
    """The part of a file that is a covariance.

    Raises:
        OutputError: there is none.
    """
    try:
        found = json.loads(foreign.read_text(path, _WHAT, _BYTES), parse_constant=_no_number)
    except (ValueError, RecursionError) as error:
        if isinstance(error, RigsimError):
            raise
        why = "nested too deep" if isinstance(error, RecursionError) else str(error).splitlines()[0]
        raise OutputError(f"{path}: no JSON ({why}); name {_WHAT}") from None
    part = found
    if isinstance(part, dict) and part.get("kind") != COVARIANCE:
        part = part.get("covariance")
    if not isinstance(part, dict) or part.get("kind") != COVARIANCE:
        raise OutputError(f"{path}: holds no covariance of a calibration; name {_WHAT}")
    try:
        return CovarianceDocument.model_validate(part, strict=True)
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False, include_input=False)[0]
        place = ".".join(map(str, first["loc"]))
        says = first["msg"][:1].lower() + first["msg"][1:]
        raise OutputError(
            f"{path}: covariance: {place}: {says}; make it anew with rigsim calibrate"
        ) from None


def _no_number(word: str) -> NoReturn:
    raise ValueError(f"{word} is no number of JSON")


def _rig(part: CovarianceRig) -> StereoRig:
    if [len(row) for row in part.rotation] != [3, 3, 3] or len(part.t_m) != 3:
        raise InvalidRange("covariance: rig: rotation must be 3 rows of 3 numbers, t_m 3 numbers")
    return StereoRig(
        _camera(part.left), _camera(part.right), Pose(np.array(part.rotation), np.array(part.t_m))
    )


def _camera(part: CovarianceCamera) -> Intrinsics:
    lens = None
    if part.lens is not None:
        model = _model(part.lens.model)
        if set(part.lens.coefficients) != set(model.names()):
            raise InvalidRange(
                f"covariance: lens {model.model} with {', '.join(part.lens.coefficients) or 'nothing'}:"
                f" must have {', '.join(model.names())}"
            )
        lens = model(**part.lens.coefficients)
    return Intrinsics(part.width_px, part.height_px, part.fx_px, part.fy_px, part.cx_px, part.cy_px, lens)


def _model(name: str) -> type[Lens]:
    if name not in BY_NAME:
        raise InvalidRange(f"covariance: lens model {name[:30]!r}: must be one of {', '.join(BY_NAME)}")
    return BY_NAME[name]


def _parameters(document: CovarianceDocument) -> RigParameters:
    said = document.parameters
    left, right = (None if name is None else _model(name) for name in said.lens_models)
    parameters = RigParameters.of((left, right), warped=said.warped)
    names = (*parameters.names, *FRAME)
    units = [unit_of(name) for name in names]
    if tuple(document.names) != names:
        wrong = next(
            (f"{a!r} where {b!r} must be" for a, b in zip(document.names, names, strict=False) if a != b),
            f"{len(document.names)} where {len(names)} must be",
        )
        raise InvalidRange(f"covariance: names of its lens models' parameters: {wrong[:100]}")
    if document.unit != units:
        wrong = next(
            (
                f"{a[:30]!r} of {name}, must be {b!r}"
                for name, a, b in zip(names, document.unit, units, strict=False)
                if a != b
            ),
            f"{len(document.unit)} where {len(units)} must be",
        )
        raise InvalidRange(f"covariance: unit: {wrong}")
    if len(said.free) != len(parameters.names):
        raise InvalidRange(
            f"covariance: free: {len(said.free)} values, must be {len(parameters.names)}, one a parameter"
        )
    square = (said.square_pixels[0], said.square_pixels[1])
    return replace(parameters, free=np.array(said.free, dtype=bool), square_pixels=square)


def _matrix(rows: list[list[float]], parameters: RigParameters) -> Array:
    """The matrix, when it is one, symmetric and positive.

    Raises:
        InvalidRange: it is not.
    """
    size = len(parameters.names) + len(FRAME)
    if [len(row) for row in rows] != [size] * size:
        widths = sorted({len(row) for row in rows})
        across = " or ".join(map(str, widths[:2])) or "0"
        raise InvalidRange(f"covariance: {len(rows)} rows of {across} numbers: must be {size} x {size}")
    matrix = np.array(rows)
    names = (*parameters.names, *FRAME)
    if not np.isfinite(matrix).all():
        i, k = np.argwhere(~np.isfinite(matrix))[0]
        raise InvalidRange(f"covariance of {names[i]} and {names[k]}: must be a finite number")
    variances = np.diagonal(matrix)
    if (variances < 0).any():
        i = int(np.argmin(variances))
        raise InvalidRange(f"covariance: variance of {names[i]} is {variances[i]:.3g}: must be >= 0")
    _check_correlations(matrix, names)
    return frozen(matrix)


def _check_sizes(covariance: CalibrationCovariance) -> None:
    """Refuse what was never estimated, and what is known so little that no draw of it need be a rig.

    Raises:
        InvalidRange: the rig's own covariances are all 0, or one is absurdly large.
    """
    if not covariance.of_rig.any():
        raise InvalidRange(
            "covariance: all of the rig's are 0: nothing was estimated; calibrate with parameters free"
        )
    # its own std may be large where a lens's coefficients undo what it does
    open_to = focal_openness(covariance)
    if open_to > MOST_OPEN:
        raise InvalidRange(f"covariance: std of a focal length is {100 * open_to:.3g} % of it: {_BOUND}")
    names, baseline_m = covariance.names, covariance.rig.baseline_m
    for name in ("tx_m", "ty_m", "tz_m"):
        share = float(covariance.std[names.index(name)]) / baseline_m
        if share > MOST_OPEN:
            raise InvalidRange(f"covariance: std of {name} is {100 * share:.3g} % of the baseline: {_BOUND}")


def _check_correlations(matrix: Array, names: tuple[str, ...]) -> None:
    std = np.sqrt(np.diagonal(matrix))
    scale = np.divide(1.0, std, out=np.zeros_like(std), where=std > 0)
    still = std == 0
    if matrix[still].any() or matrix[:, still].any():
        i = int(np.flatnonzero(still & (matrix.any(axis=0) | matrix.any(axis=1)))[0])
        raise InvalidRange(f"covariance: {names[i]} has no variance, but covariances: they must be 0")
    unit = matrix * scale[:, None] * scale
    apart = np.abs(unit - unit.T)
    if apart.max() > _ROUNDING:
        i, k = divmod(int(apart.argmax()), len(names))
        raise InvalidRange(
            f"covariance of {names[i]} and {names[k]}: {matrix[i, k]:.6g} there, {matrix[k, i]:.6g} in the"
            " mirrored place: must be symmetric"
        )
    least = float(np.linalg.eigvalsh((unit + unit.T) / 2)[0])
    if least < _NOT_POSITIVE:
        raise InvalidRange(
            f"covariance: an eigenvalue of its correlations is {least:.3g}: must be >= 0"
            " (positive semi-definite)"
        )
