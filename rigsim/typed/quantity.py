"""Quantities, ranges and pairs as people type them: ``120``, ``12cm``, ``50:500``, ``0.5:5m``, ``640x480``.

A range is ``a:b`` (8 to 12 values, both ends, in round steps if there are any, else 10), ``a:b:step``,
``a:b/count``, a list ``a,b,c``, or one value. A part without a unit takes the unit of the next part that has
one (``0.5:5m``), a step that of its range's end; failing that the option's own. The arithmetic is exact:
``0.1:0.5:0.1`` holds 0.3, not 0.30000000000000004.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from decimal import Decimal
from fractions import Fraction
from math import lcm

from rigsim.errors import InvalidRange
from rigsim.rig.quantity import BASELINE as BASELINE
from rigsim.rig.quantity import DEPTH as DEPTH
from rigsim.rig.quantity import DISPARITY as DISPARITY
from rigsim.rig.quantity import DISPARITY_NOISE as DISPARITY_NOISE
from rigsim.rig.quantity import FOCAL_MM as FOCAL_MM
from rigsim.rig.quantity import FOCAL_PX as FOCAL_PX
from rigsim.rig.quantity import FORWARD_SPEED as FORWARD_SPEED
from rigsim.rig.quantity import HFOV as HFOV
from rigsim.rig.quantity import LENGTHS, PIXELS
from rigsim.rig.quantity import NOISE as NOISE
from rigsim.rig.quantity import NOISE_PX as NOISE_PX
from rigsim.rig.quantity import PIXEL_PITCH as PIXEL_PITCH
from rigsim.rig.quantity import SENSOR_WIDTH as SENSOR_WIDTH
from rigsim.rig.quantity import SPEEDS as SPEEDS
from rigsim.rig.quantity import TIME_OFFSET as TIME_OFFSET
from rigsim.rig.quantity import TIMES as TIMES
from rigsim.rig.quantity import TURN_RATE as TURN_RATE
from rigsim.rig.quantity import VERGENCE as VERGENCE
from rigsim.rig.quantity import YAW as YAW
from rigsim.rig.quantity import QuantityKind as QuantityKind

MAX_VALUES = 1_000_000
"""More values than this in one range are a slip of the pen."""
DEFAULT_COUNT = 10
"""Values of ``a:b`` where no count near it makes a round step."""
_COUNTS = (10, 11, 9, 12, 8)
_ROUND = frozenset((Fraction(1), Fraction(2), Fraction(5, 2), Fraction(5)))

LARGEST_PX = 1e6
"""Positions in an image beyond this are a slip of the pen."""

UNIT = re.compile(r"[a-zA-Zµμ°%]\s*$")
"""Whether a quantity, or the last of a range, is typed with its unit."""
_NUMBER = re.compile(
    r"([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*((?:[a-zA-Zµμ°]+(?:/[a-zA-Z]+)?)?)"
)
_NOT_FINITE = re.compile(r"[+-]?(nan|inf|infinity)[a-z]*", re.IGNORECASE)
_LARGEST_EXPONENT = 300
_HIT = Fraction(1, 10**9)


def value(text: str, kind: QuantityKind) -> float:
    """One quantity; lengths in mm, angles in deg, the rest in px.

    Raises:
        InvalidRange: no such quantity, or out of `kind`'s bounds.
    """
    return _bounded(_parts([text], kind)[0], kind)


def values(text: str, kind: QuantityKind) -> tuple[float, ...]:
    """The values of a range, a list or one quantity, in order; units as in `value`.

    Raises:
        InvalidRange: nothing like a range, empty, reversed, too many or repeated values, out of bounds.
    """
    if ":" not in text:
        listed = tuple(_bounded(part, kind) for part in _parts(text.split(","), kind))
        if len(set(listed)) < len(listed):
            twice = next(item for place, item in enumerate(listed) if item in listed[:place])
            raise InvalidRange(f"{kind.name} {text}: {_say(twice, kind)} is given twice; remove one")
        return listed
    if "," in text:
        raise InvalidRange(f"{kind.name} {text}: a range or a list, not both; write a:b or a,b,c")
    return _range(text, kind)


def distances(text: str, *, least_mm: float = 10.0) -> tuple[float, ...]:
    """Distances, mm, of one length, a list or a range; a short one without any unit is asked about.

    Raises:
        InvalidRange: as `values`; or none has a unit, and one is under `least_mm`: metres may be meant.
    """
    found = values(text, DEPTH)
    if not UNIT.search(text) and min(found) < least_mm:
        raise InvalidRange(
            f"depth {text.strip()}: m or mm? Write the unit, as in {text.strip()}m or {text.strip()}mm"
        )
    return found


def span(text: str, kind: QuantityKind) -> tuple[float, float]:
    """Two ends ``a:b`` with a < b; units as in `value`.

    Raises:
        InvalidRange: not two ends in order.
    """
    ends = text.split(":")
    if len(ends) != 2 or "/" in text:
        raise InvalidRange(
            f"{kind.name} range {text or 'empty'}: must be two ends; write near:far, as in 0.5:5m"
        )
    start, stop = _parts(ends, kind)
    if start == stop:
        raise InvalidRange(
            f"{kind.name} range {text}: has no extent; write the nearest and the farthest, as in 0.5:5m"
        )
    _check_order(start, stop, text, kind)
    return _bounded(start, kind), _bounded(stop, kind)


def focal_lengths(text: str) -> tuple[tuple[float, ...], str]:
    """Focal lengths and their unit, ``"px"`` or ``"mm"``: a number without a unit is in px.

    Raises:
        InvalidRange: as `values`; px and lengths mixed.
    """
    written = {
        match[1] for match in re.finditer(r"[0-9.]\s*([a-zA-Zµμ°]+)", re.sub(r"[eE][+-]?[0-9]", "", text))
    }
    if written & set(LENGTHS):
        if "px" in written:
            raise InvalidRange(f"focal length {text}: px or mm, not both")
        return values(text, FOCAL_MM), "mm"
    if written - {"px"}:
        raise InvalidRange(f"focal length {text}: unknown unit {min(written)!r}; write px, mm, cm or m")
    return values(text, FOCAL_PX), "px"


def resolutions(text: str, name: str = "resolution") -> tuple[tuple[int, int], ...]:
    """Image sizes ``WIDTHxHEIGHT`` separated by commas, px; `name` says of what in the message.

    Raises:
        InvalidRange: not whole numbers >= 1, or one size twice.
    """
    sizes: list[tuple[int, int]] = []
    for part in text.split(","):
        match = re.fullmatch(r"\s*([0-9]{1,9})\s*[xX×]\s*([0-9]{1,9})\s*", part)
        if match is None:
            raise InvalidRange(f"{name} {part.strip() or 'empty'}: must be WIDTHxHEIGHT, as in 1280x720")
        width, height = int(match[1]), int(match[2])
        if width < 1 or height < 1:
            raise InvalidRange(f"{name} {width}x{height} px: width and height must be >= 1")
        if (width, height) in sizes:
            raise InvalidRange(f"{name} {text}: {width}x{height} is given twice; remove one")
        sizes.append((width, height))
    return tuple(sizes)


def rectangle(text: str, name: str) -> tuple[int, int, int, int]:
    """A part ``x,y,width,height`` of an image, whole px; `name` says which in the message.

    Raises:
        InvalidRange: not four whole numbers.
    """
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 4 or not all(re.fullmatch(r"-?[0-9]{1,9}", part) for part in parts):
        raise InvalidRange(f"{name} {text.strip() or 'empty'}: must be x,y,width,height, as in 320,0,640,480")
    x, y, width, height = (int(part) for part in parts)
    return x, y, width, height


def count(text: str, name: str) -> int:
    """A whole number; `name` says of what in the message.

    Raises:
        InvalidRange: it is none.
    """
    if not re.fullmatch(r"\s*[0-9]{1,9}\s*", text):
        raise InvalidRange(f"{name} {text.strip() or 'empty'}: must be a whole number, as in 2")
    return int(text)


def point(text: str, name: str) -> tuple[float, float]:
    """A position ``u,v`` in an image, px; `name` says which in the message.

    Raises:
        InvalidRange: not two numbers that an image could have.
    """
    kind = QuantityKind(name, "px", PIXELS)
    parts = text.split(",")
    if len(parts) != 2:
        raise InvalidRange(f"{name} {text or 'empty'}: must be two numbers u,v, as in 980,500")
    u, v = (value(part, kind) for part in parts)
    if max(abs(u), abs(v)) > LARGEST_PX:
        raise InvalidRange(f"{name} {text}: must be between -{LARGEST_PX:,.0f} and {LARGEST_PX:,.0f} px")
    return u, v


def _range(text: str, kind: QuantityKind) -> tuple[float, ...]:
    body, slash, count_text = text.partition("/")
    ends = body.split(":")
    if len(ends) > 3 or (slash and len(ends) != 2):
        raise InvalidRange(f"{kind.name} {text}: must be a:b, a:b:step or a:b/count")
    start, stop, *rest = _parts(ends, kind)
    _check_order(start, stop, text, kind)
    if rest:
        return _stepped(start, stop, rest[0], text, kind)
    count = _round_count(stop - start)
    if slash:
        if not re.fullmatch(r"\s*[0-9]{1,18}\s*", count_text) or int(count_text) < 2:
            raise InvalidRange(
                f"{kind.name} {text}: count {count_text.strip() or 'empty'} must be a whole number >= 2"
            )
        count = int(count_text)
    return _spread(start, stop, count, text, kind)


def _round_count(extent: Fraction) -> int:
    """How many values of a range have steps of 1, 2, 2.5 or 5 and any power of ten: what can be bought."""
    return next((count for count in _COUNTS if _mantissa(extent / (count - 1)) in _ROUND), DEFAULT_COUNT)


def _mantissa(value: Fraction) -> Fraction:
    """A number > 0 without its power of ten: 1 <= mantissa < 10."""
    while value >= 10:
        value /= 10
    while value < 1:
        value *= 10
    return value


def _stepped(
    start: Fraction, stop: Fraction, step: Fraction, text: str, kind: QuantityKind
) -> tuple[float, ...]:
    if step <= 0:
        raise InvalidRange(f"{kind.name} {text}: step {_say(step, kind)} must be > 0")
    steps = (stop - start) / step
    if abs(steps - round(steps)) <= _HIT * steps and round(steps) >= 1:
        return _spread(start, stop, round(steps) + 1, text, kind)
    if steps < 1:
        raise InvalidRange(
            f"{kind.name} {text}: step {_say(step, kind)} must be <= {_say(stop - start, kind)}"
        )
    return _spread(start, start + int(steps) * step, int(steps) + 1, text, kind)


def _spread(start: Fraction, stop: Fraction, count: int, text: str, kind: QuantityKind) -> tuple[float, ...]:
    if count > MAX_VALUES:
        raise InvalidRange(f"{kind.name} {text}: {count} values, must be <= {MAX_VALUES}; take a longer step")
    _bounded(start, kind)
    _bounded(stop, kind)
    # one denominator for all: a quotient of whole numbers is rounded as exactly, and much sooner
    step = (stop - start) / (count - 1)
    whole = lcm(start.denominator, step.denominator)
    first, more = int(start * whole), int(step * whole)
    return tuple((first + more * i) / whole for i in range(count))


def _parts(texts: Sequence[str], kind: QuantityKind) -> list[Fraction]:
    """Exact values in the result's unit of the parts of one range or list."""
    read = [_number(text.strip(), kind) for text in texts]
    numbers: list[Fraction] = []
    for place, (number, written) in enumerate(read):
        unit = written or next((later for _, later in read[place:] if later), "")
        if not unit and place == 2:
            unit = read[1][1]  # a step without a unit, in the unit of its end
        numbers.append(number * kind.factors[unit or kind.plain])
    return numbers


def _number(text: str, kind: QuantityKind) -> tuple[Fraction, str]:
    match = _NUMBER.fullmatch(text)
    units = ", ".join(dict.fromkeys(unit for unit in kind.factors if unit.isascii()))
    if match is None:
        if _NOT_FINITE.fullmatch(text):
            raise InvalidRange(f"{kind.name} {text}: must be a finite number")
        how = f", in {kind.plain} or with a unit ({units})" if kind.plain else ""
        raise InvalidRange(f"{kind.name} {text or 'empty'}: must be a number{how}")
    unit = match[2]
    if unit and unit not in kind.factors:
        raise InvalidRange(
            f"{kind.name} {text}: unknown unit {unit!r}; write {f'one of {units}' if kind.plain else 'none'}"
        )
    number = Decimal(match[1])
    if number and abs(number.adjusted()) > _LARGEST_EXPONENT:
        raise InvalidRange(
            f"{kind.name} {text}: must be between 1e-{_LARGEST_EXPONENT} and 1e{_LARGEST_EXPONENT}"
        )
    return Fraction(number), unit


def _check_order(start: Fraction, stop: Fraction, text: str, kind: QuantityKind) -> None:
    if stop == start:
        raise InvalidRange(f"{kind.name} {text}: the end must be > the start; write one value instead")
    if stop < start:
        raise InvalidRange(
            f"{kind.name} {text}: end {_say(stop, kind)} must be > start {_say(start, kind)}; swap them"
        )


def _bounded(number: Fraction, kind: QuantityKind) -> float:
    result = float(number)
    bounds = (
        (kind.above is not None and not result > kind.above, ">", kind.above),
        (kind.at_least is not None and not result >= kind.at_least, ">=", kind.at_least),
        (kind.below is not None and not result < kind.below, "<", kind.below),
    )
    for broken, sign, bound in bounds:
        if broken:
            raise InvalidRange(f"{kind.name} {_say(number, kind)}: must be {sign} {bound:g}")
    return result


def _say(number: Fraction | float, kind: QuantityKind) -> str:
    return f"{float(number) / float(kind.factors[kind.plain]):.12g} {kind.plain}".rstrip()
