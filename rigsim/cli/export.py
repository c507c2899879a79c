"""`rigsim export`: rigs and data sets as other programs read them."""

from __future__ import annotations

import shlex
import sys
from fractions import Fraction
from pathlib import Path
from typing import Annotated

import typer

from rigsim.cli.kit import lists, quantity
from rigsim.cli.kit.answer import print_document, print_remarks, quiet
from rigsim.cli.kit.options import Json, single_rig, takes_rig
from rigsim.cli.kit.rigs import RigOptions
from rigsim.cli.kit.sensors import Blur, FullWell, ImageNoise, ReadNoise, SensorName, sensor_from
from rigsim.errors import InvalidRange

app = typer.Typer(
    name="export",
    help="Write a rig, or a rendered data set, in other programs' formats.",
    no_args_is_help=True,
    rich_markup_mode=None,
)

_MOVE = quantity.QuantityKind(
    "move", "mm", {"mm": Fraction(1), "cm": Fraction(10), "m": Fraction(1000)}, at_least=0
)


@app.command()
@takes_rig
def rig(
    options: RigOptions,
    format: Annotated[str, typer.Option(metavar="FORMAT", help=f"{lists.RIG_FORMATS}.")],
    out: Annotated[Path, typer.Option(help="Folder of the files.")],
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False,
    as_json: Json = False,
) -> None:
    """Write a rig as calibration files: stereo.yml, left.yaml and right.yaml, camchain.yaml, and so on."""
    if options == RigOptions():
        raise InvalidRange("--rig is missing: give a file, or --preset, or --baseline and --focal")
    one = single_rig(options, None, size_for="an export")

    from rigsim.interop.files import folder
    from rigsim.interop.formats.registry import rig_files

    files = rig_files(one, format)
    folder.write_folder(out, files, force)
    if not as_json:
        typer.echo(f"{out}: {', '.join(files)}; read it back with --rig {out}")
        return
    from rigsim.interop.documents.base import Written
    from rigsim.interop.documents.export import export_rig_document

    written = Written(folder=str(out), files=sorted(files))
    print_document(export_rig_document(_command(), format, one, written))


@app.command()
@takes_rig
def dataset(
    options: RigOptions,
    format: Annotated[str, typer.Option(metavar="FORMAT", help=f"{lists.DATASET_FORMATS}.")],
    frames: Annotated[int, typer.Option(metavar="N", help="How many stereo pairs.")],
    out: Annotated[Path, typer.Option(help="Folder of the data set.")],
    scene: Annotated[str, typer.Option(help="A bundled scene's name, or an MJCF file.")] = "boards",
    mount: Annotated[
        str | None, typer.Option(help="Where the rig sits: body:NAME, site:NAME or camera:NAME.")
    ] = None,
    move: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH",
            help="Farthest move off the mount, along each axis; by default 5 % of the depth there.",
        ),
    ] = None,
    turn: Annotated[
        float, typer.Option(metavar="DEG", help="Farthest turn off the mount, about each axis.")
    ] = 3.0,
    sensor: SensorName = None,
    blur: Blur = None,
    image_noise: ImageNoise = None,
    full_well: FullWell = None,
    read_noise: ReadNoise = None,
    seed: Annotated[int, typer.Option(min=0, help="Of the viewpoints and the noise.")] = 0,
    renderer: Annotated[str, typer.Option(help="auto, egl, osmesa or rays.")] = "auto",
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False,
    as_json: Json = False,
) -> None:
    """Render stereo pairs from varied viewpoints, with true depth or disparity, masks and calibration."""
    one = options.single(scene)
    camera = sensor_from(
        sensor, options.rig, blur=blur, image_noise=image_noise, full_well=full_well, read_noise=read_noise
    )
    move_m = None if move is None else quantity.value(move, _MOVE) / 1e3

    from rigsim.interop.files import folder
    from rigsim.interop.files.dataset import check_format, nearest_m, write_dataset

    check_format(format, one)
    folder.check_output(out, force)

    from dataclasses import asdict

    from rigsim.sim.simulator import Simulator
    from rigsim.study.scene.frames import Views, render_frames
    from rigsim.study.scene.provenance import simulator_provenance

    with quiet(as_json), Simulator(scene, mount, renderer) as simulator:
        simulator.place(one)
        views = Views(count=frames, seed=seed, move_m=move_m, turn_deg=turn, nearest_m=nearest_m(format, one))
        made = render_frames(simulator, one, views, camera)
        asked = {"seed": seed, "move_mm": None if move_m is None else move_m * 1e3, "turn_deg": turn}
        provenance = simulator_provenance(simulator)
        manifest = {**asked, "sensor": asdict(camera), **provenance, "command": _command()}
        names = write_dataset(out, format, one, made, count=frames, manifest=manifest, force=force)
    print_remarks(simulator.remarks)
    if as_json:
        from rigsim.interop.documents.base import Written
        from rigsim.interop.documents.export import export_dataset_document

        remarks = [asdict(remark) for remark in simulator.remarks]
        said = {"frames": frames, **asked, "remarks": remarks, "provenance": provenance}
        written = Written(folder=str(out), files=names)
        print_document(export_dataset_document(_command(), format, one, said, written))
        return
    pairs = "1 stereo pair" if frames == 1 else f"{frames} stereo pairs"
    typer.echo(f"{out}: {pairs} of {scene} for {format}; the rig: --rig {out}")


def _command() -> str:
    return shlex.join(["rigsim", *sys.argv[1:]])
