"""Time of `rigsim design`: without rendering (limit 2 s), and with rendering and proof (limit 20 s)."""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

REPEATS = 3
ASKED = ("--range", "0.5:3m", "--depth-error", "10mm@3m", "--fov", "60deg")


def run() -> None:
    """Print seconds of whole processes, interpreter and report included, and of CPU, for busy machines."""
    print(f"rigsim design {' '.join(ASKED)}")
    for what, words, limit_s in (
        ("formulas alone, --json", ("--no-proof", "--json"), 2),
        ("formulas and report, --no-proof --out", ("--no-proof", "--out"), 2),
        ("rendered, simulated, measured, with report", ("--out",), 20),
        ("the same at 5 MP, --prefer smallest", ("--prefer", "smallest", "--out"), 20),
    ):
        wall_s, cpu_s = (
            median(part) for part in zip(*(_seconds(words) for _ in range(REPEATS)), strict=True)
        )
        print(f"  {what:48}{wall_s:6.2f} s, CPU {cpu_s:5.2f} s   (limit {limit_s} s)")


def _seconds(words: tuple[str, ...]) -> tuple[float, float]:
    """Of one process: by the clock, and of CPU."""
    with tempfile.TemporaryDirectory() as folder:
        out = (str(Path(folder) / "out"),) if words[-1] == "--out" else ()
        before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        subprocess.run(
            [sys.executable, "-m", "rigsim", "design", *ASKED, *words, *out], check=True, capture_output=True
        )
        wall_s, after = time.perf_counter() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
        return wall_s, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
