"""What bounds cost a normal run: the share of its time in readers, gate, guard and claims (limit 2 %)."""

from __future__ import annotations

import contextlib
import functools
import io
import os
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from statistics import median
from typing import Any

from rigsim import foreign, guard
from rigsim.cli import app
from rigsim.interop.files import claims
from rigsim.rig.extent import Extent
from rigsim.sim.scenes import gate, library

REPEATS = 5
BOUNDS: tuple[tuple[Any, str], ...] = (
    *((foreign, name) for name in ("read_bytes", "read_text", "check_pixels", "parse_npy")),
    *((gate, name) for name in ("check", "check_names", "check_numbers")),
    *((guard, name) for name in ("keep", "let_go")),
    *((claims, name) for name in ("claim", "release", "temporary_name", "moved", "sweep")),
    (Extent, "check"),
)
"""What is only there to bound; reading the bytes of a file is counted, too: an upper limit."""
RUNS = {
    "sweep": "sweep --baseline 50:500/4 --points 500 --trials 20 --out out --force",
    "sweep, own scene": "sweep --scene mine.xml --baseline 50:500/4 --points 500 --out out --force",
    "render": "render --scene artifact --out pair --force",
    "measure": "measure pair/left.png pair/right.png --rig pair/rig.toml --out out --force",
    "export dataset": "export dataset --scene bin --resolution 320x240 --format kitti --frames 2 --out out "
    "--force",
}


def run() -> None:
    """Print the share of each run that its bounds take."""
    spent = _Spent()
    with (
        tempfile.TemporaryDirectory(prefix="bench-bounds-") as folder,
        spent.watched(),
        _within(Path(folder)),
    ):
        Path("mine.xml").write_bytes(library.find("boards").read_bytes())
        _time(RUNS["render"], spent)  # what later runs measure, and the libraries loaded
        for name, words in RUNS.items():
            shares = [_time(words, spent) for _ in range(REPEATS)]
            print(f"{name:28} {100 * median(shares):5.2f} % in its bounds   (limit 2 %)", flush=True)


class _Spent:
    """Seconds within the bounds; one that calls another counts once."""

    def __init__(self) -> None:
        self.seconds = 0.0
        self._depth = 0

    def timed(self, function: Callable[..., Any]) -> Callable[..., Any]:
        @functools.wraps(function)
        def wrapper(*args: Any, **options: Any) -> Any:
            begin = time.perf_counter()
            self._depth += 1
            try:
                return function(*args, **options)
            finally:
                self._depth -= 1
                if not self._depth:
                    self.seconds += time.perf_counter() - begin

        return wrapper

    @contextlib.contextmanager
    def watched(self) -> Iterator[None]:
        before = [(place, name, getattr(place, name)) for place, name in BOUNDS]
        for place, name, function in before:
            setattr(place, name, self.timed(function))
        try:
            yield
        finally:
            for place, name, function in before:
                setattr(place, name, function)


@contextlib.contextmanager
def _within(folder: Path) -> Iterator[None]:
    before = Path.cwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


def _time(words: str, spent: _Spent) -> float:
    """The share of a run that its bounds take."""
    spent.seconds = 0.0
    begin = time.perf_counter()
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        code = app.run(words.split())
    assert code == 0, words
    return spent.seconds / (time.perf_counter() - begin)
