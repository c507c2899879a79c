"""Looks for a board's corners in pairs of pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from rigsim import interrupts
from rigsim.errors import InvalidImage, MeasurementFailed, OutputError
from rigsim.pixels.corners.boards import BoardCorners, find_sizes
from rigsim.pixels.reading import read_image
from rigsim.rig.arrays import AnyImage
from rigsim.rig.board import LEAST, Board
from rigsim.rig.remark import Remark
from rigsim.study.calibrate.pictures.pairs import PicturePair
from rigsim.study.calibrate.pictures.sightings import Sightings, Size
from rigsim.study.calibrate.progress import Stage

Seen: TypeAlias = Literal["found", "not_found", "unreadable", "several"]
"""What came of looking at one picture: a board, none, no picture, or more than one such board."""
_Both: TypeAlias = tuple[BoardCorners | None, BoardCorners | None]
_HINTS = ((-1, -1), (1, 1), (-1, 0), (0, -1))
"""What may be counted wrong: squares in the place of corners, mostly."""
_LOOKED_AT = 3
_NAMED = 6
_UPRIGHT = 0.6
"""Of the boards must lie across for the board to be called turned by a quarter."""


@dataclass(frozen=True, slots=True, eq=False)
class Looked:
    """What was found in pairs of pictures."""

    sightings: Sightings
    """The corners, pair by pair."""
    pairs: tuple[PicturePair, ...]
    """The pairs."""
    seen: tuple[tuple[Seen, Seen], ...]
    """What came of the left and the right picture of each."""
    remarks: tuple[Remark, ...] = ()
    """What was odd."""
    interrupted: bool = False
    """Whether Ctrl-C ended the search before the last pair."""


@dataclass(slots=True)
class _Sizes:
    """The size of each camera's pictures, as the first one has it."""

    sizes: list[tuple[Size, str] | None]

    def check(self, side: int, size: Size, file: str) -> None:
        known = self.sizes[side]
        if known is None:
            self.sizes[side] = (size, file)
        elif known[0] != size:
            camera = ("left", "right")[side]
            raise InvalidImage(
                f"{file}: {size[0]}x{size[1]} px, but {known[1]} has {known[0][0]}x{known[0][1]}: pictures"
                f" of the {camera} camera must all be of one size; leave out those of the other"
            )


def look(board: Board, pairs: Sequence[PicturePair], told: Stage | None = None) -> Looked:
    """Find the board in every picture.

    A picture without one, or that cannot be read, is no error. Ctrl-C ends the search and keeps what was
    found.

    Raises:
        InvalidImage: one camera's pictures are of different sizes.
        MeasurementFailed: no picture holds the board, or OpenCV is not installed.
    """
    sizes = _Sizes([None, None])
    found: list[_Both] = []
    seen: list[tuple[Seen, Seen]] = []
    interrupted = False
    try:
        for k, pair in enumerate(pairs):
            left, right = (
                _one(board, file, side, sizes) for side, file in enumerate((pair.left, pair.right))
            )
            found.append((left[0], right[0]))
            seen.append((left[1], right[1]))
            if told is not None:
                told("pairs searched", k + 1, len(pairs))
            if k + 1 == _LOOKED_AT:
                _refuse_others(board, pairs[: k + 1], found)
    except KeyboardInterrupt:
        if not found:
            raise
        interrupts.caught()
        interrupted = True
    if all(word == "unreadable" for both in seen for word in both):
        raise MeasurementFailed(
            f"{pairs[0].left} and {2 * len(seen) - 1} more: none is a picture that can be read"
        )
    if not _any(found):
        _refuse_others(board, pairs[:_LOOKED_AT], found)
        raise MeasurementFailed(
            f"no board of {board.cols}x{board.rows} (or {board.rows}x{board.cols}) inner corners in any of"
            f" {2 * len(found)} pictures: it must be visible as a whole, with squares of at least 6 px; count"
            " inner corners, not squares"
        )
    pairs = tuple(pairs[: len(found)])
    left_size, right_size = (known[0] if known else (0, 0) for known in sizes.sizes)
    sightings = _sightings(board, [pair.name for pair in pairs], found, (left_size, right_size))
    remarks = (*_turned(board, sightings), *_unreadable(pairs, seen))
    return Looked(sightings, pairs, tuple(seen), remarks, interrupted)


def _one(board: Board, file: str, side: int, sizes: _Sizes) -> tuple[BoardCorners | None, Seen]:
    try:
        image = read_image(file)
    except (OutputError, InvalidImage):
        return None, "unreadable"
    sizes.check(side, (image.shape[1], image.shape[0]), file)
    return _board_in(board, image)


def _board_in(board: Board, image: AnyImage) -> tuple[BoardCorners | None, Seen]:
    try:
        boards = find_sizes(image, [(board.rows, board.cols)])
    except InvalidImage:  # all black, all alike
        return None, "not_found"
    if not boards:
        return None, "not_found"
    return (boards[0], "found") if len(boards) == 1 else (None, "several")


def _sightings(
    board: Board,
    names: Sequence[str],
    found: Sequence[_Both],
    sizes: tuple[Size, Size],
) -> Sightings:
    count = board.rows * board.cols
    observed, claimed = np.full((len(found), 2, count, 2), np.nan), np.full((len(found), 2, count), np.nan)
    polarity = np.zeros((len(found), 2), dtype=np.int32)
    for k, both in enumerate(found):
        for side, corners in enumerate(both):
            if corners is not None:
                observed[k, side] = corners.uv
                claimed[k, side] = np.sqrt((corners.cov[:, 0, 0] + corners.cov[:, 1, 1]) / 2)
                polarity[k, side] = corners.polarity
    return Sightings(board, tuple(names), observed, claimed, np.ones(observed.shape[:3]), polarity, sizes)


def _turned(board: Board, sightings: Sightings) -> tuple[Remark, ...]:
    """A remark where the board's columns and rows were told the other way round than pictures show it."""
    if board.cols >= board.rows:
        return ()
    grids = sightings.observed.reshape(-1, board.rows, board.cols, 2)
    across = np.median(grids[:, :, -1] - grids[:, :, 0], axis=1)
    across = across[np.isfinite(across).all(axis=1)]
    if not len(across) or np.mean(np.abs(across[:, 1]) > np.abs(across[:, 0])) < _UPRIGHT:
        return ()
    remark = Remark(
        "board_turned",
        f"board {board.cols}x{board.rows}: both ways were tried; the pictures show it lying, {board.rows}"
        f" corners across: {board.rows}x{board.cols} is the same board, and gives the same rig",
    )
    return (remark,)


def _unreadable(pairs: Sequence[PicturePair], seen: Sequence[tuple[Seen, Seen]]) -> tuple[Remark, ...]:
    """A remark that names the files that are no pictures."""
    files = [
        file
        for pair, both in zip(pairs, seen, strict=True)
        for file, word in zip((pair.left, pair.right), both, strict=True)
        if word == "unreadable"
    ]
    if not files:
        return ()
    more = f" and {len(files) - _NAMED} more" if len(files) > _NAMED else ""
    named = f"{', '.join(files[:_NAMED])}{more}"
    return (Remark("unreadable", f"{named}: cannot be read as a picture, and is left out with its pair"),)


def _any(found: Sequence[_Both]) -> bool:
    return any(corners is not None for both in found for corners in both)


def _refuse_others(board: Board, pairs: Sequence[PicturePair], found: Sequence[_Both]) -> None:
    """Raise if the first pictures hold another board in the place of this one."""
    if _any(found):
        return
    for pair in pairs:
        for cols, rows in ((board.cols + by[0], board.rows + by[1]) for by in _HINTS):
            if min(cols, rows) < LEAST:
                continue
            try:
                others = find_sizes(read_image(pair.left), [(rows, cols)])
            except (InvalidImage, OutputError):
                continue
            if others:
                raise MeasurementFailed(
                    f"no picture shows a board of {board.cols}x{board.rows} inner corners, but {pair.left}"
                    f" one of {cols}x{rows}: count inner corners, one fewer than squares, and give"
                    f" --board {cols}x{rows}@..."
                )
