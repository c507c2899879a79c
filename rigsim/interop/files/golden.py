"""Golden results as text files that are read in a review: a head of comments, a line a number, a checksum."""

from __future__ import annotations

import csv
import hashlib
import io
from collections.abc import Iterable
from pathlib import Path

from rigsim import foreign
from rigsim.errors import OutputError
from rigsim.interop.files.folder import write_file
from rigsim.study.golden.compare import COMMAND, TABLE, Number, Record

_COLUMNS = ["name", "value", "unit", "allowed", "standard_error"]
_AGAIN = "write it again with --update"
_BYTES = 64_000_000
_WORD = "word"
"""Unit of what is no number."""


def write_golden(folder: Path, records: Iterable[Record]) -> list[Path]:
    """Write each record as ``NAME.csv``, each whole; other files of the folder stay.

    Raises:
        OutputError: the folder cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"golden folder {folder}: {error.strerror}; choose another folder") from None
    written = []
    for record in records:
        written.append(folder / f"{record.name}.csv")
        write_file(written[-1], _text(record).encode())
    return written


def read_golden(folder: Path, names: Iterable[str]) -> tuple[list[Record], list[str]]:
    """The records called `names` that the folder holds, and one line for each that cannot be read.

    Raises:
        OutputError: there is no such folder.
    """
    if not folder.is_dir():
        raise OutputError(f"golden folder {folder}: does not exist; make it with rigsim verify --update")
    records, troubles = [], []
    for name in names:
        path = folder / f"{name}.csv"
        if not path.exists():
            continue
        try:
            records.append(_read(path))
        except (OutputError, UnicodeDecodeError) as error:
            troubles.append(str(error))
    return records, troubles


def golden_file(path: Path, command: str) -> Path:
    """The golden file of a command: `path` itself where it names a CSV file, else one in that folder."""
    is_file = path.suffix == ".csv" and not path.is_dir()
    return path if is_file else path / f"{command.replace(' ', '-')}.csv"


def check_golden(path: Path, command: str, update: bool) -> None:
    """Fail before the work rather than after it where golden results cannot be read, or not be written.

    Raises:
        OutputError: there is none to compare with, it is another command's, or something else lies there.
    """
    if not update:
        read_one(path, command)
        return
    file = golden_file(path, command)
    if not file.exists():
        return
    if not file.is_file():
        raise OutputError(f"golden file {file}: is no file; choose another one")
    with file.open("rb") as stream:
        head = stream.read(1)
    if head not in (b"#", b""):
        raise OutputError(f"golden file {file}: is there, and no golden file; choose another one")
    try:
        old = _read(file)
    except OutputError:
        return  # what was edited or cut off is written anew
    _same_command(file, old, command)


def read_one(path: Path, command: str) -> Record:
    """The golden numbers of a command, from a file or from its file in a folder.

    Raises:
        OutputError: there is none, it cannot be read, or it is another command's.
    """
    file = golden_file(path, command)
    if not file.exists():
        raise OutputError(
            f"golden file {file}: does not exist; make it with --update, or in Python with update=True or "
            "RIGSIM_UPDATE_GOLDEN=1"
        )
    record = _read(file)
    _same_command(file, record, command)
    return record


def write_one(path: Path, record: Record) -> Path:
    """Write the golden numbers of a command; a folder is made where it is missing.

    Raises:
        OutputError: it cannot be written.
    """
    file = golden_file(path, record.about[COMMAND])
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"golden folder {file.parent}: {error.strerror}; choose another folder") from None
    write_file(file, _text(record).encode())
    return file


def _same_command(file: Path, record: Record, command: str) -> None:
    other = record.about.get(COMMAND, "verify")
    if other != command:
        raise OutputError(
            f"golden file {file}: is of {_called(other)}, not of {_called(command)}; give another file"
        )


def _called(command: str) -> str:
    return "a table" if command == TABLE else f"rigsim {command}"


def _text(record: Record) -> str:
    body = io.StringIO()
    body.writelines(f"# {key}: {value}\n" for key, value in record.about.items())
    writer = csv.writer(body, lineterminator="\n")
    writer.writerow(_COLUMNS)
    for number in record.numbers:
        if isinstance(number.value, str):
            writer.writerow([number.name, number.value, _WORD, "", ""])
            continue
        few = [f"{value:.10g}" if value else "" for value in (number.allowed, number.standard_error)]
        writer.writerow([number.name, f"{number.value:.10g}", number.unit, *few])
    return body.getvalue() + f"# sha256 {_checksum(body.getvalue())}\n"


def _read(path: Path) -> Record:
    try:
        text = foreign.read_text(path, "a golden file", _BYTES)
    except (OutputError, UnicodeDecodeError) as error:
        raise OutputError(f"golden file {error}; {_AGAIN}") from None
    body, mark, checksum = text.rpartition("# sha256 ")
    if not mark:
        raise OutputError(f"golden file {path}: its last line, the checksum, is missing (cut off?); {_AGAIN}")
    if checksum.strip() != _checksum(body):
        raise OutputError(
            f"golden file {path}: does not fit its checksum: edited or cut off since it was written; {_AGAIN}"
        )
    head = [line for line in body.splitlines() if line.startswith("#")]
    about = dict(line[2:].split(": ", 1) for line in head if ": " in line)
    rows = csv.DictReader(line for line in body.splitlines() if not line.startswith("#"))
    try:
        numbers = tuple(
            Number(
                row["name"],
                row["value"] if row["unit"] == _WORD else float(row["value"]),
                "" if row["unit"] == _WORD else row["unit"],
                float(row["allowed"] or 0),
                float(row["standard_error"] or 0),
            )
            for row in rows
        )
    except (KeyError, TypeError, ValueError, csv.Error) as error:
        raise OutputError(f"golden file {path}: cannot be read ({error}); {_AGAIN}") from None
    return Record(path.stem, about, numbers)


def _checksum(body: str) -> str:
    return hashlib.sha256(body.encode()).hexdigest()[:16]
