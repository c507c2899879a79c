"""Which two cameras of a file are left and right."""

from __future__ import annotations

import re
from collections.abc import Sequence

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked
from rigsim.interop.formats.values import clipped
from rigsim.rig.remark import Remark

_DIGITS = re.compile(r"0*(\d+)$")
_SIDES = (("left", "l"), ("right", "r"))


def two_of(
    names: Sequence[str], asked: Asked, usual: tuple[int, int] = (0, 1)
) -> tuple[int, int, tuple[Remark, ...]]:
    """Places in `names` of the left and the right camera, and what is to be said of the choice.

    A person calls a camera by its name or the number at its end, and the two of a pair also left and right.

    Args:
        names: the file's cameras, in its order.
        asked: what the person said.
        usual: what is taken where they said nothing.

    Raises:
        InvalidRig: there are fewer than two, or none is called so.
    """
    if len(names) < 2:
        raise InvalidRig(f"has one camera, {', '.join(names) or 'none'}: a rig has two")
    shown = clipped(", ".join(names))
    if asked.cameras is None:
        if len(names) == 2:
            return 0, 1, ()
        left, right = (names[i] for i in usual)
        other = f"{_called(left)},{_called(names[-1])}"
        text = f"has {len(names)} cameras, {shown}: {left} and {right} are taken; others with --rig-cameras"
        return *usual, (Remark("cameras", f"{text}, as {other}"),)
    found = []
    for word in asked.cameras:
        said = str(int(word)) if word.isdecimal() and len(word) < 10 else word.lower()
        places = [i for i, name in enumerate(names) if said in _callings(name, i, len(names))]
        if len(places) != 1:
            raise InvalidRig(f"camera {clipped(word)}: the file has {shown}; name two of them")
        found += places
    if found[0] == found[1]:
        raise InvalidRig(f"cameras {','.join(asked.cameras)}: must be two different ones of {shown}")
    return found[0], found[1], ()


def _called(name: str) -> str:
    digits = _DIGITS.search(name)
    return digits[1] if digits else name


def _callings(name: str, place: int, count: int) -> tuple[str, ...]:
    return (name.lower(), _called(name).lower(), *(_SIDES[place] if count == 2 else ()))
