"""Texts and bytes as the files of a calibration."""

from __future__ import annotations

from pathlib import Path

from rigsim.interop.formats.format import Asked, File, Format, Found


def read(format: Format, *contents: str | bytes | tuple[str, str], asked: Asked | None = None) -> Found:
    """What `format` finds in texts (or names with texts, or bytes), which must be one group of its own."""
    files = [_file(i, content) for i, content in enumerate(contents)]
    assert format.groups is not None
    assert format.open is not None
    (group,) = format.groups(files)
    return format.open(group, asked or Asked())


def _file(index: int, content: str | bytes | tuple[str, str]) -> File:
    if isinstance(content, bytes):
        return File(Path(f"{index}.mat"), "", content)
    name, text = content if isinstance(content, tuple) else (f"{index}.txt", content)
    return File(Path(name), text, text.encode())
