"""How far a long run has come."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager


@contextmanager
def shown(total: int, things: str) -> Iterator[Callable[[int], None] | None]:
    """A bar with things done, things/s and the time left, on a terminal's stderr; nothing elsewhere."""
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    with Progress(
        TextColumn(things),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeRemainingColumn(),
        console=Console(stderr=True),
        transient=True,
    ) as bar:
        task = bar.add_task(things, total=total, rate="")
        begin = time.monotonic()

        def advance(done: int) -> None:
            rate = done / max(time.monotonic() - begin, 1e-9)
            bar.update(task, completed=done, rate=f"{rate:.2g} {things}/s")

        yield advance


@contextmanager
def stages() -> Iterator[Callable[[str, int, int], None]]:
    """A bar for each stage in turn, as `shown`: to be told what things, how many are done, of how many."""
    now = ""
    with ExitStack() as stack:
        advance: Callable[[int], None] | None = None

        def tell(things: str, done: int, total: int) -> None:
            nonlocal now, advance
            if things != now:
                stack.close()
                now, advance = things, stack.enter_context(shown(total, things))
            if advance is not None:
                advance(done)

        yield tell
