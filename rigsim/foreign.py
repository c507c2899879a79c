"""Files that somebody else wrote: read whole, but only regular ones of a size that can be meant.

A device, a pipe or a file of gigabytes is refused before it is read; so is a picture or an array whose header
promises more than its file holds, or more than memory should.
"""

from __future__ import annotations

import errno
import io
import os
import stat
import struct
from math import prod
from pathlib import Path

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidImage, OutputError

TEXT_BYTES = 4_000_000
"""Largest calibration, rig, table or scene text; twenty thousand lines of numbers."""
TABLE_BYTES = 200_000_000
"""Largest table of measurements: a million lines."""
PICTURE_BYTES = 1_000_000_000
"""Largest picture, disparity or cloud file."""
PICTURE_PIXELS = 300_000_000
"""Most pixels of a picture: 300 megapixels are 2.4 GB of doubles."""

_MB = 1_000_000


def read_bytes(
    path: str | Path, what: str, limit_bytes: int = PICTURE_BYTES, *, follow: bool = True
) -> bytes:
    """The content of a regular file.

    Args:
        path: the file.
        what: what it should be, for messages, as ``a calibration file``.
        limit_bytes: a larger one is refused.
        follow: whether a link may stand for the file; not where a program was to write one.

    Raises:
        OutputError: there is none, it cannot be read, it is no regular file, or it is too large.
    """
    try:
        # a pipe without a writer must not keep us waiting
        flags = os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC | (0 if follow else os.O_NOFOLLOW)
        descriptor = os.open(path, flags)
        with open(descriptor, "rb") as file:
            found = os.fstat(descriptor)
            if not stat.S_ISREG(found.st_mode):
                raise OutputError(f"{path}: is {_kind(found.st_mode)}: name {what}")
            # what the system calls 0 bytes long may go on for ever, as in /proc
            content = file.read(limit_bytes + 1)
    except OSError as error:
        if isinstance(error, OutputError):
            raise
        if error.errno == errno.ELOOP and not follow:
            raise OutputError(f"{path}: is a link: must be a file of its own") from None
        if error.errno == errno.EISDIR:
            raise OutputError(f"{path}: is a folder: name {what}") from None
        raise OutputError(f"{path}: cannot be read ({error.strerror or error}); name {what}") from None
    except ValueError as error:  # a null character in the name
        raise OutputError(f"{str(path)!r}: cannot be read ({error}); name {what}") from None
    if len(content) > limit_bytes:
        size = max(found.st_size, len(content))
        raise OutputError(f"{path}: {size / _MB:.4g} MB, must be <= {limit_bytes / _MB:g} MB: name {what}")
    return content


def read_text(path: str | Path, what: str, limit_bytes: int = TEXT_BYTES) -> str:
    """The text of a regular file in UTF-8, without a byte order mark.

    Raises:
        OutputError: as `read_bytes`.
        UnicodeDecodeError: it is no text.
    """
    try:
        if stat.S_ISDIR(os.stat(path).st_mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if not os.access(path, os.R_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    except OSError as error:
        raise OutputError(f"{path}: cannot be read ({error.strerror}); name {what}") from None
    except ValueError:
        pass  # a null character in the name: told next
    content = read_bytes(path, what, limit_bytes)
    return content.decode("utf-8-sig")


def check_pixels(content: bytes, name: str | Path) -> None:
    """Refuse a picture whose header promises more pixels than are meant; other contents pass.

    PNG, JPEG, TIFF and whatever else Pillow knows, by the header alone.

    Raises:
        InvalidImage: there are too many.
    """
    from PIL import Image, UnidentifiedImageError

    limit, Image.MAX_IMAGE_PIXELS = Image.MAX_IMAGE_PIXELS, None
    try:
        with Image.open(io.BytesIO(content)) as picture:
            width, height = picture.size
    except (UnidentifiedImageError, OSError, SyntaxError, ValueError, struct.error, EOFError):
        return
    finally:
        Image.MAX_IMAGE_PIXELS = limit
    if width * height > PICTURE_PIXELS:
        raise InvalidImage(
            f"{name}: {width} x {height} pixels, must be <= {PICTURE_PIXELS // _MB} megapixels"
        )


def parse_npy(content: bytes, name: str | Path) -> npt.NDArray[np.generic]:
    """The array of real numbers in an NPY file; its header must fit the file.

    Raises:
        InvalidImage: it is none, or promises more or other numbers than it holds.
    """
    file = io.BytesIO(content)
    try:
        version = np.lib.format.read_magic(file)
        header = np.lib.format
        read = header.read_array_header_1_0 if version == (1, 0) else header.read_array_header_2_0
        shape, _, dtype = read(file)
        held = len(content) - file.tell()
        if dtype.kind not in "biuf":
            raise InvalidImage(f"{name}: no NPY file of numbers ({dtype}): must be real numbers")
        if prod(shape) * dtype.itemsize != held:
            raise InvalidImage(
                f"{name}: its header promises {prod(shape) * dtype.itemsize} bytes of numbers, it has {held}"
            )
        return np.asarray(np.load(io.BytesIO(content), allow_pickle=False))
    except InvalidImage:
        raise
    except Exception:  # a header is read as Python: whatever that raises
        raise InvalidImage(f"{name}: no NPY file of numbers") from None


def _kind(mode: int) -> str:
    for test, name in (
        (stat.S_ISDIR, "a folder"),
        (stat.S_ISFIFO, "a pipe"),
        (stat.S_ISCHR, "a device"),
        (stat.S_ISBLK, "a device"),
        (stat.S_ISSOCK, "a socket"),
    ):
        if test(mode):
            return name
    return "no regular file"
