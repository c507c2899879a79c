"""The renderer of the server: a process of its own, and a queue where only the newest request survives."""

from __future__ import annotations

import asyncio
import contextlib
import threading
import time
from dataclasses import dataclass, field
from typing import TypeAlias

from rigsim.studio.draw import worker
from rigsim.studio.draw.child import Child
from rigsim.studio.draw.request import Failed, Pair, PairRequest

FREED_AFTER_S = 30.0
"""The process ends so long after the last key was released."""
UNUSED_S = 900.0
"""The process ends so long after the last picture, even if keys are held."""
LONGEST_S = 120.0
"""A picture that takes longer is given up, and the process with it."""

_LONG_S = 4.0  # that a full picture may wait behind coarse ones

Drawn: TypeAlias = Pair | Failed | None
"""A pair, why there is none, or nothing where nobody waits for it any more."""


@dataclass(eq=False)
class _Job:
    """A call that waits for its picture."""

    key: str
    request: PairRequest
    loop: asyncio.AbstractEventLoop
    future: asyncio.Future[Drawn]
    since: float = field(default_factory=time.monotonic)

    def answer(self, answer: Drawn) -> None:
        """Let the call return, from any thread."""
        with contextlib.suppress(RuntimeError):  # its loop has been closed
            self.loop.call_soon_threadsafe(self._set, answer)

    def _set(self, answer: Drawn) -> None:
        if not self.future.done():
            self.future.set_result(answer)


class RenderProcess:
    """Draws pairs for any number of keys (a key is a browser's tab), one at a time.

    The process is started for the first request, and again for the next one after it stopped.
    """

    def __init__(
        self, freed_after_s: float = FREED_AFTER_S, unused_s: float = UNUSED_S, longest_s: float = LONGEST_S
    ) -> None:
        """Begin without a process.

        Args:
            freed_after_s: the process ends so long after the last key was released.
            unused_s: the process ends so long after the last picture, even if keys are held.
            longest_s: a picture that takes longer is given up.
        """
        self._freed_after_s, self._unused_s, self._longest_s = freed_after_s, unused_s, longest_s
        self._changed = threading.Condition()
        self._waiting: dict[str, _Job] = {}
        self._served: dict[str, float] = {}  # when each held key last got a picture
        self._used = time.monotonic()
        self._current: _Job | None = None
        self._child: Child | None = None
        self._thread: threading.Thread | None = None
        self._closed = False

    @property
    def pid(self) -> int | None:
        """Process id of the renderer; None while there is none."""
        child = self._child
        return None if child is None else child.pid

    @property
    def waiting(self) -> tuple[str, ...]:
        """Keys whose newest request has not been begun."""
        with self._changed:
            return tuple(self._waiting)

    @property
    def drawing(self) -> str | None:
        """The key whose picture is being drawn."""
        current = self._current
        return None if current is None else current.key

    async def draw(self, key: str, request: PairRequest) -> Drawn:
        """The pair; why there is none; or None where a newer request of the same key took its place.

        Args:
            key: whose it is, as a tab's name: it holds the process until it is released.
            request: what to draw.
        """
        loop = asyncio.get_running_loop()
        job = _Job(key, request, loop, loop.create_future())
        with self._changed:
            if self._closed:
                return None
            older = self._waiting.pop(key, None)
            self._waiting[key] = job
            self._served.setdefault(key, 0.0)
            self._stop_current(key)
            if self._thread is None:
                self._thread = threading.Thread(target=self._run, name="rigsim renderer", daemon=True)
                self._thread.start()
            self._changed.notify()
        if older is not None:
            older.answer(None)
        try:
            return await job.future
        finally:
            with self._changed:
                if self._waiting.get(key) is job:
                    del self._waiting[key]

    def release(self, key: str) -> None:
        """Forget a key: what it waits for returns None, and it holds the process no longer."""
        with self._changed:
            job = self._waiting.pop(key, None)
            self._served.pop(key, None)
            self._used = time.monotonic()
            self._changed.notify()
        if job is not None:
            job.answer(None)

    def close(self) -> None:
        """End the process at once and for good; whoever waits gets None."""
        with self._changed:
            self._closed = True
            jobs = [*self._waiting.values(), *([] if self._current is None else [self._current])]
            self._waiting.clear()
            child, self._child = self._child, None
            thread = self._thread
            self._changed.notify()
        for job in jobs:
            job.answer(None)
        if child is not None:
            child.end()
        if thread is not None:
            thread.join()
        if child is not None:
            child.close()

    def _stop_current(self, key: str) -> None:
        """End a full picture that the same key no longer wants; a coarse one is as good as done."""
        current = self._current
        if current is None or current.key != key or current.request.coarse or self._child is None:
            return
        with contextlib.suppress(OSError):  # whoever receives from it finds out as well
            self._child.send(worker.STOP)

    def _run(self) -> None:
        """The thread that talks to the process."""
        while (job := self._await_job()) is not None:
            answer = self._draw(job)
            with self._changed:
                self._current = None
                self._used = time.monotonic()
                if job.key in self._served:
                    self._served[job.key] = self._used
            job.answer(answer)

    def _await_job(self) -> _Job | None:
        """The next job; None when the thread is to end, with the process ended before."""
        with self._changed:
            while not self._closed:
                job = self._choose()
                if job is not None:
                    self._current = self._waiting.pop(job.key)
                    return job
                spare_s = (
                    self._used + (self._unused_s if self._served else self._freed_after_s) - time.monotonic()
                )
                if spare_s <= 0:
                    break
                self._changed.wait(spare_s)
            self._thread = None
            if not self._closed and self._child is not None:
                self._child.close()
                self._child = None
            return None

    def _choose(self) -> _Job | None:
        """Coarse before full, unless that waited long; then who has waited longest since the last picture."""
        now = time.monotonic()

        def rank(job: _Job) -> tuple[bool, float, float]:
            late = now - job.since > _LONG_S
            return (not (job.request.coarse or late), self._served.get(job.key, 0.0), job.since)

        return min(self._waiting.values(), key=rank, default=None)

    def _draw(self, job: _Job) -> Drawn:
        """Have the process draw; where it stops, say so to all who wait, and start it again."""
        try:
            child = self._started()
            if child is None:
                return None
            child.send(job.request)
            answer: Drawn = child.receive(self._longest_s)
        except TimeoutError:
            return self._begin_again(f"gave no picture within {self._longest_s:g} s")
        except (EOFError, OSError):
            return self._begin_again("")
        return answer

    def _started(self) -> Child | None:
        with self._changed:
            if self._child is None and not self._closed:
                self._child = Child(worker.main)
            return self._child

    def _begin_again(self, why: str) -> Drawn:
        with self._changed:
            child, self._child = self._child, None
            jobs = list(self._waiting.values())
            self._waiting.clear()
        if child is None:
            return None  # closed
        said = why or child.how_it_ended()
        child.close()
        failed = Failed(
            f"The renderer stopped ({said}); it has been started again: move a control to draw anew."
        )
        with contextlib.suppress(OSError):  # then the next request says so
            self._started()
        for job in jobs:
            job.answer(failed)
        return failed
