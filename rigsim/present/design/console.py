"""A design in a terminal: the answer, what was asked for beside what is had, why, and what else there is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rigsim.present.design.tolerance import held_by, limit_says, tolerance_says
from rigsim.present.design.words import badge, more_in_pictures, noise, outcome
from rigsim.present.kit.console import make_console, print_table
from rigsim.present.kit.format import MISSING, number, plain
from rigsim.study.calibrate.counted import DesignCalibration
from rigsim.study.design import words as words
from rigsim.study.design.buildable import leaves_resolution_open, smallest_resolution
from rigsim.study.design.least import least_size
from rigsim.study.design.proof import Proof, held_to, recommended, verdict
from rigsim.study.design.solve import Candidate, Design, Specification
from rigsim.study.design.tolerance import DesignTolerance
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
        f"Without build errors, this camera meets all requirements at any baseline from "
        f"{words.size(low.baseline_m, 4)} to {words.size(high.baseline_m, 4)}: a shorter one fails "
        f"{words.whole(low.requirement)}, a longer one fails {words.whole(high.requirement)}.",
        f"The recommended baseline is {plain(pick.margin * 100, 2)} % from its nearest limit"
        + ("; the interval is too narrow for more." if pick.is_tight else "."),
        _budget(pick, design.specification),
        *_told_apart(pick, design.specification),
        *([f"{words.body(pick.camera)}."] if pick.camera.body_m else []),
    ]
    if not proofs:
        said.append("Not verified: formulas only, no proof was asked for.")
    for proof in proofs:
        rig = f"{words.size(proof.candidate.baseline_m, 4)}, {words.camera(proof.candidate.camera)}"
        how = outcome(proof)
        said.append(f"{how[:1].upper()}{how[1:]}." if proof.candidate == pick else f"{rig}: {how}.")
    spec = design.specification
    own = next((p for p in proofs if p.candidate == pick), None)
    said += filter(None, [more_in_pictures(own.checks, spec.noise_px) if own is not None else ""])
    if own is not None and own.method == "corners" and spec.noise_source != "measured":
        said.append(
            "The measured points are corners of calibration boards, which are located most exactly; errors "
            "on ordinary surfaces are closer to the simulated ones."
        )
    said.append(f"Pixel noise {spec.noise_px:.3g} px per coordinate: {noise(spec)}.")
    n = len(design.feasible)
    said.append(
        f"{n} of {len(design.intervals)} cameras qualify; {design.preference} first, with margin preferred."
    )
    said += [*_smallest(design, pick), *_least(design, pick)]
    return tuple(said)


def _smallest(design: Design, pick: Candidate) -> list[str]:
    """The smallest resolution that would do, where several were tried."""
    if not leaves_resolution_open(design):
        return []
    rigs = f"95 of 100 {design.specification.builder.class_name} rigs, as built or recalibrated,"
    built = f": {rigs} should hold it" if design.preference == "buildable" else ""
    found = smallest_resolution(design)
    if found is None:
        return [f"At no resolution tried should {rigs} hold it."]
    size = f"{found.camera.width_px}x{found.camera.height_px} px"
    where = (
        ""
        if found.camera.pixels == pick.camera.pixels
        else f", with a baseline of {words.size(found.baseline_m, 4)}"
    )
    return [f"By formula the smallest of the resolutions tried that will do is {size}{where}{built}."]


def _least(design: Design, pick: Candidate) -> list[str]:
    """The size that would just do, whether it was tried or not."""
    found = least_size(pick, design.specification)
    if found is None:
        return []
    return [
        f"With this field of view and shape {found.width_px}x{found.height_px} px would just do by formula, "
        f"with a baseline of {words.size(found.baseline_m, 4)} and no build errors."
    ]


def _budget(pick: Candidate, spec: Specification) -> str:
    noise, wanted = min(100 * pick.noise_share, 100.0), 100 * spec.build_share
    if spec.calibration is not None:
        return f"{_with_calibration(pick, spec.calibration)} (--build-share asks for {wanted:.3g} %)."
    said = (
        f"Pixel noise takes {noise:.3g} % of the allowed variance of the depth error; {100 - noise:.3g} % is "
        "left for build errors"
    )
    if pick.keeps_share:
        return f"{said} (--build-share asks for {wanted:.3g} %)."
    return f"{said}: less than the {wanted:.3g} % of --build-share, which no rig here reaches."


def _with_calibration(pick: Candidate, calibration: DesignCalibration) -> str:
    noise, left = 100 * pick.noise_share, 100 * pick.calibration_share
    rest = max(100 - noise - left, 0.0)
    return (
        f"Pixel noise takes {noise:.3g} % of the allowed variance of the depth error and the calibration"
        f" ({calibration.of.name}, {calibration.of.source}) {left:.3g} %; {rest:.3g} % is left for what"
        " changes afterwards"
    )


def _told_apart(pick: Candidate, spec: Specification) -> list[str]:
    """Noise and calibration of every depth error; nothing where no calibration is counted."""
    if spec.calibration is None:
        return []
    said = []
    for asked in spec.requirements:
        if asked.calibration is not None:
            noise, left, both = (words.value(asked, part, 3) for part in spec.parts(asked, pick))
            said.append(f"{words.name(asked)}: {noise} pixel noise, {left} calibration, {both} both")
    return [
        f"Noise and calibration add as squares, {'; '.join(said)}. The scene's cameras are exact: what the"
        " calibration leaves is added to what was simulated and measured."
    ]


def requirement_rows(design: Design, proofs: Sequence[Proof]) -> list[tuple[str, ...]]:
    """Requirement, limit, by the formulas, simulated, measured in the pictures, and whether it is met."""
    pick = recommended(design, proofs)
    spec = design.specification
    rows: list[tuple[str, ...]] = []
    for asked in spec.asked_of(pick.camera):
        held = held_to(asked, pick, proofs)
        formula = achieved_value(asked, pick, spec)
        told = verdict(asked, pick, proofs, spec)
        missed = held is not None and held.is_met and held.is_missed_by_pixels
        rows.append(
            (
                words.name(asked),
                f"{'>=' if asked.at_least else '<='} {words.value(asked, asked.limit)}",
                words.value(asked, formula, 3),
                _said(asked, math.nan if held is None else held.simulated),
                _said(asked, math.nan if held is None else held.measured),
                "measured: not met" if missed else told.replace("_", " "),
            )
        )
    return rows


REQUIREMENT_HEADS = ("requirement", "asked for", "formula", "simulated", "measured", "")
"""Heads of `requirement_rows`."""


def shown_by_words(design: Design, proofs: Sequence[Proof]) -> str:
    """How the simulated values were found, in a sentence; empty without a proof."""
    pick = recommended(design, proofs)
    asked_of_it = design.specification.asked_of(pick.camera)
    checks = [held for asked in asked_of_it if (held := held_to(asked, pick, proofs))]
    if not checks:
        return ""
    found = {
        shown_by: ", ".join(
            dict.fromkeys(
                words.name(c.requirement) for c in checks if c.shown_by == shown_by and not c.is_widened
            )
        )
        for shown_by in _SHOWN_BY
    }
    said = [f"{names} {_SHOWN_BY[shown_by]}" for shown_by, names in found.items() if names]
    said += [
        f"{words.name(c.requirement)} from points at "
        f"{words.span(c.nearest_m, c.farthest_m)}, the nearest available"
        for c in checks
        if c.is_widened
    ]
    return f"Simulated: {'; '.join(said)}."


_SHOWN_BY = {
    "points": "from points of the scene near that distance",
    "plane": "from a plane at that distance that fills the pictures",
    "rays": "from the rays at the image borders",
    "pictures": "from the rendered pictures",
    "cameras": "from the cameras as placed",
}


def _said(asked: Requirement, value: float) -> str:
    return words.value(asked, value, 3) if math.isfinite(value) else MISSING


def achieved_value(asked: Requirement, pick: Candidate, spec: Specification) -> float:
    """What `pick` has of `asked`, in the unit of its limit."""
    return asked.achieved(pick.camera, pick.baseline_m, spec.disparity_std_px)


def yields_words(tolerance: DesignTolerance) -> str:
    """How many rigs of each class are good, in a sentence."""
    said = (
        f"{item.name} {words.share(item.as_built.share)} / {words.share(item.recalibrated.share)}"
        for item in tolerance.yields
    )
    counts = [c for item in tolerance.yields for c in (item.as_built, item.recalibrated)]
    worst = max(c.standard_error for c in counts)
    rigs = " to ".join(dict.fromkeys(f"{end(c.rigs for c in counts):,}" for end in (min, max)))
    return (
        f"Yield with pixel noise, {rigs} rigs per class (%), as built / recalibrated: {', '.join(said)} "
        f"(standard error up to {100 * worst:.1f})."
    )


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
    design: Design,
    proofs: Sequence[Proof],
    tolerance: DesignTolerance | None = None,
    folder: Path | None = None,
    *,
    console: Console | None = None,
) -> None:
    """Print the rig, what was asked for and achieved, the Pareto front, and where the report is."""
    console = console or make_console()
    how = badge(proofs) or "Recommended, not verified"
    console.print(f"{how}: {headline(design, proofs)}", style="bold", soft_wrap=True)
    if tolerance is not None and held_by(tolerance)[0] != "agrees":
        console.print(f"  When it is built: {held_by(tolerance)[1]}.", style="bold", soft_wrap=True)
    for sentence in sentences(design, proofs):
        console.print(f"  {sentence.replace('`', '')}", soft_wrap=True)
    console.print()
    print_table(
        "Asked for and achieved",
        REQUIREMENT_HEADS,
        requirement_rows(design, proofs),
        numeric=(False, True, True, True, True, False),
        console=console,
    )
    if tolerance is not None:
        console.print(tolerance_says(tolerance), soft_wrap=True)
        console.print(yields_words(tolerance), soft_wrap=True)
        console.print(limit_says(tolerance), soft_wrap=True)
        console.print()
    front = design.pareto[:_MOST]
    more = f", {_MOST} of {len(design.pareto)}" if len(design.pareto) > _MOST else ""
    print_table(
        f"Pareto-optimal rigs{more}",
        CANDIDATE_HEADS,
        [candidate_row(candidate) for candidate in front],
        numeric=(True,) * 6 + (False,),
        console=console,
    )
    if folder is not None:
        console.print(f"Report: {folder / 'design.html'}", style="bold", soft_wrap=True)
