"""Does `rigsim verify` catch the mutants, name them, and leave right triangulators alone; and its seconds."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Mapping, Sequence

from benchmarks.subjects import triangulators
from benchmarks.subjects.mutant import Mutant
from benchmarks.subjects.mutant_names import named_right
from benchmarks.subjects.mutants import MUTANTS
from rigsim.study.triangulators.registry import KNOWN
from rigsim.study.verify.case import Case
from rigsim.study.verify.checks import statistical_checks
from rigsim.study.verify.runner import FALSE_ALARM, run_case, verify
from rigsim.study.verify.session import Selection, gather
from rigsim.theory.custom import TriangulatorFunction

SEEDS = 200
SCENES_EVERY = 10
LIMITS_S = {"quick": 20, "full": 300}
RIGHT: Mapping[str, TriangulatorFunction] = {
    "optimal": KNOWN["optimal"],
    "dlt": KNOWN["dlt"],
    "midpoint": KNOWN["midpoint"],
    "cv2": KNOWN["cv2"],
    "own linear": triangulators.linear,
    "own rectification": triangulators.opencv,
}
"""Triangulators that must pass."""


def run() -> None:
    """Print the score by suite, what was named for each mutant, false alarms and seconds."""
    quick = gather(Selection("quick")).cases
    score(quick)
    full = gather(Selection("full")).cases
    missed = [mutant.name for mutant in MUTANTS if not caught(mutant, full)]
    print(f"caught by full            {tally(MUTANTS, missed)}   (limit all)", flush=True)
    false_alarms()
    for suite, limit_s in LIMITS_S.items():
        print(f"rigsim verify --suite {suite:6}{seconds(suite):6.1f} s   (limit {limit_s} s)", flush=True)


def score(cases: Sequence[Case]) -> None:
    """Mutants against the quick suite: caught, and named; one that is only wasteful is not diagnosed."""
    missed, wrong = [], []
    failing = [mutant for mutant in MUTANTS if not mutant.only_strict]
    for mutant in MUTANTS:
        (result,) = verify(cases, {mutant.name: mutant.function})
        if result.passed(mutant.only_strict):
            missed.append(mutant.name)
        if mutant.only_strict:
            continue
        right = named_right(mutant, result.diagnoses)
        if not right:
            wrong.append(mutant.name)
        says = ", ".join(f"{one.mistake} {one.explained:.2f}" for one in result.diagnoses) or "nothing"
        print(f"  {mutant.name:32}{'right' if right else 'wrong':7}{says}", flush=True)
    print(f"caught by quick           {tally(MUTANTS, missed)}   (limit all)")
    print(f"rightly named             {tally(failing, wrong)}   (limit 80 %)", flush=True)


def tally(mutants: Sequence[Mutant], lost: Sequence[str]) -> str:
    n = len(mutants)
    return f"{n - len(lost)} of {n}, {1 - len(lost) / n:.0%}{'; not ' if lost else ''}{', '.join(lost)}"


def caught(mutant: Mutant, cases: Sequence[Case]) -> bool:
    """Whether a case fails; the first is enough."""
    share = FALSE_ALARM / sum(statistical_checks(case) for case in cases)
    return any(
        run_case(case, mutant.name, mutant.function, share).status(mutant.only_strict) in ("failed", "error")
        for case in cases
    )


def false_alarms() -> None:
    """Right triangulators, one run for each and every seed."""
    alarms: list[str] = []
    for seed in range(SEEDS):
        scenes = None if seed % SCENES_EVERY == 0 else ()
        cases = gather(Selection("quick", seed, scenes=scenes)).cases
        for name, function in RIGHT.items():
            (result,) = verify(cases, {name: function})
            if not result.passed():
                alarms.append(f"{name} (seed {seed})")
    share = len(alarms) / (SEEDS * len(RIGHT))
    print(
        f"false alarms              {len(alarms)} of {SEEDS * len(RIGHT)}, {share:.1%}   (limit 1 %): "
        f"{SEEDS} seeds of {', '.join(RIGHT)} {' '.join(alarms)}",
        flush=True,
    )


def seconds(suite: str) -> float:
    """Of a whole process, with rigsim's own and OpenCV's triangulators."""
    command = [sys.executable, "-m", "rigsim", "verify", "--suite", suite]
    begin = time.perf_counter()
    subprocess.run(
        [*command, "--triangulator", "optimal,dlt,midpoint,rectified,cv2"], check=True, capture_output=True
    )
    return time.perf_counter() - begin
