"""A design in a terminal: the answer, what was asked for beside what is had, why, and what else there is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rigsim.present.console import make_console, print_table
from rigsim.present.format import number
from rigsim.study import design_words as words
from rigsim.study.design import Candidate, Design, Specification
from rigsim.study.design_document import recommended
from rigsim.study.design_proof import Proof
from rigsim.theory.inverse import Requirement

if TYPE_CHECKING:
    from rich.console import Console

_MOST = 6


def headline(design: Design, proofs: Sequence[Proof]) -> str:
    """The answer in one sentence."""
    pick = recommended(design, proofs)
    return f"{words.size(pick.baseline_m, 4)} baseline, {words.camera(pick.camera)}"


def sentences(design: Design, proofs: Sequence[Proof]) -> tuple[str, ...]:
    """What else must be known: the interval with what binds, its margin, and what became of the proof."""
    pick = recommended(design, proofs)
    low, high = pick.interval.lower, pick.interval.upper
    said = [
        f"With this camera any baseline from {words.size(low.baseline_m, 4)} to "
        f"{words.size(high.baseline_m, 4)} will do: shorter fails {words.whole(low.requirement)}, "
        f"longer fails {words.whole(high.requirement)}.",
        f"The pick keeps {pick.margin * 100:.2g} % of its baseline from the nearer end"
        + ("; the interval has no more room." if pick.is_tight else "."),
    ]
    if not proofs:
        said.append("Not verified: formulas only, no proof was asked for.")
    for proof in proofs:
        rig = f"{words.size(proof.candidate.baseline_m, 4)}, {words.camera(proof.candidate.camera)}"
        said.append(
            f"{proof.why[:1].upper()}{proof.why[1:]}." if proof.candidate == pick else f"{rig}: {proof.why}."
        )
    n = len(design.feasible)
    said.append(
        f"{n} of {len(design.intervals)} cameras can do it; preferred: {design.preference}, with room."
    )
    return tuple(said)


def requirement_rows(design: Design, proofs: Sequence[Proof]) -> list[tuple[str, str, str, str]]:
    """Requirement, limit, what the formulas give, what was simulated."""
    pick = recommended(design, proofs)
    spec = design.specification
    simulated = {
        held.requirement: words.size(held.simulated_m)
        for proof in proofs
        if proof.candidate == pick
        for held in proof.checks
        if math.isfinite(held.simulated_m)
    }
    return [
        (
            words.name(asked),
            f"{'>=' if asked.at_least else '<='} {words.value(asked, asked.limit)}",
            words.value(asked, achieved_value(asked, pick, spec), 3),
            simulated.get(asked, "–"),
        )
        for asked in spec.requirements
    ]


def achieved_value(asked: Requirement, pick: Candidate, spec: Specification) -> float:
    """What `pick` has of `asked`, in the unit of its limit."""
    return asked.achieved(pick.camera, pick.baseline_m, spec.disparity_std_px)


def candidate_row(candidate: Candidate) -> tuple[str, ...]:
    """One rig as the cells of `CANDIDATE_HEADS`."""
    camera = candidate.camera
    return (
        number(candidate.baseline_m * 1e3, 4),
        number(camera.focal_px, 4),
        f"{camera.width_px}x{camera.height_px}",
        f"{math.degrees(camera.hfov_rad):.1f}",
        number(candidate.far_error_m * 1e3),
        f"{camera.pixels / 1e6:.2f}",
        camera.name or "–",
    )


CANDIDATE_HEADS = (
    "baseline\nmm",
    "focal\npx",
    "image\npx",
    "HFOV\ndeg",
    "error at far\nend, mm",
    "image\nMP",
    "camera",
)


def print_design(
    design: Design, proofs: Sequence[Proof], folder: Path | None = None, *, console: Console | None = None
) -> None:
    """Print the rig, what was asked for and achieved, the Pareto front, and where the report is."""
    console = console or make_console()
    verified = any(proof.verified for proof in proofs)
    badge = "Verified" if verified else "Recommended, not verified"
    console.print(f"{badge}: {headline(design, proofs)}", style="bold", soft_wrap=True)
    for sentence in sentences(design, proofs):
        console.print(f"  {sentence.replace('`', '')}", soft_wrap=True)
    console.print()
    print_table(
        "Asked for and achieved",
        ("requirement", "asked for", "formula", "simulated"),
        requirement_rows(design, proofs),
        numeric=(False, True, True, True),
        console=console,
    )
    front = design.pareto[:_MOST]
    more = f", {_MOST} of {len(design.pareto)}" if len(design.pareto) > _MOST else ""
    print_table(
        f"Rigs that no other beats in every way{more}",
        CANDIDATE_HEADS,
        [candidate_row(candidate) for candidate in front],
        numeric=(True,) * 6 + (False,),
        console=console,
    )
    if folder is not None:
        console.print(f"Report: {folder / 'design.html'}", style="bold", soft_wrap=True)
