"""The page of a design: verdict, requirements against what is achieved, plots, data sheet, command."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from rigsim.present import style
from rigsim.present.design_console import (
    CANDIDATE_HEADS,
    achieved_value,
    candidate_row,
    headline,
    requirement_rows,
    sentences,
)
from rigsim.present.design_figures import pareto_figure, plan_figure, region_figure
from rigsim.present.report import _data_uri
from rigsim.study import design_words as words
from rigsim.study.design import Candidate, Design
from rigsim.study.design_document import recommended
from rigsim.study.design_proof import Proof
from rigsim.theory.inverse import Camera
from rigsim.theory.limits import blind_zone_m

_MOST_ROWS = 15


def design_html(design: Design, proofs: Sequence[Proof], command: str) -> str:
    """The report of a design as one page, without scripts, links or network."""
    environment = Environment(
        loader=PackageLoader("rigsim.present"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["prose"] = _prose
    pick = recommended(design, proofs)
    spec = design.specification
    proof = next((p for p in proofs if p.candidate == pick and p.result is not None), None)
    show = proof.result.showcase if proof is not None and proof.result is not None else None
    met = [asked.is_met(achieved_value(asked, pick, spec)) for asked in spec.requirements]
    return environment.get_template("design.html").render(
        verified=any(p.verified for p in proofs),
        proved=bool(proofs),
        headline=headline(design, proofs),
        sentences=sentences(design, proofs),
        requirements=list(zip(requirement_rows(design, proofs), met, strict=True)),
        region=Markup(style.to_svg(region_figure(design, pick), "region", "Feasible region")),
        pareto=Markup(style.to_svg(pareto_figure(design, pick), "pareto", "Pareto front")),
        plan=Markup(style.to_svg(plan_figure(design, pick, proofs), "plan", "The rig from above")),
        heads=[head.replace("\n", " ") for head in CANDIDATE_HEADS],
        front=[candidate_row(candidate) for candidate in _one_a_camera(design)],
        sheet=data_sheet(design, pick),
        left=_data_uri(show.image_left) if show else "",
        right=_data_uri(show.image_right) if show else "",
        command=command,
    )


def data_sheet(design: Design, pick: Candidate) -> list[tuple[str, str]]:
    """What to buy and to build, as name and value."""
    camera, spec = pick.camera, design.specification
    f_b = camera.focal_px * pick.baseline_m
    lens = pick.rig.left
    return [
        *([("Camera and lens", camera.name)] if camera.name else []),
        ("Baseline", words.size(pick.baseline_m, 5)),
        (
            "Baselines allowed",
            " to ".join(words.size(end.baseline_m, 4) for end in (pick.interval.lower, pick.interval.upper)),
        ),
        ("Image", f"{camera.width_px} × {camera.height_px} px, {camera.pixels / 1e6:.2f} MP"),
        ("Focal length", f"{camera.focal_px:.5g} px (focal length in mm over pixel pitch in mm)"),
        ("Field of view", f"{lens.hfov_deg:.1f}° × {lens.vfov_deg:.1f}°"),
        ("Axes", "parallel; same rows in both images"),
        ("Working range", f"{words.distance(spec.near_m)} to {words.distance(spec.far_m)}"),
        ("Disparities", f"{f_b / spec.far_m:.4g} px (far) to {f_b / spec.near_m:.4g} px (near)"),
        ("Seen by both from", words.size(blind_zone_m(pick.rig))),
        *(
            (
                f"Depth error at {words.distance(z)}",
                f"{words.size(z**2 * spec.disparity_std_px / f_b)} (1 standard deviation)",
            )
            for z in (spec.near_m, math.sqrt(spec.near_m * spec.far_m), spec.far_m)
        ),
        (
            "Pixel noise assumed",
            f"{spec.noise_px:g} px per coordinate, {spec.disparity_std_px:.3g} px of disparity",
        ),
    ]


def _one_a_camera(design: Design) -> list[Candidate]:
    """The best of the front of each camera, in order, and not too many."""
    cameras: dict[Camera, Candidate] = {}
    for candidate in design.pareto:
        cameras.setdefault(candidate.camera, candidate)
    return list(cameras.values())[:_MOST_ROWS]


def _prose(text: str) -> Markup:
    """Escaped text, with true signs, in which `words` between backticks are set as code."""
    signs = text.replace("<=", "≤").replace(">=", "≥")
    return Markup(re.sub(r"`([^`]*)`", r"<code>\1</code>", str(escape(signs))))
