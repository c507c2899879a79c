"""What the page asks of the renderer, and what it gets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeAlias

from rigsim.rig.arrays import Light
from rigsim.rig.stereo import StereoRig

Overlay: TypeAlias = Literal["none", "anaglyph", "disparity", "error"]
"""What may be laid over the left picture."""


@dataclass(frozen=True, slots=True)
class PairRequest:
    """A stereo pair that somebody wants to see."""

    rig: StereoRig
    """The rig that is assumed: depth, disparity and error are of it."""
    scene: str = "boards"
    """A bundled scene's name, or the path of an MJCF file."""
    size: tuple[int, int] | None = None
    """Width and height that are drawn, px; None for the rig's own (at most 1.3 million pixels), or 320 px of
    width when `coarse`."""
    coarse: bool = False
    """Drawn at once, without shadows and with one sample a pixel."""
    overlay: Overlay = "none"
    """The overlay that is wanted."""
    noise_px: float = 0.25
    """Standard deviation of one pixel coordinate in the rig's own pictures, px."""
    built: StereoRig | None = None
    """The rig that takes the pictures, where it is another than the one assumed."""


class Legend(NamedTuple):
    """What the colours of an overlay mean."""

    low: float
    """Value at the dark end."""
    high: float
    """Value at the bright end."""
    unit: str
    """Unit of both."""
    words: str
    """What is shown."""


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """A stereo pair, ready to be shown."""

    left: bytes
    """Left picture, JPEG."""
    right: bytes
    """Right picture, JPEG."""
    width: int
    """Of the pictures as drawn, px."""
    height: int
    """Of the pictures as drawn, px."""
    coarse: bool
    """Whether it was drawn at once, and a better one may follow."""
    overlay_image: bytes | None
    """PNG or JPEG of the left picture's size; None where none was asked for."""
    legend: Legend | None
    """What the overlay's colours mean; None where they have no scale."""
    depth_m: Light
    """Depth of each left pixel, (H, W), m; NaN for nothing. Read-only, as are the other arrays."""
    disparity_px: Light
    """``u_left - u_right`` in pixels of the rig's own pictures, whatever was drawn, (H, W); NaN where the
    right camera does not see the point."""
    depth_std_m: Light
    """Expected standard deviation of the depth, (H, W), m; NaN where the right camera does not see it."""
    seconds: float
    """From the request's arrival at the renderer to the end of the work, s."""
    remarks: tuple[str, ...]
    """What a person should know of the scene and the rig's place in it."""


@dataclass(frozen=True, slots=True)
class Failed:
    """Why there is no answer."""

    text: str
    """One line: the value, the bound and the way out."""
