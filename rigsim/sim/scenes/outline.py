"""What a scene file asks for, read before MuJoCo takes it in: its files, its elements, its memory.

A replicate of a million, a texture of terabytes and a mesh that is a pipe are seen here, at the price of
reading the text once.
"""

from __future__ import annotations

import os
import re
import stat
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.parsers import expat

from rigsim import foreign
from rigsim.errors import InvalidScene, OutputError

SCENE_BYTES = 100_000_000
"""Largest MJCF text; meshes may stand in it."""
MOST_ELEMENTS = 20_000
"""Most bodies, geoms, sites, cameras and lights, replicated ones counted: MuJoCo takes minutes for more."""
MOST_MB = 1_000.0
"""Most memory that textures, height fields and sizes may ask for."""

_COUNTED = frozenset({"body", "geom", "site", "camera", "light", "joint", "freejoint", "frame"})
_UNSURE = frozenset(
    {"replicate", "flexcomp", "composite", "attach", "plugin", "model", "flex", "skin", "size"}
)
"""What multiplies, nests or reserves: how much only MuJoCo knows."""
_FOLDERS = ("assetdir", "meshdir", "texturedir")
_UNITS = {"K": 2**10, "M": 2**20, "G": 2**30, "T": 2**40, "P": 2**50, "E": 2**60}
_MB = 1e6


@dataclass(slots=True)
class Outline:
    """What was read of a scene."""

    plain: bool = True
    """Whether nothing in it can keep MuJoCo busy for long."""
    elements: float = 0.0
    """Bodies, geoms and the like."""
    megabytes: float = 0.0
    """What it asks for."""
    greediest: str = ""
    """The element that asks for most of it."""
    files: list[str] = field(default_factory=list)
    """Files that it names."""
    folders: list[str] = field(default_factory=lambda: [""])
    """Where those may be."""
    includes: list[str] = field(default_factory=list)
    """Parts of it in files of their own."""
    _most: float = 0.0
    _copies: list[float] = field(default_factory=lambda: [1.0])

    def read(self, path: Path) -> None:
        """Add the elements of one file; what is no XML leaves the rest to MuJoCo.

        Raises:
            InvalidScene: it cannot be read, is too large or is no UTF-8.
        """
        try:
            content = foreign.read_bytes(path, "an MJCF file", SCENE_BYTES)
        except OutputError as error:
            raise InvalidScene(str(error)) from None
        try:
            content.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            line = content.count(b"\n", 0, error.start) + 1
            raise InvalidScene(f"{path}: line {line} is not UTF-8 text: save it as UTF-8") from None
        parser = expat.ParserCreate()
        parser.StartElementHandler = self._open
        parser.EndElementHandler = self._close
        parser.StartDoctypeDeclHandler = self._stop
        try:
            parser.Parse(content, True)
        except (expat.ExpatError, _Stopped):
            self.plain = False
        self._copies = [1.0]

    def _stop(self, *_: Any) -> None:
        raise _Stopped  # entities of entities need not be unfolded: MuJoCo knows none

    def _open(self, tag: str, words: dict[str, str]) -> None:
        copies = self._copies[-1]
        if tag == "replicate":
            copies *= max(1.0, _number(words.get("count", "")))
        self._copies.append(copies)
        self.elements += copies * (tag in _COUNTED)
        self.plain &= tag not in _UNSURE
        if "file" in words:
            (self.includes if tag == "include" else self.files).append(words["file"])
        self.files += [
            words[key] for key in words if tag == "texture" and key.startswith("file") and key != "file"
        ]
        self.folders += [words[key] for key in _FOLDERS if tag == "compiler" and key in words]
        asked = _megabytes(tag, words)
        self.megabytes += asked
        if asked > self._most:
            self._most, self.greediest = asked, f"<{tag}> {words.get('name', '')[:40]}".strip()

    def _close(self, _: str) -> None:
        self._copies.pop()


class _Stopped(Exception):
    pass


def outline(path: Path) -> Outline:
    """What the MJCF file at `path` asks for, with all that it includes.

    Raises:
        InvalidScene: one of its files is no regular file or too large, or it asks for too much.
    """
    found = Outline()
    found.read(path)
    read = {os.path.realpath(path)}
    while found.includes:
        for part in _places(path, found.includes.pop(), [""]):
            if os.path.realpath(part) not in read and part.exists():
                read.add(os.path.realpath(part))
                try:
                    found.read(part)
                except InvalidScene as error:
                    raise InvalidScene(f"{path}: includes {error}") from None
        if found.elements > MOST_ELEMENTS or len(read) > MOST_ELEMENTS:
            break
    for name in dict.fromkeys(found.files):
        for file in _places(path, name, found.folders):
            _check_file(path, file)
    if found.elements > MOST_ELEMENTS:
        raise InvalidScene(
            f"{path}: {found.elements:.6g} bodies, geoms, sites, cameras and lights, "
            f"must be <= {MOST_ELEMENTS}: take fewer (a smaller count of <replicate>)"
        )
    if found.megabytes > MOST_MB:
        raise InvalidScene(
            f"{path}: asks for {found.megabytes:.4g} MB of memory, must be <= {MOST_MB:g}: "
            f"make {found.greediest} smaller"
        )
    return found


def _places(path: Path, name: str, folders: list[str]) -> list[Path]:
    """Where MuJoCo may find a file that the scene at `path` names."""
    try:
        return [path.parent / folder / name for folder in dict.fromkeys(folders)]
    except (ValueError, OSError):
        return []


def _check_file(path: Path, file: Path) -> None:
    try:
        found = file.stat()
    except (OSError, ValueError):
        return  # MuJoCo says which one is missing
    if not stat.S_ISREG(found.st_mode):
        raise InvalidScene(f"{path}: {file} is no regular file: name another one")
    if found.st_size > foreign.PICTURE_BYTES:
        raise InvalidScene(
            f"{path}: {file} has {found.st_size / _MB:.4g} MB, "
            f"must be <= {foreign.PICTURE_BYTES / _MB:g}: name a smaller one"
        )


def _megabytes(tag: str, words: dict[str, str]) -> float:
    """Memory that one element asks for."""
    value = {key: _number(word) for key, word in words.items()}
    if tag == "texture":
        return value.get("width", 0) * value.get("height", 0) * max(3, value.get("nchannel", 3)) / _MB
    if tag == "hfield":
        return value.get("nrow", 0) * value.get("ncol", 0) * 8 / _MB
    if tag == "size":
        return sum(number * (1 if key == "memory" else 8) for key, number in value.items()) / _MB
    return 0.0


def _number(word: str) -> float:
    """A number that may end in K, M, G; 0 for anything else."""
    match = re.fullmatch(
        r"\s*\+?([0-9]{1,300}(?:\.[0-9]*)?(?:[eE]\+?[0-9]{1,3})?)\s*([KMGTPE]?)\s*", word.upper()[:400]
    )
    return float(match[1]) * _UNITS.get(match[2], 1) if match else 0.0
