"""`rigsim.check_rig`: what a rig is, and what is odd about it."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rigsim.api.result import Result
from rigsim.api.rigs import RigLike, rig_reading
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.study.rig.facts import RigFacts, facts_of_rig

if TYPE_CHECKING:
    from rigsim.interop.documents.base import Written
    from rigsim.present.kit.types import Figure, Table


@dataclass(frozen=True, slots=True, eq=False)
class CheckedRig(Result):
    """A rig as it stands, and what is odd about it."""

    facts: RigFacts
    """What it is."""
    format: str
    """Whose format its files are of; ``preset`` of a preset, ``rig`` of a rig that was given as one."""
    sources: tuple[str, ...] = ()
    """Its files."""
    remarks: tuple[Remark, ...] = ()
    """What is odd about it."""

    @property
    def rig(self) -> StereoRig:
        """The rig."""
        return self.facts.rig

    @property
    def table(self) -> Table:
        """One row a camera: ``side``, ``model``, and its numbers."""
        from rigsim.present.kit.types import table

        document: Any = self.document()
        return table({"side": side, **document[side]} for side in ("left", "right"))

    @property
    def verdict(self) -> tuple[str, ...]:
        """The codes of the remarks; empty where nothing is odd."""
        return tuple(remark.code for remark in self.remarks)

    @property
    def headline(self) -> str:
        """The rig in one sentence."""
        from rigsim.present.rig.words import sentence

        return sentence(self.facts, self.format, self.remarks)

    @property
    def figures(self) -> Mapping[str, Callable[[], Figure]]:
        """``rig``: from above and from its side."""
        from rigsim.present.rig.figure import views_figure

        return {"rig": lambda: views_figure(self.rig)}

    def files(self) -> dict[str, bytes]:
        """rig.json and rig.png."""
        from rigsim.interop.files.tables import json_bytes
        from rigsim.present.kit.style import to_png

        return {"rig.json": json_bytes(self.document()), "rig.png": to_png(self.figure())}

    def document(self, written: Written | None = None) -> Mapping[str, Any]:
        """The rig and what is odd about it; docs/reference/rig.md says what the keys mean."""
        from rigsim.interop.documents.rig import rig_document

        return rig_document(self.facts, self.format, self.sources, self.remarks)

    def print(self, folder: Path | None = None) -> None:
        """Print the rig, its cameras, what both see, and the remarks."""
        from rigsim.present.rig.console import print_rig

        print_rig(self.facts, self.format, self.remarks, folder)


def check_rig(
    rig: RigLike,
    *more: str | os.PathLike[str],
    unit: str | None = None,
    size_px: tuple[int, int] | None = None,
    swap: bool = False,
    cameras: tuple[str, str] | None = None,
    mode: str | None = None,
) -> CheckedRig:
    """What a rig is, and what is odd about it.

    Args:
        rig: As of `read_rig`, and so are the others.
        more: The other files of the same calibration.
        unit: Unit of the file's lengths, where it does not say it.
        size_px: Image size, width and height, of a file that has none.
        swap: Whether the file's left camera is the right one.
        cameras: Names of the left and the right camera, of a file with more than two.
        mode: Which of a file's modes.

    Raises:
        OutputError, InvalidRig, InvalidRange: As `read_rig`.

    Example:
        >>> import rigsim
        >>> checked = rigsim.check_rig("oak-d")
        >>> checked.facts.arrangement, checked.rig.is_rectified, checked.verdict
        ('horizontal', True, ())
        >>> inwards = rigsim.make_rig("oak-d", yaw_deg=170)
        >>> rigsim.check_rig(inwards).verdict
        ('no_overlap',)
    """
    from rigsim.interop.formats.kit.reading import RigReading

    found = rig_reading(rig, more, RigReading(unit, size_px, swap, cameras, mode))
    sources = tuple(str(file.path) for file in found.files)
    return CheckedRig(facts_of_rig(found.rig), found.format, sources, found.remarks)
