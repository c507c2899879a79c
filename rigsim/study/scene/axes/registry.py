"""Every axis of a sweep, in the order of their columns. A new one is a file here, an import and a line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from rigsim.study.scene.axes import (
    baseline,
    focal,
    hfov,
    noise,
    resolution,
    sensor,
    triangulator,
    vergence,
)
from rigsim.study.scene.axes.axis import Axis
from rigsim.study.scene.axes.right_camera import forward, pitch, roll, vertical, yaw

if TYPE_CHECKING:
    from rigsim.rig.noise import PixelNoise
    from rigsim.study.scene.axes.configuration import Configuration

ALL: tuple[Axis, ...] = (
    baseline.AXIS,
    focal.AXIS,
    hfov.AXIS,
    resolution.AXIS,
    vergence.AXIS,
    yaw.AXIS,
    pitch.AXIS,
    roll.AXIS,
    vertical.AXIS,
    forward.AXIS,
    noise.AXIS,
    triangulator.AXIS,
    sensor.AXIS,
)
"""What can be varied."""

BY_NAME: Mapping[str, Axis] = MappingProxyType({axis.name: axis for axis in ALL})
"""The same by name."""

OF_COLUMN: Mapping[str, Axis] = MappingProxyType(
    {column.name: axis for axis in ALL for column in axis.columns}
)
"""The axis of each of their columns."""

OF_RIG: tuple[Axis, ...] = tuple(
    sorted((axis for axis in ALL if axis.of_rig is not None), key=lambda axis: axis.loop)
)
"""Those that change the rig, in the order of their loops."""

OF_NOISE: tuple[Axis, ...] = tuple(axis for axis in ALL if axis.of_noise is not None)
"""Those that change the noise."""


def values(configuration: Configuration) -> dict[str, Any]:
    """The axes' columns of one row."""
    return {
        column.name: value
        for axis in ALL
        for column, value in zip(axis.columns, axis.read(configuration), strict=True)
    }


def noises(given: Mapping[str, Sequence[float]]) -> tuple[PixelNoise, ...]:
    """Every noise that values of the noise axes, by name, ask for; the axes multiply."""
    from rigsim.rig.noise import PixelNoise

    found: tuple[PixelNoise, ...] = (PixelNoise(float(noise.AXIS.default or 0)),)
    for axis in OF_NOISE:
        if axis.of_noise is not None and given.get(axis.name):
            found = tuple(axis.of_noise(one, value) for one in found for value in given[axis.name])
    return found
