"""What a calibration format is: one file of this room, and a line of the registry."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rigsim.errors import InvalidRig
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig


@dataclass(frozen=True, slots=True)
class File:
    """A file of a calibration, as it was read."""

    path: Path
    """Where it is."""
    text: str
    """What it says; empty where it is binary."""
    content: bytes = b""
    """Its bytes, for what is no text."""

    @property
    def name(self) -> str:
        """Its name without its folder."""
        return self.path.name


@dataclass(frozen=True, slots=True)
class Asked:
    """What a person says beside the files."""

    size_px: tuple[int, int] | None = None
    """Image size, width and height, px, for files that have none (``--rig-size``)."""
    cameras: tuple[str, str] | None = None
    """Which two of a file's cameras are left and right (``--rig-cameras``)."""
    mode: str | None = None
    """Which of a file's modes (``--rig-mode``)."""


@dataclass(frozen=True, slots=True)
class Found:
    """A rig as its files describe it."""

    rig: StereoRig
    """The rig; its lengths are in `unit`, which the core turns into metres."""
    unit: str | None = "m"
    """The unit that the format, or the file, fixes; None where it says none (a board's squares)."""
    remarks: tuple[Remark, ...] = ()
    """What only the format can know to be odd: a size that was taken for granted, a camera left out."""


def alone(knows: Callable[[str], bool]) -> Callable[[Sequence[File]], list[tuple[File, ...]]]:
    """`Format.groups` of a format whose rigs are single files, known by their text."""
    return lambda files: [(file,) for file in files if knows(file.text)]


_PAIRS = (("left", "right"), ("0", "1"), ("1", "2"), ("cam0", "cam1"), ("l", "r"))


def names_sides(asked: Asked) -> bool:
    """Whether ``--rig-cameras`` asks a file that has a left and a right camera for the right one first.

    Raises:
        InvalidRig: it asks for cameras that such a file does not have.
    """
    if asked.cameras is None:
        return False
    first, second = (word.lower() for word in asked.cameras)
    if (first, second) in _PAIRS:
        return False
    if (second, first) in _PAIRS:
        return True
    raise InvalidRig(
        f"cameras {','.join(asked.cameras)}: the file has left and right; leave --rig-cameras out"
    )


def swapped(rig: StereoRig) -> StereoRig:
    """The rig with its right camera for the left one."""
    return StereoRig(rig.right, rig.left, rig.right_from_left.inverse)


@dataclass(frozen=True, slots=True, eq=False)
class Format:
    """A calibration format."""

    name: str
    """As ``rigsim export rig --format`` takes it."""
    says: str
    """What it is, a phrase for lists."""
    suffixes: tuple[str, ...]
    """Endings that its files mostly have, small: for people, nothing is known by them."""
    in_folder: str
    """The name that a folder with it is known by."""
    in_dataset: str = ""
    """The same of a data set of `rigsim.interop.files.dataset`: of its first frame, as all have the same."""
    groups: Callable[[Sequence[File]], list[tuple[File, ...]]] = field(kw_only=True)
    """The sets of these files that each make one rig of this format, known by content, in the order in which
    `open` takes them."""
    open: Callable[[tuple[File, ...], Asked], Found] = field(kw_only=True)
    """The rig in one of `groups`' sets, or `InvalidRig` with one line that does not name the file."""
    lacks: Callable[[File], str | None] | None = None
    """What a file of this format lacks to make a rig, one line that does not name it; None where it is of
    another format, or lacks nothing."""
    write: Callable[[StereoRig], Mapping[str, str]] | None = None
    """Its files' texts, by name, or `InvalidRig` where it cannot hold the rig; None where none is written."""
    has_modes: bool = False
    """Whether its files may hold several modes, of which ``--rig-mode`` chooses one."""
    fixes_unit: str = ""
    """The unit that all its files have by their keys or their maker; empty where one may be said beside."""
    late: bool = False
    """Whether it would take others' files, which use the same names: it gets those that are left."""
