"""`rigsim sweep`: many rigs in one scene, predicted and simulated, with a report."""

from __future__ import annotations

import importlib.util
import shlex
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rigsim.cli.kit import ends, lists, quantity
from rigsim.cli.kit.answer import print_document, print_remarks, quiet
from rigsim.cli.kit.axes import asked, takes_axes, values_of
from rigsim.cli.kit.progress import shown
from rigsim.cli.kit.rigs import RigOptions
from rigsim.cli.kit.sensors import (
    Blur,
    FullWell,
    ReadNoise,
    SensorName,
    sensor_labels,
    sensor_of,
    sensors_from,
)
from rigsim.cli.kit.triangulators import TIMEOUT, InProcess
from rigsim.errors import InvalidRange
from rigsim.study.scene.axes import registry

if TYPE_CHECKING:
    from rigsim.rig.perturbation import Perturbation
    from rigsim.rig.stereo import StereoRig
    from rigsim.study.sweep.result import SweepResult

MANY_RIGS = 1000
"""More rigs than this are run only with --yes."""


TYPICAL_NOISE_GREY = 2
"""Image noise of an ordinary 8-bit camera in good light, grey levels."""


@takes_axes
def sweep(
    typed: Mapping[str, str],
    scene: Annotated[str, typer.Option(help="A bundled scene's name, or an MJCF file.")] = "boards",
    mount: Annotated[
        str | None, typer.Option(help="Where the rig sits: body:NAME, site:NAME or camera:NAME.")
    ] = None,
    preset: Annotated[str | None, typer.Option(help="A rig to start from; see `rigsim presets`.")] = None,
    rig: Annotated[Path | None, typer.Option(help="Start from a rig.toml, or another calibration.")] = None,
    assume: Annotated[
        Path | None,
        typer.Option(
            help="The rig that triangulates, where it is another than the true one of --rig, which projects: "
            "a rig.toml, or another calibration."
        ),
    ] = None,
    sensor_width: Annotated[str | None, typer.Option(help="Active sensor width, for a focal in mm.")] = None,
    pixel_pitch: Annotated[str | None, typer.Option(help="Pixel pitch, um, for a focal in mm.")] = None,
    depth_range: Annotated[
        str | None, typer.Option("--range", help="Depths of the truth points: 0.5:5m.")
    ] = None,
    points: Annotated[int, typer.Option(help="Truth points of each rig.")] = 2000,
    trials: Annotated[int, typer.Option(help="Noisy repetitions of each point.")] = 100,
    measure: Annotated[
        str,
        typer.Option(
            help="What to measure in the pictures: auto (corners where the scene has boards, else patches), "
            "none, corners, patches or dense."
        ),
    ] = "auto",
    sensor: SensorName = None,
    blur: Blur = None,
    image_noise: Annotated[
        str | None,
        typer.Option(
            metavar="GREY",
            help="White noise of the pictures, grey levels of 255; 0,1,2 for several. By default "
            f"{TYPICAL_NOISE_GREY}, unless a sensor says otherwise.",
        ),
    ] = None,
    full_well: FullWell = None,
    read_noise: ReadNoise = None,
    triangulator: Annotated[
        str, typer.Option(help=f"{lists.TRIANGULATORS}, or package.module:function; commas.")
    ] = "optimal",
    timeout: Annotated[
        str, typer.Option(metavar="TIME", help="For one call of a function of yours, a block of trials.")
    ] = "60s",
    in_process: InProcess = False,
    seed: Annotated[int, typer.Option(help="Seed of every random number.")] = 0,
    jobs: Annotated[int, typer.Option(help="Processes; the numbers do not depend on it.")] = 1,
    out: Annotated[
        Path | None, typer.Option(help="Folder of the report.", show_default="reports/SCENE-TIME")
    ] = None,
    renderer: Annotated[str, typer.Option(help="auto, egl, osmesa or rays.")] = "auto",
    supersample: Annotated[
        int, typer.Option(help="Samples along each side of a drawn pixel: 1, 2 or 4.")
    ] = 2,
    force: Annotated[bool, typer.Option("--force", help="Replace a report that is there.")] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON document; files are written only with --out.")
    ] = False,
    yes: Annotated[bool, typer.Option("--yes", help=f"Run more than {MANY_RIGS} rigs.")] = False,
) -> None:
    """Sweep rigs through a scene: predicted, simulated and measured depth error side by side, in a report.

    Axes multiply. Lengths are in mm unless mm, cm or m is written.
    """
    noise_values = values_of(typed, registry.OF_NOISE)
    methods = _methods(triangulator)
    timeout_s = None if in_process else quantity.value(timeout, TIMEOUT)
    range_m = None
    if depth_range is not None:
        near_mm, far_mm = quantity.span(depth_range, quantity.DEPTH)
        range_m = (near_mm / 1e3, far_mm / 1e3)
    options = RigOptions.of(typed, rig=rig, preset=preset, sensor_width=sensor_width, pixel_pitch=pixel_pitch)
    grid = options.grid(scene)
    assumed, perturbation = _assumed(assume, rig)
    if image_noise is None and sensor is None and full_well is None and sensor_of(rig) is None:
        image_noise = str(TYPICAL_NOISE_GREY)
    sensors = sensors_from(
        sensor, rig, blur=blur, image_noise=image_noise, full_well=full_well, read_noise=read_noise
    )
    if len(grid) > MANY_RIGS and not yes:
        raise InvalidRange(
            f"{len(grid):,} rigs: more than {MANY_RIGS:,}; add --yes to run them all, or take fewer values"
        )

    from rigsim.interop.files import folder

    target = out
    if target is None and not as_json:
        target = Path("reports") / f"{Path(scene).stem}-{time.strftime('%Y%m%d-%H%M%S')}"
    if target is not None:
        folder.check_output(target, force)

    from rigsim.study.scene.plan import Plan
    from rigsim.study.sweep.run import sweep as run

    if renderer == "auto":
        from rigsim.sim import backend

        renderer = backend.choose()
        if renderer == "rays":
            typer.echo(
                "no GL library works here: using rays, which measure nothing (see `rigsim doctor`)", err=True
            )
    if measure == "auto" and importlib.util.find_spec("cv2") is None:
        measure = "none"
        typer.echo("OpenCV is not installed: nothing is measured (pip install 'rigsim[vision]')", err=True)

    plan = Plan(
        scene=scene,
        mount=mount,
        noises=registry.noises(noise_values),
        triangulators=methods,
        range_m=range_m,
        n_points=points,
        n_trials=trials,
        seed=seed,
        renderer=renderer,
        supersample=supersample,
        measure=measure,
        assumed=assumed,
        perturbation=perturbation,
        timeout_s=timeout_s,
        asked=asked(typed),
        sensors=dict(zip(sensor_labels(sensors, sensor), sensors, strict=True)),
        extra={"command": shlex.join(["rigsim", *sys.argv[1:]])},
    )
    with quiet(as_json), shown(len(grid), "rigs") as progress:
        result = run(grid, plan, jobs=jobs, progress=progress)
    _deliver(result, target, force, as_json)
    if not result.complete:
        raise typer.Exit(ends.INTERRUPTED)


def _assumed(assume: Path | None, rig: Path | None) -> tuple[StereoRig | None, Perturbation | None]:
    """The rig that triangulates, or how the built rig differs from --rig's; None where nothing says."""
    from rigsim.interop.formats.calibration import calibration_perturbation, read_calibration

    perturbation = None if rig is None else calibration_perturbation(rig)
    if assume is None:
        return None, perturbation
    if perturbation is not None:
        raise InvalidRange(
            f"--assume {assume}: {rig} has a [perturbation] already, which says the same thing; give one"
        )
    if calibration_perturbation(assume) is not None:
        raise InvalidRange(
            f"--assume {assume}: its [perturbation] says what the built rig is, and so does --rig; "
            f"take it out, or give this file by --rig alone"
        )
    return read_calibration(assume), None


def _deliver(result: SweepResult, target: Path | None, force: bool, as_json: bool) -> None:
    from rigsim import present
    from rigsim.interop.files import folder
    from rigsim.interop.files.tables import sweep_files
    from rigsim.present.sweep import words

    print_remarks(result.remarks)
    files: dict[str, bytes] = {}
    if target is not None:
        files = {**present.sweep_files(result), **sweep_files(result, words.spelled)}
        folder.write_folder(target, files, force)
    if not as_json:
        present.print_sweep(result, target)
        return
    from rigsim.interop.documents.base import Written
    from rigsim.interop.documents.sweep import sweep_document

    written = None if target is None else Written(folder=str(target), files=sorted(files))
    print_document(sweep_document(result, words, written))


def _methods(text: str) -> tuple[str, ...]:
    methods = tuple(part.strip() for part in text.split(","))
    if not all(methods):
        raise InvalidRange(f"triangulator {text!r}: empty; name one, or several with commas")
    return methods
