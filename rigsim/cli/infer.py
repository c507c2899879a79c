"""`rigsim infer`: from a data sheet's claim or a wall test to the disparity noise behind it."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rigsim.cli.kit import quantity
from rigsim.cli.kit.answer import print_document, print_remarks
from rigsim.cli.kit.options import Json, single_rig, takes_rig
from rigsim.cli.kit.rigs import DEFAULT_PRESET, RigOptions
from rigsim.errors import InvalidRange

if TYPE_CHECKING:
    from rigsim.rig.remark import Remark
    from rigsim.rig.stereo import StereoRig
    from rigsim.study.infer.run import ErrorsByDistance

_CLAIM = "write error@distance, as in 1%@4m, 10mm@3m or 8.1:13.1m@10m"


@takes_rig
def infer(
    options: RigOptions,
    claim: Annotated[
        str | None,
        typer.Option(
            metavar="ERROR@Z,...",
            help="Depth errors claimed: 1%@4m,2%@7m; 10mm@3m; or nearest:farthest, 8.1:13.1m@10m.",
        ),
    ] = None,
    data: Annotated[
        Path | None,
        typer.Option(
            metavar="CSV", help="Wall test: distance_mm, depth_std_mm and optionally depth_bias_mm, n."
        ),
    ] = None,
    p95: Annotated[
        bool, typer.Option("--p95", help="The errors claimed are 95th percentiles, not one std.")
    ] = False,
    to: Annotated[
        str | None, typer.Option(metavar="RIG", help="Carry the noise over to a rig.toml or preset.")
    ] = None,
    at: Annotated[
        str | None,
        typer.Option(metavar="Z,...", help="Distances for --to: 1m,2m,4m. By default those given."),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Folder for infer.json and infer.png.")] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False,
    as_json: Json = False,
) -> None:
    """Infer the disparity noise that explains depth errors at known distances.

    An error counts as one standard deviation unless --p95 says otherwise.
    """
    if (claim is None) == (data is None):
        raise InvalidRange("give either --claim or --data: what the depth errors are")
    if p95 and claim is None:
        raise InvalidRange("--p95 is about --claim: --data holds standard deviations")
    if at is not None and to is None:
        raise InvalidRange("--at is about another rig: name it by --to")
    from rigsim.interop.files import folder

    if out is not None:
        folder.check_output(out, force)
    rig = single_rig(options, None)
    errors, said = _claimed(claim, rig, p95) if claim is not None else (_measured(data), [])
    other = None if to is None else _other_rig(to)

    import numpy as np

    from rigsim.study.infer import run as study

    inference = study.infer_disparity_noise(rig, errors)
    carried = None
    if other is not None:
        depths_mm = quantity.values(at, quantity.DEPTH) if at is not None else None
        depths_m = errors.depths_m if depths_mm is None else np.array(depths_mm) / 1e3
        carried = study.transfer(inference, other, depths_m)
    from rigsim.interop.documents.infer import inference_document
    from rigsim.present.infer.words import sentence
    from rigsim.study.infer.remarks import remarks

    said += remarks(inference, units_written=claim is not None)
    document = inference_document(inference, sentence(inference), carried, said)
    if out is not None:
        from rigsim.interop.files.tables import json_bytes
        from rigsim.present.infer.figure import inference_png

        files = {"infer.json": json_bytes(document), "infer.png": inference_png(inference, carried)}
        folder.write_folder(out, files, force)
    print_remarks(said)
    if as_json:
        print_document(document)
    else:
        from rigsim.present.infer.console import print_inference

        print_inference(inference, carried, out)


def _measured(path: Path | None) -> ErrorsByDistance:
    from rigsim.interop.files.depth_errors import read_depth_errors

    assert path is not None
    return read_depth_errors(path)


def _other_rig(word: str) -> StereoRig:
    path = Path(word)
    if path.suffix.lower() in (".toml", ".txt") or path.is_file():
        return RigOptions(rig=path).base(DEFAULT_PRESET)
    return RigOptions(preset=word).base(DEFAULT_PRESET)


def _claimed(text: str, rig: StereoRig, p95: bool) -> tuple[ErrorsByDistance, list[Remark]]:
    """The depth errors of ``1%@4m,10mm@3m``, and what is odd about them.

    Raises:
        InvalidRange: a claim cannot be read, has no unit, is out of bounds, or stands there twice.
    """
    import numpy as np

    from rigsim.study.infer.remarks import bounds_remark
    from rigsim.study.infer.run import P95, ErrorsByDistance, depth_gain, disparity_of_bounds

    said_of: list[Remark] = []
    depths: list[float] = []
    stds: list[float] = []
    for part in text.split(","):
        said, sign, where = (word.strip() for word in part.partition("@"))
        if not sign or not said or not where:
            raise InvalidRange(f"claim {part.strip() or 'empty'}: {_CLAIM}")
        depth_mm = _length(where, "distance", part)
        if depth_mm in depths:
            raise InvalidRange(f"claim {part.strip()}: {where} stands there twice; remove one")
        if said.endswith("%"):
            std_mm = _percent(said, part) / 100 * depth_mm
        elif ":" in said:
            near_mm, far_mm = quantity.span(said, quantity.DEPTH)
            _length(said.rpartition(":")[2], "depth", part)
            if not near_mm < depth_mm < far_mm:
                raise InvalidRange(f"claim {part.strip()}: {where} must lie between the two bounds")
            gain = float(depth_gain(rig, np.array([depth_mm / 1e3]))[0]) * 1e3
            std_mm = gain * disparity_of_bounds(rig, near_mm / 1e3, far_mm / 1e3)
            odd = bounds_remark(rig, part.strip(), near_mm / 1e3, depth_mm / 1e3, far_mm / 1e3)
            said_of += [odd] if odd is not None else []
        else:
            std_mm = _length(said, "depth error", part)
        depths.append(depth_mm)
        stds.append(std_mm / P95 if p95 else std_mm)
    return ErrorsByDistance(np.array(depths) / 1e3, np.array(stds) / 1e3), said_of


def _percent(said: str, part: str) -> float:
    try:
        value = float(said[:-1])
    except ValueError:
        value = math.nan
    if not 0 < value <= 100:
        raise InvalidRange(f"claim {part.strip()}: percent of the distance must be > 0 and <= 100")
    return value


def _length(text: str, name: str, part: str) -> float:
    """A length in mm that has to have its unit."""
    if re.fullmatch(r"[-+0-9.eE\s]+", text):
        unit = "%, mm, cm or m" if name == "depth error" else "mm, cm or m"
        raise InvalidRange(f"claim {part.strip()}: {name} {text} has no unit; write {unit}")
    kind = quantity.QuantityKind(name, "mm", quantity.DEPTH.factors, above=0)
    return quantity.value(text, kind)
