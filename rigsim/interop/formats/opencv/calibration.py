"""Which files make one of OpenCV's calibrations: one with all, a pair, or a file a camera and one of both.

The pair is what OpenCV's sample program writes: ``intrinsics.yml`` with the cameras, ``extrinsics.yml`` with
the way between them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File, Format, Found, names_sides, swapped
from rigsim.interop.formats.opencv.filestorage import is_storage, storage_table
from rigsim.interop.formats.opencv.names import Facts, facts_of, sides_of_files
from rigsim.interop.formats.opencv.rig import camera_matrix, rig_of
from rigsim.interop.formats.opencv_yaml import FILE_NAME, IN_METRES, opencv_yaml
from rigsim.interop.formats.values import clipped
from rigsim.rig.stereo import StereoRig

_SIDES = ("left", "right")
_OPENCV_S_OWN = re.compile(r"^\s*%YAML|!!opencv-matrix|<opencv_storage", re.MULTILINE)
_SAME = 1e-6
_MOST_PARTS = 6


def parse_opencv_yaml(text: str) -> StereoRig:
    """The rig in the text of one file that has all, lengths as they stand there.

    Raises:
        InvalidRig: no table, a matrix is missing, or values cannot be.
    """
    return rig_of(facts_of(text), Asked()).rig


@dataclass(frozen=True, slots=True)
class _Part:
    """A file, and what it says."""

    file: File
    facts: Facts
    side: str = ""
    """The camera that it is of, where it is of one."""

    @property
    def is_whole(self) -> bool:
        if self.facts.has_camera("left") or self.facts.has_camera("right"):
            return self.facts.has_cameras and self.facts.has_pose
        return not self.has_way and (self.facts.has_projections or self.facts.has("Q"))

    @property
    def has_way(self) -> bool:
        return self.facts.has("T") and (self.facts.has("R") or self.facts.has("rvec"))

    @property
    def is_of_one(self) -> bool:
        """Whether it is of one camera, and does not say which."""
        sided = any(self.facts.has_camera(side) for side in _SIDES)
        return self.facts.has_camera() and not sided and not self.is_camera_info

    @property
    def is_camera_info(self) -> bool:
        """Whether it is ROS's, whose pose stands elsewhere."""
        return self.facts.has("rect") and self.facts.has("P")


def groups(files: Sequence[File]) -> list[tuple[File, ...]]:
    """The sets of files that each make one of OpenCV's calibrations; the one with the pose comes last."""
    parts = list(_parts(files))
    broken = [(file,) for file in files if _is_broken(file)]
    whole = [part for part in parts if part.is_whole]
    rest = [part for part in parts if not part.is_whole]
    made: list[tuple[File, ...]] = []
    taken: set[int] = set()
    for part in whole:
        beside = [other for other in rest if _agrees(other, part)]
        taken |= {id(other) for other in beside}
        made.append((*(other.file for other in beside), part.file))
    rest = [part for part in rest if id(part) not in taken]
    ways = [part for part in rest if part.has_way or part.facts.has_pose][:_MOST_PARTS]
    pairs = [part for part in rest if part.facts.has_cameras][:_MOST_PARTS]
    lefts, rights = ([part for part in rest if part.side == side][:_MOST_PARTS] for side in _SIDES)
    made += [(pair.file, way.file) for pair in pairs for way in ways]
    for left in lefts:
        for right in rights:
            for way in ways:
                cameras = [part.file for part in (left, right) if part is not way]
                made.append((*cameras, way.file))
    return [*broken, *made]


def lacks(file: File) -> str | None:
    """What a file that says something of a camera lacks to make a rig."""
    part = next(_parts([file]), None)
    if part is None or part.is_whole:
        return None
    facts = part.facts
    if part.has_way:
        if facts.has_camera("left") or facts.has_camera("right"):
            side = "right" if facts.has_camera("left") else "left"
            own = f"K{_SIDES.index(side) + 1}"
            return f"{own} is missing: the {side} camera's matrix{_cure(facts, own) if facts.unused else ''}"
        what = "no camera matrices"
        if facts.has_camera():
            key = facts.key("K") if facts.has("K") else "fx, fy, cx, cy"
            what = f"one camera's matrix, {clipped(key)}, of no side"
        elif facts.unused:
            what = "no camera matrices found"
        return f"has R and T, and {what}{_cure(facts, 'K1, D1, K2, D2')}"
    if facts.has_cameras:
        turn, way = facts.has("R") or facts.has("rvec"), facts.has("T")
        what = "R" if way and not turn else "T" if turn and not way else "R and T"
        return f"has both camera matrices, but not {what} between the cameras{_cure(facts, what)}"
    return "is the calibration of one camera: name those of both, and the file with R and T"


def _cure(facts: Facts, missing: str) -> str:
    """What to do where something is missing: rename what was not understood, or name another file."""
    beside = f"name the file with {missing} beside it, as --rig intrinsics.yml --rig extrinsics.yml"
    if not facts.unused:
        return f": {beside}"
    shown = ", ".join(clipped(key) for key in facts.unused[:_MOST_PARTS])
    return f"; not understood: {shown}; rename what is {missing}, or {beside}"


def _open(files: tuple[File, ...], asked: Asked) -> Found:
    if len(files) == 1:
        facts = facts_of(files[0].text)
    else:
        facts, *others = (
            part.facts.of_side(part.side) if part.is_of_one else part.facts
            for part in reversed(list(_parts(files)))
        )
        for other in others:
            facts = facts.with_(other)
    found = rig_of(facts, asked)
    if found.unit is None and any(IN_METRES in file.text for file in files):
        found = replace(found, unit="m")
    return replace(found, rig=swapped(found.rig)) if names_sides(asked) else found


def _parts(files: Sequence[File]) -> Iterator[_Part]:
    """The files that say something of a camera, or of the way between two."""
    parts = list(_unsided(files))
    sides = sides_of_files([part.file.path for part in parts if part.is_of_one])
    for part in parts:
        own = [side for side in _SIDES if part.facts.has_camera(side)]
        yield replace(part, side=own[0] if len(own) == 1 else sides.get(part.file.path, ""))


def _unsided(files: Sequence[File]) -> Iterator[_Part]:
    for file in files:
        if not is_storage(file.text):
            continue
        try:
            part = _Part(file, facts_of(file.text))
        except InvalidRig:
            continue
        facts = part.facts
        if part.is_whole or part.has_way or any(facts.has_camera(side) for side in ("", *_SIDES)):
            yield part


def _is_broken(file: File) -> bool:
    """Whether a file is OpenCV's and cannot be read."""
    if not _OPENCV_S_OWN.search(file.text[:20000]) or not is_storage(file.text):
        return False
    try:
        facts_of(file.text)
    except InvalidRig:
        return True
    return not storage_table(file.text)


def _agrees(part: _Part, whole: _Part) -> bool:
    """Whether a file of cameras says of them what the whole calibration says."""
    if part.has_way:
        return False
    pairs = [(part.facts, side, side) for side in _SIDES if part.facts.has_camera(side)]
    if not pairs and part.side:
        pairs = [(part.facts, "", part.side)]
    for facts, side, own in pairs:
        one, other = camera_matrix(facts, side), camera_matrix(whole.facts, own)
        if one is None or other is None or not np.allclose(one, other, rtol=_SAME, atol=0):
            return False
    return bool(pairs)


FORMAT = Format(
    "opencv",
    "OpenCV's FileStorage (YAML, XML, JSON), as its calibration and rectification samples write it",
    (".yml", ".yaml", ".xml", ".json"),
    FILE_NAME,
    groups=groups,
    open=_open,
    lacks=lacks,
    late=True,
    write=lambda rig: {FILE_NAME: opencv_yaml(rig)},
)
