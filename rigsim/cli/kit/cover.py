"""Options of one's own report."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer


@dataclass(frozen=True, slots=True)
class CoverWords:
    """The options of the report's head, as typed."""

    title: Annotated[str, typer.Option(help="Title of the report, in place of its own.")] = ""
    note: Annotated[str, typer.Option(help="A paragraph of the report: whom it is for.")] = ""
    logo: Annotated[
        Path | None, typer.Option(metavar="FILE", help="A picture at its head: PNG or SVG, up to 500 kB.")
    ] = None

    def said(self) -> dict[str, Any]:
        """As `rigsim.sweep` and `rigsim.design` take them."""
        return {"title": self.title, "note": self.note, "logo": self.logo}
