"""Rigs one after the other, or spread over processes; results come in the order of the rigs."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
from collections.abc import Generator, Iterable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool

from rigsim.errors import RigsimError
from rigsim.rig.stereo import StereoRig
from rigsim.sim.simulator import Simulator
from rigsim.study.geometry import Outcome, run_rig
from rigsim.study.plan import Plan

_AHEAD = 4  # rigs queued for each process: enough to keep it busy, few enough to stop soon

_THREADS = ("LP_NUM_THREADS", "OPENBLAS_NUM_THREADS")

_worker: tuple[Simulator, Plan] | None = None


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
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _open(plan: Plan, backend: str) -> None:
    """Set up one process; Ctrl-C is for the parent to handle."""
    global _worker
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _worker = (Simulator(plan.scene, plan.mount, backend), plan)


def _run(rig: StereoRig) -> Outcome:
    assert _worker is not None
    simulator, plan = _worker
    return run_rig(simulator, rig, plan)


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
