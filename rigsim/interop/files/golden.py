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
from rigsim.study.verify.golden import Number, Record

_COLUMNS = ["name", "value", "unit", "allowed", "standard_error"]
_AGAIN = "write it again with --update"


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


def _text(record: Record) -> str:
    body = io.StringIO()
    body.writelines(f"# {key}: {value}\n" for key, value in record.about.items())
    writer = csv.writer(body, lineterminator="\n")
    writer.writerow(_COLUMNS)
    for number in record.numbers:
        few = [f"{value:.10g}" if value else "" for value in (number.allowed, number.standard_error)]
        writer.writerow([number.name, f"{number.value:.10g}", number.unit, *few])
    return body.getvalue() + f"# sha256 {_checksum(body.getvalue())}\n"


def _read(path: Path) -> Record:
    try:
        text = foreign.read_text(path, "a golden file")
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
                float(row["value"]),
                row["unit"],
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
