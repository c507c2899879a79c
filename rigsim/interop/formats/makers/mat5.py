"""The numbers, texts and structs in a MAT-file of version 5 (MathWorks, "MAT-File Format").

Read here, as scipy's reader ends the process at some broken files. What is none of these (an object, a sparse
matrix, a function) is left out.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator

import numpy as np

from rigsim.errors import InvalidRig

_MATRIX, _COMPRESSED = 14, 15
_CELL, _STRUCT, _CHAR = 1, 2, 4
_NUMBERS = range(6, 16)
_TYPES = {
    1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8", 16: "u1",
    17: "u2", 18: "u4",
}  # fmt: skip
_HEAD_BYTES = 128
_MOST_BYTES = 50_000_000
_MOST_VALUES = 100_000
_DEEPEST = 12


def mat5_variables(content: bytes) -> dict[str, object]:
    """The variables by name: arrays (rows, columns), texts, dicts of structs; lists of several structs.

    Raises:
        InvalidRig: it is no whole file, or unpacks to more than is meant.
    """
    reader = _Reader(">" if content[126:128] == b"MI" else "<")
    try:
        return dict(reader.variables(content))
    except InvalidRig:
        raise
    # the last two: an element is missing, in a generator and elsewhere
    except (struct.error, zlib.error, ValueError, IndexError, OverflowError, RuntimeError, StopIteration):
        raise InvalidRig("is no whole MAT-file: a variable cannot be read") from None


class _Reader:
    """Takes elements from bytes, and counts what they hold."""

    def __init__(self, order: str) -> None:
        self.order, self.unpacked, self.values = order, 0, 0

    def variables(self, content: bytes) -> Iterator[tuple[str, object]]:
        for kind, data in self.elements(content[_HEAD_BYTES:], padded=False):
            if kind == _COMPRESSED:
                unpacking = zlib.decompressobj()
                data = unpacking.decompress(data, _MOST_BYTES + 1 - self.unpacked)
                self.unpacked += len(data)
                if self.unpacked > _MOST_BYTES:
                    raise InvalidRig(f"unpacks to over {_MOST_BYTES // 1_000_000} MB: save the struct alone")
                kind, data = next(self.elements(data))
            if kind == _MATRIX:
                yield self.matrix(data, 0)

    def elements(self, data: bytes, padded: bool = True) -> Iterator[tuple[int, bytes]]:
        """Type and content of each element; packed variables are not padded to eight bytes."""
        place = 0
        while place + 8 <= len(data):
            kind, length = struct.unpack_from(f"{self.order}II", data, place)
            if kind >> 16:  # a small one: type and length share four bytes, the content has the other four
                yield kind & 0xFFFF, data[place + 4 : place + 4 + (kind >> 16)]
                place += 8
                continue
            if place + 8 + length > len(data):
                raise InvalidRig("is no whole MAT-file: it ends within a variable")
            yield kind, data[place + 8 : place + 8 + length]
            place += 8 + length
            if padded or kind != _COMPRESSED:
                place += -place % 8

    def matrix(self, data: bytes, depth: int) -> tuple[str, object]:
        """Name and value of an array; the value is None where it is left out."""
        self.values += 1
        if depth > _DEEPEST or self.values > _MOST_VALUES:
            raise InvalidRig("holds more values than a calibration does: save the struct alone")
        parts = self.elements(data)
        if not data:
            return "", np.zeros((0, 0))
        kind = int(self.array(*next(parts))[0]) & 0xFF
        dims = [int(size) for size in self.array(*next(parts))]
        if min(dims, default=-1) < 0 or len(dims) < 2:
            raise InvalidRig("is no whole MAT-file: an array has no size")
        name = next(parts)[1].decode("latin-1")
        if kind in _NUMBERS:
            values = self.array(*next(parts))
            return name, np.asarray(values, dtype=np.float64).reshape(dims, order="F")
        if kind == _CHAR:
            return name, "".join(chr(int(code)) for code in self.array(*next(parts))).strip()
        if kind == _STRUCT:
            return name, self.struct(parts, int(np.prod(dims, dtype=object)), depth)
        if kind == _CELL:
            return name, [self.matrix(part, depth + 1)[1] for _, part in parts]
        return name, None

    def struct(self, parts: Iterator[tuple[int, bytes]], count: int, depth: int) -> object:
        """The struct's fields, or those of each of several."""
        length = int(self.array(*next(parts))[0])
        words = next(parts)[1]
        if length < 1:
            raise InvalidRig("is no whole MAT-file: a struct's names have no length")
        names = [
            words[i : i + length].split(b"\0")[0].decode("latin-1") for i in range(0, len(words), length)
        ]
        if count * max(1, len(names)) > _MOST_VALUES:
            raise InvalidRig("holds more values than a calibration does: save the struct alone")
        rows = [{name: self.matrix(next(parts)[1], depth + 1)[1] for name in names} for _ in range(count)]
        return rows[0] if len(rows) == 1 else rows

    def array(self, kind: int, data: bytes) -> np.ndarray[tuple[int], np.dtype[np.generic]]:
        """The numbers of an element."""
        if kind not in _TYPES:
            raise InvalidRig(f"is no whole MAT-file: numbers of type {kind}")
        return np.frombuffer(data, dtype=np.dtype(f"{self.order}{_TYPES[kind]}"))
