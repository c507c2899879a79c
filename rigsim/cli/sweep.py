"""`rigsim sweep`: many rigs in one scene, predicted, simulated and measured, with a report."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rigsim import interrupts
from rigsim.cli.kit import lists
from rigsim.cli.kit.answer import claim, command, deliver, quiet
from rigsim.cli.kit.axes import DISPARITY_NOISE, takes_axes
from rigsim.cli.kit.cover import CoverWords
from rigsim.cli.kit.golden import GoldenWords, held, leave_where_moved
from rigsim.cli.kit.options import (
    PICTURES,
    READING,
    Binning,
    Crop,
    PixelPitch,
    PresetName,
    Rectify,
    Resize,
    RigCameras,
    RigFile,
    RigMode,
    RigSize,
    RigSwap,
    RigUnit,
    SensorWidth,
    takes,
    tell_of_rig,
)
from rigsim.cli.kit.progress import shown
from rigsim.cli.kit.sensors import Blur, FullWell, ReadNoise, SensorName, sensor_words
from rigsim.cli.kit.triangulators import TIMEOUT, InProcess
from rigsim.errors import InvalidRange, TriangulatorError
from rigsim.study.scene.axes import registry
from rigsim.typed import quantity
from rigsim.typed.axes import numbers_of
from rigsim.typed.design import depth_error
from rigsim.typed.rigs import RigOptions

if TYPE_CHECKING:
    from rigsim.api.kit.asked import DepthError

MANY_RIGS = 1000
"""More rigs than this are run only with --yes."""

TYPICAL_NOISE_GREY = 2
"""What help calls `rigsim.api.kit.sensors.TYPICAL_NOISE_GREY`, without loading it."""


@dataclass(frozen=True, slots=True)
class SweepWords:
    """The options of `rigsim sweep` besides its axes, as typed."""

    scene: Annotated[str, typer.Option(help="A bundled scene's name, or an MJCF file.")] = "boards"
    mount: Annotated[
        str | None, typer.Option(help="Where the rig sits: body:NAME, site:NAME or camera:NAME.")
    ] = None
    preset: PresetName = None
    rig: RigFile = None
    rig_unit: RigUnit = None
    rig_size: RigSize = None
    rig_swap: RigSwap = False
    rig_cameras: RigCameras = None
    rig_mode: RigMode = None
    crop: Crop = None
    binning: Binning = None
    resize: Resize = None
    assume: Annotated[
        Path | None,
        typer.Option(
            help="The rig that triangulates, where it is another than the true one of --rig, which projects: "
            "a rig.toml, or another calibration."
        ),
    ] = None
    calibration: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="The covariance.json, plan.json or calibration.json of rigsim calibrate: every trial is"
            " triangulated with another calibration of its rig, and the prediction holds what that leaves.",
        ),
    ] = None
    sensor_width: SensorWidth = None
    pixel_pitch: PixelPitch = None
    depth_range: Annotated[
        str | None, typer.Option("--range", help="Depths of the truth points: 0.5:5m.")
    ] = None
    require: Annotated[
        list[str] | None,
        typer.Option(
            metavar="ERROR@DISTANCE",
            help="Depth error that rows are to keep, root mean square: 10mm@3m, 1%@2m; p95:20mm@3m for the"
            " 95th percentile. Marks each row met, not_met or not_shown. May be given several times.",
        ),
    ] = None
    points: Annotated[int, typer.Option(help="Truth points of each rig.")] = 2000
    trials: Annotated[int, typer.Option(help="Noisy repetitions of each point.")] = 100
    measure: Annotated[
        str,
        typer.Option(
            help="What to measure in the pictures: auto (corners where the scene has boards, else patches), "
            "none, corners, patches or dense."
        ),
    ] = "auto"
    rectify: Rectify = None
    sensor: SensorName = None
    blur: Blur = None
    image_noise: Annotated[
        str | None,
        typer.Option(
            metavar="GREY",
            help="White noise of the pictures, grey levels of 255; 0,1,2 for several. By default "
            f"{TYPICAL_NOISE_GREY}, unless a sensor says otherwise.",
        ),
    ] = None
    full_well: FullWell = None
    read_noise: ReadNoise = None
    triangulator: Annotated[
        str, typer.Option(help=f"{lists.TRIANGULATORS}, or package.module:function; commas.")
    ] = "optimal"
    timeout: Annotated[
        str, typer.Option(metavar="TIME", help="Time limit for one call of your function, a block of trials.")
    ] = "60s"
    in_process: InProcess = False
    seed: Annotated[int, typer.Option(help="Seed of every random number.")] = 0
    jobs: Annotated[int, typer.Option(help="Processes; the numbers do not depend on it.")] = 1
    out: Annotated[
        Path | None, typer.Option(help="Folder of the report.", show_default="reports/SCENE-TIME")
    ] = None
    renderer: Annotated[str, typer.Option(help="auto, egl, osmesa or rays.")] = "auto"
    supersample: Annotated[int, typer.Option(help="Samples along each side of a drawn pixel: 1, 2 or 4.")] = 2
    force: Annotated[bool, typer.Option("--force", help="Replace a report that is there.")] = False
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON document; files are written only with --out.")
    ] = False
    yes: Annotated[bool, typer.Option("--yes", help=f"Run more than {MANY_RIGS} rigs.")] = False


@takes_axes
@takes(SweepWords)
@takes(CoverWords)
@takes(GoldenWords)
def sweep(typed: Mapping[str, str], words: SweepWords, cover: CoverWords, golden: GoldenWords) -> None:
    """Sweep rigs through a scene: predicted, simulated and measured depth error side by side, in a report.

    Axes multiply. Lengths are in mm unless mm, cm or m is written.
    """
    noises, disparity_noises_px = numbers_of(typed, registry.OF_NOISE), _disparity_noises_px(typed)
    methods = _methods(words.triangulator)
    timeout_s = quantity.value(words.timeout, TIMEOUT)
    range_m = _range(words.depth_range)
    required = _required(words.require)
    options = _rigs(typed, words)
    options = tell_of_rig(options)
    axes, n_rigs = options.axes(words.scene), len(options.grid(words.scene))
    sensor = _sensor(options, words)
    if n_rigs > MANY_RIGS and not words.yes:
        raise InvalidRange(
            f"{n_rigs:,} rigs: more than {MANY_RIGS:,}; add --yes to run them all, or take fewer values"
        )
    out = words.out
    if out is None and not words.as_json:
        out = Path("reports") / f"{Path(words.scene).stem}-{time.strftime('%Y%m%d-%H%M%S')}"
    claim(out, words.force)
    golden.check("sweep")

    from rigsim.api.sweep import sweep as run

    with quiet(words.as_json), shown(n_rigs, "rigs") as progress:
        result = run(
            **axes,
            **sensor,
            noises_px=noises.pop("noise", None),
            disparity_noises_px=disparity_noises_px,
            more={**options.other_axes(), **noises},
            scene=words.scene,
            mount=words.mount,
            assume=words.assume,
            calibration=words.calibration,
            range_m=range_m,
            points=words.points,
            trials=words.trials,
            measure=words.measure,
            rectify=words.rectify,
            triangulators=methods,
            timeout_s=timeout_s,
            in_process=words.in_process,
            seed=words.seed,
            renderer=words.renderer,
            supersample=words.supersample,
            jobs=words.jobs,
            progress=progress,
            command=command(),
            require=required,
            **cover.said(),
        )
    if result.complete:
        result = held(result, golden, "sweep")
    deliver(result, out, words.force, words.as_json)
    if not result.complete:
        raise typer.Exit(interrupts.INTERRUPTED)
    if result.broken:
        raise TriangulatorError(result.broken, "raised")
    leave_where_moved(result.golden)


def _disparity_noises_px(typed: Mapping[str, str]) -> tuple[float, ...] | None:
    text = typed.get(DISPARITY_NOISE)
    return None if text is None else quantity.values(text, quantity.DISPARITY_NOISE)


def _rigs(typed: Mapping[str, str], words: SweepWords) -> RigOptions:
    options = RigOptions.of(
        typed,
        rig=words.rig,
        **{name: getattr(words, name) for name in (*READING, *PICTURES)},
        preset=words.preset,
        sensor_width=words.sensor_width,
        pixel_pitch=words.pixel_pitch,
    )
    if words.calibration is None or options.typed():
        return options
    from rigsim.api.kit.calibrations import read_calibration_tolerance

    return replace(options, read=read_calibration_tolerance(words.calibration).covariance.rig)


def _sensor(options: RigOptions, words: SweepWords) -> dict[str, Any]:
    return sensor_words(
        words.sensor,
        options.files,
        blur=words.blur,
        image_noise=words.image_noise,
        full_well=words.full_well,
        read_noise=words.read_noise,
    )


def _range(text: str | None) -> tuple[float, float] | None:
    if text is None:
        return None
    near_mm, far_mm = quantity.span(text, quantity.DEPTH)
    return near_mm / 1e3, far_mm / 1e3


def _required(words: list[str] | None) -> list[DepthError]:
    found = []
    for text in words or []:
        if "@" not in text:
            raise InvalidRange(f"require {text or 'empty'}: at which distance? Write it, as in 10mm@3m")
        found.append(depth_error(text, math.nan))
    return found


def _methods(text: str) -> tuple[str, ...]:
    methods = tuple(part.strip() for part in text.split(","))
    if not all(methods):
        raise InvalidRange(f"triangulator {text!r}: empty; name one, or several with commas")
    return methods
