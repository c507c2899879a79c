"""What every page is made with: one environment, one writer of paragraphs, pictures within the page."""

from __future__ import annotations

import base64
import re
from dataclasses import dataclass
from functools import cache
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from rigsim.present.kit.pictures import encode
from rigsim.rig.arrays import AnyImage

_PICTURE_WIDTH = 1100
_MOST_PICTURE_BYTES = 1_000_000


@dataclass(frozen=True, slots=True)
class Cover:
    """The head of a report; empty where nothing is its own."""

    title: str = ""
    """In place of the page's title."""
    note: str = ""
    """A paragraph under the answer: whom it is for, what it belongs to."""
    logo: bytes = b""
    """A picture, PNG or SVG."""
    logo_type: str = ""
    """Its media type."""

    @property
    def logo_uri(self) -> str:
        """The logo within the page; as a picture, whose scripts and links no browser follows."""
        if not self.logo:
            return ""
        return f"data:{self.logo_type};base64,{base64.b64encode(self.logo).decode('ascii')}"


@cache
def environment() -> Environment:
    """Where the templates are and how they are filled in: text escaped, what is missing an error."""
    made = Environment(
        loader=PackageLoader("rigsim.present"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters["prose"] = prose
    return made


def fill(template: str, **values: Any) -> str:
    """The page that a template becomes."""
    return environment().get_template(template).render(**values)


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
    """Escaped text, with true signs, in which `words` between backticks are set as code."""
    signs = text.replace("<=", "≤").replace(">=", "≥")
    return Markup(re.sub(r"`([^`]*)`", r"<code>\1</code>", str(escape(signs))))


def data_uri(image: AnyImage) -> str:
    """The image as an embedded JPEG, made smaller until it is fit for a page."""
    width = _PICTURE_WIDTH
    data = encode(image, "jpeg", width=width)
    while len(data) > _MOST_PICTURE_BYTES and width > 300:
        width = width * 3 // 4
        data = encode(image, "jpeg", width=width)
    return "data:image/jpeg;base64," + base64.b64encode(data).decode("ascii")
