"""What a calibration format is: one file of this room, and a line of the registry."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from rigsim.errors import InvalidRig
from rigsim.interop.formats.values import read_text
from rigsim.rig.stereo import StereoRig


def _never(_: str) -> bool:
    """Of a format of several files, none of which says enough."""
    return False


@dataclass(frozen=True, slots=True, eq=False)
class Format:
    """A calibration format."""

    name: str
    """As ``rigsim export rig --format`` takes it."""
    says: str
    """What it is, a phrase for lists."""
    suffixes: tuple[str, ...]
    """Endings of its files, small."""
    in_folder: str
    """The name that a folder with it is known by."""
    in_dataset: str = ""
    """The same of a data set of `rigsim.interop.files.dataset`: of its first frame, as all have the same."""
    knows: Callable[[str], bool] = _never
    """Whether a file's text is of this format."""
    parse: Callable[[str], StereoRig] | None = None
    """The rig in the text of its one file; None where it needs several."""
    read: Callable[[Path], StereoRig] | None = None
    """The rig in a file, where that is more than to parse it."""
    names: tuple[str, ...] = ()
    """Names that its files have whatever they say."""
    write: Callable[[StereoRig], Mapping[str, str]] | None = None
    """Its files' texts, by name, or `InvalidRig` where it cannot hold the rig; None where none is written."""
    drawn_up: bool = False
    """Whether a rig is taken as somebody drew it up: its right camera may lie on the left side."""
    late: bool = False
    """Whether its `knows` holds for others' texts as well: it is asked last."""
    otherwise: tuple[str, ...] = ()
    """Endings of which it takes the files that no format knows."""

    def rig(self, path: Path) -> StereoRig:
        """The rig in the file at `path`.

        Raises:
            OutputError: a file cannot be read.
            InvalidRig: it holds no rig that can be; the message names the file.
        """
        if self.read is not None:
            return self.read(path)
        assert self.parse is not None, self.name
        try:
            return self.parse(read_text(path))
        except InvalidRig as error:
            raise InvalidRig(f"{path}: {error}") from None
