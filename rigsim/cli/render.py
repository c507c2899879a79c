"""`rigsim render`: what a rig sees, with its exact depth and disparity."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

from rigsim.cli.kit.answer import print_document, print_remarks, quiet
from rigsim.cli.kit.options import Json
from rigsim.cli.kit.rigs import RigOptions


def render(
    out: Annotated[Path, typer.Option(help="Folder of the pictures.")],
    scene: Annotated[str, typer.Option(help="A bundled scene's name, or an MJCF file.")] = "boards",
    mount: Annotated[
        str | None, typer.Option(help="Where the rig sits: body:NAME, site:NAME or camera:NAME.")
    ] = None,
    baseline: Annotated[str | None, typer.Option(help="Baseline, mm.")] = None,
    focal: Annotated[
        str | None, typer.Option(help="Focal length, px; or mm with --sensor-width or --pixel-pitch.")
    ] = None,
    hfov: Annotated[str | None, typer.Option(help="Horizontal field of view, deg.")] = None,
    resolution: Annotated[str | None, typer.Option(help="Image size: 1280x960.")] = None,
    vergence: Annotated[str | None, typer.Option(help="Toe-in angle, deg.")] = None,
    preset: Annotated[str | None, typer.Option(help="A rig to start from; see `rigsim presets`.")] = None,
    rig: Annotated[Path | None, typer.Option(help="Start from a rig.toml, or another calibration.")] = None,
    sensor_width: Annotated[str | None, typer.Option(help="Active sensor width, for a focal in mm.")] = None,
    pixel_pitch: Annotated[str | None, typer.Option(help="Pixel pitch, um, for a focal in mm.")] = None,
    renderer: Annotated[str, typer.Option(help="auto, egl, osmesa or rays.")] = "auto",
    force: Annotated[bool, typer.Option("--force", help="Replace pictures that are there.")] = False,
    as_json: Json = False,
) -> None:
    """Render a stereo pair with exact depth, disparity and segmentation."""
    options = RigOptions(rig, preset, baseline, focal, hfov, sensor_width, pixel_pitch, resolution, vergence)
    one = options.single(scene)

    from rigsim.interop.files import folder

    folder.check_output(out, force)

    from rigsim import present
    from rigsim.interop.files.tables import render_files
    from rigsim.study.scene.snapshot import take_snapshot

    with quiet(as_json):
        command = shlex.join(["rigsim", *sys.argv[1:]])
        snapshot = take_snapshot(one, scene, mount, renderer, {"command": command})
        files = {**present.render_files(snapshot), **render_files(snapshot)}
    folder.write_folder(out, files, force)
    print_remarks(snapshot.remarks)
    if as_json:
        from rigsim.interop.documents.base import Written
        from rigsim.interop.documents.render import render_document

        print_document(render_document(snapshot, Written(folder=str(out), files=sorted(files))))
        return
    typer.echo(f"{out}: stereo pair of {snapshot.scene}, {one.left.width}x{one.left.height} px")
