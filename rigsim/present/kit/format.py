"""Numbers as a person writes them: few digits, a unit, no nine-digit tails."""

from __future__ import annotations

import math

MISSING = "–"
"""What stands where there is no number."""
_NEGLIGIBLE = 1e-4
_ROUNDING = 1e-9


def number(value: float, digits: int = 3) -> str:
    """`value` with `digits` significant digits, trailing zeros kept: ``9.80``, ``0.0123``, ``12,346``.

    Whole digits are never rounded away; below 0.0001 the number is ``≈ 0``, without one it is a dash.
    """
    value = float(value)
    if not math.isfinite(value):
        return MISSING
    if value == 0:
        return "0"
    if abs(value) < _NEGLIGIBLE:
        return "≈ 0"
    decimals = _decimals(value, digits)
    decimals = _decimals(round(value, decimals), digits)  # 9.996 becomes 10.0, not 10.00
    return _typeset(f"{value:.{decimals}f}")


def fixed(value: float, decimals: int) -> str:
    """`value` with so many decimals, whatever its size: ``2571.4``."""
    return _typeset(f"{value:.{decimals}f}") if math.isfinite(value) else MISSING


def plain(value: float, digits: int = 5) -> str:
    """`value` as short as it can be said: ``120``, ``0.25``, ``882.5``; for parameters and ticks."""
    value = float(value)
    if not math.isfinite(value):
        return MISSING
    if value == 0:
        return "0"
    decimals = min(_decimals(value, digits), 8)
    text = f"{value:.{decimals}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return _typeset(text)


def length_mm(value_mm: float, digits: int = 3) -> str:
    """A length given in mm, in the unit that suits it: ``12.0 µm``, ``9.80 mm``, ``1.24 m``."""
    if not math.isfinite(value_mm):
        return MISSING
    size = abs(round(value_mm, 6))
    if size >= 999.5:
        return f"{number(value_mm / 1e3, digits)} m"
    if size >= 0.1 or size < _NEGLIGIBLE:
        return f"{number(value_mm, digits)} mm"
    return f"{number(value_mm * 1e3, digits)} µm"


def length(value_m: float, digits: int = 3) -> str:
    """A length given in m, in the unit that suits it."""
    return length_mm(value_m * 1e3, digits)


def lengths_within(value_m: float, low_m: float, high_m: float) -> tuple[str, str, str]:
    """A length given in m and the ends of its interval, all in the unit that suits it, to the digits that
    `with_interval` shows."""
    unit = length(value_m).rpartition(" ")[2] if math.isfinite(value_m) else ""
    if not unit or not math.isfinite(high_m - low_m):
        return length(value_m), length(low_m), length(high_m)
    scale = {"m": 1.0, "mm": 1e3, "µm": 1e6}[unit]
    shown, low, high = with_interval(value_m * scale, low_m * scale, high_m * scale)
    return f"{shown} {unit}", f"{low} {unit}", f"{high} {unit}"


def percent(fraction: float) -> str:
    """A share as a percentage without its sign: ``98.7``; 100 and 0 are said only when exact."""
    value = 100 * float(fraction)
    if not math.isfinite(value):
        return MISSING
    if 0 < value < 0.05:
        return "< 0.1"
    if 99.95 <= value < 100:
        return "> 99.9"
    return "100" if value == 100 else "0" if value == 0 else _typeset(f"{value:.1f}")


def sampled_percent(n_good: int, n: int) -> str:
    """A share of samples as a percentage without its sign: three digits, or what sampling leaves; 0 and
    100 only where all agree."""
    share = n_good / n
    if 0 < share < 0.0005:
        return "< 0.1"
    if 0.9995 <= share < 1:
        return "> 99.9"
    error = math.sqrt(share * (1 - share) / n)
    return min(f"{100 * share:.3g}", to_error(100 * share, 100 * error), key=len)


def ratio(value: float) -> str:
    """A ratio near one, three decimals: ``1.003``."""
    return _typeset(f"{value:.3f}") if math.isfinite(value) else MISSING


def count(value: float) -> str:
    """A whole number with its thousands apart: ``2,000``."""
    return _typeset(f"{value:.0f}", group_from=4) if math.isfinite(value) else MISSING


def to_error(value: float, error: float) -> str:
    """`value` to the decimal place of the second significant digit of its uncertainty: ``1.0031`` for 0.0030.

    Whole digits are never rounded away. Three digits where there is no uncertainty to go by: none, zero, or
    lost in rounding.
    """
    value = float(value)
    if not math.isfinite(value):
        return MISSING
    decimals = _error_decimals(value, error)
    return number(value) if decimals is None else _rounded(value, decimals)


def with_error(value: float, error: float) -> str:
    """A value and its standard error, to two significant digits of that: ``1.0031 ± 0.0030``."""
    if not (math.isfinite(value) and math.isfinite(error)):
        return MISSING
    decimals = _error_decimals(value, error)
    return f"{to_error(value, error)} ± {'0' if decimals is None else _rounded(error, decimals)}"


def with_interval(value: float, low: float, high: float) -> tuple[str, str, str]:
    """A value and the ends of its interval, to two significant digits of half its width: ``0.362``,
    ``0.299``, ``0.438``."""
    half = (high - low) / 2
    return to_error(value, half), to_error(low, half), to_error(high, half)


def _error_decimals(value: float, error: float) -> int | None:
    """Decimals that show two significant digits of `error`; None where it is none."""
    if not (math.isfinite(error) and error > _ROUNDING * max(abs(value), _ROUNDING)):
        return None
    decimals = _decimals(error, 2)
    return _decimals(round(error, decimals), 2)  # 0.0996 is 0.10, not 0.100


def _rounded(value: float, decimals: int) -> str:
    text = _typeset(f"{value:.{decimals}f}")
    return text if text.strip("−0.") else text.removeprefix("−")  # nothing has no sign


def _decimals(value: float, digits: int) -> int:
    return 0 if value == 0 else max(digits - 1 - math.floor(math.log10(abs(value))), 0)


def _typeset(text: str, group_from: int = 5) -> str:
    """A true minus sign, and groups of three once there are `group_from` whole digits."""
    sign, text = ("−", text[1:]) if text.startswith("-") else ("", text)
    whole, point, rest = text.partition(".")
    if len(whole) >= group_from:
        whole = f"{int(whole):,}"
    return sign + whole + point + rest
