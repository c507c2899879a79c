"""Which process writes where: locks, temporary names, and what dead runs have left.

A temporary name holds the number of its process and when that began, so that the next run knows whose it is
and whether that still runs. A claim is a lock file in the system's folder for temporary files, with the
number of the process in it; the system holds the lock as long as the process lives.
"""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import os
import re
import secrets
import tempfile
from pathlib import Path

from rigsim import guard
from rigsim.errors import OutputError
from rigsim.guardian import remove as remove_path

_TEMPORARY = re.compile(r"\.rigsim-(?:(\d+)-(\d+)-)?[0-9a-f]{8}\.tmp")
_claimed: dict[Path, tuple[int, int, Path]] = {}
"""By output: the process that claimed it, the open lock file, and its path."""


def is_own(name: str) -> bool:
    """Whether a file name is one of rigsim's own temporary ones."""
    return _TEMPORARY.fullmatch(name) is not None


def temporary_name(folder: Path) -> Path:
    """A name in `folder` for what is not finished, known as this process's."""
    pid = os.getpid()
    return folder / f".rigsim-{pid}-{_began(pid)}-{secrets.token_hex(4)}.tmp"


def claim(path: Path) -> None:
    """Take the output `path` for this process.

    Raises:
        OutputError: another process writes there.
    """
    output = path.absolute()
    if output in _claimed and _claimed[output][0] == os.getpid():
        return
    key = hashlib.sha256(os.fsencode(output)).hexdigest()[:16]
    lock = Path(tempfile.gettempdir(), f".rigsim-{os.getuid()}-{key}.lock")
    guard.be_ready()
    try:
        descriptor = os.open(lock, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o600)
    except OSError:  # nowhere to lock: two runs are not told apart, but never overwrite either
        return
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        os.ftruncate(descriptor, 0)
        os.pwrite(descriptor, f"{os.getpid()}\n".encode(), 0)
    except BlockingIOError:
        holder = os.pread(descriptor, 20, 0).decode(errors="replace").strip()
        os.close(descriptor)
        raise OutputError(
            f"output folder {path}: another run (process {holder or 'unknown'}) writes there; wait for it, or"
            " choose another folder"
        ) from None
    except OSError:
        pass
    guard.keep("path", str(lock))
    _claimed[output] = (os.getpid(), descriptor, lock)


def release(path: Path) -> None:
    """Give back what `claim` took; nothing where nothing was."""
    pid, descriptor, lock = _claimed.pop(path.absolute(), (0, -1, path))
    if pid == os.getpid():
        with contextlib.suppress(OSError):
            lock.unlink()
        guard.let_go("path", str(lock))
        os.close(descriptor)


def release_all() -> None:
    """Give back every claim of this process."""
    for path in list(_claimed):
        release(path)


def moved(temporary: Path) -> None:
    """A temporary folder has become what it was made for."""
    guard.let_go("path", str(temporary.absolute()))


def remove(temporary: Path) -> None:
    """Remove a temporary folder of this process."""
    remove_path(str(temporary))
    guard.let_go("path", str(temporary.absolute()))


def sweep(folder: Path) -> None:
    """Remove what runs that have ended left in `folder`; what live ones work on stays."""
    with contextlib.suppress(OSError):
        for entry in list(os.scandir(folder)):
            found = _TEMPORARY.fullmatch(entry.name)
            if found and (found[1] is None or _began(int(found[1])) != int(found[2])):
                remove_path(entry.path)


def _began(pid: int) -> int:
    """When a process began, in the system's ticks, as numbers are used again; 0 where it does not run."""
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii", errors="replace") as file:
            return int(file.read().rpartition(")")[2].split()[19])
    except (OSError, IndexError, ValueError):
        pass
    try:  # no /proc
        os.kill(pid, 0)
    except OSError:
        return 0
    return 1
