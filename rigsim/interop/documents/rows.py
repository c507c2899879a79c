"""Rows of documents, made from the tables of columns that files and pages are made from."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Literal

from pydantic import Field, create_model

from rigsim.interop.documents.base import Part
from rigsim.study.scene.column import Column


def row_model(name: str, says: str, columns: Iterable[Column], base: type[Part] = Part) -> type[Part]:
    """A model with a key for each column: its type, whether it may be null, and its meaning.

    Args:
        name: of the model.
        says: what a row is.
        columns: the keys, in order.
        base: the model whose keys come first.
    """
    fields: dict[str, Any] = {}
    for column in columns:
        kind: Any = {"text": str, "count": int}.get(column.format, int if column.whole else float)
        if column.words:
            kind = Literal[column.words]
        fields[column.name] = (
            kind | None if column.empty else kind,
            Field(description=column.meaning, pattern=column.pattern or None, gt=column.above),
        )
    model: type[Part] = create_model(name, __base__=base, __doc__=says, __module__=__name__, **fields)
    return model
