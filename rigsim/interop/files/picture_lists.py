"""Picture files that words of a command stand for: files, folders, patterns."""

from __future__ import annotations

import glob
from collections.abc import Sequence
from pathlib import Path

from rigsim.errors import OutputError

ENDINGS = frozenset({".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".pgm", ".ppm", ".webp"})
"""Endings of what counts as a picture in a folder."""
_MOST = 20_000


def picture_files(words: Sequence[str]) -> list[list[str]]:
    """The files of each word, sorted by name: a folder's pictures, what a pattern matches, or the file
    itself.

    Raises:
        OutputError: a word stands for no picture.
    """
    groups = []
    for word in words:
        path = Path(word)
        if path.is_dir():
            found = sorted(str(each) for each in path.iterdir() if each.suffix.lower() in ENDINGS)
            why = f"folder without pictures ({', '.join(sorted(ENDINGS))})"
        elif path.exists():
            found, why = [word], ""
        elif glob.has_magic(word):
            found = sorted(each for each in glob.glob(word) if Path(each).is_file())
            why = "no file matches this pattern"
        else:
            found, why = [], "there is no such file"
        if not found:
            raise OutputError(f"{word}: {why}: name pictures, a folder of them, or a pattern as 'left*.png'")
        if len(found) > _MOST:
            raise OutputError(f"{word}: {len(found)} files: must be <= {_MOST}")
        groups.append(found)
    return groups
