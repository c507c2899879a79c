"""Work on many points in blocks whose buffers stay in the processor's cache."""

from __future__ import annotations

from collections.abc import Iterator


def blocks(count: int, size: int) -> Iterator[slice]:
    """Slices of at most `size` that cover `count` points in order."""
    for start in range(0, count, size):
        yield slice(start, min(start + size, count))
