"""Rigs one after the other, or spread over processes; results come in the order of the rigs."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
from collections.abc import Generator, Iterable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace

from rigsim import guard, interrupts
from rigsim.errors import RigsimError
from rigsim.rig.stereo import StereoRig
from rigsim.sim.simulator import Simulator
from rigsim.study.scene.look import Outcome, run_rig
from rigsim.study.scene.plan import Plan
from rigsim.study.triangulators.registry import started

_AHEAD = 4  # rigs queued for each process: enough to keep it busy, few enough to stop soon

_THREADS = ("LP_NUM_THREADS", "OPENBLAS_NUM_THREADS")

_worker: tuple[Simulator, Plan] | None = None
_triangulators = contextlib.ExitStack()


def run_all(rigs: Iterable[StereoRig], plan: Plan, jobs: int, simulator: Simulator) -> Generator[Outcome]:
    """Yield the outcome of each rig, in order, whatever the number of processes."""
    if jobs == 1:
        for rig in rigs:
            yield run_rig(simulator, rig, plan)
        return
    yield from _run_in_processes(rigs, plan, jobs, simulator.backend)


def _run_in_processes(rigs: Iterable[StereoRig], plan: Plan, jobs: int, backend: str) -> Generator[Outcome]:
    waiting: list[Future[Outcome]] = []
    # forking after GL has started hangs the children
    pool = ProcessPoolExecutor(
        jobs, mp_context=multiprocessing.get_context("spawn"), initializer=_open, initargs=(plan, backend)
    )
    with _one_thread_each():
        try:
            for rig in rigs:
                with interrupts.held_back():  # a process that is still starting has no answer to Ctrl-C
                    waiting.append(pool.submit(_run, rig))
                if len(waiting) >= _AHEAD * jobs:
                    yield waiting.pop(0).result()
            while waiting:
                yield waiting.pop(0).result()
        except BrokenProcessPool:
            raise RigsimError(
                "a worker process died (out of memory, or the script lacks "
                "`if __name__ == '__main__':`): use --jobs 1"
            ) from None
        except BaseException:
            _end_workers()
            raise
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _open(plan: Plan, backend: str) -> None:
    """Set up one process; Ctrl-C is for the parent to handle."""
    global _worker
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    guard.end_with_parent()
    # never left: this process is ended, and whatever it started ends with it
    methods = _triangulators.enter_context(started(plan.triangulators, plan.timeout_s, at_once=False))
    _worker = (Simulator(plan.scene, plan.mount, backend), replace(plan, triangulators=methods))


def _run(rig: StereoRig) -> Outcome:
    assert _worker is not None
    simulator, plan = _worker
    return run_rig(simulator, rig, plan)


def _end_workers() -> None:
    """End all worker processes, whatever they are at."""
    for child in multiprocessing.active_children():
        child.kill()


@contextlib.contextmanager
def _one_thread_each() -> Iterator[None]:
    """Let each process rasterise and multiply with one thread: several processes share the cores better."""
    before = {name: os.environ.get(name) for name in _THREADS}
    for name in _THREADS:
        os.environ.setdefault(name, "1")
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
