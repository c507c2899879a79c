"""Documents as strict JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any, Final, Literal

COVARIANCE: Final[Literal["calibration-covariance"]] = "calibration-covariance"
"""The ``kind`` of what other commands compute with: its numbers keep every digit."""
DIGITS = 15
"""As many significant digits as every double keeps: 70.00000000000001 is 70."""


_EVERY_DIGIT = 17


def json_text(document: Mapping[str, Any], encoding: str = "utf-8") -> str:
    """A document as indented JSON that every parser reads: null for NaN and for what is infinite, and the 15
    significant digits of a number that mean something; all of them in a part whose ``kind`` is `COVARIANCE`.

    Args:
        document: mappings, sequences, text, numbers (numpy's too), None.
        encoding: what the text will be written in; what it cannot hold is escaped.
    """
    values = _plain(document, DIGITS)
    text = json.dumps(values, indent=2, ensure_ascii=False, allow_nan=False)
    try:
        text.encode(encoding)
    except UnicodeEncodeError:
        return json.dumps(values, indent=2, allow_nan=False)
    return text


def clean(value: float, digits: int = 12) -> float:
    """Without the rounding noise after so many significant digits, such as 1000 times metres leaves."""
    return float(f"{value:.{digits}g}")


def _plain(value: Any, digits: int) -> Any:
    if isinstance(value, Mapping):
        kept = _EVERY_DIGIT if value.get("kind") == COVARIANCE else digits
        return {key: _plain(item, kept) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item, digits) for item in value]
    if hasattr(value, "tolist"):  # numpy's arrays and scalars
        return _plain(value.tolist(), digits)
    if isinstance(value, float):
        return clean(value, digits) if math.isfinite(value) else None
    return value
