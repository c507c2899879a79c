"""Several rigs, or one at several distances, side by side: one table, beside what the makers claim."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import typer

from rigsim.api.calc.better import Rated, better, modes_of
from rigsim.api.calc.fact import Fact, values
from rigsim.cli.kit.answer import print_remarks
from rigsim.cli.kit.facts import Form, print_facts
from rigsim.cli.kit.golden import GoldenWords

if TYPE_CHECKING:
    from rigsim.rig.catalogue.commercial import Figure
    from rigsim.rig.remark import Remark
    from rigsim.rig.stereo import StereoRig

_HEADS = ("rig", "Z, m", "disparity, px", "depth std, mm", "nearest, mm", "farthest, mm")
_ROWS = ("rows apart, px",)
_CLAIM = ("maker's claim, mm", "basis")
_NOT_KNOWN = "not known"


@dataclass(frozen=True, slots=True)
class At:
    """A rig at a distance."""

    name: str
    """What the rig is called."""
    depth_mm: float
    """The distance, mm."""
    rig: StereoRig
    """The rig."""
    preset: str | None
    """The preset that it started from."""
    facts: list[Fact]
    """What is told of it."""
    remarks: list[Remark]
    """What is odd about it."""

    @property
    def claim(self) -> Figure | None:
        """The maker's claim that is nearest."""
        if self.preset is None:
            return None
        from rigsim.rig.presets import preset

        return preset(self.preset).claim_near(self.depth_mm)

    @property
    def is_bought(self) -> bool:
        """Whether it is a camera that somebody makes."""
        if self.preset is None:
            return False
        from rigsim.rig.presets import preset

        return bool(preset(self.preset).figures)


def row_of(one: At) -> dict[str, Any]:
    """A row of the JSON document; lengths in mm, as their names say."""
    told = values(one.facts)
    lengths = ("depth_std", "depth_near", "depth_far", "depth_bias")
    claim = one.claim
    at_mm = None if claim is None else claim.at_mm
    return {
        "rig": one.name,
        "z_mm": one.depth_mm,
        **{f"{name}_mm": told[name] for name in lengths},
        "seen_by": told["seen_by"],
        "baseline_mm": one.rig.baseline_m * 1e3,
        "focal_px": one.rig.left.fx,
        **{key: told[key] for key in ("disparity_px", "row_px", "row_least_px", "row_most_px")},
        "claimed_mm": None if claim is None else _claimed_mm(claim, one.depth_mm),
        "claimed_pct": None if claim is None else claim.value,
        "claimed_at_mm": at_mm,
        "claim_source": "" if claim is None else claim.source,
    }


def print_beside(rows: Sequence[At], noise_px: float, form: Form, golden: GoldenWords) -> None:
    """Print every rig at every distance, in the order given."""
    several = len({one.name for one in rows}) > 1
    remarks = [
        replace(remark, text=_named(one.name, remark.text)) if several else remark
        for one in rows
        for remark in one.remarks
    ]
    told = {remark.text: remark for remark in remarks}  # each once
    says = _says(rows, noise_px)

    def document() -> dict[str, Any]:
        from rigsim.interop.documents.calc import depth_document

        nothing = dict.fromkeys(fact.key for fact in rows[0].facts)
        return depth_document(nothing, list(told.values()), [row_of(one) for one in rows], says)

    print_remarks(told.values())
    named = [[Fact("rig", "rig", one.name, "", ""), *one.facts, *_claim_facts(one)] for one in rows]
    print_facts(
        named[0],
        title="Depth",
        form=form,
        document=document,
        rows=named,
        golden=golden,
        show=lambda: _show(rows, noise_px, says, markdown=form.markdown),
    )


def _says(rows: Sequence[At], noise_px: float) -> str:
    """Which rig is the more accurate where; empty for one rig."""
    rated = [Rated(one.name, one.depth_mm, float(values(one.facts)["depth_std"])) for one in rows]
    return better(rated, noise_px, modes_of({one.name: (one.preset, one.rig) for one in rows}))


def _show(rows: Sequence[At], noise_px: float, says: str, *, markdown: bool) -> None:
    """Print the table for people, and the sentence."""
    apart = any(not one.rig.is_rectified for one in rows)
    claimed = any(one.is_bought for one in rows)
    heads = (*_HEADS, *(_ROWS if apart else ()), *(_CLAIM if claimed else ()))
    cells = [
        (*_cells(one), *(_rows_cells(one) if apart else ()), *(_claim_cells(one) if claimed else ()))
        for one in rows
    ]
    numeric = [False, *[True] * (len(heads) - 1)]
    if claimed:
        numeric[-1] = False
    if markdown:
        lines = [heads, ["---:" if right else "---" for right in numeric], *cells]
        typer.echo("\n".join(f"| {' | '.join(line)} |" for line in lines) + (f"\n\n{says}" if says else ""))
        return
    from rigsim.present.kit.console import make_console, paragraph, print_table

    title = f"Depth on the left optical axis, for {noise_px:g} px of noise per coordinate"
    broken = tuple(head.replace(", ", "\n") for head in heads)
    print_table(title, broken, cells, numeric=numeric)
    if says:
        paragraph(make_console(), says)


def _claim_facts(one: At) -> list[Fact]:
    claim = one.claim
    claimed_mm = math.nan if claim is None else _claimed_mm(claim, one.depth_mm)
    return [Fact("claimed", "maker's claim", claimed_mm, "mm", "")]


def _claimed_mm(claim: Figure, depth_mm: float) -> float:
    """A claim as it would be at another distance, mm: an error of stereo grows with the distance squared."""
    at_mm = claim.at_mm or depth_mm
    return claim.value / 100 * at_mm * (depth_mm / at_mm) ** 2


def _cells(one: At) -> tuple[str, ...]:
    from rigsim.present.kit.format import plain, to_error

    told = values(one.facts)
    std_mm = float(told["depth_std"])
    ends = [float(told[key]) for key in ("depth_near", "depth_far")]
    # as many digits as tell them from the distance
    shown = [to_error(end, std_mm) if math.isfinite(end) else _shown(end) for end in ends]
    seen = (_shown(told[key]) for key in ("disparity_px", "depth_std"))
    return (one.name, plain(one.depth_mm / 1e3), *seen, *shown)


def _rows_cells(one: At) -> tuple[str]:
    """How far rows are apart at most, on the axis where nobody knows the image."""
    told = values(one.facts)
    ends = [abs(float(told[key])) for key in ("row_least_px", "row_most_px")]
    return (_shown(abs(float(told["row_px"])) if math.isnan(max(ends)) else max(ends)),)


def _claim_cells(one: At) -> tuple[str, str]:
    """The maker's claim at this distance, and what it says itself."""
    from rigsim.present.kit.format import MISSING, number

    claim = one.claim
    if claim is None:
        return _NOT_KNOWN if one.is_bought else MISSING, ""
    at_m = (claim.at_mm or 0.0) / 1e3
    says = f"{claim.value:g} % at {at_m:g} m" + (", by a user's word" if claim.hearsay else "")
    if not math.isclose(claim.at_mm or 0.0, one.depth_mm):
        says = f"Z² from {says}"
    return number(_claimed_mm(claim, one.depth_mm)), says


def _named(name: str, text: str) -> str:
    """A remark with the rig's name before it, once."""
    return text if text.startswith(f"{name}: ") else f"{name}: {text}"


def _shown(value: float | str) -> str:
    from rigsim.present.kit.format import MISSING, number

    if isinstance(value, str) or math.isnan(value):
        return MISSING
    return "infinite" if math.isinf(value) else number(value)
