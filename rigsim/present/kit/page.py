"""What every page is made with."""

from __future__ import annotations

import re
from typing import Any

from markupsafe import Markup, escape


def flat(values: dict[str, Any], prefix: str = "") -> list[tuple[str, str]]:
    """Nested JSON values as (name, text) pairs."""
    pairs: list[tuple[str, str]] = []
    for name, value in values.items():
        if isinstance(value, dict):
            pairs += flat(value, f"{prefix}{name} ")
        elif isinstance(value, list | tuple):
            pairs.append((prefix + name, (" " if name == "command" else ", ").join(map(str, value))))
        else:
            pairs.append((prefix + name, "–" if value is None else str(value)))
    return pairs


def prose(text: str) -> Markup:
    """Escaped text in which `words` between backticks are set as code."""
    return Markup(re.sub(r"`([^`]*)`", r"<code>\1</code>", str(escape(text))))
