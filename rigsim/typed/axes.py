"""The numbers of the axes that were typed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rigsim.study.scene.axes import registry
from rigsim.study.scene.axes.axis import Axis
from rigsim.typed import quantity


def numbers_of(typed: Mapping[str, str], axes: Sequence[Axis]) -> dict[str, tuple[float, ...]]:
    """The numbers of those of `axes` that were typed, by name, in the unit of their kind.

    Raises:
        InvalidRange: a value cannot be read, or is out of bounds.
    """
    return {
        axis.name: quantity.values(typed[axis.name], axis.kind)
        for axis in axes
        if axis.kind is not None and axis.name in typed
    }


def values_of(typed: Mapping[str, str], axes: Sequence[Axis]) -> dict[str, tuple[float, ...]]:
    """The same as the axes take them."""
    return {
        name: tuple(value * registry.BY_NAME[name].scale for value in values)
        for name, values in numbers_of(typed, axes).items()
    }
