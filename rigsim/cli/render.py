"""`rigsim render`: what a rig sees, with its exact depth and disparity."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import typer

from rigsim.cli.kit.answer import claim, command, deliver, quiet
from rigsim.cli.kit.options import Json, takes, takes_rig
from rigsim.typed.mounted import mounted
from rigsim.typed.rigs import RigOptions


@dataclass(frozen=True, slots=True)
class RenderWords:
    """The options of `rigsim render`, as typed."""

    out: Annotated[Path, typer.Option(help="Folder of the pictures.")]
    scene: Annotated[str, typer.Option(help="A bundled scene's name, or an MJCF file.")] = "boards"
    mount: Annotated[
        str | None, typer.Option(help="Where the rig sits: body:NAME, site:NAME or camera:NAME.")
    ] = None
    renderer: Annotated[str, typer.Option(help="auto, egl, osmesa or rays.")] = "auto"
    force: Annotated[bool, typer.Option("--force", help="Replace pictures that are there.")] = False
    as_json: Json = False


@takes_rig
@takes(RenderWords)
def render(options: RigOptions, words: RenderWords) -> None:
    """Render a stereo pair with exact depth, disparity and segmentation."""
    options, remarks = mounted(options, words.scene, words.mount)
    rig = options.single(words.scene)
    claim(words.out, words.force)

    from rigsim.api.render import render as run

    with quiet(words.as_json):
        result = run(rig, scene=words.scene, mount=words.mount, renderer=words.renderer, command=command())
    snapshot = replace(result.snapshot, remarks=(*remarks, *result.snapshot.remarks))
    result = replace(result, snapshot=snapshot)
    deliver(result, words.out, words.force, words.as_json)
