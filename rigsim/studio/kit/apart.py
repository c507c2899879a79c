"""What takes longer than a frame runs in other processes, which end with this one."""

from __future__ import annotations

import functools
from collections.abc import Callable
from concurrent.futures.process import BrokenProcessPool
from typing import Any, ParamSpec, TypeVar

from nicegui import run, ui

from rigsim.studio.draw.child import begin

_P = ParamSpec("_P")
_R = TypeVar("_R")


async def apart(do: Callable[_P, _R], *words: _P.args, **named: _P.kwargs) -> _R | None:
    """What ``do(*words, **named)`` returns, from another process.

    None where it failed, which is said on the page, and where the page is being closed.
    """
    try:
        return await run.cpu_bound(_begun, do, words, named)
    except run.SubprocessException as error:
        ui.notify(error.original_message.partition("\n")[0][:300], type="warning")
    except BrokenProcessPool:
        ui.notify("The process that computes this has ended; change something to try again", type="warning")
    return None


def _begun(do: Callable[..., _R], words: tuple[Any, ...], named: dict[str, Any]) -> _R:
    _begin_once()
    return do(*words, **named)


@functools.cache
def _begin_once() -> None:
    begin()
