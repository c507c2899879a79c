"""Documents as strict JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

DIGITS = 15
"""As many significant digits as every double keeps: 70.00000000000001 is 70."""


def json_text(document: Mapping[str, Any], encoding: str = "utf-8") -> str:
    """A document as indented JSON that every parser reads: null for NaN and for what is infinite, and the 15
    significant digits of a number that mean something.

    Args:
        document: mappings, sequences, text, numbers (numpy's too), None.
        encoding: what the text will be written in; what it cannot hold is escaped.
    """
    values = _plain(document)
    text = json.dumps(values, indent=2, ensure_ascii=False, allow_nan=False)
    try:
        text.encode(encoding)
    except UnicodeEncodeError:
        return json.dumps(values, indent=2, allow_nan=False)
    return text


def clean(value: float, digits: int = 12) -> float:
    """Without the rounding noise after so many significant digits, such as 1000 times metres leaves."""
    return float(f"{value:.{digits}g}")


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if hasattr(value, "tolist"):  # numpy's arrays and scalars
        return _plain(value.tolist())
    if isinstance(value, float):
        return clean(value, DIGITS) if math.isfinite(value) else None
    return value
