"""`rigsim design`: from requirements to a rig, proved in a scene."""

from __future__ import annotations

import time
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated

import typer

from rigsim.cli.kit.answer import claim, command, deliver
from rigsim.cli.kit.cover import CoverWords
from rigsim.cli.kit.golden import GoldenWords, held, leave_where_moved
from rigsim.cli.kit.options import DisparityNoise, takes
from rigsim.cli.kit.sensors import Blur, FullWell, ImageNoise, ReadNoise, sensor_words
from rigsim.cli.kit.tolerances import MaxRowError, ToleranceWord
from rigsim.typed.design import design_arguments

UNVERIFIED = 3
"""Exit code when the simulation does not confirm any rig tried."""


@dataclass(frozen=True, slots=True)
class DesignWords:
    """The options of `rigsim design`, as typed."""

    depth_range: Annotated[str, typer.Option("--range", metavar="NEAR:FAR", help="Working range: 0.5:3m.")]
    depth_error: Annotated[
        list[str],
        typer.Option(
            metavar="ERROR[@DISTANCE]",
            help="Depth error allowed, root mean square of one rig with its noise: 10mm@3m, 1%, 1%@2m; "
            "p95:20mm@3m for the 95th percentile. At the far end by default. May be given "
            "several times.",
        ),
    ]
    fov: Annotated[str | None, typer.Option(metavar="DEG", help="Horizontal field of view, at least.")] = None
    vfov: Annotated[str | None, typer.Option(metavar="DEG", help="Vertical field of view, at least.")] = None
    cover: Annotated[
        str | None,
        typer.Option(
            metavar="WIDTH[xHEIGHT][@DISTANCE]",
            help="What both cameras see, at least: 2m@3m, 0.8x0.6m@1.2m. At the far end by default.",
        ),
    ] = None
    noise: Annotated[
        str | None,
        typer.Option(
            metavar="PX",
            help="Noise per pixel coordinate, standard deviation; by default 0.25, or with --sensor what is "
            "measured in pictures taken with it.",
        ),
    ] = None
    disparity_noise: DisparityNoise = None
    build_share: Annotated[
        str,
        typer.Option(
            metavar="%",
            help="Share of that error's variance that noise leaves for errors of mounting and calibration: "
            "50%, or 0% for cameras that have none.",
        ),
    ] = "50%"
    max_row_error: MaxRowError = None
    calibration: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="The covariance.json, plan.json or calibration.json of rigsim calibrate: what it leaves"
            " counts in every depth error, noise and calibration adding as squares.",
        ),
    ] = None
    max_baseline: Annotated[
        str | None, typer.Option(metavar="LENGTH", help="Longest baseline: 150 (mm), 0.15m.")
    ] = None
    min_baseline: Annotated[
        str | None, typer.Option(metavar="LENGTH", help="Shortest baseline: 60 (mm), 6cm.")
    ] = None
    body_width: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH",
            help="Width of a camera's body: two do not fit closer. By default that of a usual camera "
            "with the --sensor, where it is known; 0 for none.",
        ),
    ] = None
    resolution: Annotated[
        str | None,
        typer.Option(
            help="Image sizes to try: 640x480,1280x960. A --sensor is scaled down to them; with "
            "--pixel-pitch a smaller one is a crop, with --sensor-width it has larger pixels."
        ),
    ] = None
    sensor: Annotated[
        str | None, typer.Option(metavar="NAME,...", help="Sensors to try; see `rigsim scenes`.")
    ] = None
    pixel_pitch: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH",
            help="Pixel pitch of cameras without a name: 3.45um, at every --resolution: a smaller one is a "
            "crop, with less field of view behind the same lens.",
        ),
    ] = None
    sensor_width: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH",
            help="Width of all their pixels, instead: 6.4mm, at every --resolution: a smaller one is scaled, "
            "with the same field of view.",
        ),
    ] = None
    crop: Annotated[
        str | None, typer.Option(metavar="WxH", help="Part of each --sensor that is read: 1920x1080.")
    ] = None
    binning: Annotated[
        int, typer.Option(metavar="N", help="Pixels across, and down, that each --sensor reads as one.")
    ] = 1
    lens: Annotated[
        str | None,
        typer.Option(
            help="Lenses to try: 2.8,4,6,8mm with --sensor, --pixel-pitch or --sensor-width; or 900,1200px, "
            "or 60,70deg."
        ),
    ] = None
    max_disparity: Annotated[
        str | None, typer.Option(metavar="PX", help="Disparities that the matcher searches.")
    ] = None
    min_overlap: Annotated[
        list[str] | None,
        typer.Option(
            metavar="%[@DISTANCE]",
            help="Share of the left image that the right camera sees, at least: 80%, 80%@1m. At the near end "
            "by default, where it is 50% when nothing is asked. May be given several times.",
        ),
    ] = None
    nearest_focus: Annotated[
        str | None,
        typer.Option(metavar="LENGTH", help="Nearest distance in focus: 0.3m."),
    ] = None
    max_pixels: Annotated[
        str | None, typer.Option(metavar="MP", help="Maximum pixels of one image: 2MP.")
    ] = None
    prefer: Annotated[
        str,
        typer.Option(
            help="buildable (the cheapest of which 95 of 100 built rigs are good), smallest (baseline), "
            "cheapest (fewest pixels, then baseline) or most-accurate."
        ),
    ] = "buildable"
    scene: Annotated[
        str,
        typer.Option(
            help="Scene to verify the rig in: auto makes one, with something to see at every distance asked "
            "for; or a bundled one, or MJCF."
        ),
    ] = "auto"
    no_proof: Annotated[
        bool, typer.Option("--no-proof", help="Formulas only: nothing is rendered or simulated.")
    ] = False
    measure: Annotated[
        str,
        typer.Option(
            help="What is measured in the pictures: auto, corners, patches, dense or none. auto is as in "
            "sweep, and patches as well when a sensor's noise is measured."
        ),
    ] = "auto"
    blur: Blur = None
    image_noise: ImageNoise = None
    full_well: FullWell = None
    read_noise: ReadNoise = None
    class_name: Annotated[
        str,
        typer.Option("--class", metavar="NAME", help="Who builds it: printed, machined or calibrated."),
    ] = "machined"
    tolerance: ToleranceWord = None
    seed: Annotated[int, typer.Option(help="Seed of every random number.")] = 0
    renderer: Annotated[str, typer.Option(help="auto, egl, osmesa or rays.")] = "auto"
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON document; files are written only with --out.")
    ] = False
    out: Annotated[
        Path | None, typer.Option(help="Folder of the report.", show_default="reports/design-TIME")
    ] = None
    force: Annotated[bool, typer.Option("--force", help="Replace a report that is there.")] = False


@takes(DesignWords)
@takes(CoverWords)
@takes(GoldenWords)
def design(words: DesignWords, cover: CoverWords, golden: GoldenWords) -> None:
    """Find the rigs that meet requirements, recommend one, and verify it by simulation.

    Says which requirement binds at each end of the baselines allowed; when nothing is feasible, which one to
    relax and by how much. Exit code 3 when the simulation confirms none of the rigs tried.
    """
    asked = design_arguments({item.name: getattr(words, item.name) for item in fields(words)})
    sensor = sensor_words(
        blur=words.blur,
        image_noise=words.image_noise,
        full_well=words.full_well,
        read_noise=words.read_noise,
    )
    del sensor["sensor"]  # there are several, among the cameras
    out = words.out
    if out is None and not words.as_json:
        out = Path("reports") / f"design-{time.strftime('%Y%m%d-%H%M%S')}"

    golden.check("design")

    from rigsim.api.design import design as run

    result = run(
        **asked,
        **sensor,
        scene=words.scene,
        proof=not words.no_proof,
        measure=words.measure,
        seed=words.seed,
        renderer=words.renderer,
        command=command(),
        **cover.said(),
        ready=lambda: claim(out, words.force),
    )
    result = held(result, golden, "design", {"scene": words.scene, "seed": str(words.seed)})
    deliver(result, out, words.force, words.as_json)
    leave_where_moved(result.golden)
    if result.verdict == "not verified":
        raise typer.Exit(UNVERIFIED)
