"""`rigsim infer`: from a data sheet's claim or a wall test to the disparity noise behind it."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rigsim.cli.kit.answer import claim as claim_folder
from rigsim.cli.kit.answer import deliver
from rigsim.cli.kit.options import Json, takes, takes_rig
from rigsim.errors import InvalidRange
from rigsim.typed import quantity
from rigsim.typed.rigs import DEFAULT_PRESET, RigOptions, single_rig

if TYPE_CHECKING:
    from rigsim.api.kit.asked import DepthError
    from rigsim.rig.stereo import StereoRig

_CLAIM = "write error@distance, as in 1%@4m, 10mm@3m or 8.1:13.1m@10m"


@dataclass(frozen=True, slots=True)
class InferWords:
    """The options of `rigsim infer`, as typed."""

    claim: Annotated[
        str | None,
        typer.Option(
            "--claim",
            "--measured",
            metavar="ERROR@Z,...",
            help="Depth errors, claimed or your own measurements: 1%@4m,2%@7m; 10mm@3m; or nearest:farthest,"
            " 8.1:13.1m@10m.",
        ),
    ] = None
    data: Annotated[
        Path | None,
        typer.Option(
            metavar="CSV",
            help="Wall test: distance_mm (or distance_m, z_mm, z_m), depth_std_mm and optionally"
            " depth_bias_mm, n.",
        ),
    ] = None
    p95: Annotated[
        bool, typer.Option("--p95", help="The errors claimed are 95th percentiles, not one std.")
    ] = False
    to: Annotated[
        str | None, typer.Option(metavar="RIG", help="Another rig to apply the noise to: rig.toml or preset.")
    ] = None
    at: Annotated[
        str | None,
        typer.Option(
            metavar="Z,...",
            help="Distances to tell the error at: 1m,2m,4m. Of the rig of --to, by default those given;"
            " without --to of the same rig.",
        ),
    ] = None
    out: Annotated[Path | None, typer.Option(help="Folder for infer.json and infer.png.")] = None
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False
    as_json: Json = False


@takes_rig
@takes(InferWords)
def infer(options: RigOptions, words: InferWords) -> None:
    """Infer the disparity noise that explains depth errors at known distances.

    An error counts as one standard deviation unless --p95 says otherwise. A preset's own claims, as its maker
    publishes them, are taken where neither --claim nor --data is given.
    """
    if words.claim is not None and words.data is not None:
        raise InvalidRange("give either --claim or --data: what the depth errors are")
    if words.claim is None and words.data is None and options.preset is None:
        raise InvalidRange(
            "give either --claim or --data: what the depth errors are; or a --preset with a claim"
        )
    if words.p95 and words.data is not None:
        raise InvalidRange("--p95 is about --claim: --data holds standard deviations")
    claim_folder(words.out, words.force)
    rig = single_rig(options, None)
    errors = [] if words.claim is None else [_claimed(part, words.p95) for part in words.claim.split(",")]
    other = None if words.to is None else _other_rig(words.to)
    at_m = None
    if words.at is not None:
        at_m = [mm / 1e3 for mm in quantity.values(words.at, quantity.DEPTH)]

    from rigsim.api.infer import infer as run
    from rigsim.api.infer import published_claims

    odd = options.mode_remarks(rig)
    if options.preset is not None and not errors and words.data is None:
        claims, published = published_claims(options.preset, p95=words.p95)
        errors, odd = list(claims), [*odd, *published]
    result = run(rig, errors=errors, data=words.data, to=other, to_at_m=at_m)
    result = replace(result, remarks=(*odd, *result.remarks))
    deliver(result, words.out, words.force, words.as_json)


def _other_rig(word: str) -> StereoRig:
    path = Path(word)
    if path.suffix.lower() in (".toml", ".txt") or path.is_file():
        return RigOptions(rig=path).base(DEFAULT_PRESET)
    return RigOptions(preset=word).base(DEFAULT_PRESET)


def _claimed(part: str, p95: bool) -> DepthError:
    """The depth error of ``1%@4m``, ``10mm@3m`` or ``8.1:13.1m@10m``.

    Raises:
        InvalidRange: it cannot be read, has no unit, or is out of bounds.
    """
    from rigsim.api.kit.asked import DepthError

    said, sign, where = (word.strip() for word in part.partition("@"))
    if not sign or not said or not where:
        raise InvalidRange(f"claim {part.strip() or 'empty'}: {_CLAIM}")
    at_m = _length(where, "distance", part) / 1e3
    if said.endswith("%"):
        return DepthError(at_m, pct=_percent(said, part), p95=p95, words=part.strip())
    if ":" in said:
        bounds_mm = quantity.span(said, quantity.DEPTH)
        _length(said.rpartition(":")[2], "depth", part)
        return DepthError(at_m, bounds_mm=bounds_mm, p95=p95, words=part.strip())
    return DepthError(at_m, _length(said, "depth error", part), p95=p95, words=part.strip())


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
