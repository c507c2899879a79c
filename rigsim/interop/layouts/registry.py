"""Every layout of data sets. A new one is a file here and a line below; what writes and lists follows."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from rigsim.interop.layouts import colmap, kitti, middlebury, opencv
from rigsim.interop.layouts.layout import Layout

ALL: tuple[Layout, ...] = (
    middlebury.LAYOUT,
    kitti.LAYOUT,
    opencv.LAYOUT,
    colmap.LAYOUT,
)
"""All layouts."""

BY_NAME: Mapping[str, Layout] = MappingProxyType({layout.name: layout for layout in ALL})
"""The same by name."""
