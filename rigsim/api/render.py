"""`rigsim.render`: what a rig sees, with its exact depth and disparity."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rigsim.api.kit.plain import takes
from rigsim.api.result import Result
from rigsim.api.rigs import RigLike, rig_for
from rigsim.rig import given

if TYPE_CHECKING:
    from rigsim.interop.documents.base import Written
    from rigsim.present.kit.types import Figure, Table
    from rigsim.rig.remark import Remark
    from rigsim.study.scene.snapshot import Snapshot


@dataclass(frozen=True, slots=True)
class RenderOptions:
    """The arguments of `render`, which says what they mean."""

    rig: RigLike | None = None
    _: KW_ONLY
    scene: str | os.PathLike[str] = "boards"
    mount: str | None = None
    renderer: str = "auto"
    command: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Rendered(Result):
    """A stereo pair with its truth."""

    snapshot: Snapshot
    """Pictures, depths, segmentation and disparity."""

    @property
    def remarks(self) -> tuple[Remark, ...]:
        """What is odd about the scene or the rig's place in it."""
        return self.snapshot.remarks

    @property
    def table(self) -> Table:
        """Smallest, median and largest depth and disparity of the left pixels."""
        from rigsim.present.kit.types import table

        document = self.document()
        names = ("depth_left_mm", "disparity_px")
        return table({"quantity": name, **document[name]} for name in names)

    @property
    def verdict(self) -> float | None:
        """Share of the left pixels with a depth that the right camera sees too, 0 to 1."""
        share = self.document()["visible_fraction"]
        return None if share is None else float(share)

    @property
    def headline(self) -> str:
        """What was rendered."""
        lens = self.snapshot.rig.left
        return f"stereo pair of {self.snapshot.scene}, {lens.width}x{lens.height} px"

    @property
    def figures(self) -> Mapping[str, Callable[[], Figure]]:
        """``left``, ``right`` and ``disparity``."""
        from rigsim.present.sweep.files import render_figures

        return render_figures(self.snapshot)

    def files(self) -> dict[str, bytes]:
        """left.png, right.png, anaglyph.png, disparity.png and .npy, depths, segmentation and rig.toml."""
        from rigsim import present
        from rigsim.interop.files.tables import render_files

        return {**present.render_files(self.snapshot), **render_files(self.snapshot)}

    def document(self, written: Written | None = None) -> Mapping[str, Any]:
        """What was rendered in a few numbers; without `written` it names no files."""
        from rigsim.interop.documents.base import Written
        from rigsim.interop.documents.render import render_document

        return render_document(self.snapshot, written or Written(folder="", files=[]))

    def print(self, folder: Path | None = None) -> None:
        """Print what was rendered, and where to."""
        from rigsim.present.kit.console import make_console

        where = "" if folder is None else f"{folder}: "
        make_console().print(where + self.headline, soft_wrap=True, markup=False, highlight=False)


@takes(RenderOptions)
def render(options: RenderOptions) -> Rendered:
    """Render a stereo pair with exact depth, disparity and segmentation.

    Args:
        rig: A preset's name, a calibration's path or text, or a rig; by default the one that the scene is
            made for.
        scene: A bundled scene's name, or the path of an MJCF file.
        mount: Where the rig sits: ``body:NAME``, ``site:NAME`` or ``camera:NAME``.
        renderer: auto, egl, osmesa or rays.
        command: What the files and the document name as the command that made them.

    Raises:
        InvalidRig, OutputError, InvalidRange: As `read_rig`.
        InvalidScene: Scene or mount cannot be used.
        RenderUnavailable: The renderer asked for does not work here.

    Example:
        >>> import rigsim
        >>> rig = rigsim.StereoRig.rectified(rigsim.Intrinsics.from_focal(80, 60, 70.0), 0.06)
        >>> found = rigsim.render(rig, scene="bin", renderer="rays")
        >>> found.snapshot.disparity.shape
        (60, 80)
        >>> 0.5 < found.verdict < 1
        True
    """
    from rigsim.study.scene.snapshot import take_snapshot

    scene = str(given.path(options.scene, "scene"))
    rig = rig_for(options.rig, scene)
    # the same key as always, whether or not there is a command to name
    extra = {"command": options.command}
    return Rendered(take_snapshot(rig, scene, options.mount, options.renderer, extra))
