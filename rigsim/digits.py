"""Numbers in sentences: a few digits, never a power of ten."""

from __future__ import annotations

from decimal import Decimal


def short(value: float, digits: int = 3) -> str:
    """`value` with at most `digits` significant digits, as ``g`` writes it, but ``290`` for ``2.9e+02``.

    Whole digits are never rounded away: ``1234`` with three digits, too.
    """
    text = f"{value:.{digits}g}"
    if "e" not in text:
        return text
    return f"{value:.0f}" if abs(value) >= 1 else f"{Decimal(text):f}"


def length(length_mm: float, digits: int = 3) -> str:
    """A length given in mm: in mm, or in m from 1 m on, by what is printed: ``1 m`` for 999.9."""
    if abs(float(f"{length_mm:.{digits}g}")) >= 1000:
        return f"{short(length_mm / 1e3, digits)} m"
    return f"{short(length_mm, digits)} mm"
