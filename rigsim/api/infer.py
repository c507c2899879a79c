"""`rigsim.infer`: from depth errors at known distances to the disparity noise behind them."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rigsim.api.kit.asked import DepthError, depth_errors
from rigsim.api.kit.plain import takes
from rigsim.api.result import Result
from rigsim.api.rigs import RigLike, Several, preset_name, read_rig
from rigsim.errors import InvalidRange
from rigsim.rig import given
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.study.infer.run import (
    P95,
    ErrorsByDistance,
    Inference,
    Transfer,
    depth_gain,
    disparity_of_bounds,
    infer_disparity_noise,
    transfer,
)

if TYPE_CHECKING:
    from rigsim.interop.documents.base import Written
    from rigsim.present.kit.types import Figure, Table
    from rigsim.rig.catalogue.commercial import Figure as Published


@dataclass(frozen=True, slots=True)
class InferOptions:
    """The arguments of `infer`, which says what they mean."""

    rig: RigLike
    _: KW_ONLY
    depth_error_mm: Several | None = None
    depth_error_pct: Several | None = None
    at_m: Several | None = None
    p95: bool = False
    errors: Sequence[DepthError] = ()
    data: str | os.PathLike[str] | None = None
    to: RigLike | None = None
    to_at_m: Several | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Inferred(Result):
    """The disparity noise behind depth errors, and what it does at other distances or to another rig."""

    inference: Inference
    """What follows from the errors."""
    carried: Transfer | None
    """The same noise on another rig, or at other distances; None where neither was named."""
    remarks: tuple[Remark, ...] = ()
    """What is odd about the errors."""

    @property
    def table(self) -> Table:
        """One row a distance: ``distance_mm``, ``depth_std_mm`` and what explains it."""
        from rigsim.present.kit.types import table

        rows: Any = self.document()["rows"]
        return table(rows)

    @property
    def verdict(self) -> str:
        """Whether stereo noise can be behind it."""
        return self.inference.verdict

    @property
    def headline(self) -> str:
        """The answer in one sentence."""
        return str(self.document()["says"])

    @property
    def figures(self) -> Mapping[str, Callable[[], Figure]]:
        """``infer``: the errors, and the law that explains them."""
        from rigsim.present.infer.figure import inference_figure

        return {"infer": lambda: inference_figure(self.inference, self.carried)}

    def files(self) -> dict[str, bytes]:
        """infer.json and infer.png."""
        from rigsim.interop.files.tables import json_bytes
        from rigsim.present.infer.figure import inference_png

        picture = inference_png(self.inference, self.carried)
        return {"infer.json": json_bytes(self.document()), "infer.png": picture}

    def document(self, written: Written | None = None) -> Mapping[str, Any]:
        """The inference; docs/reference/infer.md says what the keys mean."""
        from rigsim.interop.documents.infer import inference_document
        from rigsim.present.infer.words import sentence

        return inference_document(self.inference, sentence(self.inference), self.carried, self.remarks)

    def print(self, folder: Path | None = None) -> None:
        """Print the noise, the law and every distance."""
        from rigsim.present.infer.console import print_inference

        print_inference(self.inference, self.carried, folder)


@takes(InferOptions)
def infer(options: InferOptions) -> Inferred:
    """Infer the disparity noise that explains depth errors at known distances.

    Args:
        rig: The rig that they are of: a preset's name, a calibration's path or text, or a rig.
        depth_error_mm: Standard deviations of depth, mm, each at its own distance. Of a preset they are what
            its maker claims where neither errors nor data are given.
        depth_error_pct: The same in percent of the distance, instead.
        at_m: Their distances, m.
        p95: Whether they are 95th percentiles.
        errors: More of them, each a `DepthError`, which may be two bounds as well.
        data: A wall test's CSV, instead: distance_mm, depth_std_mm and optionally depth_bias_mm, n. Lengths
            may be in m or cm, as the ending of a column's name says; z_mm or z_m is a distance as well.
        to: A rig that the noise is carried over to.
        to_at_m: Distances for it, m, by default those given; without `to`, for the rig that the errors are
            of.

    Raises:
        InvalidRange: A value is out of bounds, missing or given twice.
        InvalidRig, OutputError: As `read_rig`; or the CSV cannot be read.

    Example:
        >>> import rigsim
        >>> found = rigsim.infer("oak-d", depth_error_pct=[1, 2], at_m=[4, 7])
        >>> len(found.table), found.verdict
        (2, 'untested')
        >>> len(rigsim.infer("oak-d").table)  # its maker's claims at 4, 7 and 10.5 m
        3
        >>> found.inference.disparity_std_px < 0.3
        True
    """
    from rigsim.study.infer.remarks import remarks

    claims = depth_errors(
        options.depth_error_mm, options.depth_error_pct, options.at_m, options.p95, options.errors
    )
    if claims and options.data is not None:
        raise InvalidRange("give either depth errors or data: what they are")
    published: tuple[Remark, ...] = ()
    if not claims and options.data is None:
        claims, published = published_claims(options.rig, p95=options.p95)
    rig = read_rig(options.rig)
    said: tuple[Remark, ...] = ()
    if options.data is None:
        errors, said = _claimed(claims, rig)
    else:
        from rigsim.interop.files.depth_errors import read_depth_errors

        errors = read_depth_errors(given.path(options.data, "data"))
    other = None if options.to is None else read_rig(options.to)
    if other is None and options.to_at_m is not None:
        other = rig
    inference = infer_disparity_noise(rig, errors)
    carried = None
    if other is not None:
        at_m = options.to_at_m
        depths_m = errors.depths_m if at_m is None else np.array(given.reals(at_m, "to_at_m"))
        carried = transfer(inference, other, depths_m)
    return Inferred(
        inference, carried, (*published, *said, *remarks(inference, units_written=options.data is None))
    )


def published_claims(rig: RigLike, *, p95: bool = False) -> tuple[tuple[DepthError, ...], tuple[Remark, ...]]:
    """The depth errors that a preset's maker claims, and what to know of them.

    Raises:
        InvalidRange: `rig` names no preset, or no claim is published of it.
    """
    name = preset_name(rig)
    if name is None:
        raise InvalidRange(
            "give either depth errors or data: what they are; only a preset has its maker's claims"
        )
    from rigsim.rig.presets import preset

    named = preset(name)
    if not named.claims:
        raise InvalidRange(f"{name}: no accuracy is published of it: give depth errors or data")
    errors = tuple(
        DepthError((claim.at_mm or 0.0) / 1e3, pct=claim.value, p95=p95, words=_words(claim))
        for claim in named.claims
    )
    doubted = [_words(claim) for claim in named.claims if claim.hearsay]
    doubt = f"; {', '.join(doubted)} by an unconfirmed user report alone" if doubted else ""
    text = (
        f"as published of {name}: {', '.join(error.words for error in errors)}{doubt}; "
        f"sources by `rigsim presets {name}`"
    )
    return errors, (Remark("published", text),)


def _words(claim: Published) -> str:
    return f"{claim.value:g}%@{(claim.at_mm or 0.0) / 1e3:g}m"


def _claimed(claims: Sequence[DepthError], rig: StereoRig) -> tuple[ErrorsByDistance, tuple[Remark, ...]]:
    """The depth errors of what is claimed, and what is odd about them."""
    depths_m: list[float] = []
    stds_mm: list[float] = []
    said: list[Remark] = []
    for claim in claims:
        name = f"claim {claim.said}"
        if claim.at_m is None:
            raise InvalidRange(f"{name}: at which distance? give at_m as well")
        at_m = given.real(claim.at_m, f"{name}, distance")
        if at_m in depths_m:
            where = claim.words.rpartition("@")[2].strip() or f"{at_m:g} m"
            raise InvalidRange(f"{name}: {where} is given twice; remove one")
        if claim.pct is not None and not 0 < claim.pct <= 100:
            raise InvalidRange(f"{name}: percent of the distance must be > 0 and <= 100")
        # in mm, as claims have always been read: the last digit depends on it
        std_mm = math.nan if claim.mm is None else claim.mm
        if claim.pct is not None:
            std_mm = claim.pct / 100 * (at_m * 1e3)
        if claim.bounds_mm is not None:
            std_mm, odd = _between(claim, name, at_m, rig)
            said += odd
        depths_m.append(at_m)
        stds_mm.append(std_mm / P95 if claim.p95 else std_mm)
    return ErrorsByDistance(np.array(depths_m), np.array(stds_mm) / 1e3), tuple(said)


def _between(claim: DepthError, name: str, at_m: float, rig: StereoRig) -> tuple[float, list[Remark]]:
    """The standard deviation, mm, that two bounds say, and what is odd about them."""
    from rigsim.study.infer.remarks import bounds_remark

    near_mm, far_mm = given.reals(claim.bounds_mm, f"{name}, bounds_mm")
    if not near_mm / 1e3 < at_m < far_mm / 1e3:
        where = claim.words.rpartition("@")[2].strip() or f"{at_m:g} m"
        raise InvalidRange(f"{name}: {where} must lie between the two bounds")
    gain_mm = float(depth_gain(rig, np.array([at_m]))[0]) * 1e3
    odd = bounds_remark(rig, claim.said, near_mm / 1e3, at_m, far_mm / 1e3)
    std_mm = gain_mm * disparity_of_bounds(rig, near_mm / 1e3, far_mm / 1e3)
    return std_mm, [] if odd is None else [odd]
