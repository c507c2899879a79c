"""Argument lists and files that nobody meant: every answer is in time, in one line, and no traceback."""

from __future__ import annotations

import contextlib
import io
import os
import random
import resource
import signal
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from types import FrameType

from benchmarks.subjects.fuzz_seeds import SEEDS
from rigsim.cli import app
from rigsim.cli.kit.faults import NO_NET

ARGUMENTS = 2000
FILES = 3000
SEED = 1
LIMIT_S = 10.0  # of processor time, as the machine may be shared
WAIT_S = 60  # of anything, so that what waits for ever is found, too
MEMORY_B = 2_000_000_000

NUMBERS = (
    "0",
    "1",
    "-1",
    "0.5",
    "3",
    "70",
    "1e300",
    "-1e300",
    "nan",
    "inf",
    "1e-300",
    "99999999999",
    "0x10",
    "½",
    "١",
)
UNITS = (
    "",
    "mm",
    "m",
    "cm",
    "px",
    "deg",
    "%",
    "um",
    "km",
    "mm@3m",
    "%@4m",
    ":",
    ":5",
    "/",
    "/0",
    "x3",
    ",",
    "x480",
)
WORDS = (
    "",
    " ",
    "boards",
    "nothing",
    "../..",
    "a:b",
    "=1+1",
    "\t",
    "é",
    "\u202e",
    "x" * 300,
    "{}",
    "--",
    "-",
    "*",
    "$HOME",
)
COMMANDS: dict[tuple[str, ...], tuple[str, ...]] = {
    ("calc", "point"): (
        "--focal",
        "--baseline",
        "--left",
        "--right",
        "--resolution",
        "--principal",
        "--noise",
        "--hfov",
    ),
    ("calc", "depth"): (
        "--z",
        "--focal",
        "--baseline",
        "--hfov",
        "--resolution",
        "--preset",
        "--noise",
        "--pixel-pitch",
    ),
    ("calc", "limits"): (
        "--z",
        "--focal",
        "--baseline",
        "--hfov",
        "--resolution",
        "--disparities",
        "--shift",
        "--preset",
    ),
    ("infer",): ("--claim", "--preset", "--focal", "--baseline", "--resolution"),
    ("presets",): ("--json",),
    ("scenes",): ("--json",),
    ("tolerance",): ("--preset", "--class", "--depth-error", "--range", "--rigs", "--seed"),
    ("sweep",): (
        "--scene",
        "--mount",
        "--baseline",
        "--range",
        "--noise",
        "--points",
        "--trials",
        "--vergence",
        "--sensor",
    ),
    ("render",): ("--scene", "--mount", "--resolution", "--baseline"),
    ("design",): ("--range", "--depth-error", "--fov", "--overlap", "--noise", "--max-baseline", "--sensor"),
    ("export", "rig"): ("--preset", "--format", "--baseline", "--resolution"),
    ("verify",): ("--triangulator", "--cases", "--suite", "--seed", "--scene"),
    ("compare",): ("--geometry", "--points", "--seed"),
}
ALWAYS: dict[tuple[str, ...], tuple[str, ...]] = {
    # little work, so that what takes long is no work but a hang; what follows may ask for more
    ("sweep",): (
        *("--renderer", "rays", "--measure", "none", "--points", "50", "--trials", "5", "--json"),
        *("--baseline", "60,120", "--resolution", "320x240"),
    ),
    # software GL ends the whole process where memory is short, so nothing is drawn under the limit
    ("render",): ("--renderer", "rays"),
    ("tolerance",): ("--rigs", "100"),
    ("design",): ("--no-proof",),
    ("compare",): ("--points", "100"),
    ("verify",): ("--list", "--scene", "none"),
}


def run() -> None:
    """Print how the runs ended, and every one that ended badly."""
    os.environ[NO_NET] = "1"
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    held = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (held + MEMORY_B, hard))
    before = Path.cwd()
    try:
        with tempfile.TemporaryDirectory(prefix="bench-fuzz-") as folder:
            os.chdir(folder)
            _report("argument lists", ARGUMENTS, _arguments)
            _report("mutated files", FILES, _file)
            os.chdir(before)
    finally:
        os.chdir(before)
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def _report(what: str, count: int, make: Callable[[random.Random], list[str]]) -> None:
    rng = random.Random(SEED)
    ends: Counter[str] = Counter()
    bad: list[str] = []
    slowest = 0.0
    for _ in range(count):
        words = make(rng)
        begin = time.process_time()
        how, told = _try(words)
        slowest = max(slowest, time.process_time() - begin)
        ends[how] += 1
        if how.startswith("bad"):
            bad.append(f"{' '.join(words)[:160]}: {told[:300]}")
    print(
        f"{count} {what}: {dict(ends)}; slowest {slowest:.1f} s of processor; {len(bad)} bad   (limit 0)",
        flush=True,
    )
    for line in bad[:20]:
        print(f"  {line}", flush=True)


def _try(words: list[str]) -> tuple[str, str]:
    """How a command ended, and what it said on standard error."""

    def too_long(_number: int, _frame: FrameType | None) -> None:
        raise TimeoutError

    said, complained = io.StringIO(), io.StringIO()
    signal.signal(signal.SIGALRM, too_long)
    signal.signal(signal.SIGPROF, too_long)
    signal.alarm(WAIT_S)
    signal.setitimer(signal.ITIMER_PROF, LIMIT_S)
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(complained):
            code = app.run(words)
    except BaseException as error:
        return "bad: " + type(error).__name__, f"{type(error).__name__}: {error}"
    finally:
        signal.alarm(0)
        signal.setitimer(signal.ITIMER_PROF, 0)
    told = complained.getvalue()
    errors = [line for line in told.splitlines() if line.startswith("rigsim: error:")]
    if code in (1, 2) and len(errors) != 1:
        return "bad: not one line", told
    if "Traceback" in told or code not in (0, 1, 2, 3):
        return f"bad: exit {code}", told
    return f"exit {code}", told


def _arguments(rng: random.Random) -> list[str]:
    command = rng.choice(list(COMMANDS))
    words = [*command, *ALWAYS.get(command, ())]
    for option in rng.sample(COMMANDS[command], rng.randint(0, len(COMMANDS[command]))):
        words += [option, _value(rng)]
    if rng.random() < 0.1:
        words.insert(rng.randint(1, len(words)), rng.choice(WORDS))
    return words


def _value(rng: random.Random) -> str:
    return rng.choice(
        (
            rng.choice(NUMBERS) + rng.choice(UNITS),
            f"{rng.choice(NUMBERS)}{rng.choice(UNITS)}{rng.choice(',:x@/')}{rng.choice(NUMBERS)}{rng.choice(UNITS)}",
            rng.choice(WORDS),
        )
    )


def _file(rng: random.Random) -> list[str]:
    kind = rng.choice(list(SEEDS))
    content = _mutated(bytearray(SEEDS[kind]), rng)
    path = Path(kind)
    path.unlink(missing_ok=True)
    path.write_bytes(content)
    if kind == "errors.csv":
        return ["infer", kind, "--preset", "oak-d"]
    if kind == "scene.mjcf.xml":
        return ["sweep", "--scene", kind, *ALWAYS[("sweep",)]]
    return ["calc", "depth", "--z", "3m", "--rig", kind]


def _mutated(content: bytearray, rng: random.Random) -> bytes:
    for _ in range(rng.randint(1, 6)):
        at = rng.randrange(len(content) + 1)
        match rng.randrange(7):
            case 0:
                content[at : at + rng.randint(1, 40)] = b""
            case 1:
                content[at:at] = rng.randbytes(rng.randint(1, 8))
            case 2:
                piece = content[at : at + rng.randint(1, 60)]
                content[at:at] = piece * rng.randint(1, 20)
            case 3:
                content[at : at + 1] = bytes([rng.randrange(256)])
            case 4:
                content[at:at] = rng.choice(NUMBERS).encode()
            case 5:
                content[at:at] = rng.choice(
                    (b"[", b"{", b"'", b'"', b":", b"&a *a", b"\0", b"\r", b"\xff\xfe", b"<", b"-")
                )
            case _:
                other = rng.choice(list(SEEDS.values()))
                content[at:at] = other[: rng.randint(1, len(other))]
        if not content:
            content = bytearray(b" ")
    return bytes(content)
