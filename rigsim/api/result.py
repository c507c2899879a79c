"""What every function of `rigsim` returns."""

from __future__ import annotations

import html
import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, cast

from rigsim.errors import InvalidRange
from rigsim.rig import given

if TYPE_CHECKING:
    from rigsim.interop.documents.base import Written
    from rigsim.present.kit.types import Figure, Table
    from rigsim.rig.remark import Remark
    from rigsim.study.golden.compare import GoldenReport

_MOST_ROWS = 30


class Result(ABC):
    """An answer: a table, a verdict, figures, files and a JSON document."""

    __slots__ = ()

    @property
    @abstractmethod
    def table(self) -> Table:
        """The numbers: a pandas DataFrame, units in the columns' names."""

    @property
    @abstractmethod
    def verdict(self) -> object:
        """What is concluded, as a value."""

    @property
    @abstractmethod
    def headline(self) -> str:
        """The answer in one sentence."""

    @property
    @abstractmethod
    def remarks(self) -> tuple[Remark, ...]:
        """What is odd about what was asked, each said once."""

    @property
    @abstractmethod
    def figures(self) -> Mapping[str, Callable[[], Figure]]:
        """What draws each figure, by name; the main one first."""

    @abstractmethod
    def files(self) -> dict[str, bytes]:
        """Name to content of what `write` writes."""

    @abstractmethod
    def document(self, written: Written | None = None) -> Mapping[str, Any]:
        """What `to_json` says, as JSON values.

        Args:
            written: what `write` returned, for documents that name their files.
        """

    @abstractmethod
    def print(self, folder: Path | None = None) -> None:
        """Print what the command line prints for people; `folder` is where the files were written."""

    def holding(self, golden: GoldenReport) -> Self:
        """The same, with what came of a comparison with golden results, which `document` and `print` tell.

        Only of results that have a `golden`.
        """
        return cast(Self, replace(cast(Any, self), golden=golden))

    def figure(self, name: str = "") -> Figure:
        """Draw a figure, as a matplotlib Figure.

        Args:
            name: one of `figures`; the first one by default.

        Raises:
            InvalidRange: there is no figure of that name.
        """
        drawers = self.figures
        if not drawers:
            raise InvalidRange("figure: there is nothing to draw here")
        chosen = name or next(iter(drawers))
        if chosen not in drawers:
            raise InvalidRange(f"figure {given.shown(name)}: choose one of {', '.join(drawers)}")
        return drawers[chosen]()

    def write(self, folder: str | os.PathLike[str], force: bool = False) -> Written:
        """Write the files that the command line's ``--out`` writes.

        Args:
            folder: made with its parents when missing.
            force: replace files that are there.

        Returns:
            The folder, and the files' names.

        Raises:
            OutputError: the folder cannot be written, or is not empty without `force`.
        """
        from rigsim.interop.documents.base import Written
        from rigsim.interop.files.folder import write_folder

        path = given.path(folder, "output folder")
        files = self.files()
        write_folder(path, files, force)
        return Written(folder=str(path), files=sorted(files))

    def to_json(self, written: Written | None = None) -> str:
        """The document that the command line's ``--json`` prints.

        Args:
            written: what `write` returned, for documents that name their files.
        """
        from rigsim.interop.documents.text import json_text

        return json_text(self.document(written))

    def _repr_html_(self) -> str:
        """The answer and the table, for notebooks."""
        said = [self.headline, *(remark.text for remark in self.remarks)]
        paragraphs = "".join(f"<p>{html.escape(text.replace('`', ''))}</p>" for text in said)
        return paragraphs + str(self.table.to_html(max_rows=_MOST_ROWS, index=False))
