"""Which pictures belong together: by the sides and the digits in their names."""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePath

from rigsim.errors import InvalidRange

_TOKEN = re.compile(r"\d+|[A-Z]+(?![a-z])|[A-Z]?[a-z]+")
_SIDES = (("left", "right"), ("l", "r"), ("lft", "rgt"), ("links", "rechts"))
_CAMERAS = frozenset({"cam", "camera", "c", "image", "im", "img", "view", "sensor", "eye", "video"})
"""Words after which a number says which camera it is, where there are two of it."""
Key = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class PicturePair:
    """Two pictures of one moment."""

    left: str
    """File of the left camera."""
    right: str
    """File of the right camera."""

    @property
    def name(self) -> str:
        """Both files' names without what they share: ``left01/right01``, ``003``."""
        if self.left == self.right:  # a table of corners names the moment alone
            return str(PurePath(self.left).with_suffix(""))
        left, right = PurePath(self.left).stem, PurePath(self.right).stem
        return left if left == right else f"{left}/{right}"


@dataclass(frozen=True, slots=True)
class Paired:
    """Pictures in pairs."""

    pairs: tuple[PicturePair, ...]
    """In the order of their names."""
    alone: tuple[str, ...]
    """Pictures that belong to none."""
    by_order: bool = False
    """Whether their order alone, and nothing in their names, paired them."""


def paired(groups: Sequence[Sequence[str]]) -> Paired:
    """Pair pictures.

    Two groups, each of several pictures or of one, are the left and the right camera's. Otherwise names tell:
    left and right, l and r, cam0 and cam1, or two folders.

    Args:
        groups: Files that each word of a command stood for.

    Raises:
        InvalidRange: nothing tells left from right, or no pictures belong together.
    """
    files = list(dict.fromkeys(file for group in groups for file in group))
    if len(files) < 2:
        raise InvalidRange(f"{len(files)} picture(s): give those of both cameras, as left*.png right*.png")
    sides = _by_words(files)
    if sides is None and len(groups) == 2:
        sides = (list(groups[0]), list(groups[1]))
    if sides is None:
        folders = list(dict.fromkeys(str(PurePath(file).parent) for file in files))
        if len(folders) != 2:
            raise InvalidRange(
                f"{PurePath(files[0]).name} and {len(files) - 1} more: nothing in their names tells left"
                " from right: give two folders or two patterns, as 'a/*.png' 'b/*.png', left first"
            )
        sides = (
            [file for file in files if str(PurePath(file).parent) == folders[0]],
            [file for file in files if str(PurePath(file).parent) == folders[1]],
        )
    found = _matched(*sides)
    if not found.pairs:
        raise InvalidRange(
            f"{len(sides[0])} left and {len(sides[1])} right pictures: no two have the same number in their"
            " names: name them alike, as left01.png and right01.png"
        )
    return found


def _by_words(files: Sequence[str]) -> tuple[list[str], list[str]] | None:
    """Files of the left and the right camera by words in their names; None where they do not tell all."""
    for words in _SIDES:
        found = _split(files, [_side_word(file, words) for file in files])
        if found is not None:
            return found
    numbers = [_camera_number(file) for file in files]
    two = sorted({number for number in numbers if number is not None})
    if len(two) != 2 or None in numbers:
        return None
    return _split(files, [two.index(number) for number in numbers if number is not None])


def _split(files: Sequence[str], sides: Sequence[int | None]) -> tuple[list[str], list[str]] | None:
    if None in sides or len(set(sides)) < 2:
        return None
    left, right = (
        [file for file, side in zip(files, sides, strict=True) if side == which] for which in (0, 1)
    )
    return left, right


def _side_word(file: str, words: tuple[str, str]) -> int | None:
    """0 or 1 by the last of two words in a file's name or, where none is, in its folder's."""
    for part in (PurePath(file).stem, PurePath(file).parent.name):
        found = [side for token in _tokens(part) for side in (0, 1) if _says(token, words[side])]
        if found:
            return found[-1]
    return None


def _says(token: str, word: str) -> bool:
    """Whether a token is a word for a side, or a long one begins or ends with it: leftcam."""
    return token == word or (len(word) > 3 and (token.startswith(word) or token.endswith(word)))


def _camera_number(file: str) -> int | None:
    """The number after a word for a camera, in a file's name or in its folder's."""
    folder = _tokens(PurePath(file).parent.name)
    if len(folder) == 2 and folder[0] in _CAMERAS and folder[1].isdigit():
        return int(folder[1])
    tokens = _tokens(PurePath(file).stem)
    for word, number in itertools.pairwise(tokens):
        # a number alone, as in img_003, is the moment's
        if word in _CAMERAS and number.isdigit() and len(tokens) > 2:
            return int(number)
    return None


def _tokens(text: str) -> list[str]:
    return [token.lower() for token in _TOKEN.findall(text)]


def _matched(left: Sequence[str], right: Sequence[str]) -> Paired:
    """Pairs of the same numbers or, where nothing in their names fits, of the same order."""
    for keys_of in (_numbers, _stems):
        keys = keys_of(left), keys_of(right)
        if any(len(set(each)) < len(each) for each in keys):
            continue
        others = dict(zip(keys[1], right, strict=True))
        pairs = [
            (key, PicturePair(file, others[key]))
            for key, file in zip(keys[0], left, strict=True)
            if key in others
        ]
        if pairs:
            in_pairs = {file for _, pair in pairs for file in (pair.left, pair.right)}
            alone = [file for file in (*left, *right) if file not in in_pairs]
            pairs.sort(key=lambda each: _natural(each[1].left))
            return Paired(tuple(pair for _, pair in pairs), tuple(sorted(alone, key=_natural)))
    if len(left) != len(right):
        return Paired((), (*left, *right))
    ordered = zip(sorted(left, key=_natural), sorted(right, key=_natural), strict=True)
    return Paired(tuple(PicturePair(*each) for each in ordered), (), by_order=True)


def _numbers(files: Sequence[str]) -> list[Key]:
    """The numbers in each name, without those that all of them share, as a camera's."""
    numbers = [[int(token) for token in _tokens(PurePath(file).stem) if token.isdigit()] for file in files]
    if len({len(each) for each in numbers}) != 1:
        return [tuple(each[-1:]) for each in numbers]
    shared = [len(set(column)) == 1 and len(files) > 1 for column in zip(*numbers, strict=True)]
    return [tuple(number for number, same in zip(each, shared, strict=True) if not same) for each in numbers]


def _stems(files: Sequence[str]) -> list[Key]:
    return [(PurePath(file).stem.lower(),) for file in files]


def _natural(file: str) -> list[tuple[int, int, str]]:
    """Sorts img2 before img10."""
    return [
        (0, int(token), "") if token.isdigit() else (1, 0, token) for token in _tokens(PurePath(file).name)
    ]
