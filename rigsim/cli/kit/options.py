"""Options that commands on a single rig share, and the rig they describe."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from dataclasses import MISSING, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Concatenate, ParamSpec, TypeVar, cast, get_type_hints

import typer

from rigsim.cli.kit.answer import tell
from rigsim.cli.kit.axes import CONTEXT, meant
from rigsim.study.scene.axes import registry
from rigsim.typed import quantity
from rigsim.typed.rigs import RigOptions

if TYPE_CHECKING:
    from rigsim.rig.remark import Remark

_P = ParamSpec("_P")
_R = TypeVar("_R")

SensorWidth = Annotated[
    str | None, typer.Option(metavar="LENGTH", help="Active sensor width: 6.4mm. Needs --resolution.")
]
PixelPitch = Annotated[str | None, typer.Option(metavar="LENGTH", help="Pixel pitch: 3.45um.")]
RigFile = Annotated[
    list[Path] | None,
    typer.Option(
        metavar="FILE",
        help="Start from a rig.toml or another calibration, a file or a folder; twice for two files of one;"
        " see docs/reference/export.md.",
    ),
]
RigUnit = Annotated[
    str | None,
    typer.Option(
        metavar="UNIT",
        help="Unit of the --rig file's lengths, where it says none: mm, cm, m, in, or 25mm (squares).",
    ),
]
RigSize = Annotated[
    str | None, typer.Option(metavar="WxH", help="Image size of a --rig file that has none: 1280x720.")
]
RigSwap = Annotated[bool, typer.Option("--rig-swap", help="The --rig file's left camera is the right one.")]
RigCameras = Annotated[
    str | None, typer.Option(metavar="A,B", help="Left and right camera of a --rig file with more: 0,1.")
]
RigMode = Annotated[
    str | None, typer.Option(metavar="MODE", help="Which mode of a --rig file that has several: HD.")
]
Crop = Annotated[
    str | None,
    typer.Option(
        metavar="X,Y,W,H", help="Cut W x H px out of both pictures of --rig or --preset, from pixel X,Y on."
    ),
]
Binning = Annotated[
    str | None, typer.Option(metavar="N", help="Average N x N px of --rig's or --preset's pictures: 2.")
]
Resize = Annotated[
    str | None,
    typer.Option(metavar="WxH", help="Scale --rig's or --preset's pictures, edge to edge: 640x480."),
]
READING = ("rig_unit", "rig_size", "rig_swap", "rig_cameras", "rig_mode")
"""The options that say something of the file that --rig names."""
PICTURES = ("crop", "binning", "resize")
"""The options that change the pictures of --rig or --preset, in the order in which they do."""
PresetName = Annotated[
    str | None, typer.Option(metavar="NAME", help="Start from a rig by name; see rigsim presets.")
]

_RIG_OPTIONS: dict[str, Any] = {
    **{
        axis.name: Annotated[
            str | None, typer.Option(metavar=axis.metavar or None, help=axis.help_one or axis.help)
        ]
        for axis in registry.ALL
        if axis.of_rig is not None
    },
    "sensor_width": SensorWidth,
    "pixel_pitch": PixelPitch,
    "rig": RigFile,
    **dict(zip(READING, (RigUnit, RigSize, RigSwap, RigCameras, RigMode), strict=True)),
    "preset": PresetName,
    **dict(zip(PICTURES, (Crop, Binning, Resize), strict=True)),
}

Principal = Annotated[
    str | None,
    typer.Option(
        metavar="U,V",
        help="Principal point of both cameras, px: by default the image's middle, or 0,0 (pixels counted from"
        " the optical axis) when no image size is known.",
    ),
]
Noise = Annotated[
    str | None,
    typer.Option(
        metavar="PX",
        help=f"Standard deviation of every pixel coordinate in both images.  [default: {quantity.NOISE_PX}]",
    ),
]
DisparityNoise = Annotated[
    str | None,
    typer.Option(
        metavar="PX", help="Standard deviation of a disparity, instead of --noise: sqrt(2) times as much."
    ),
]
Rectify = Annotated[
    str | None,
    typer.Option(
        metavar="VIEW",
        help="What a pair that is not rectified is turned into before it is matched: perspective, "
        "cylinder or latlong, the last two about the baseline.  [default: by what the lenses see]",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document, at full precision.")]
Csv = Annotated[bool, typer.Option("--csv", help="Print CSV, at full precision.")]
Markdown = Annotated[bool, typer.Option("--markdown", help="Print a Markdown table.")]


def takes(words: type[Any]) -> Callable[[Callable[..., _R]], Callable[..., _R]]:
    """Give a command the fields of `words`, a dataclass, as its options, in place of the parameter of that
    class: the command gets one."""
    names = [field.name for field in fields(words)]

    def decorate(command: Callable[..., _R]) -> Callable[..., _R]:
        own = list(inspect.signature(command, eval_str=True).parameters.values())
        (place,) = (item for item in own if item.annotation is words)

        @functools.wraps(command)
        def run(*first: Any, **given: Any) -> _R:
            given[place.name] = words(**{name: given.pop(name) for name in names})
            return command(*first, **given)

        hints = get_type_hints(words, include_extras=True)
        options = [
            inspect.Parameter(
                field.name,
                inspect.Parameter.KEYWORD_ONLY,
                default=inspect.Parameter.empty if field.default is MISSING else field.default,
                annotation=hints[field.name],
            )
            for field in fields(words)
        ]
        at = own.index(place)
        rest = (item.replace(kind=inspect.Parameter.KEYWORD_ONLY) for item in own[at + 1 :])
        parameters = [*own[:at], *options, *rest]
        run.__annotations__ = {item.name: item.annotation for item in parameters}
        vars(run)["__signature__"] = inspect.Signature(parameters)
        return run

    return decorate


def takes_rig(command: Callable[Concatenate[RigOptions, _P], _R]) -> Callable[..., _R]:
    """Give `command` the rig options as its own, and hand them to it as its first argument."""

    @functools.wraps(command)
    def run(context: typer.Context, **words: Any) -> _R:
        typed = meant(registry.OF_RIG, words, context)
        options = RigOptions.of(typed, **{name: words.pop(name) for name in _RIG_OPTIONS if name in words})
        options = tell_of_rig(options)
        return cast(Callable[..., _R], command)(options, **words)

    own = list(inspect.signature(command, eval_str=True).parameters.values())[1:]
    rig = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=_default(name), annotation=annotation)
        for name, annotation in _RIG_OPTIONS.items()
    ]
    parameters = [CONTEXT, *(item.replace(kind=inspect.Parameter.KEYWORD_ONLY) for item in own), *rig]
    # where typer looks for a function's parameters
    run.__annotations__ = {item.name: item.annotation for item in parameters}
    vars(run)["__signature__"] = inspect.Signature(parameters)
    return run


def tell_of_rig(options: RigOptions) -> RigOptions:
    """Say what is odd about the calibration that --rig names, and what becomes of pictures of another shape,
    before anything is made of it; the same options, with what was read."""
    remarks: list[Remark] = []
    each = options.each()
    for place, (name, one) in enumerate(each):
        found = one.reading() if one.preset is None else None
        each[place] = name, replace(one, found=found)
        odd = (*(() if found is None else found.remarks), *one.shape_remarks())
        remarks += odd if len(each) == 1 else (replace(item, text=f"{name}: {item.text}") for item in odd)
    tell(remarks)
    return options if len(each) > 1 else each[0][1]


def _default(name: str) -> str | bool | None:
    if name == "rig_swap":
        return False
    axis = registry.BY_NAME.get(name)
    return None if axis is None else axis.default
