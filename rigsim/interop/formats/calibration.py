"""Any calibration file, pair of them, or folder, as a rig: what `--rig` takes.

A format is known by what its files say, never by the ending of their names.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rigsim.errors import InvalidRig, OutputError, RigsimError
from rigsim.interop.formats import middlebury, registry, rig_toml
from rigsim.interop.formats.format import File
from rigsim.interop.formats.kit.files import file_of, neighbours, read_file, siblings
from rigsim.interop.formats.kit.reading import AS_IT_IS, Reading, RigFiles, RigReading, reading
from rigsim.interop.formats.kit.recognise import (
    FileSet,
    candidates,
    chosen,
    named,
    unfit,
    unknown,
    with_all,
)
from rigsim.rig import given
from rigsim.rig.perturbation import Perturbation
from rigsim.rig.stereo import PixelGrid, StereoRig

if TYPE_CHECKING:
    from rigsim.rig.sensor import Sensor

NOTHING_SAID = RigReading()


def read(paths: Sequence[str | Path], said: RigReading = NOTHING_SAID) -> Reading:
    """The rig in a calibration: a file, the files of one calibration, or a folder with them.

    A file is tried alone, then with its neighbours in the folder; a folder must hold one calibration, or
    several that say the same.

    Args:
        paths: one file or folder, or the files of one calibration.
        said: what a person says beside them.

    Raises:
        OutputError: a file cannot be read, or a folder holds no calibration or several.
        InvalidRig: the files hold no rig that can be; one line that names them.
        InvalidRange: what was said cannot be.
    """
    places = [given.path(path, "calibration file") for path in paths]
    if len(places) == 1 and os.path.isdir(places[0]):  # unlike Path's, it takes names of any length
        made, place = _in_folder(places[0]), str(places[0])
    else:
        files = [read_file(path) for path in dict.fromkeys(places)]
        made, place = _of_files(files), named(files)
    return _read(made, said, place)


def parse(content: str | bytes, said: RigReading = NOTHING_SAID, name: str = "rig") -> Reading:
    """The rig in the content of one calibration file; `name` is what messages call it.

    Raises:
        InvalidRig: it holds no rig that can be.
        InvalidRange: what was said cannot be.
    """
    file = file_of(Path(name), content.encode() if isinstance(content, str) else content)
    made = candidates([file])
    if not made:
        raise unknown(file)
    return _read(made, said, name)


def read_calibration(path: str | Path, said: RigReading = NOTHING_SAID) -> StereoRig:
    """The rig alone of what `read` reads.

    Raises:
        OutputError, InvalidRig, InvalidRange: as `read`.
    """
    return read([path], said).rig


def parse_calibration(text: str) -> StereoRig:
    """The rig alone of what `parse` reads.

    Raises:
        InvalidRig: as `parse`.
    """
    return parse(text).rig


def is_toml(text: str) -> bool:
    """Whether the text of a calibration file is a rig.toml's, which alone tells more than the rig."""
    return rig_toml.knows(text)


def holds_calibration(folder: Path) -> bool:
    """Whether a folder holds a calibration."""
    try:
        return bool(_in_folder(folder))
    except RigsimError:
        return False


def paths_of(rig: str | os.PathLike[str]) -> tuple[Path, ...]:
    """The paths of a calibration, as it is named.

    Raises:
        InvalidRange: it is no path.
    """
    return rig.paths if isinstance(rig, RigFiles) else (given.path(rig, "rig"),)


def calibration_sensor(paths: Sequence[Path]) -> Sensor | None:
    """The sensor in what `read` reads; only a rig.toml says something of one.

    Raises:
        OutputError, InvalidRig: as `rigsim.interop.formats.rig_toml.read_sensor`.
    """
    path = _of_format(paths, rig_toml.FORMAT.name)
    return None if path is None else rig_toml.read_sensor(path)


def calibration_perturbation(paths: Sequence[Path]) -> Perturbation | None:
    """How the built rig differs from what `read` reads; only a rig.toml says something of it.

    Raises:
        OutputError, InvalidRig: as `rigsim.interop.formats.rig_toml.read_perturbation`.
    """
    path = _of_format(paths, rig_toml.FORMAT.name)
    return None if path is None else rig_toml.read_perturbation(path)


def disparity_range(paths: Sequence[Path], grid: PixelGrid = AS_IT_IS) -> tuple[float, float] | None:
    """Least and largest disparity, px, in what `read` reads; only Middlebury's calib.txt has one.

    Args:
        paths: the calibration.
        grid: what is done to its pictures: disparities grow and shrink with their width.

    Raises:
        OutputError, InvalidRig: as `rigsim.interop.formats.middlebury.read_calib`.
    """
    path = _of_format(paths, middlebury.FORMAT.name)
    found = None if path is None else middlebury.read_calib(path)
    if found is None or found.disparity_range is None:
        return None
    scale = grid.apply(found.rig).left.fx / found.rig.left.fx
    low, high = found.disparity_range
    return low * scale, high * scale


def _read(made: list[FileSet], said: RigReading, place: str) -> Reading:
    return _read_once(tuple(made), said, place)


@functools.lru_cache(maxsize=8)
def _read_once(made: tuple[FileSet, ...], said: RigReading, place: str) -> Reading:
    """One command reads a file several times, and what is odd about its lenses takes a while to find."""
    one, found = chosen(made, said.asked, place)
    if said.mode is not None and not one.format.has_modes:
        mode = f"mode {said.mode[:30]!r}"
        raise InvalidRig(f"{named(one.files)}: {mode}: {one.format.name} has no modes; leave --rig-mode out")
    if said.unit is not None and one.format.fixes_unit:
        raise InvalidRig(
            f"{named(one.files)}: rig unit {said.unit[:30]!r}: {one.format.name} is in "
            f"{one.format.fixes_unit} always; leave --rig-unit out"
        )
    try:
        return reading(found, one.format.name, said, one.files)
    except RigsimError as error:
        raise type(error)(f"{named(one.files)}: {error}") from None


def _of_files(files: list[File]) -> list[FileSet]:
    """The candidates that take all these files: they alone, or else they and their neighbours.

    Raises:
        InvalidRig: there are none.
    """
    made = with_all(candidates(files), files)
    if made:
        return made
    paths = {file.path for file in files}
    others = [file for file in neighbours(files[0].path) if file.path not in paths]
    made = with_all(candidates([*files, *others]), files)
    if not made:
        raise unknown(files[0]) if len(files) == 1 else unfit(files)
    return made


def _in_folder(folder: Path) -> list[FileSet]:
    """The candidates in a folder, or in the data set whose folder it is.

    Raises:
        OutputError: there are none.
    """
    files = siblings(folder)
    made = candidates(files)
    for format in registry.ALL:
        first = folder / format.in_dataset
        if not made and format.in_dataset and first.is_file():
            made = _of_files([read_file(first)])
    if not made:
        hints = (str(unknown(file)) for file in files if _is_part(file))
        hint = next(hints, None)
        if hint is not None:
            raise OutputError(f"{folder}: holds no whole calibration: {hint}")
        called = next((file for file in files if file.name in {one.in_folder for one in registry.ALL}), None)
        if called is not None:
            raise OutputError(f"{folder}: holds no calibration: {unknown(called)}")
        *others, last = (format.in_folder for format in registry.ALL)
        raise OutputError(
            f"{folder}: holds no calibration; name a folder with {', '.join(others)} or {last}, for example"
        )
    return made


def _is_part(file: File) -> bool:
    return any(format.lacks is not None and format.lacks(file) for format in registry.ALL)


def _of_format(paths: Sequence[Path], format: str) -> Path | None:
    """The file that makes a rig of `format`, where `paths` are of that format."""
    if len(paths) != 1:
        return None
    (path,) = paths
    made = _in_folder(path) if os.path.isdir(path) else candidates([read_file(path)])
    return next((one.files[0].path for one in made if one.format.name == format), None)
