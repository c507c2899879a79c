"""Calibration files as bytes and text, and what a file looks like that is none."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Sequence
from pathlib import Path

from rigsim import foreign
from rigsim.errors import RigsimError
from rigsim.interop.formats.format import File
from rigsim.interop.formats.values import clipped

_SIBLING_BYTES = 1_000_000
_MOST_SIBLINGS = 100
_A_CAMERA = re.compile(r"cam(?:era)?_?\d+|left|right", re.IGNORECASE)
"""Folders of one camera, as in ASL's layout."""
_NO_CALIBRATIONS = re.compile(
    r"\.(?:png|jpe?g|tiff?|bmp|p[gp]m|pfm|exr|webp|npy|npz|ply|pcd|bag|mp4|avi|mkv|zip|gz|pdf|py|pyc|so|o|[ch](?:pp)?|md"
    r"|html|ipynb|csv)$",
    re.IGNORECASE,
)
_MAGIC = (
    (b"\x89PNG", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"II*\x00", "a TIFF picture"),
    (b"MM\x00*", "a TIFF picture"),
    (b"GIF8", "a GIF picture"),
    (b"BM", "a BMP picture"),
    (b"%PDF", "a PDF"),
    (b"PK\x03\x04", "a ZIP archive"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"\x7fELF", "a program"),
    (b"\x93NUMPY", "a NumPy array"),
    (b"MATLAB 5.0", "a MATLAB file"),
    (b"\x89HDF", "an HDF5 file"),
    (b"#ROSBAG", "a ROS bag"),
)
_CALIBRATOR = "# oST version"
_GAP = "\n" * 50
_KEY = re.compile(r"^[ \t]*\"?([A-Za-z][\w. ]{0,40})\"?[ \t]*([:=])", re.MULTILINE)


def read_file(path: Path) -> File:
    """The file at `path`.

    Raises:
        OutputError: it cannot be read, or is too large.
    """
    what = "a calibration file"
    return file_of(path, foreign.read_bytes(path, what, foreign.TEXT_BYTES))


def file_of(path: Path, content: bytes) -> File:
    """A file of this content: UTF-8, UTF-16 or Latin-1, line ends made one; without text if it is binary."""
    return File(path, _text(content), content)


def siblings(folder: Path) -> list[File]:
    """The files of a folder, and of its cameras' folders, that may be calibrations: not the pictures,
    nor what is large."""
    return [*_calibrations(folder), *(file for own in _cameras(folder) for file in _calibrations(own))]


def neighbours(path: Path) -> list[File]:
    """The files beside one, those of the other cameras included where it lies in a camera's folder."""
    folder = path.parent
    found = siblings(folder)
    if _A_CAMERA.fullmatch(folder.absolute().name):
        above = folder.parent if folder.name else Path(os.pardir)
        others = (other for other in _cameras(above) if not other.samefile(folder))
        found += [file for other in others for file in _calibrations(other)]
    return found


def _cameras(folder: Path) -> list[Path]:
    return [
        Path(folder, entry.name)
        for entry in _entries(folder)
        if _A_CAMERA.fullmatch(entry.name) and entry.is_dir()
    ]


def _entries(folder: Path) -> list[os.DirEntry[str]]:
    try:
        return sorted(os.scandir(folder), key=lambda entry: entry.name)
    except OSError:
        return []


def _calibrations(folder: Path) -> list[File]:
    found: list[File] = []
    for entry in _entries(folder):
        if _NO_CALIBRATIONS.search(entry.name) or len(found) >= _MOST_SIBLINGS:
            continue
        try:
            if entry.is_file() and entry.stat().st_size <= _SIBLING_BYTES:
                found.append(read_file(Path(folder, entry.name)))
        except (OSError, RigsimError):
            continue
    return found


def looks_like(file: File) -> str:
    """What a file is that no format knows, a phrase."""
    if not file.content.strip() and not file.text.strip():
        return "is empty"
    name = next((name for magic, name in _MAGIC if file.content.startswith(magic)), None)
    if name is not None:
        return f"looks like {name}"
    if not file.text:
        return "looks like binary data"
    start = file.text.lstrip()[:200].lower()
    if start.startswith(("<!doctype html", "<html")):
        return "looks like a web page (HTML): save the file itself"
    if start.startswith("<"):
        root = re.search(r"<([A-Za-z_][\w.:-]*)", file.text)
        return f"looks like XML with the root {clipped(root[1]) if root else '(none)'}"
    if start.startswith(("{", "[{")):
        return _json(file.text)
    if _CALIBRATOR in file.text:
        return (
            "looks like what ROS's cameracalibrator prints: its button SAVE writes left.yaml and right.yaml,"
            " which are read"
        )
    return _keyed(file.text)


def _text(content: bytes) -> str:
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        text = content.decode("utf-16", errors="replace")
    elif b"\x00" in content:
        return ""
    else:
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError:
            if any(content.startswith(magic) for magic, _ in _MAGIC):
                return ""
            text = content.decode("latin-1")
    return _closed_up(text.replace("\r\n", "\n").replace("\r", "\n"))


def _closed_up(text: str) -> str:
    """The text without the rest of very long gaps, in which a search for a line's beginning gets lost."""
    if _GAP not in text.replace(" ", "").replace("\t", ""):
        return text
    lines, blank = [], 0
    for line in text.split("\n"):
        blank = 0 if line.strip() else blank + 1
        if blank <= len(_GAP):
            lines.append(line)
    return "\n".join(lines)


def _json(text: str) -> str:
    try:
        table = json.loads(text)
    except ValueError as error:
        return f"looks like JSON, but {clipped(str(error))}"
    except RecursionError:
        return "looks like JSON, but is nested too deep"
    return f"looks like JSON with {_names(list(table)) if isinstance(table, dict) else 'a list'}"


def _keyed(text: str) -> str:
    found = _KEY.findall(text[:20000])
    keys = list(dict.fromkeys(key.strip() for key, _ in found))
    if not keys:
        words = text[:2000].split()
        numbers = sum(word.strip(",;").lstrip("+-")[:1].isdigit() for word in words)
        return "looks like a table of numbers" if words and numbers * 2 > len(words) else "looks like text"
    if found[0][1] == "=":
        return f"looks like TOML or an INI file with {_names(keys)}"
    from rigsim.interop.formats.yaml_text import yaml_table

    try:
        yaml_table(text)
    except RigsimError as error:
        return f"looks like YAML, but {error}"
    return f"looks like YAML with {_names(keys)}"


def _names(keys: Sequence[object]) -> str:
    return clipped(", ".join(str(key)[:20] for key in keys[:6])) or "nothing"
