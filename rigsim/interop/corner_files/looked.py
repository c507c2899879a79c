"""Corner files in the place of pictures."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from rigsim.errors import InvalidImage, InvalidRange, MeasurementFailed, OutputError
from rigsim.interop.corner_files.read import PictureCorners, read_corners
from rigsim.pixels.reading import read_image
from rigsim.rig.arrays import Array
from rigsim.rig.board import Board
from rigsim.study.calibrate.pictures.look import Looked, Seen
from rigsim.study.calibrate.pictures.pairs import Paired, PicturePair, paired
from rigsim.study.calibrate.pictures.remarks import pairing_remarks
from rigsim.study.calibrate.pictures.sightings import Sightings, Size

_DIVIDED = 2.0
"""Coordinates, px, that none exceeds are no pixels."""
_NOT_SEEN: Seen = "not_found"


def looked_from(paths: Sequence[Path], board: Board, sizes: tuple[Size, Size] | None) -> Looked:
    """What corner files hold, in pairs.

    Args:
        paths: One file of both cameras, or the left and the right camera's.
        board: The board.
        sizes: Width and height of the left and the right pictures; None reads them from the pictures, where
            they lie.

    Raises:
        OutputError: a file cannot be read.
        InvalidRange: it is no corner file, its pictures do not pair, or nothing tells the pictures' size.
    """
    if not 1 <= len(paths) <= 2:
        raise InvalidRange(
            f"{len(paths)} corner files: give one of both cameras, or the left and the right one's"
        )
    count = board.rows * board.cols
    files = [read_corners(path, count) for path in paths]
    if not any(np.isfinite(each.uv).any() for rows in files for each in rows):
        raise MeasurementFailed(f"{paths[0]}: holds no corner")
    left, right = _sides(files)
    matched = _paired(left, right)
    if sizes is None:
        sizes = _size(left, paths, "left"), _size(right, paths, "right")
    sightings = _sightings(board, matched.pairs, left, right, sizes)
    seen: list[tuple[Seen, Seen]] = [
        ("found" if cameras[0] else _NOT_SEEN, "found" if cameras[1] else _NOT_SEEN)
        for cameras in sightings.cameras
    ]
    return Looked(sightings, matched.pairs, tuple(seen), pairing_remarks(matched))


def _sides(
    files: Sequence[list[PictureCorners]],
) -> tuple[dict[str, PictureCorners], dict[str, PictureCorners]]:
    """Pictures of the left and the right camera by name."""
    if len(files) == 2:
        return {each.picture: each for each in files[0]}, {each.picture: each for each in files[1]}
    by_camera: dict[str, dict[str, PictureCorners]] = {"left": {}, "right": {}}
    if all(each.camera for each in files[0]):
        for each in files[0]:
            by_camera[each.camera][each.picture] = each
        return by_camera["left"], by_camera["right"]
    named = {each.picture: each for each in files[0]}
    pairs = paired([list(named)])
    alone = {name: named[name] for name in pairs.alone}
    left = {pair.left: named[pair.left] for pair in pairs.pairs}
    return {**left, **alone}, {pair.right: named[pair.right] for pair in pairs.pairs}


def _paired(left: dict[str, PictureCorners], right: dict[str, PictureCorners]) -> Paired:
    both = [name for name in left if name in right]
    if both:
        alone = [name for name in (*left, *right) if name not in both]
        return Paired(tuple(PicturePair(name, name) for name in both), tuple(dict.fromkeys(alone)))
    if not (left and right):
        side = "right" if left else "left"
        raise InvalidRange(f"corner files: have no picture of the {side} camera")
    return paired([list(left), list(right)])


def _sightings(
    board: Board,
    pairs: Sequence[PicturePair],
    left: dict[str, PictureCorners],
    right: dict[str, PictureCorners],
    sizes: tuple[Size, Size],
) -> Sightings:
    both = [(left[pair.left], right[pair.right]) for pair in pairs]
    observed, level, std = (
        np.array([[getattr(each, name) for each in pair] for pair in both])
        for name in ("uv", "level", "std_px")
    )
    for side, (width, height) in enumerate(sizes):
        _check_inside(observed[:, side], width, height)
    names = tuple(pair.name for pair in pairs)
    unknown = np.zeros((len(pairs), 2), dtype=np.int32)
    return Sightings(board, names, observed, std, 2.0**-level, unknown, sizes)


def _check_inside(uv: Array, width: int, height: int) -> None:
    if not np.isfinite(uv).any():
        return
    if np.nanmax(np.abs(uv)) <= _DIVIDED:
        raise InvalidRange(
            f"corners all lie within {np.nanmax(np.abs(uv)):.2g} px of 0,0: they look divided by the"
            " picture's size or by the focal length: give them in pixels"
        )
    farthest = np.nanmax(uv.reshape(-1, 2), axis=0, initial=-np.inf)
    if farthest[0] > width or farthest[1] > height:
        raise InvalidRange(
            f"corners reach {farthest[0]:.0f},{farthest[1]:.0f} px, the pictures are {width}x{height}: give"
            " their --size"
        )


def _size(pictures: dict[str, PictureCorners], paths: Sequence[Path], side: str) -> Size:
    for name in pictures:
        for folder in (Path(), *(path.parent for path in paths)):
            if os.path.isfile(folder / name):
                try:
                    image = read_image(folder / name)
                except (InvalidImage, OutputError):
                    continue
                return int(image.shape[1]), int(image.shape[0])
    raise InvalidRange(
        f"size of the {side} pictures: no corner file tells it, and no picture lies there: give --size WxH"
    )
