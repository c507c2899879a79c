"""The page of a design: verdict, requirements against what is achieved, plots, data sheet, command."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from markupsafe import Markup

from rigsim.present.design.console import (
    CANDIDATE_HEADS,
    candidate_row,
    headline,
    requirement_rows,
    sentences,
    shown_by_words,
)
from rigsim.present.design.figures import pareto_figure, plan_figure, region_figure
from rigsim.present.design.tolerance import held_by, limit_says, tolerance_says
from rigsim.present.design.words import badge
from rigsim.present.design.words import noise as noise_from
from rigsim.present.kit import style
from rigsim.present.kit.format import count, with_error
from rigsim.present.kit.page import Cover, data_uri, fill
from rigsim.present.tolerance.console import (
    quantity_heads,
    quantity_rows,
    row_heads,
    row_rows,
    tolerance_figure,
)
from rigsim.rig.catalogue.sensors import sensor_preset
from rigsim.study.design import words as words
from rigsim.study.design.proof import Proof, recommended
from rigsim.study.design.solve import Candidate, Design
from rigsim.study.design.tolerance import DesignTolerance
from rigsim.study.tolerance.count import Count
from rigsim.study.tolerance.sensitivities import CLASSES
from rigsim.theory.inverse import Camera
from rigsim.theory.inverse_error import noise_error
from rigsim.theory.limits import blind_zone_m

_MOST_ROWS = 15
_PITCHES_UM = (2.2, 3.45, 4.8)  # common ones, to give an idea of the lens


def design_html(
    design: Design,
    proofs: Sequence[Proof],
    tolerance: DesignTolerance | None,
    command: str,
    cover: Cover | None = None,
) -> str:
    """The report of a design as one page, without scripts, links or network."""
    pick = recommended(design, proofs)
    proof = next((p for p in proofs if p.candidate == pick), None)
    show = proof.show if proof is not None else None
    return fill(
        "design.html",
        title="Design of a stereo rig",
        cover=cover or Cover(),
        verified=badge(proofs).replace("Verified", "Verified by simulation"),
        held_by=None if tolerance is None else held_by(tolerance),
        proved=bool(proofs),
        headline=headline(design, proofs),
        calibrated=design.specification.calibration is not None,
        sentences=[*sentences(design, proofs), *([] if tolerance is None else [limit_says(tolerance)])],
        requirements=requirement_rows(design, proofs),
        shown_by=shown_by_words(design, proofs),
        region=Markup(style.to_svg(region_figure(design, pick), "region", "Feasible region")),
        pareto=Markup(style.to_svg(pareto_figure(design, pick), "pareto", "Pareto front")),
        plan=Markup(style.to_svg(plan_figure(design, pick, proofs), "plan", "The rig from above")),
        heads=[head.replace("\n", " ") for head in CANDIDATE_HEADS],
        front=[candidate_row(candidate) for candidate in _one_a_camera(design)],
        sheet=data_sheet(design, pick),
        left="" if show is None else data_uri(show.image_left),
        right="" if show is None else data_uri(show.image_right),
        sensor="" if proof is None else proof.sensor,
        tolerance=None if tolerance is None else _tolerance_part(tolerance),
        command=command,
    )


def _tolerance_part(tolerance: DesignTolerance) -> dict[str, Any]:
    """What the page says of tolerances."""
    result = tolerance.result
    required_m = result.required.error_m
    at = words.distance(result.required.depth_m)
    size = words.size(tolerance.noise_error_m)
    noise = f"Pixel noise alone causes an error of {size} at {at}, root mean square. "
    left_m2 = required_m**2 - tolerance.noise_error_m**2
    if left_m2 > 0 and not result.required.p95:
        noise += (
            f"The two add as squares: a rig with build errors of {words.size(math.sqrt(left_m2))} over "
            f"the image has {words.size(required_m)} in all."
        )
    return {
        "says": tolerance_says(tolerance),
        "noise": noise,
        "class_name": tolerance.class_name,
        "about": CLASSES[tolerance.class_name].about,
        "required": f"{words.size(required_m)} at {at}",
        "statistic": "the 95th percentile of its errors" if result.required.p95 else "the root mean square",
        "heads": [head.replace("\n", " ") for head in _with_rows(quantity_heads(result), row_heads(result))],
        "rows": [
            _with_rows(of_depth, of_rows)
            for of_depth, of_rows in zip(quantity_rows(result), row_rows(result), strict=True)
        ],
        "yields": [
            (
                item.name,
                CLASSES[item.name].about,
                *(_counted(rigs) for rigs in (item.as_built, item.recalibrated)),
            )
            for item in tolerance.yields
        ],
        "n_rigs": count(result.n_rigs),
        "figure": Markup(style.to_svg(tolerance_figure(result), "tolerance", "Tolerances of the rig")),
    }


def _with_rows(of_depth: Sequence[str], of_rows: Sequence[str]) -> tuple[str, ...]:
    """Cells of the ranked table, with those of the rows before the unit."""
    return (*of_depth[:-1], *of_rows, of_depth[-1])


def _counted(found: Count) -> str:
    return f"{with_error(100 * found.share, 100 * found.standard_error)} of {count(found.rigs)}"


def data_sheet(design: Design, pick: Candidate) -> list[tuple[str, str]]:
    """What to buy and to build, as name and value."""
    camera, spec = pick.camera, design.specification
    f_b = camera.focal_px * pick.baseline_m
    lens = pick.rig.left
    low, high = (words.size(end.baseline_m, 4) for end in (pick.interval.lower, pick.interval.upper))
    return [
        ("Cameras", "two of the same model, with the same lens"),
        *_to_buy(camera),
        ("Image", f"{camera.width_px} × {camera.height_px} px, {camera.pixels / 1e6:.2f} MP"),
        ("Focal length", f"{camera.focal_px:.5g} px{_in_mm(camera)}"),
        ("Field of view", f"{lens.hfov_deg:.1f}° × {lens.vfov_deg:.1f}°, horizontal × vertical"),
        ("Lens distortion", "any that a calibration describes; focus and aperture locked"),
        ("Exposure", "both cameras triggered together"),
        ("Baseline", f"{words.size(pick.baseline_m, 5)} between the lenses' optical centres"),
        ("Baselines allowed", f"{low} to {high}"),
        ("Mounting", "axes parallel, at the same height; tolerances below"),
        ("Working range", f"{words.distance(spec.near_m)} to {words.distance(spec.far_m)}"),
        ("Disparity search", f"{f_b / spec.far_m:.4g} px (far) to {f_b / spec.near_m:.4g} px (near)"),
        ("Seen by both from", f"{words.size(blind_zone_m(pick.rig))} on"),
        *(
            (
                f"Depth error at {words.distance(z)}",
                f"{words.size(z * noise_error(z * spec.disparity_std_px / f_b))}, root mean square, by noise",
            )
            for z in (spec.near_m, math.sqrt(spec.near_m * spec.far_m), spec.far_m)
        ),
        (
            "Pixel noise",
            f"{spec.noise_px:.3g} px per coordinate, {spec.disparity_std_px:.3g} px of disparity: "
            f"{noise_from(spec)}",
        ),
    ]


def _to_buy(camera: Camera) -> list[tuple[str, str]]:
    """Sensor and lens, as far as they are named."""
    if not camera.sensor or camera.pitch_um is None:
        return [("Sensor", "any with this many pixels; global shutter when the rig or the scene moves")]
    width, height = (side * camera.pitch_um / 1e3 for side in (camera.width_px, camera.height_px))
    maker = sensor_preset(camera.sensor).maker
    return [
        (
            "Sensor",
            f"{maker} {camera.sensor.upper()}, {width:.2f} × {height:.2f} mm "
            f"({math.hypot(width, height):.1f} mm diagonal), {camera.pitch_um:g} µm pixels",
        ),
        (
            "Lens",
            f"{camera.focal_mm:.3g} mm, image circle at least {math.hypot(width, height):.1f} mm",
        ),
    ]


def _in_mm(camera: Camera) -> str:
    if camera.focal_mm is not None:
        return f" = {camera.focal_mm:.3g} mm behind {camera.pitch_um:g} µm pixels"
    said = ", ".join(f"{camera.focal_px * pitch / 1e3:.2f} mm behind {pitch:g} µm" for pitch in _PITCHES_UM)
    return f": pixel pitch times this, as {said}"


def _one_a_camera(design: Design) -> list[Candidate]:
    """The best of the front of each camera, in order, and not too many."""
    cameras: dict[Camera, Candidate] = {}
    for candidate in design.pareto:
        cameras.setdefault(candidate.camera, candidate)
    return list(cameras.values())[:_MOST_ROWS]
