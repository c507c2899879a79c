"""The lens tables of rig.toml, one for each model of the registry of lenses, made from its coefficients."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, fields
from decimal import Decimal
from functools import reduce
from operator import or_
from types import MappingProxyType
from typing import Annotated, Any

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    GetCoreSchemaHandler,
    Tag,
    create_model,
)

from rigsim.rig.lens import registry
from rigsim.rig.lens.lens import Lens

LARGEST = 10**12
"""Bound of every number, far beyond any rig."""


def _number(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, int | Decimal):
        raise ValueError("must be a number")
    number = Decimal(value)
    if not number.is_finite() or abs(number) > LARGEST:
        raise ValueError(f"must be a finite number within +-{LARGEST:g}")
    return number


Number = Annotated[Decimal, BeforeValidator(_number)]
"""A number of a rig.toml."""


class TomlTable(BaseModel):
    """A table of a rig.toml: no key but its own."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class LensTable(TomlTable):
    """The coefficients of a lens."""

    model: str = registry.DEFAULT

    def lens(self) -> Lens:
        """The lens they are of."""
        terms = {name: float(value) for name, value in self if name != "model"}
        return registry.BY_NAME[self.model](**terms)


def _known(value: object) -> object:
    raise ValueError(f"must be one of {', '.join(registry.BY_NAME)}")


class _Unknown(LensTable):
    """Of a model that no file of the registry is: refused, whatever else it says."""

    model_config = ConfigDict(extra="ignore", frozen=True)
    model: Annotated[str, BeforeValidator(_known)] = ""


def _table(lens: type[Lens]) -> type[LensTable]:
    terms: dict[str, Any] = {
        field.name: (Number, ... if field.default is MISSING else Decimal(repr(field.default)))
        for field in fields(lens)
    }
    return create_model(f"{lens.__name__}Table", __base__=LensTable, **terms)


TABLES: Mapping[str, type[LensTable]] = MappingProxyType(
    {**{name: _table(lens) for name, lens in registry.BY_NAME.items()}, "": _Unknown}
)
"""The table of each model, by name; of no name, that of models that are unknown."""


class _OfItsModel:
    """Reads a lens table as the one of the model that it names."""

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> Any:
        choices: list[Any] = [Annotated[table, Tag(name)] for name, table in TABLES.items()]
        return handler.generate_schema(Annotated[reduce(or_, choices), Discriminator(_model_of)])


def _model_of(value: object) -> str:
    named = value.get("model", registry.DEFAULT) if isinstance(value, Mapping) else registry.DEFAULT
    return named if isinstance(named, str) and named in registry.BY_NAME else ""


AnyLens = Annotated[LensTable, _OfItsModel()]
"""A field with a lens table; in the path of an error its model stands after the field's name."""
