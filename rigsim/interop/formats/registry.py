"""Every calibration format. A new one is a file here and a line below; what reads and writes follows."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

from rigsim.errors import InvalidRange, InvalidRig
from rigsim.interop.formats import (
    colmap,
    middlebury,
    mjcf,
    nerfstudio,
    rig_toml,
)
from rigsim.interop.formats.format import Format
from rigsim.interop.formats.kitti import kitti
from rigsim.interop.formats.makers import matlab, oak, realsense, zed
from rigsim.interop.formats.opencv import calibration as opencv
from rigsim.interop.formats.photogrammetry import anipose, metashape, mrcal
from rigsim.interop.formats.robotics import basalt, euroc, kalibr, ros
from rigsim.interop.formats.slam import ncamera, okvis, orbslam, vins
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.study.export.approximate import nearest_rig

ALL: tuple[Format, ...] = (
    rig_toml.FORMAT,
    opencv.FORMAT,
    ros.FORMAT,
    kalibr.FORMAT,
    basalt.FORMAT,
    euroc.FORMAT,
    vins.FORMAT,
    okvis.FORMAT,
    ncamera.FORMAT,
    orbslam.FORMAT,
    middlebury.FORMAT,
    kitti.FORMAT,
    colmap.FORMAT,
    mjcf.FORMAT,
    nerfstudio.FORMAT,
    oak.FORMAT,
    realsense.FORMAT,
    zed.FORMAT,
    matlab.FORMAT,
    mrcal.FORMAT,
    metashape.FORMAT,
    anipose.FORMAT,
)
"""All that are read."""

RIG_FORMATS: Mapping[str, Callable[[StereoRig], Mapping[str, str]]] = MappingProxyType(
    {format.name: format.write for format in ALL if format.write is not None}
)
"""Those that are written, by name; each turns a rig into texts by file name, or raises `InvalidRig`."""

OURS_ALONE = "none but rig.toml (rigsim.write_rig)"
"""Which formats hold a rig, where none that is written does."""


def rig_files(rig: StereoRig, format: str) -> dict[str, bytes]:
    """The calibration files of `rig` in a format of `RIG_FORMATS`, by name.

    Raises:
        InvalidRange: there is no such format.
        InvalidRig: the format cannot hold the rig; the message names those that can.
    """
    if format not in RIG_FORMATS:
        raise InvalidRange(f"format {format!r}: must be one of {', '.join(RIG_FORMATS)}")
    try:
        texts = RIG_FORMATS[format](rig)
    except InvalidRig as error:
        able = ", ".join(name for name in RIG_FORMATS if _holds(name, rig)) or OURS_ALONE
        straight = StereoRig(replace(rig.left, lens=None), replace(rig.right, lens=None), rig.right_from_left)
        or_fit = "; or fit its nearest lens with --approximate" if _holds(format, straight) else ""
        raise InvalidRig(f"format {format}: {error}; formats that hold this rig: {able}{or_fit}") from None
    return {name: text.encode() for name, text in texts.items()}


def approximate_files(rig: StereoRig, format: str) -> tuple[dict[str, bytes], tuple[Remark, ...]]:
    """As `rig_files`, with the nearest lenses that the format has where it lacks the rig's own.

    The remarks tell how far the pixels are off.

    Raises:
        InvalidRange: there is no such format.
        InvalidRig: the format cannot hold the rig, or has no lens that shows what the rig's do.
    """
    if format not in RIG_FORMATS or _holds(format, rig):
        return rig_files(rig, format), ()
    found = nearest_rig(rig, lambda other: _holds(format, other))
    if found is None:
        try:
            rig_files(rig, format)
        except InvalidRig as error:
            why = str(error).partition("; or fit its nearest lens")[0]
            raise InvalidRig(f"{why}; no lens that it has shows all that these do") from None
    assert found is not None
    fitted, both = found
    remarks = tuple(
        Remark(
            "approximate",
            f"the {side} lens, {_called(own)}, was fitted by {_called(fit.camera)}: off by"
            f" {fit.rms_px:.2g} px rms over the image, {fit.largest_px:.2g} px at most",
        )
        for side, own, fit in zip(("left", "right"), (rig.left, rig.right), both, strict=True)
        if fit.camera is not own
    )
    return rig_files(fitted, format), remarks


def _called(camera: Intrinsics) -> str:
    return "pinhole" if camera.lens is None else camera.lens.model


def _holds(format: str, rig: StereoRig) -> bool:
    try:
        RIG_FORMATS[format](rig)
    except InvalidRig:
        return False
    return True
