"""The command line in this process: a new interpreter takes seconds to import what a command needs."""

from __future__ import annotations

import contextlib
import io
from dataclasses import dataclass
from pathlib import Path

from rigsim.cli.app import run


@dataclass(frozen=True)
class Done:
    """What became of a command, by the names that `subprocess` gives it."""

    returncode: int
    stdout: str
    stderr: str


def rigsim(*words: object, cwd: Path) -> Done:
    """Run ``rigsim WORDS`` in the folder `cwd`.

    For what belongs to a process (signals, exit codes of the shell, its environment, user's modules) start
    a real one.
    """
    raw = io.BytesIO(), io.BytesIO()
    out, err = (io.TextIOWrapper(stream, encoding="utf-8", write_through=True) for stream in raw)
    with contextlib.chdir(cwd), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = run([str(word) for word in words])
    return Done(code, *(stream.getvalue().decode("utf-8") for stream in raw))
