"""`rigsim export`: rigs and data sets as other programs read them."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Annotated

import typer

from rigsim.cli.kit import lists
from rigsim.cli.kit.answer import command, deliver, quiet
from rigsim.cli.kit.options import Json, takes, takes_rig
from rigsim.cli.kit.sensors import Blur, FullWell, ImageNoise, ReadNoise, SensorName, sensor_words
from rigsim.errors import InvalidRange
from rigsim.typed import quantity
from rigsim.typed.rigs import RigOptions, single_rig

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
    approximate: Annotated[
        bool,
        typer.Option(
            "--approximate",
            help="Fit the nearest lens that the format has, where it lacks the rig's; tells the px.",
        ),
    ] = False,
    as_json: Json = False,
) -> None:
    """Write a rig as calibration files: stereo.yml, left.yaml and right.yaml, camchain.yaml, and so on."""
    if options == RigOptions():
        raise InvalidRange("--rig is missing: give a file, or --preset, or --baseline and --focal")
    one = single_rig(options, None, size_for="an export")

    from rigsim.api.export import export_rig

    deliver(export_rig(one, format, approximate=approximate, command=command()), out, force, as_json)


@dataclass(frozen=True, slots=True)
class DatasetWords:
    """The options of `rigsim export dataset`, as typed."""

    format: Annotated[str, typer.Option(metavar="FORMAT", help=f"{lists.DATASET_FORMATS}.")]
    frames: Annotated[int, typer.Option(metavar="N", help="How many stereo pairs.")]
    out: Annotated[Path, typer.Option(help="Folder of the data set.")]
    scene: Annotated[str, typer.Option(help="A bundled scene's name, or an MJCF file.")] = "boards"
    mount: Annotated[
        str | None, typer.Option(help="Where the rig sits: body:NAME, site:NAME or camera:NAME.")
    ] = None
    move: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH",
            help="Farthest move off the mount, along each axis; by default 5 % of the depth there.",
        ),
    ] = None
    turn: Annotated[
        float, typer.Option(metavar="DEG", help="Farthest turn off the mount, about each axis.")
    ] = 3.0
    sensor: SensorName = None
    blur: Blur = None
    image_noise: ImageNoise = None
    full_well: FullWell = None
    read_noise: ReadNoise = None
    seed: Annotated[int, typer.Option(min=0, help="Seed of the viewpoints and the noise.")] = 0
    renderer: Annotated[str, typer.Option(help="auto, egl, osmesa or rays.")] = "auto"
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False
    as_json: Json = False


@app.command()
@takes_rig
@takes(DatasetWords)
def dataset(options: RigOptions, words: DatasetWords) -> None:
    """Render stereo pairs from varied viewpoints, with true depth or disparity, masks and calibration."""
    one = options.single(words.scene)
    sensor = sensor_words(
        words.sensor,
        options.files,
        blur=words.blur,
        image_noise=words.image_noise,
        full_well=words.full_well,
        read_noise=words.read_noise,
    )
    move_mm = None if words.move is None else quantity.value(words.move, _MOVE)

    from rigsim.api.export import export_dataset

    with quiet(words.as_json):
        result = export_dataset(
            one,
            words.format,
            words.frames,
            words.out,
            force=words.force,
            scene=words.scene,
            mount=words.mount,
            move_mm=move_mm,
            turn_deg=words.turn,
            seed=words.seed,
            renderer=words.renderer,
            command=command(),
            **sensor,
        )
    deliver(result, None, words.force, words.as_json)
