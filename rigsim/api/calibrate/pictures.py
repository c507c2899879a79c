"""`rigsim.calibrate_pictures`: a rig from pictures of a board, and how good it is."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from rigsim.api.calibrate.options import as_board
from rigsim.api.kit.plain import takes
from rigsim.api.result import Result
from rigsim.errors import InvalidRange
from rigsim.rig import given
from rigsim.rig.board import Board
from rigsim.rig.noise import coordinate_noise_px
from rigsim.rig.quantity import NOISE_PX
from rigsim.rig.remark import Remark

if TYPE_CHECKING:
    from rigsim.interop.documents.base import Written
    from rigsim.interop.documents.calibrate.pictures import PicturesSays
    from rigsim.present.kit.types import Figure, Table
    from rigsim.rig.stereo import StereoRig
    from rigsim.study.calibrate.pictures.look import Looked
    from rigsim.study.calibrate.pictures.result import CalibratedPictures, PicturesVerdict

Picture: TypeAlias = str | os.PathLike[str]


@dataclass(frozen=True, slots=True)
class CalibrateOptions:
    """The arguments of `calibrate_pictures`, which says what they mean."""

    pictures: Sequence[Picture | Sequence[Picture]] = ()
    _: KW_ONLY
    board: Board | str
    model: str = "brown"
    fix: Iterable[str] = ()
    warp: bool = False
    at_m: float | Iterable[float] = (1.0, 2.0, 3.0, 5.0)
    noise_px: float | None = None
    disparity_noise_px: float | None = None
    corners: Picture | Sequence[Picture] | None = None
    size: tuple[int, int] | None = None
    command: str = ""
    progress: Callable[[str, int, int], None] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class CalibratedRig(Result):
    """A rig calibrated from pictures of a board."""

    result: CalibratedPictures
    """Everything that was found."""
    command: str = ""
    """What files name as the command that made them."""

    @property
    def rig(self) -> StereoRig:
        """The rig."""
        return self.result.rig

    @property
    def remarks(self) -> tuple[Remark, ...]:
        """What is odd about the pictures, and about what came of them."""
        return self.result.remarks

    @property
    def table(self) -> Table:
        """One row a pair of pictures: the columns of ``pictures``."""
        from rigsim.present.kit.types import table

        return table(self.document()["pictures"])

    @property
    def verdict(self) -> PicturesVerdict:
        """``agrees``, ``suspect``, ``flagged`` or ``untold``: whether the pictures predict one another."""
        return self.result.verdict

    @property
    def headline(self) -> str:
        """The answer in one sentence."""
        from rigsim.present.calibrate.pictures_words import headline

        return headline(self.result)

    @property
    def figures(self) -> Mapping[str, Callable[[], Figure]]:
        """``coverage`` and ``residuals``."""
        from rigsim.present.calibrate.pictures_figures import pictures_figures

        return pictures_figures(self.result)

    def files(self) -> dict[str, bytes]:
        """rig.toml, covariance.json, corners.csv, coverage.png and residuals.png; `write` adds
        calibration.json, which names them all."""
        from rigsim.interop.files.calibration import calibration_files
        from rigsim.present.kit.style import to_png

        pictures = {f"{name}.png": to_png(draw()) for name, draw in self.figures.items()}
        return {**pictures, **calibration_files(self.result, self.headline)}

    def write(self, folder: str | os.PathLike[str], force: bool = False) -> Written:
        """Write `files` and calibration.json; as `Result.write`."""
        from rigsim.interop.documents.base import Written
        from rigsim.interop.files.folder import write_folder
        from rigsim.interop.files.tables import json_bytes

        path = given.path(folder, "output folder")
        files = self.files()
        written = Written(folder=str(path), files=sorted([*files, "calibration.json"]))
        write_folder(path, {**files, "calibration.json": json_bytes(self.document(written))}, force)
        return written

    def document(self, written: Written | None = None) -> Mapping[str, Any]:
        """Everything that was found; docs/reference/calibrate_pictures.md says what the keys mean."""
        from rigsim.interop.documents.calibrate.pictures import pictures_document

        return pictures_document(self.result, _says(), self.command, written)

    def print(self, folder: Path | None = None) -> None:
        """Print the rig, every pair, and what the calibration leaves of the depth."""
        from rigsim.present.calibrate.pictures_console import print_pictures

        print_pictures(self.result, folder)


@takes(CalibrateOptions)
def calibrate_pictures(options: CalibrateOptions) -> CalibratedRig:
    """Calibrate a rig from pictures of a checker board, and say how good it is.

    Corners are found, OpenCV calibrates, all corners are adjusted together; then each pair is predicted by
    the others, and what does not fit is left out, with a reason. The covariance, at the corner noise that was
    found, says what is left of the depth.

    Args:
        pictures: Files, folders or patterns of both cameras' pictures, paired by the sides and the digits in
            their names; or two lists, the left and the right camera's.
        board: The board, or its text: ``9x6@25mm``, inner corners along it and down, and a square's side.
        model: Lens model: pinhole, brown, rational (8 terms) or fisheye (Kannala-Brandt).
        fix: What is not estimated: ``aspect``, ``k3``, ``tangential``, ``principal``, ...
        warp: Whether the board's warp is estimated as well.
        at_m: Depths that the depth error is told at, m.
        noise_px: Standard deviation of one coordinate of a match when the rig measures, px; 0.25 by default.
        disparity_noise_px: Standard deviation of a disparity, px, instead: sqrt(2) times as much.
        corners: Corners found elsewhere, in the place of pictures: a corners.vnl or a CSV table, or two.
        size: Width and height of the pictures, px, where only `corners` are given.
        command: What the files name as the command that made them.
        progress: Told what things are done, how many, of how many.

    Raises:
        InvalidImage: Pictures of one camera differ in size, all are the same, or one camera's are mirrored.
        InvalidRange: A value is out of bounds, pictures do not pair, or OpenCV cannot hold what is held.
        MeasurementFailed: Too few pairs show the board, or they leave the rig open.
        OutputError: A file cannot be read.

    Example:
        >>> import tempfile, pathlib, numpy as np, rigsim
        >>> rig, board = rigsim.preset("oak-d").rig, rigsim.Board(9, 6, 0.03)
        >>> held = rigsim.plan_calibration(rig, board=board, poses=8).plan.poses
        >>> noise = np.random.default_rng(0)
        >>> rows = ["picture,camera,corner,u_px,v_px"]
        >>> for k, points in enumerate(held.points_left(board.points)):
        ...     for camera, uv in zip(("left", "right"), rig.project(points)):
        ...         uv = uv + 0.1 * noise.standard_normal(uv.shape)
        ...         rows += [f"{k},{camera},{corner},{u},{v}" for corner, (u, v) in enumerate(uv)]
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     file = pathlib.Path(folder, "corners.csv")
        ...     _ = file.write_text(chr(10).join(rows))
        ...     found = rigsim.calibrate_pictures(corners=file, size=(1280, 800), board=board)
        >>> round(found.rig.baseline_m * 1e3, 1), found.verdict
        (75.0, 'agrees')
    """
    from rigsim.study.calibrate.pictures.asked import PicturesAsked
    from rigsim.study.calibrate.pictures.run import calibrate_pictures as run

    board = as_board(options.board)
    at_m = (options.at_m,) if isinstance(options.at_m, int | float) else tuple(options.at_m)
    noise_px = coordinate_noise_px(options.noise_px, options.disparity_noise_px)
    asked = PicturesAsked(
        board,
        options.model,
        tuple(options.fix),
        tuple(sorted({given.real(z_m, "depth", InvalidRange) for z_m in at_m})),
        NOISE_PX if noise_px is None else given.real(noise_px, "noise", InvalidRange),
        options.warp,
    )
    return CalibratedRig(run(asked, _looked(options, board)), options.command)


def _looked(options: CalibrateOptions, board: Board) -> Looked:
    """The corners, from pictures or from files."""
    if options.corners is not None:
        from rigsim.interop.corner_files.looked import looked_from

        if options.pictures:
            raise InvalidRange("corners: are in the place of pictures: give one or the other")
        corners = options.corners
        paths = [corners] if isinstance(corners, str | os.PathLike) else corners
        size = options.size
        return looked_from(
            [given.path(each, "corner file") for each in paths], board, None if size is None else (size, size)
        )
    from rigsim.interop.files.picture_lists import picture_files
    from rigsim.study.calibrate.pictures.look import look
    from rigsim.study.calibrate.pictures.pairs import paired
    from rigsim.study.calibrate.pictures.remarks import pairing_remarks

    groups = []
    for each in options.pictures:
        several = [each] if isinstance(each, str | os.PathLike) else each
        words = [str(given.path(word, "picture")) for word in several]
        found = picture_files(words)
        groups.append([file for files in found for file in files])
    matched = paired(groups)
    looked = look(board, matched.pairs, options.progress)
    return replace(looked, remarks=(*pairing_remarks(matched), *looked.remarks))


def _says() -> PicturesSays:
    from rigsim.interop.documents.calibrate.pictures import PicturesSays
    from rigsim.present.calibrate.pictures_words import headline, holding_of, picture_words

    return PicturesSays(headline, picture_words, holding_of)
