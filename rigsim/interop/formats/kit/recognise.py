"""Which format files are of, by what they say."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rigsim.errors import InvalidRig, OutputError, RigsimError
from rigsim.interop.formats import registry
from rigsim.interop.formats.format import Asked, File, Format, Found
from rigsim.interop.formats.kit.files import looks_like
from rigsim.interop.formats.kit.reading import metres
from rigsim.interop.formats.values import printable
from rigsim.rig.stereo import StereoRig

_SAME_FOCAL, _SAME_BASELINE, _SAME_TURN = 2e-3, 2e-3, 2e-3
"""Shares, and rad, by which two files of one calibration may differ: programs round what they write."""


@dataclass(frozen=True, slots=True)
class FileSet:
    """Files that make a rig of a format."""

    format: Format
    """The format."""
    files: tuple[File, ...]
    """Its files, as the format takes them."""

    @property
    def paths(self) -> frozenset[Path]:
        """Where the files are."""
        return frozenset(file.path for file in self.files)

    @property
    def name(self) -> str:
        """What messages call the files, without their folder."""
        return " + ".join(file.name for file in self.files)

    def found(self, asked: Asked) -> Found:
        """The rig.

        Raises:
            InvalidRig: it holds no rig that can be; the message does not name the files.
        """
        return self.format.open(self.files, asked)


def candidates(files: Sequence[File]) -> list[FileSet]:
    """Every set of these files that makes a rig of a format."""
    made = []
    for format in registry.ALL:
        try:
            made += [FileSet(format, tuple(group)) for group in format.groups(files)]
        except InvalidRig:  # a neighbour that cannot be read is nobody's
            continue
    taken = {path for one in made if not one.format.late for path in one.paths}
    return [one for one in made if not (one.format.late and one.paths & taken)]


def with_all(made: Iterable[FileSet], files: Sequence[File]) -> list[FileSet]:
    """Those that take all of `files`."""
    paths = {file.path for file in files}
    return [one for one in made if paths <= one.paths]


def chosen(made: Sequence[FileSet], asked: Asked, place: str) -> tuple[FileSet, Found]:
    """The one candidate there is, or the best of several that say the same.

    Args:
        made: candidates, at least one.
        asked: what a person said.
        place: where the files are, for messages.

    Raises:
        InvalidRig: none holds a rig that can be.
        OutputError: they are several rigs.
    """
    opened: list[tuple[FileSet, Found]] = []
    failed: list[tuple[FileSet, RigsimError]] = []
    for one in made:
        try:
            opened.append((one, one.found(asked)))
        except RigsimError as error:
            failed.append((one, error))
    if not opened:
        first, why = failed[0]
        raise InvalidRig(f"{named(first.files)}: {printable(str(why))}")
    opened.sort(key=lambda item: (item[1].unit is None, _without_size(item[1]), -len(item[0].files)))
    best, found = opened[0]
    taken = [item[0].paths for item in opened]
    others = [item[0] for item in opened[1:] if not (item[0].paths & best.paths or _same(item[1], found))]
    others += [one for one, _ in failed if not any(one.paths & paths for paths in taken)]
    if others:
        shown = [one for one in made if one in (best, *others)]
        raise OutputError(f"{place}: holds {', '.join(one.name for one in shown)}; name one of them")
    return best, found


def unknown(file: File) -> InvalidRig:
    """What is to be said of a file that is of no format."""
    hint = next((hint for _, lacks in _partly() if (hint := lacks(file))), None)
    if hint is not None:
        return InvalidRig(f"{file.path}: {printable(hint)}")
    known = ", ".join(format.name for format in registry.ALL)
    return InvalidRig(f"{file.path}: {printable(looks_like(file))}; calibrations that are read: {known}")


def unfit(files: Sequence[File]) -> InvalidRig:
    """What is to be said of several files that are not of one calibration."""
    names = []
    for file in files:
        own = candidates([file])
        names.append(f"{file.name} is {own[0].format.name}" if own else str(_part(file)))
    text = "; ".join(names)
    return InvalidRig(f"{named(files)}: are not the files of one calibration: {text}")


def named(files: Sequence[File]) -> str:
    """Files as messages call them."""
    first, *others = files
    return " + ".join([str(first.path), *(file.name for file in others)])


def _part(file: File) -> str:
    owner = next((format.name for format, lacks in _partly() if lacks(file)), None)
    return f"{file.name} {looks_like(file)}" if owner is None else f"{file.name} is a part of {owner}"


def _partly() -> list[tuple[Format, Callable[[File], str | None]]]:
    """The formats that know a part of theirs, those that take what is left last."""
    in_turn = sorted(registry.ALL, key=lambda format: format.late)
    return [(format, format.lacks) for format in in_turn if format.lacks is not None]


def _without_size(found: Found) -> bool:
    return any(remark.code == "no_size" for remark in found.remarks)


def _same(one: Found, other: Found) -> bool:
    a, b = one.rig, other.rig
    turn = np.abs(a.right_from_left.R - b.right_from_left.R).max()
    lengths = (one.unit is None) != (other.unit is None) or _near(
        a.baseline_m * metres(one.unit or "m"), b.baseline_m * metres(other.unit or "m"), _SAME_BASELINE
    )
    return bool(lengths and turn <= _SAME_TURN and _focals_near(a, b))


def _focals_near(a: StereoRig, b: StereoRig) -> bool:
    pairs = ((a.left, b.left), (a.right, b.right))
    return all(
        _near(one.fx, other.fx, _SAME_FOCAL) and _near(one.fy, other.fy, _SAME_FOCAL) for one, other in pairs
    )


def _near(a: float, b: float, share: float) -> bool:
    return abs(a - b) <= share * abs(b)
