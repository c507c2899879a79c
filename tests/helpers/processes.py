"""What became of processes."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path


def is_alive(pid: int) -> bool:
    """Whether a process runs; one that was killed may still wait for its parent to notice."""
    try:
        os.kill(pid, 0)
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] not in ("Z", "X")
    except (ProcessLookupError, FileNotFoundError):
        return False


def wait_for_end(pid: int) -> None:
    """Return when a process that was killed is gone; the system takes its time."""
    while is_alive(pid):
        time.sleep(0.01)


def children() -> set[int]:
    """This process's children, those that nobody has waited for included."""
    folders = Path("/proc/self/task").iterdir()
    return {int(pid) for folder in folders for pid in (folder / "children").read_text().split()}


def modules_after(*words: str) -> set[str]:
    """The modules that a fresh process holds after ``rigsim WORDS``."""
    code = (
        "import sys\n"
        "from rigsim.cli.app import run\n"
        "code = run(sys.argv[1:])\n"
        "print(' '.join(sys.modules), file=sys.stderr)\n"
        "sys.exit(code)"
    )
    done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True, check=True)
    return set(done.stderr.splitlines()[-1].split())
