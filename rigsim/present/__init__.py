"""Tables to people: plots, the HTML report and console tables.

The functions here load what they need when they are called: importing this package costs nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy.typing as npt

    from rigsim.present.kit.page import Cover
    from rigsim.rig.noise import PixelNoise
    from rigsim.rig.stereo import StereoRig
    from rigsim.study.scene.snapshot import Snapshot
    from rigsim.study.sweep.result import SweepResult

__all__ = ["plot_points", "print_sweep", "print_table", "render_files", "sweep_files"]


def sweep_files(result: SweepResult, cover: Cover | None = None) -> dict[str, bytes]:
    """Name to content: report.html, topdown.png, depth_error.png, left.png, right.png; witnesses.png too
    when something was measured. `cover` is the report's own head."""
    from rigsim.present.sweep import files

    return files.sweep_files(result, cover)


def render_files(snapshot: Snapshot) -> dict[str, bytes]:
    """Name to content: left.png, right.png, disparity.png, and anaglyph.png for images of one size."""
    from rigsim.present.sweep import files

    return files.render_files(snapshot)


def plot_points(
    rig: StereoRig, points_left: npt.ArrayLike, noise: PixelNoise | None = None, title: str = ""
) -> bytes:
    """PNG of a few points (N, 3) m in the left camera's frame, from above, with lines of sight."""
    from rigsim.present.sweep import files

    return files.plot_points(rig, points_left, noise, title)


def print_sweep(result: SweepResult, folder: Path | None = None) -> None:
    """Print the end of a sweep: the verdict, the best rows, what is flagged, and where the report is."""
    from rigsim.present.sweep import console

    console.print_sweep(result, folder)


def print_table(title: str, columns: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
    """Print a table with a heading."""
    from rigsim.present.kit import console

    console.print_table(title, columns, rows)
