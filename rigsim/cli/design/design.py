"""`rigsim design`: from requirements to a rig, proved in a scene."""

from __future__ import annotations

import math
import shlex
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rigsim.cli.design import asked as read
from rigsim.cli.design.room import Optics, fittings, has_own_noise, room_plan, try_out
from rigsim.cli.kit import quantity
from rigsim.cli.kit.answer import print_document
from rigsim.cli.kit.sensors import Blur, FullWell, ImageNoise, ReadNoise
from rigsim.errors import InvalidRange

if TYPE_CHECKING:
    from rigsim.rig.sensor import Sensor
    from rigsim.study.design.proof import Proof
    from rigsim.study.design.solve import Design
    from rigsim.study.design.tolerance import DesignTolerance

UNVERIFIED = 3
"""Exit code when the simulation does not confirm any rig tried."""


def design(
    depth_range: Annotated[str, typer.Option("--range", metavar="NEAR:FAR", help="Working range: 0.5:3m.")],
    depth_error: Annotated[
        list[str],
        typer.Option(
            metavar="ERROR[@DISTANCE]",
            help="Depth error allowed, root mean square of one rig with its noise: 10mm@3m, 1%, 1%@2m; "
            "p95:20mm@3m for the 95th percentile. At the far end unless said. May be given "
            "several times.",
        ),
    ],
    fov: Annotated[
        str | None, typer.Option(metavar="DEG", help="Horizontal field of view, at least.")
    ] = None,
    cover: Annotated[
        str | None, typer.Option(metavar="WIDTH[@DISTANCE]", help="Width both cameras see, at least: 2m@3m.")
    ] = None,
    noise: Annotated[
        str | None,
        typer.Option(
            metavar="PX",
            help="Noise per pixel coordinate, standard deviation; by default 0.25, or with --sensor what is "
            "measured in pictures taken with it.",
        ),
    ] = None,
    build_share: Annotated[
        str,
        typer.Option(
            metavar="%",
            help="Share of that error's variance that noise leaves for errors of mounting and calibration: "
            "50%, or 0% for cameras that have none.",
        ),
    ] = "50%",
    max_baseline: Annotated[
        str | None, typer.Option(metavar="LENGTH", help="Longest baseline: 150 (mm), 0.15m.")
    ] = None,
    resolution: Annotated[str | None, typer.Option(help="Image sizes to try: 640x480,1280x960.")] = None,
    sensor: Annotated[
        str | None, typer.Option(metavar="NAME,...", help="Sensors to try, instead; see `rigsim scenes`.")
    ] = None,
    lens: Annotated[
        str | None,
        typer.Option(help="Lenses to try: 2.8,4,6,8mm with --sensor; or 900,1200px, or 60,70deg."),
    ] = None,
    max_disparity: Annotated[
        str | None, typer.Option(metavar="PX", help="Disparities that the matcher searches.")
    ] = None,
    min_overlap: Annotated[
        list[str] | None,
        typer.Option(
            metavar="%[@DISTANCE]",
            help="Share of the left image that the right camera sees, at least: 80%, 80%@1m. At the near end "
            "unless said, where it is 50% when nothing is asked. May be given several times.",
        ),
    ] = None,
    nearest_focus: Annotated[
        str | None,
        typer.Option(metavar="LENGTH", help="Nearest distance at which the lenses draw sharply: 0.3m."),
    ] = None,
    max_pixels: Annotated[
        str | None, typer.Option(metavar="MP", help="Most pixels of one image: 2MP.")
    ] = None,
    prefer: Annotated[
        str,
        typer.Option(help="smallest (baseline), cheapest (fewest pixels, then baseline) or most-accurate."),
    ] = "cheapest",
    scene: Annotated[
        str, typer.Option(help="Where the pick is proved: a bundled scene, or MJCF.")
    ] = "boards",
    no_proof: Annotated[
        bool, typer.Option("--no-proof", help="Formulas only: nothing is rendered or simulated.")
    ] = False,
    measure: Annotated[
        str,
        typer.Option(
            help="What is measured in the pictures: auto, corners, patches, dense or none. auto is as in "
            "sweep, and patches as well when a sensor's noise is measured."
        ),
    ] = "auto",
    blur: Blur = None,
    image_noise: ImageNoise = None,
    full_well: FullWell = None,
    read_noise: ReadNoise = None,
    class_name: Annotated[
        str,
        typer.Option("--class", metavar="NAME", help="Tolerances to rank: printed, machined or calibrated."),
    ] = "machined",
    seed: Annotated[int, typer.Option(help="Seed of every random number.")] = 0,
    renderer: Annotated[str, typer.Option(help="auto, egl, osmesa or rays.")] = "auto",
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON document; files are written only with --out.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="Folder of the report.", show_default="reports/design-TIME")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a report that is there.")] = False,
) -> None:
    """Find the rigs that meet requirements, recommend one, and prove it by simulation.

    Says which requirement binds at each end of the baselines allowed; when nothing is feasible, which one to
    relax and by how much. Exit code 3 when the simulation confirms none of the rigs tried.
    """
    near_mm, far_mm = read.working_range(depth_range)
    near_m, far_m = near_mm / 1e3, far_mm / 1e3
    cameras = read.cameras(resolution, sensor, lens, fov)

    from rigsim.study.design.proof import recommended
    from rigsim.study.design.solve import PRIOR_NOISE_PX, solve, specify
    from rigsim.study.design.tolerance import design_tolerance
    from rigsim.study.tolerance.sensitivities import CLASSES
    from rigsim.theory.inverse import Requirement

    if class_name not in CLASSES:
        raise InvalidRange(f"class {class_name!r}: choose one of {', '.join(CLASSES)}")
    asked = [read.depth_error(text, far_m) for text in depth_error]
    if fov is not None:
        asked.append(Requirement("fov", math.radians(quantity.value(fov, quantity.HFOV))))
    if cover is not None:
        width, at_m = read.at_distance(cover, far_m, "cover")
        asked.append(Requirement("cover", read.metres(width, "cover"), at_m))
    if max_baseline is not None:
        asked.append(Requirement("max_baseline", quantity.value(max_baseline, quantity.BASELINE) / 1e3))
    if max_disparity is not None:
        asked.append(Requirement("max_disparity", quantity.value(max_disparity, quantity.DISPARITY), near_m))
    if max_pixels is not None:
        asked.append(Requirement("pixels", read.pixels(max_pixels)))
    asked += [read.overlap(text, near_m) for text in min_overlap or []]
    specification = specify(
        near_m,
        far_m,
        asked,
        noise_px=PRIOR_NOISE_PX if noise is None else quantity.value(noise, quantity.NOISE),
        nearest_focus_m=0.0 if nearest_focus is None else read.metres(nearest_focus, "nearest focus"),
        build_share=read.build_share(build_share),
    )
    if noise is None:
        says = "assumed, as none was given"
        specification = replace(specification, noise_source="assumed", noise_says=says)
    optics = Optics(blur, image_noise, full_well, read_noise)
    fits = fittings(sorted({camera.sensor for camera in cameras}), optics)
    measures_noise = sensor is not None and noise is None and not no_proof and measure != "none"
    if not measures_noise:
        solve(specification, cameras, prefer)  # what cannot be is said before anything is drawn

    from rigsim.interop.files import folder

    target = out or (None if as_json else Path("reports") / f"design-{time.strftime('%Y%m%d-%H%M%S')}")
    if target is not None:
        folder.check_output(target, force)
    proofs: tuple[Proof, ...] = ()
    if no_proof:
        found = solve(specification, cameras, prefer)
    else:
        plan = room_plan(specification, scene, seed, renderer, measure, fits)
        found, proofs = try_out(specification, cameras, prefer, plan, fits, measures_noise)
    tolerance = design_tolerance(
        found.specification, recommended(found, proofs), class_name, seed, found.candidates
    )
    pick = recommended(found, proofs).camera.sensor
    sensor_used = fits[pick][1] if has_own_noise(pick, optics) or blur is not None else None
    _deliver(found, proofs, tolerance, sensor_used, target, force, as_json)
    if proofs and not proofs[-1].verified:
        raise typer.Exit(UNVERIFIED)


def _deliver(
    found: Design,
    proofs: tuple[Proof, ...],
    tolerance: DesignTolerance | None,
    sensor: Sensor | None,
    target: Path | None,
    force: bool,
    as_json: bool,
) -> None:
    from rigsim.interop.documents.design import design_document
    from rigsim.interop.documents.text import json_text
    from rigsim.interop.files import folder
    from rigsim.interop.formats.rig_toml import write_rig
    from rigsim.present.design.words import outcome
    from rigsim.study.design.proof import recommended

    document = design_document(found, proofs, tolerance, outcome)
    command = shlex.join(["rigsim", *sys.argv[1:]])
    if target is not None:
        from rigsim.present.design.page import design_html

        pick = recommended(found, proofs)
        comment = f"rigsim design: {document['recommended']['reason']}"
        files = {
            "rig.toml": write_rig(pick.rig, comment, sensor).encode(),
            "design.json": (json_text(document) + "\n").encode(),
            "design.html": design_html(found, proofs, tolerance, command).encode(),
        }
        folder.write_folder(target, files, force)
    if as_json:
        print_document(document)
    else:
        from rigsim.present.design.console import print_design

        print_design(found, proofs, tolerance, target)
