"""Rigs as people name them: a preset, a calibration file, its text, or a rig; and grids of them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias, overload

from rigsim.errors import InvalidRange, InvalidRig, InvalidScene
from rigsim.rig import given
from rigsim.rig.stereo import PixelGrid, StereoRig

if TYPE_CHECKING:
    from rigsim.interop.formats.kit.reading import Reading, RigReading
    from rigsim.rig.perturbation import Perturbation
    from rigsim.rig.sensor import Sensor

RigLike: TypeAlias = StereoRig | str | os.PathLike[str]
"""A rig, a preset's name, the path of a calibration, or a calibration file's text."""

Several: TypeAlias = float | Iterable[float]
"""One number or several."""

Sizes: TypeAlias = tuple[int, int] | Iterable[tuple[int, int]]
"""One (width, height), px, or several."""

DEFAULT_PRESET = "boards"


def read_rig(
    rig: RigLike,
    *more: str | os.PathLike[str],
    unit: str | None = None,
    size_px: tuple[int, int] | None = None,
    swap: bool = False,
    cameras: tuple[str, str] | None = None,
    mode: str | None = None,
) -> StereoRig:
    """The rig that a name, a path or a text says.

    A calibration of any format is read, known by what it says; ``rigsim.read_rig("intrinsics.yml")`` finds
    the extrinsics.yml beside it. What is odd about it is printed by `rigsim rig`.

    Args:
        rig: A preset's name, as ``oak-d``; the path of a file or folder, which comes first where both exist;
            the text of a file, which has more than one line; or a rig, which comes back as it is.
        more: The other files of the same calibration.
        unit: Unit of the file's lengths, where it does not say it: ``mm``, ``cm``, ``m``, ``in``, or ``25mm``
            for a board's squares of 25 mm.
        size_px: Image size, width and height, of a file that has none.
        swap: Whether the file's left camera is the right one.
        cameras: Names of the left and the right camera, of a file with more than two.
        mode: Which of a file's modes, as ``HD``.

    Raises:
        OutputError: a file cannot be read, or a folder holds no calibration or several.
        InvalidRig: it holds no rig that can be, or does not say something that decides.
        InvalidRange: it is none of these, or a word about it cannot be.

    Example:
        >>> import rigsim
        >>> rig = rigsim.read_rig("oak-d")
        >>> print(f"{rig.baseline_m * 1e3:.0f} mm, {rig.left.width}x{rig.left.height} px")
        75 mm, 1280x800 px
        >>> rigsim.read_rig(rigsim.write_rig(rig)) == rig
        True
    """
    from rigsim.interop.formats.kit.reading import RigReading

    return rig_reading(rig, more, RigReading(unit, size_px, swap, cameras, mode)).rig


def rig_reading(rig: RigLike, more: Sequence[str | os.PathLike[str]], said: RigReading) -> Reading:
    """What `read_rig` reads, with whose format it is and what is odd about it: ``preset`` of a name, ``rig``
    of a rig.

    Raises:
        OutputError, InvalidRig, InvalidRange: as `read_rig`.
    """
    from rigsim.interop.formats.kit.reading import Reading, RigFiles, RigReading
    from rigsim.study.rig.remarks import remarks_of_rig

    if isinstance(rig, RigFiles):
        said, more = rig.said, (*rig.paths[1:], *more)
    of_file = replace(said, grid=RigReading().grid) != RigReading() or len(more) > 0
    if isinstance(rig, StereoRig):
        if of_file:
            raise InvalidRange("a rig and words about a file: name the file, or give the rig alone")
        return Reading(rig, "rig", remarks_of_rig(rig))
    name = None if of_file else preset_name(rig)
    if name is not None:
        from rigsim.rig.presets import preset

        return Reading(said.grid.apply(preset(name).rig), "preset")
    from rigsim.interop.formats import calibration

    if isinstance(rig, str) and "\n" in rig:
        return calibration.parse(rig, said)
    path = given.path(rig, "rig")
    if isinstance(rig, str) and not path.suffix and path.name == rig and not os.path.lexists(path):
        from rigsim.rig.presets import PRESETS

        raise InvalidRange(
            f"rig {given.shown(rig)}: no file here and no preset has that name; name a file, or one of "
            f"{', '.join(PRESETS)}"
        )
    return calibration.read([path, *(given.path(other, "rig") for other in more)], said)


@overload
def write_rig(
    path: str | os.PathLike[str], rig: StereoRig, comment: str = "", sensor: Sensor | None = None
) -> Path: ...


@overload
def write_rig(path: StereoRig, rig: str = "", comment: Sensor | None = None) -> str: ...


@overload
def write_rig(path: StereoRig, *, comment: str = "", sensor: Sensor | None = None) -> str: ...


@overload
def write_rig(*, rig: StereoRig, comment: str = "", sensor: Sensor | None = None) -> str: ...


def write_rig(
    path: object = None, rig: object = None, comment: object = "", sensor: object = None
) -> Path | str:
    """Write a rig as a rig.toml, which `read_rig` and ``--rig`` read back bit for bit.

    ``write_rig(path, rig)`` writes the file and gives its path back; one that is there is replaced.
    ``write_rig(rig)`` gives the text alone, as does ``write_rig(rig, comment, sensor)``. `export_rig` writes
    the formats of other programs.

    Args:
        path: The file; its name ends in .toml.
        rig: The rig.
        comment: Put on top, as many lines as it has.
        sensor: Written number by number, without the name it may have had, so that it stays what it was.

    Raises:
        InvalidRange: the path is none, or has another ending.
        InvalidRig: there is no rig.
        OutputError: the file cannot be written.

    Example:
        >>> import rigsim
        >>> print(rigsim.write_rig(rigsim.preset("bin").rig, comment="over the bin").splitlines()[0])
        # over the bin
    """
    if isinstance(path, StereoRig):
        if rig is not None:  # (rig, comment, sensor)
            comment, sensor = rig, sensor if comment == "" else comment
        return _rig_text(path, comment, sensor)
    if path is None:
        return _rig_text(rig, comment, sensor)
    file = given.path(path, "rig file")
    text = _rig_text(rig, comment, sensor)
    if file.suffix.lower() != ".toml":
        raise InvalidRange(f"rig file {file}: must end in .toml; rigsim.export_rig writes other formats")
    from rigsim.interop.files.folder import write_file

    write_file(file, text.encode())
    return file


def _rig_text(rig: object, comment: object, sensor: object) -> str:
    from rigsim.interop.formats import rig_toml
    from rigsim.rig.sensor import Sensor

    one = given.a(StereoRig, rig, "a StereoRig: the rig to write", InvalidRig)
    words = given.a(str, comment, "text: the comment of a rig file", InvalidRig)
    if sensor is None:
        return rig_toml.write_rig(one, words)
    return rig_toml.write_rig(one, words, given.a(Sensor, sensor, "a Sensor: of a rig file", InvalidRig))


@dataclass(frozen=True, slots=True)
class Told:
    """All that a file says besides its rig; nothing where no file was named."""

    sensor: Sensor | None = None
    """Its sensor."""
    perturbation: Perturbation | None = None
    """How the built rig differs from it."""
    disparities_px: tuple[float, float] | None = None
    """Disparities to search, px."""


def told_of(rig: RigLike | None) -> Told:
    """What the file or text behind `rig` says besides the rig.

    Raises:
        OutputError, InvalidRig: as `read_rig`.
    """
    if rig is None or isinstance(rig, StereoRig) or preset_name(rig) is not None:
        return Told()
    from rigsim.interop.formats import calibration, rig_toml
    from rigsim.interop.formats.kit.reading import RigFiles

    if isinstance(rig, str) and "\n" in rig:
        if not calibration.is_toml(rig):
            return Told()
        return Told(rig_toml.parse_sensor(rig), rig_toml.parse_perturbation(rig))
    paths = calibration.paths_of(rig)
    grid = rig.said.grid if isinstance(rig, RigFiles) else PixelGrid()
    return Told(
        calibration.calibration_sensor(paths),
        calibration.calibration_perturbation(paths),
        calibration.disparity_range(paths, grid),
    )


def rig_for(rig: RigLike | None, scene: str = "") -> StereoRig:
    """The rig that is named, or the one that is made for a scene."""
    from rigsim.rig.presets import PRESETS, preset

    if rig is not None:
        return read_rig(rig)
    return preset(scene if scene in PRESETS else DEFAULT_PRESET).rig


def rig_file(rig: RigLike | None) -> str:
    """How messages call the file of `rig`."""
    return "rig" if rig is None or isinstance(rig, StereoRig) or "\n" in str(rig) else str(rig)


def preset_name(rig: RigLike) -> str | None:
    """The preset that a word names where no file and no folder with a calibration has that name."""
    if not isinstance(rig, str) or "\n" in rig:
        return None
    from rigsim.rig.presets import preset

    try:
        name = preset(rig).name
    except InvalidScene:
        return None
    if os.path.isfile(rig):
        return None
    if os.path.isdir(rig):
        from rigsim.interop.formats.calibration import holds_calibration

        return None if holds_calibration(Path(rig)) else name
    return name
