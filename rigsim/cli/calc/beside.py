"""Several rigs, or one at several distances, side by side: one table, beside what the makers claim."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import typer

from rigsim.cli.kit.answer import print_remarks
from rigsim.cli.kit.facts import Fact, Form, print_facts, values
from rigsim.cli.kit.golden import GoldenWords

if TYPE_CHECKING:
    from rigsim.rig.catalogue.commercial import Figure
    from rigsim.rig.remark import Remark
    from rigsim.rig.stereo import StereoRig

_HEADS = (
    "rig",
    "Z, m",
    "disparity, px",
    "depth std, mm",
    "nearest, mm",
    "farthest, mm",
    "maker's claim, mm",
    "",
)


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
        replace(remark, text=f"{one.name}: {remark.text}") if several else remark
        for one in rows
        for remark in one.remarks
    ]
    told = {remark.text: remark for remark in remarks}  # each once

    def document() -> dict[str, Any]:
        from rigsim.interop.documents.calc import depth_document

        nothing = dict.fromkeys(fact.key for fact in rows[0].facts)
        return depth_document(nothing, list(told.values()), [row_of(one) for one in rows])

    print_remarks(told.values())
    named = [[Fact("rig", "rig", one.name, "", ""), *one.facts, *_claim_facts(one)] for one in rows]
    print_facts(
        named[0],
        title="Depth",
        form=form,
        document=document,
        rows=named,
        golden=golden,
        show=lambda: _show(rows, noise_px, markdown=form.markdown),
    )


def _show(rows: Sequence[At], noise_px: float, *, markdown: bool) -> None:
    """Print the table for people."""
    wide = len(_HEADS) if any(one.claim for one in rows) else len(_HEADS) - 2
    heads, cells = _HEADS[:wide], [_cells(one)[:wide] for one in rows]
    if markdown:
        typer.echo(f"| {' | '.join(heads)} |\n|---|{'---:|' * 5}{'---:|---|' * (wide == len(_HEADS))}")
        for row in cells:
            typer.echo(f"| {' | '.join(row)} |")
        return
    from rigsim.present.kit.console import print_table

    title = f"Depth on the left optical axis, for {noise_px:g} px of noise per coordinate"
    broken = tuple(head.replace(", ", "\n") for head in heads)
    print_table(title, broken, cells, numeric=(False, *[True] * 6, False)[:wide])


def _claim_facts(one: At) -> list[Fact]:
    claim = one.claim
    claimed_mm = math.nan if claim is None else _claimed_mm(claim, one.depth_mm)
    return [Fact("claimed", "maker's claim", claimed_mm, "mm", "")]


def _claimed_mm(claim: Figure, depth_mm: float) -> float:
    """A claim as it would be at another distance, mm: an error of stereo grows with the distance squared."""
    at_mm = claim.at_mm or depth_mm
    return claim.value / 100 * at_mm * (depth_mm / at_mm) ** 2


def _cells(one: At) -> tuple[str, ...]:
    from rigsim.present.kit.format import MISSING, number, plain

    told, claim = values(one.facts), one.claim

    def shown(key: str) -> str:
        value = told[key]
        if isinstance(value, str) or math.isnan(value):
            return MISSING
        return "infinite" if math.isinf(value) else number(value)

    claimed, says = MISSING, ""
    if claim is not None:
        claimed = number(_claimed_mm(claim, one.depth_mm))
        at_m = (claim.at_mm or 0.0) / 1e3
        says = f"{claim.value:g} % at {at_m:g} m" + (", by a user's word" if claim.hearsay else "")
        if not math.isclose(claim.at_mm or 0.0, one.depth_mm):
            says = f"Z² from {says}"
    keys = ("disparity_px", "depth_std", "depth_near", "depth_far")
    return (one.name, plain(one.depth_mm / 1e3), *(shown(key) for key in keys), claimed, says)
