"""Output folders: written whole or not at all, and never over what somebody else has put there.

Files are completed under temporary names on the same disk and moved into place, so a killed run leaves no
half file, and a full disk leaves nothing. A folder is claimed from the first check on until it is written or
the process ends: a second run into it is told at once. What a killed run left is removed by the next one.
"""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from rigsim import guard
from rigsim.errors import OutputError
from rigsim.interop.files import claims

NEEDED_BYTES = 16_000_000
"""Free space asked for before a run starts: a report with its pictures and tables, generously."""

_REASONS = {
    errno.ENOSPC: "the disk is full; free some space or choose another folder",
    errno.EDQUOT: "the disk quota is used up; free some space or choose another folder",
    errno.EROFS: "the disk is read-only; choose another folder",
    errno.EACCES: "permission denied; choose another folder",
    errno.EPERM: "permission denied; choose another folder",
    errno.ENAMETOOLONG: "the name is too long; choose another folder",
}


def check_output(
    path: Path, force: bool = False, *, names: Collection[str] = (), needed_bytes: int = NEEDED_BYTES
) -> None:
    """Fail before the work rather than after it when `path` cannot take the files called `names`.

    The folder is claimed for this process: another one that checks it fails until this one has ended.

    Raises:
        OutputError: not a folder, not writable, not empty without `force`, another run's, or on a full disk.
    """
    try:
        ground = _check(path, force, names, needed_bytes)
        claims.claim(path)
        claims.sweep(ground)
    except OSError as error:
        if isinstance(error, OutputError):
            raise
        raise _explained(path, error) from None


def write_folder(path: Path, files: Mapping[str, bytes], force: bool = False) -> None:
    """Write `files` (name to content) into the folder `path`, made with its parents when missing.

    A new folder appears whole. With `force` the files are replaced one by one, each whole, and
    files of other names stay.

    Raises:
        OutputError: as `check_output`; nothing half-written is left.
        ValueError: a name is not a plain file name.
    """
    for name in files:
        if name in ("", ".", "..") or Path(name).name != name:
            raise ValueError(f"file name {name!r}: must be plain, without a folder")
    check_output(path, force, names=files, needed_bytes=0)
    made: list[Path] = []
    temporary: Path | None = None
    try:
        made = _make_parents(path)
        is_new = not path.exists()
        temporary = _temporary_beside(path)
        for name, content in files.items():
            _write_through(temporary / name, content)
        if is_new:
            os.rename(temporary, path)  # refused by the system when the folder has been filled meanwhile
            claims.moved(temporary)
            temporary, made = None, []
        else:
            _move_in(temporary, path, force)
    except OSError as error:
        raise _explained(path, error) from None
    finally:
        if temporary is not None:
            claims.remove(temporary)
            if not path.exists():
                _remove_empty(made)
        claims.release(path)


@contextmanager
def folder_in_progress(
    path: Path, force: bool = False, *, needed_bytes: int = NEEDED_BYTES
) -> Iterator[Path]:
    """A folder to fill, with subfolders as wanted, that becomes `path` once the block ends without an error.

    For what does not fit memory at once. A new folder appears whole. With `force` the files are moved in one
    by one, each whole, and files of other names stay.

    Raises:
        OutputError: as `check_output`, and when the disk fails on the way; nothing is left of it.
    """
    check_output(path, force, needed_bytes=needed_bytes)
    made: list[Path] = []
    temporary: Path | None = None
    try:
        made = _make_parents(path)
        is_new = not path.exists()
        temporary = _temporary_beside(path)
        yield temporary
        if is_new:
            os.rename(temporary, path)
            claims.moved(temporary)
            temporary, made = None, []
        else:
            _move_in(temporary, path, force)
    except OSError as error:
        if isinstance(error, OutputError):
            raise
        raise _explained(path, error) from None
    finally:
        if temporary is not None:
            claims.remove(temporary)
            if not path.exists():
                _remove_empty(made)
        claims.release(path)


def write_file(path: Path, content: bytes) -> None:
    """Write one file whole, over an older one of that name; a link keeps leading to it.

    A device or a pipe (``/dev/stdout``) is written into, as nothing may stand in its place.

    Raises:
        OutputError: its folder does not exist or cannot be written; an older file stays as it was.
    """
    target = path.resolve() if path.is_symlink() and path.is_file() else path
    temporary = claims.temporary_name(target.absolute().parent)
    guard.keep("path", str(temporary))
    try:
        if path.exists() and not path.is_file() and not path.is_dir():
            _write_into(path, content)
        else:
            _write_through(temporary, content)
            os.replace(temporary, target)
    except OSError as error:
        reason = _REASONS.get(error.errno or 0, f"{error.strerror or error}; choose another folder")
        raise OutputError(f"output file {path}: {reason}") from None
    finally:
        temporary.unlink(missing_ok=True)
        guard.let_go("path", str(temporary))


def _check(path: Path, force: bool, names: Collection[str], needed_bytes: int) -> Path:
    """The folder, there already, in which `path` is or will be."""
    if path.is_dir():
        held = _held(path)
        if held and not force:
            some = ", ".join(held[:3]) + (", ..." if len(held) > 3 else "")
            raise OutputError(
                f"output folder {path}: already holds {some}; choose another one, or add --force to replace"
                " rigsim's files"
            )
        for name in names:
            if (path / name).is_dir():
                raise OutputError(
                    f"output folder {path}: {name} is a folder there; choose another output folder"
                )
        ground = path
    elif path.is_symlink() and not path.exists():
        raise OutputError(f"output folder {path}: is a link that leads nowhere; choose another folder")
    elif path.exists():
        raise OutputError(f"output folder {path}: is a file; choose a folder")
    else:
        ground = next(parent for parent in path.absolute().parents if parent.exists())
        if not ground.is_dir():
            raise OutputError(f"output folder {path}: {ground} is a file; choose another folder")
    if not os.access(ground, os.W_OK | os.X_OK):
        raise OutputError(f"output folder {path}: {ground} is not writable; choose another folder")
    free = shutil.disk_usage(ground).free
    if free < needed_bytes:
        raise OutputError(
            f"output folder {path}: {free / 1e6:.1f} MB are free on its disk, must be >="
            f" {needed_bytes / 1e6:.0f} MB; free some space or choose another folder"
        )
    return ground


def _held(path: Path) -> list[str]:
    """Names in a folder, without rigsim's own temporary ones."""
    return sorted(entry.name for entry in path.iterdir() if not claims.is_own(entry.name))


def _move_in(temporary: Path, path: Path, force: bool) -> None:
    """Move the files of a temporary folder into one that was there; over their namesakes with `force`."""
    if not force and _held(path):
        raise OSError(errno.ENOTEMPTY, os.strerror(errno.ENOTEMPTY))
    for file in sorted(part for part in temporary.rglob("*") if part.is_file()):
        target = path / file.relative_to(temporary)
        target.parent.mkdir(parents=True, exist_ok=True)
        if force:
            os.replace(file, target)
        else:
            os.link(file, target)  # unlike a rename, refused when something of that name has come meanwhile
            file.unlink()


def _make_parents(path: Path) -> list[Path]:
    """Make the missing parents, and name those that were made, innermost first."""
    missing = [parent for parent in path.absolute().parents if not parent.exists()]
    path.absolute().parent.mkdir(parents=True, exist_ok=True)
    return missing


def _temporary_beside(path: Path) -> Path:
    """A new hidden folder on `path`'s own disk; not tempfile's, whose mode would outlive the move."""
    temporary = claims.temporary_name(path if path.exists() else path.absolute().parent)
    guard.keep("path", str(temporary.absolute()))
    temporary.mkdir()
    return temporary


def _write_into(path: Path, content: bytes) -> None:
    """Write into what is no regular file; a pipe that nobody reads fails instead of waiting."""
    descriptor = os.open(path, os.O_WRONLY | os.O_NONBLOCK)
    os.set_blocking(descriptor, True)
    with open(descriptor, "wb") as file:
        file.write(content)


def _write_through(path: Path, content: bytes) -> None:
    with path.open("xb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())  # some disks say only now that they are full


def _remove_empty(folders: list[Path]) -> None:
    for folder in folders:
        try:
            folder.rmdir()
        except OSError:
            return


def _explained(path: Path, error: OSError) -> OutputError:
    if error.errno in (errno.EEXIST, errno.ENOTEMPTY):
        return OutputError(f"output folder {path}: another run has just filled it; choose another one")
    reason = _REASONS.get(error.errno or 0, f"{error.strerror or error}; choose another folder")
    return OutputError(f"output folder {path}: {reason}")
