"""Work of seconds, in processes beside the page."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures.process import BrokenProcessPool
from typing import TypeVar

from nicegui import run, ui

Answer = TypeVar("Answer")


async def beside(do: Callable[..., Answer], *words: object) -> Answer | None:
    """Do it in another process; None where that failed, which is said, or the page ends.

    Args:
        do: a function of a module.
        words: its arguments, which are sent to the other process.
    """
    try:
        return await run.cpu_bound(do, *words)
    except run.SubprocessException as error:
        ui.notify(f"{error.original_message.splitlines()[0][:300]}", type="warning")
    except BrokenProcessPool:
        ui.notify("The process that computes this has ended; change something to try again", type="warning")
    return None
