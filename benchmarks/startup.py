"""What the command line costs before it does anything, as a multiple of importing its own library."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

REPEATS = 15
CHECKOUT = Path(__file__).resolve().parents[1]
RIGSIM = [sys.executable, "-c", "from rigsim.cli import main; raise SystemExit(main())"]
POINT = ["calc", "point", "--focal", "1200", "--baseline", "150", "--left", "980,500", "--right", "910,500"]
JOBS = {
    'python -c "import typer"': [sys.executable, "-c", "import typer"],
    "rigsim --help": [*RIGSIM, "--help"],
    'python -c "import typer, numpy"': [sys.executable, "-c", "import typer, numpy"],
    "rigsim calc point": [*RIGSIM, *POINT],
    "./run --help": [str(CHECKOUT / "run"), "--help"],
}


def run() -> None:
    """Print the median wall time of each command; runs are interleaved so that load hits all alike."""
    times: dict[str, list[float]] = {name: [] for name in JOBS}
    for _ in range(REPEATS):
        for name, command in JOBS.items():
            begin = time.perf_counter()
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
            times[name].append(time.perf_counter() - begin)
    found = {name: median(taken) for name, taken in times.items()}
    unit = found['python -c "import typer"']
    print(f"{'command':34} {'ms':>6} {'x import typer':>15}")
    for name, seconds in found.items():
        print(f"{name:34} {seconds * 1e3:6.0f} {seconds / unit:15.2f}")
    print(f"./run adds {(found['./run --help'] - found['rigsim --help']) * 1e3:.0f} ms to the program")
    print(f"a pytest session that does not use the plugin takes {_plugin_ms():+.1f} ms with it (limit 20 ms)")


def _plugin_ms() -> float:
    """Median difference of pytest sessions of one empty test with and without the plugin, in pairs."""
    differences = []
    with TemporaryDirectory() as folder:
        Path(folder, "test_nothing.py").write_text("def test_nothing():\n    pass\n")
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"]
        for _ in range(REPEATS):
            seconds = []
            for more in ([], ["-p", "no:rigsim"]):
                begin = time.perf_counter()
                subprocess.run([*command, *more], cwd=folder, check=True, stdout=subprocess.DEVNULL)
                seconds.append(time.perf_counter() - begin)
            differences.append(seconds[0] - seconds[1])
    return median(differences) * 1e3
