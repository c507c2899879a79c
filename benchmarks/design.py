"""Time of `rigsim design`: formulas alone (limit 2 s), and with rendering and proof (limit 20 s)."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

REPEATS = 3
ASKED = ("--range", "0.5:3m", "--depth-error", "10mm@3m", "--fov", "60deg")


def run() -> None:
    """Print seconds of whole processes, interpreter and report included."""
    print(f"rigsim design {' '.join(ASKED)}")
    for what, words, limit_s in (
        ("formulas alone, --json", ("--no-proof", "--json"), 2),
        ("formulas and report, --no-proof --out", ("--no-proof", "--out"), 2),
        ("rendered, simulated, measured, with report", ("--out",), 20),
        ("the same at 5 MP, --prefer smallest", ("--prefer", "smallest", "--out"), 20),
    ):
        print(f"  {what:48}{median(_seconds(words) for _ in range(REPEATS)):6.2f} s   (limit {limit_s} s)")


def _seconds(words: tuple[str, ...]) -> float:
    with tempfile.TemporaryDirectory() as folder:
        out = (str(Path(folder) / "out"),) if words[-1] == "--out" else ()
        begin = time.perf_counter()
        subprocess.run(
            [sys.executable, "-m", "rigsim", "design", *ASKED, *words, *out], check=True, capture_output=True
        )
        return time.perf_counter() - begin
