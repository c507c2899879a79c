"""Ends what must not outlive rigsim, whatever ends rigsim itself; a script that needs nothing of it.

`rigsim.guard` starts it and tells it on standard input, a JSON line each, what is to be ended and what no
longer is. When the lines end, because rigsim has, killed or not, it ends what is left and then itself.
"""

import contextlib
import json
import os
import shutil
import signal
import sys
import time

_ROUNDS = 20  # a family may grow while it is ended
_PAUSE_S = 0.005


def end_family(mark: str) -> None:
    """Kill every process whose environment holds `mark`, those in sessions of their own too."""
    looks = 0  # a process that just becomes another program shows no environment: look twice
    for _ in range(_ROUNDS):
        found = _marked(mark.encode())
        for pid in found:
            with contextlib.suppress(OSError):
                os.kill(pid, signal.SIGKILL)
        looks = 0 if found else looks + 1
        if looks == 2:
            return
        time.sleep(_PAUSE_S)


def _marked(mark: bytes) -> list[int]:
    found = []
    with contextlib.suppress(OSError):  # no /proc: the process group must do
        for name in os.listdir("/proc"):
            if name.isdigit() and int(name) != os.getpid():
                with contextlib.suppress(OSError), open(f"/proc/{name}/environ", "rb") as environment:
                    if mark in environment.read():
                        found.append(int(name))
    return found


def remove(path: str) -> None:
    """Remove a temporary folder or file."""
    if os.path.isdir(path) and not os.path.islink(path):
        shutil.rmtree(path, ignore_errors=True)
    else:
        with contextlib.suppress(OSError):
            os.unlink(path)


def main() -> None:
    """Listen, then end what is left."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    kept: dict[tuple[str, str], None] = {}
    for line in sys.stdin:
        with contextlib.suppress(ValueError):
            word, kind, what = json.loads(line)
            if word == "keep":
                kept[kind, what] = None
            else:
                kept.pop((kind, what), None)
    for kind, what in kept:
        if kind == "family":
            end_family(what)
    for kind, what in kept:
        if kind == "path":
            remove(what)


if __name__ == "__main__":
    if os.fork() == 0:  # nobody's child: whoever waits for all of theirs must not wait for this one
        main()
