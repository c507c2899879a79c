"""The size of the pictures: the lens stays, and its focal length in px grows with the width.

A camera one can buy has its own lens in a mode of that size, where one is published.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rigsim.errors import InvalidRange
from rigsim.study.scene.axes.axis import Axis
from rigsim.study.scene.column import Column

if TYPE_CHECKING:
    from rigsim.rig.intrinsics import Intrinsics
    from rigsim.rig.remark import Remark
    from rigsim.rig.stereo import StereoRig
    from rigsim.study.scene.recipe import Recipe

_SAME_SHAPE = 0.01
"""By which shapes may differ: 848x480 is taken for 16:9."""


def _change(recipe: Recipe, size: tuple[int, int]) -> Recipe:
    from rigsim.rig.presets import published_lens

    published = published_lens(recipe.base, *size)
    return recipe.lenses(lambda lens: _behind(lens, *size) if published is None else published)


def shape_remark(rig: StereoRig, width: int, height: int) -> Remark | None:
    """What becomes of pictures that get another shape; None where they keep theirs, or have a mode of it."""
    from rigsim.rig.presets import published_lens
    from rigsim.rig.remark import Remark

    own = rig.left
    rows = own.height * width / own.width
    if abs(height / rows - 1) <= _SAME_SHAPE or published_lens(rig, width, height) is not None:
        return None
    done = f"cut by {rows - height:.0f} rows" if height < rows else f"grown by {height - rows:.0f} rows"
    return Remark(
        "shape",
        f"--resolution {width}x{height} has another shape than the rig's {own.width}x{own.height} px: the "
        f"picture is scaled to {width} px across, {own.hfov_deg:.3g} deg as before, and {done}, half of them "
        f"above; --crop X,Y,W,H says what is cut out instead, --resize {width}x{height} squeezes it all in",
    )


def _behind(lens: Intrinsics, width: int, height: int) -> Intrinsics:
    """The lens behind another pixel grid; the principal point keeps its place."""
    if width < 1 or height < 1:
        raise InvalidRange(f"resolution {width}x{height}: both sides must be >= 1 px")
    # square growth: the width sets the scale, the height is cropped or extended evenly
    scale = width / lens.width
    return replace(
        lens,
        width=width,
        height=height,
        fx=lens.fx * scale,
        fy=lens.fy * scale,
        cx=(lens.cx - (lens.width - 1) / 2) * scale + (width - 1) / 2,
        cy=(lens.cy - (lens.height - 1) / 2) * scale + (height - 1) / 2,
    )


AXIS = Axis(
    name="resolution",
    columns=(
        Column("width_px", "image width", "px", "short", "Image width, px.", empty=False, whole=True),
        Column("height_px", "image height", "px", "short", "Image height, px.", empty=False, whole=True),
    ),
    word="image width",
    read=lambda row: (row.rig.left.width, row.rig.left.height),
    help="Image sizes: 640x480,1280x960.",
    help_one="Image size, px: 1280x960.",
    metavar="WxH",
    of_rig=_change,
    loop=0,
    field="resolutions_px",
)
