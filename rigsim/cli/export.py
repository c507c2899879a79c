"""`rigsim export`: rigs and data sets as other programs read them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rigsim.cli.options import single_rig, takes_rig
from rigsim.cli.rigs import RigOptions
from rigsim.errors import InvalidRange

app = typer.Typer(
    name="export",
    help="Write a rig, or a rendered data set, in other programs' formats.",
    no_args_is_help=True,
    rich_markup_mode=None,
)

_RIG_FORMATS = "opencv, ros, kalibr, middlebury, colmap, mjcf or nerfstudio."


@app.command()
@takes_rig
def rig(
    options: RigOptions,
    format: Annotated[str, typer.Option(metavar="FORMAT", help=_RIG_FORMATS)],
    out: Annotated[Path, typer.Option(help="Folder of the files.")],
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False,
) -> None:
    """Write a rig as calibration files: stereo.yml, left.yaml and right.yaml, camchain.yaml, and so on."""
    if options == RigOptions():
        raise InvalidRange("--rig is missing: give a file, or --preset, or --baseline and --focal")
    one = single_rig(options, None, size_for="an export")

    from rigsim.interop import folder
    from rigsim.interop.export import rig_files

    files = rig_files(one, format)
    folder.write_folder(out, files, force)
    typer.echo(f"{out}: {', '.join(files)}; read it back with --rig {out}")
