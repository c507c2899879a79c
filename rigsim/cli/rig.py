"""`rigsim rig`: what a calibration's rig is, and what is odd about it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rigsim.cli.kit.answer import claim, print_document
from rigsim.cli.kit.options import (
    Binning,
    Crop,
    Json,
    PresetName,
    Resize,
    RigCameras,
    RigMode,
    RigSize,
    RigSwap,
    RigUnit,
    takes,
)
from rigsim.errors import InvalidRange
from rigsim.typed.rigs import DEFAULT_PRESET, RigOptions

if TYPE_CHECKING:
    from rigsim.api.check_rig import CheckedRig


@dataclass(frozen=True, slots=True)
class RigWords:
    """The options of `rigsim rig`, as typed."""

    preset: PresetName = None
    rig_unit: RigUnit = None
    rig_size: RigSize = None
    rig_swap: RigSwap = False
    rig_cameras: RigCameras = None
    rig_mode: RigMode = None
    crop: Crop = None
    binning: Binning = None
    resize: Resize = None
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for rig.png, the rig from above and from its side, and rig.json."),
    ] = None
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False
    as_json: Json = False


@takes(RigWords)
def rig(
    words: RigWords,
    files: Annotated[
        list[Path] | None,
        typer.Argument(metavar="[FILE]...", help="A calibration: its file, its files, or their folder."),
    ] = None,
) -> None:
    """Say what a calibration's rig is, and what is odd about it: each remark with its reason and cure."""
    if not files and words.preset is None:
        raise InvalidRange("nothing to look at: name a calibration file, or a preset with --preset")
    if files and words.preset is not None:
        raise InvalidRange("a file and --preset both given: give one")
    claim(words.out, words.force)
    result = _checked(words, tuple(files or ()))
    written = None if words.out is None else result.write(words.out, words.force)
    if words.as_json:
        from rigsim.cli.kit.answer import print_remarks

        print_remarks(result.remarks)
        print_document(result.document(written))
    else:
        result.print(words.out)


def _checked(words: RigWords, files: tuple[Path, ...]) -> CheckedRig:
    from rigsim.api.check_rig import check_rig

    options = RigOptions(
        *(files or None, words.rig_unit, words.rig_size, words.rig_swap, words.rig_cameras, words.rig_mode),
        *(words.preset, words.crop, words.binning, words.resize),
    )
    named = options.files
    if named is not None:
        return check_rig(named)
    made = check_rig(options.base(DEFAULT_PRESET))
    return replace(made, format="preset", remarks=tuple(options.mode_remarks(made.rig)))
