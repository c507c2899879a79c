"""The last resort: a fault that nobody foresaw is one line, and a file with the details."""

from __future__ import annotations

import tempfile
import time
import traceback

NO_NET = "RIGSIM_NO_NET"
"""Environment variable that lets unforeseen faults through as they are; tests set it."""


def unforeseen(error: BaseException, words: list[str]) -> str:
    """One line about a fault that is rigsim's own; the traceback goes to a file, which the line names."""
    doing = " ".join(["rigsim", *words])
    doing = doing if len(doing) <= 200 else doing[:197] + "..."
    text = "".join(traceback.format_exception(error))
    lines = str(error).strip().splitlines()
    says = f"{type(error).__name__}: {lines[0][:200]}" if lines else type(error).__name__
    try:
        prefix = f"rigsim-fault-{time.strftime('%Y%m%d-%H%M%S')}-"
        descriptor, path = tempfile.mkstemp(prefix=prefix, suffix=".txt")
        with open(descriptor, "w", encoding="utf-8", errors="backslashreplace") as file:
            file.write(f"{doing}\n\n{text}")
        where = f"the details are in {path}; please report them"
    except OSError as problem:
        where = f"the details could not be written ({problem.strerror or problem})"
    return f"an internal error of rigsim in `{doing}` ({says}): {where}"
