"""Run the benchmarks named on the command line, or all: every module here with a ``run() -> None``."""

from __future__ import annotations

import importlib
import os
import pkgutil
import platform
import sys

import cv2
import numpy as np
import scipy

import benchmarks.verdicts
from rigsim import __version__


def main(names: list[str]) -> int:
    """Print the tables of the benchmarks called `names`, or of all; 2 when one does not exist."""
    known = sorted(m.name for m in pkgutil.iter_modules(benchmarks.__path__) if not m.name.startswith("_"))
    known.remove("subjects")  # what they look at
    parts = {f"verdicts.{m.name}" for m in pkgutil.iter_modules(benchmarks.verdicts.__path__)}
    unknown = [name for name in names if name not in {*known, *parts}]
    if unknown:
        choices = ", ".join(sorted([*known, *parts]))
        print(f"unknown benchmark {unknown[0]!r}: choose among {choices}", file=sys.stderr)
        return 2
    print(
        f"rigsim {__version__}, numpy {np.__version__}, scipy {scipy.__version__}, OpenCV {cv2.__version__}, "
        f"Python {platform.python_version()}, {platform.machine()}, {os.cpu_count()} cores"
    )
    for name in names or known:
        print(f"\n== {name}", flush=True)
        importlib.import_module(f"benchmarks.{name}").run()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
