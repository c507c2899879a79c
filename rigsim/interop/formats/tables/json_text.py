"""JSON as calibration programs write it."""

from __future__ import annotations

import json

from rigsim.errors import InvalidRig
from rigsim.interop.formats.values import clipped


def json_table(text: str) -> dict[str, object]:
    """The table that a JSON text holds.

    Raises:
        InvalidRig: it is no JSON, or no table.
    """
    try:
        found = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InvalidRig(f"is not JSON: {clipped(str(error))}") from None
    if not isinstance(found, dict):
        raise InvalidRig("is no calibration: must be a table of names and values")
    return found
