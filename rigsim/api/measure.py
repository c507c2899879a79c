"""`rigsim.measure`: what the pixels of somebody's own pair say."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from rigsim.api.kit.plain import takes
from rigsim.api.result import Result
from rigsim.api.rigs import RigLike, read_rig, told_of
from rigsim.errors import InvalidRange
from rigsim.pixels.dense.views import view_of
from rigsim.rig import given
from rigsim.rig.arrays import AnyImage, Array
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig

if TYPE_CHECKING:
    from rigsim.interop.documents.base import Written
    from rigsim.present.kit.types import Figure, Table
    from rigsim.study.measure.result import PairMeasurement

Picture = str | os.PathLike[str] | npt.NDArray[Any]
"""A picture's file, or its pixels (H, W) or (H, W, 3)."""


@dataclass(frozen=True, slots=True)
class MeasureOptions:
    """The arguments of `measure`, which says what they mean."""

    left: Picture
    right: Picture
    rig: RigLike | Callable[[AnyImage], StereoRig]
    _: KW_ONLY
    board: tuple[int, int] | None = None
    square_mm: float | None = None
    matcher: str | None = "sgbm"
    timeout_s: float = 120.0
    disparities_px: tuple[float, float] | None = None
    rectify: str | None = None
    truth: str | os.PathLike[str] | npt.NDArray[Any] | None = None
    truth_scale: float | None = None
    target: tuple[int, int, int, int] | None = None
    command: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Measured(Result):
    """What the pixels of a pair say."""

    result: PairMeasurement
    """All that was measured."""
    remarks: tuple[Remark, ...] = ()
    """What is odd is among the findings of `result`."""

    @property
    def table(self) -> Table:
        """One row a trusted match; the columns of matches.csv."""
        from rigsim.interop.files.measure import matches_table

        return matches_table(self.result)

    @property
    def verdict(self) -> Literal["agrees", "flagged", "untold"]:
        """Whether rows and depths are as the rig says: the worst that was concluded."""
        kinds = {finding.kind for finding in (*self.result.verdicts, *self.result.findings)}
        if "flagged" in kinds:
            return "flagged"
        return "untold" if "untold" in kinds else "agrees"

    @property
    def headline(self) -> str:
        """The answer in a sentence or two."""
        from rigsim.present.measure.figures import headline

        return headline(self.result)

    @property
    def figures(self) -> Mapping[str, Callable[[], Figure]]:
        """``disparity``, ``left`` and ``right``."""
        from rigsim.present.measure.figures import pair_figures

        return pair_figures(self.result)

    def files(self) -> dict[str, bytes]:
        """disparity.png, matches.csv, points.ply, rig.toml, provenance.json, and of a dense measurement
        disparity.pfm and cloud.ply; `write` adds measure.json, which names them all."""
        from rigsim.interop.files.measure import pair_files
        from rigsim.present.measure.console import pair_pictures

        return {**pair_pictures(self.result), **pair_files(self.result)}

    def write(self, folder: str | os.PathLike[str], force: bool = False) -> Written:
        """Write `files` and measure.json; as `Result.write`."""
        from rigsim.interop.documents.base import Written
        from rigsim.interop.files.folder import write_folder
        from rigsim.interop.files.tables import json_bytes

        path = given.path(folder, "output folder")
        files = self.files()
        written = Written(folder=str(path), files=sorted([*files, "measure.json"]))
        write_folder(path, {**files, "measure.json": json_bytes(self.document(written))}, force)
        return written

    def document(self, written: Written | None = None) -> Mapping[str, Any]:
        """All that was measured; docs/reference/measure.md says what the keys mean."""
        from rigsim.interop.documents.measure.document import measure_document
        from rigsim.present.measure.words import sentence

        return measure_document(self.result, sentence, written)

    def print(self, folder: Path | None = None) -> None:
        """Print what was measured, and how sure it is."""
        from rigsim.present.measure.console import print_pair

        print_pair(self.result, folder)


@takes(MeasureOptions)
def measure(options: MeasureOptions) -> Measured:
    """Measure a pair of pictures: matches, depths, how accurate they are, and whether the rig fits.

    Args:
        left: The left picture: a file, or its pixels (H, W) or (H, W, 3).
        right: The right picture.
        rig: The rig that took them: a preset's name, a calibration's path or text, or a rig; or a function
            that makes one from the left picture.
        board: Rows and columns of inner corners of checker boards, which are measured as well.
        square_mm: Known side of the boards' squares, mm, which tells whether depths are right.
        matcher: Who finds a disparity for every pixel: sgbm; ``package.module:function(left, right, rig)``;
            a command with {left}, {right} and {out} in it; or None for nobody.
        timeout_s: Longest time for a matcher, s.
        rectify: What a pair that is not rectified is turned into before it is matched: perspective, cylinder
            or latlong; None chooses by what the lenses see.
        disparities_px: Least and largest disparity to search, px; by default what a calib.txt says.
        truth: True disparity of the left pixels: a .pfm, .npy or .png file, or (H, W) px.
        truth_scale: Grey levels of a truth PNG that are one px; 256 where it has 16 bits.
        target: Pixels of a flat target, to judge by itself: first column and row, width and height.
        command: What the files name as the command that made them.

    Raises:
        InvalidImage: A picture or the truth cannot be used, or does not fit the others or the rig.
        InvalidRange: A value is out of bounds.
        MeasurementFailed: Nothing matched, no board was found, the pictures are swapped, or the matcher
            failed.
        OutputError: A file cannot be read.

    Example:
        >>> import rigsim
        >>> from rigsim.testing import render_stereo
        >>> rig = rigsim.StereoRig.rectified(rigsim.Intrinsics.from_focal(200, 150, 175.0), 0.06)
        >>> pair = render_stereo("bin", rig)
        >>> found = rigsim.measure(pair.left, pair.right, rig, matcher=None)
        >>> len(found.table) > 10, found.verdict
        (True, 'untold')
    """
    return Measured(_measured(options))


def _measured(options: MeasureOptions) -> PairMeasurement:
    from rigsim.interop.files.measure import sources
    from rigsim.study.measure.run import Wanted, measure_pair, versions

    if options.square_mm is not None and options.board is None:
        raise InvalidRange(
            f"square {options.square_mm:g} mm: is the side of a board's squares: give the board"
        )
    left, right = _pixels(options.left, "left picture"), _pixels(options.right, "right picture")
    if callable(options.rig):
        rig, searched = options.rig(left), None
    else:
        rig, searched = read_rig(options.rig), told_of(options.rig).disparities_px
    named = {"left": options.left, "right": options.right, "truth": options.truth}
    paths = {name: Path(path) for name, path in named.items() if isinstance(path, str | os.PathLike)}
    return measure_pair(
        left,
        right,
        rig,
        Wanted(
            matcher=options.matcher,
            board=options.board,
            square_m=None if options.square_mm is None else options.square_mm / 1e3,
            target=options.target,
            disparity_range=options.disparities_px or searched,
            timeout_s=options.timeout_s,
            rectify=view_of(options.rectify),
        ),
        truth=_truth(options),
        provenance={"command": options.command, **sources(paths), **versions()},
    )


def _truth(options: MeasureOptions) -> Array | None:
    """True disparity (H, W) px; None where none was given."""
    from rigsim.interop.files.measure import read_truth

    if options.truth is None:
        return None
    if isinstance(options.truth, np.ndarray):
        return np.asarray(options.truth, dtype=np.float64)
    return read_truth(given.path(options.truth, "truth"), options.truth_scale)


def _pixels(picture: Picture, what: str) -> AnyImage:
    """A picture's pixels."""
    if isinstance(picture, np.ndarray):
        return picture
    from rigsim.pixels.reading import read_image

    return read_image(given.path(picture, what))
