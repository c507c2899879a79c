"""What a person says beside a calibration's files, and what came of reading them."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass, replace
from pathlib import Path

from rigsim.errors import InvalidRange, InvalidRig
from rigsim.interop.formats.format import Asked, File, Found, swapped
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import PixelGrid, StereoRig
from rigsim.study.rig.remarks import remarks_of_rig
from rigsim.study.rig.shape import sides_exchanged

_UNITS_M = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "in": 0.0254}
_LENGTH = re.compile(r"\s*(\d+\.?\d*|\.\d+)?\s*(mm|cm|m|in)\s*", re.IGNORECASE)
AS_IT_IS = PixelGrid()
"""Pictures to which nothing is done."""
_LEAST_M, _MOST_M = 1e-3, 5.0
"""Baselines that a rig on a table has, m: beyond them the unit must be said."""
_SHORT_M, _LONG_M = 1e-2, 1.0
"""Baselines that most rigs have, m: beyond them the unit is worth a word."""


def metres(unit: str) -> float:
    """What one of the file's lengths is, m: of ``mm``, ``cm``, ``m``, ``in``, or the side of a square.

    Raises:
        InvalidRange: it is none of these.
    """
    found = _LENGTH.fullmatch(unit) if isinstance(unit, str) and len(unit) < 30 else None
    count = float(found[1] or 1) if found else 0.0
    if found is None or not 0 < count < 1e6:
        raise InvalidRange(
            f"rig unit {str(unit)[:30]!r}: must be mm, cm, m or in, or the side of a board's squares, as 25mm"
        )
    return count * _UNITS_M[found[2].lower()]


@dataclass(frozen=True, slots=True)
class RigReading:
    """What a person says beside the files; None where nothing was said."""

    unit: str | None = None
    """Unit of the file's lengths: ``mm``, ``cm``, ``m``, ``in``, or ``25mm`` for squares of 25 mm."""
    size_px: tuple[int, int] | None = None
    """Image size, width and height, px, of a file that has none."""
    swap: bool = False
    """Whether the file's left camera is the right one."""
    cameras: tuple[str, str] | None = None
    """Names of the left and the right camera, of a file with more than two."""
    mode: str | None = None
    """Which of a file's modes, as ``HD``."""
    grid: PixelGrid = AS_IT_IS
    """What is done to the pictures that the file is of."""

    @property
    def asked(self) -> Asked:
        """What the formats are asked."""
        return Asked(self.size_px, self.cameras, self.mode)


@dataclass(frozen=True, slots=True)
class RigFiles(os.PathLike[str]):
    """A calibration as it is named: its files, or a folder, and what is said beside them."""

    paths: tuple[Path, ...]
    """One file or folder, or the files of one calibration."""
    said: RigReading = RigReading()
    """What is said beside them."""

    def __fspath__(self) -> str:
        """The first of the paths."""
        return str(self.paths[0])

    def __str__(self) -> str:
        """What messages call them."""
        return " + ".join(str(path) for path in self.paths)


@dataclass(frozen=True, slots=True)
class Reading:
    """A calibration as it was read."""

    rig: StereoRig
    """The rig, metres."""
    format: str
    """Name of its format, as `rigsim.interop.formats.registry.ALL` has it."""
    remarks: tuple[Remark, ...] = ()
    """What is odd about it."""
    unit: str | None = "m"
    """What its lengths were taken to be in; None where nobody said, and metres were assumed."""
    files: tuple[File, ...] = ()
    """Its files."""


def reading(found: Found, format: str, said: RigReading, files: tuple[File, ...]) -> Reading:
    """What the files hold, in metres, the way round that the person said, with what is odd about it.

    Raises:
        InvalidRange: the unit that was said is none.
        InvalidRig: the unit is not known and decides, or the size contradicts.
    """
    _check_size(found.rig, said.size_px)
    unit = found.unit if said.unit is None else said.unit
    rig = found.rig if unit is None else _scaled(found.rig, metres(unit))
    remarks = [one for one in found.remarks if one.code != "unit_said" or said.unit != found.unit]
    if unit is None:
        remarks += _of_unit(rig.baseline_m)
    if said.swap:
        rig = swapped(rig)
    if sides_exchanged(rig):
        remarks.append(_of_sides(rig, said.swap))
    changed = said.grid.apply(rig)
    said_already = {remark.code for remark in remarks}
    remarks += [remark for remark in remarks_of_rig(rig, changed) if remark.code not in said_already]
    return Reading(changed, format, tuple(remarks), unit, files)


def _scaled(rig: StereoRig, factor: float) -> StereoRig:
    pose = rig.right_from_left
    return replace(rig, right_from_left=replace(pose, t=pose.t * factor))


def _check_size(rig: StereoRig, size_px: tuple[int, int] | None) -> None:
    for camera in (rig.left, rig.right):
        if size_px is not None and (camera.width, camera.height) != size_px:
            raise InvalidRig(
                f"size {size_px[0]}x{size_px[1]}: contradicts the file's own {camera.width}x{camera.height};"
                " leave --rig-size out (--resize and --crop change a rig)"
            )


def _of_unit(baseline: float) -> list[Remark]:
    """What is to be said of a baseline whose unit nobody said, taken for metres."""
    if not _LEAST_M <= baseline <= _MOST_M:
        first, *others = ("mm", "cm", "25mm") if baseline > _MOST_M else ("m", "in", "25mm")
        readings = [f"{_mm(baseline, first)} with --rig-unit {first}"]
        readings += [f"{_mm(baseline, unit)} with {unit}" for unit in others]
        raise InvalidRig(
            f"the unit of its lengths is not said, and a baseline of {baseline:.5g} can be"
            f" {', '.join(readings)} (squares of 25 mm): choose one"
        )
    if _SHORT_M <= baseline <= _LONG_M:
        return []
    other = "mm" if baseline > _LONG_M else "in"
    text = (
        f"the file does not say the unit of its lengths: metres assumed, a baseline of"
        f" {baseline * 1e3:.4g} mm ({_mm(baseline, other)} with --rig-unit {other},"
        f" {_mm(baseline, '25mm')} with 25mm for squares)"
    )
    return [Remark("unit", text)]


def _mm(baseline: float, unit: str) -> str:
    return f"{baseline * metres(unit) * 1e3:.4g} mm"


def _of_sides(rig: StereoRig, swapped: bool) -> Remark:
    way_out = "leave --rig-swap out" if swapped else "exchange the cameras with --rig-swap"
    return Remark(
        "swapped",
        f"the right camera lies {rig.baseline_m * 1e3:.4g} mm to the left of the left one: {way_out}, or, if"
        " the pose between them is inverted, turn it round in the file",
    )
