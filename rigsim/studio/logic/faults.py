"""Errors in the words of the page: they are made for the command line, and name its options."""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType

LABELS: Mapping[str, str] = MappingProxyType(
    {
        "baseline": "Baseline",
        "focal": "Focal length",
        "hfov": "Field of view",
        "resolution": "Image size",
        "principal": "Principal point",
        "pixel-pitch": "Pixel pitch",
        "sensor-width": "Sensor width",
        "noise": "Noise",
        "rig": "a rig's file",
        "preset": "a preset",
        "range": "Working range",
    }
)
"""What the page calls the command line's options."""
_OPTION = re.compile(r"--([a-z][a-z-]*)")


def plain(text: str) -> str:
    """An error with the page's labels in place of options; it begins with a capital."""
    said = _OPTION.sub(lambda match: LABELS.get(match[1], match[1].replace("-", " ")), text)
    return said[:1].upper() + said[1:]
