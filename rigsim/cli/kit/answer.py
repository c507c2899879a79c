"""``--json``: one document on standard output, and nothing else there."""

from __future__ import annotations

import contextlib
import os
import shlex
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextvars import ContextVar
from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import typer

from rigsim.errors import OutputError

if TYPE_CHECKING:
    from rigsim.api.result import Result
    from rigsim.rig.remark import Remark


_TOLD: ContextVar[tuple[Remark, ...]] = ContextVar("_TOLD", default=())
"""What was said already of the calibration that a command starts from."""


def tell(remarks: Sequence[Remark]) -> None:
    """Print what is odd about the calibration that a command starts from; no answer prints it again."""
    _TOLD.set(())
    print_remarks(remarks)
    _TOLD.set(tuple(remarks))


def print_remarks(remarks: Iterable[Remark]) -> None:
    """Print each remark once, a line each on standard error: ``rigsim: note: ...``."""
    told = {_line(remark) for remark in _TOLD.get()}
    for text in dict.fromkeys(_line(remark) for remark in remarks):
        if text not in told:
            typer.echo(f"rigsim: note: {text}", err=True)


def _line(remark: Remark) -> str:
    return " ".join(remark.text.split())


def command() -> str:
    """The command as it was typed."""
    return shlex.join(["rigsim", *typed()])


def typed() -> list[str]:
    """The words after the program's name."""
    return sys.argv[1:]


def claim(out: Path | None, force: bool) -> None:
    """Fail before the work rather than after it when the folder `out` cannot be written."""
    if out is not None:
        from rigsim.interop.files.folder import check_output

        check_output(out, force)


def deliver(result: Result, out: Path | None, force: bool, as_json: bool) -> None:
    """Write, and print for people or as a document, what came of a command."""
    print_remarks(result.remarks)
    told = tuple(remark for remark in _TOLD.get() if remark not in result.remarks)
    if told and any(field.name == "remarks" for field in fields(cast(Any, result))):
        result = replace(cast(Any, result), remarks=(*told, *result.remarks))
    written = None if out is None else result.write(out, force)
    if as_json:
        print_document(result.document(written))
    else:
        result.print(out)


def print_document(document: Mapping[str, Any]) -> None:
    """Print `document` as strict JSON.

    Raises:
        OutputError: standard output is closed, or takes no more.
    """
    from rigsim.interop.documents.text import json_text

    try:
        typer.echo(json_text(document, getattr(sys.stdout, "encoding", None) or "utf-8"))
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        # what could not be written must not be tried again at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise OutputError(f"standard output: {error.strerror or error}; send it elsewhere") from None


@contextlib.contextmanager
def quiet(wanted: bool) -> Iterator[None]:
    """Send what others print meanwhile to standard error, when `wanted`.

    The user's own triangulator or matcher, the processes it runs in, and C libraries all may print.
    """
    if not wanted or sys.stdout is None:
        yield
        return
    sys.stdout.flush()
    kept = os.dup(1)
    try:
        os.dup2(2, 1)
        with contextlib.redirect_stdout(sys.stderr):
            yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
