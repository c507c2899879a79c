"""Hypothesis profiles: the same examples every time where it must be repeatable; one thread a process."""

from __future__ import annotations

import os
import signal

import pytest
from hypothesis import settings

# read when numpy and GL are first loaded: there are as many test processes as cores
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("LP_NUM_THREADS", "1")
os.environ["RIGSIM_NO_NET"] = "1"  # a fault must be seen, not caught in a line

# nohup, and a shell that starts the tests in the background, ignore these, and so would what is started here
for _number in (signal.SIGINT, signal.SIGHUP):
    if signal.getsignal(_number) is signal.SIG_IGN:
        signal.signal(_number, signal.default_int_handler if _number == signal.SIGINT else signal.SIG_DFL)

settings.register_profile("ci", deadline=None, derandomize=True)
settings.register_profile("dev", deadline=None)
settings.load_profile("ci" if os.environ.get("CI") else "dev")


@pytest.fixture
def few_built_rigs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Designs build 200 rigs a class, not 2000: for tests that do not ask for a yield to the percent."""
    from rigsim.study.design import tolerance

    monkeypatch.setattr(tolerance, "_RIGS", 200)
