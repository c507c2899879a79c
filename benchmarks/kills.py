"""What a killed run leaves: 60 kills at random moments over seven commands, and the same command again."""

from __future__ import annotations

import hashlib
import os
import random
import secrets
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

KILLS = 60
SEED = 1
GRACE_S = 5.0
LIMIT_S = 300.0
SIGNALS = (signal.SIGTERM, signal.SIGKILL, signal.SIGINT)
PROGRAM = """
import sys
from pathlib import Path
import time
folder = Path(sys.argv[1])
time.sleep(0.05)
rows = (folder / "observations.csv").read_text().splitlines()[1:]
(folder / "points.csv").write_text("x,y,z\\n" + "0,0,1\\n" * len(rows))
"""
COMMANDS: dict[str, str] = {
    "sweep": "sweep --baseline 100,200 --points 50 --trials 3 --resolution 160x120 --measure none --jobs 2 "
    "--out out",
    "design": "design --range 0.5:3m --depth-error 40mm@3m --resolution 640x480 --no-proof --out out",
    "verify": "verify --exec PROGRAM --scene none --cases rectified,doffs,verged --out out",
    "compare": "compare optimal dlt --geometry verged --points 500 --out out",
    "export": "export dataset --scene bin --resolution 160x120 --format middlebury --frames 2 --out out",
    "measure": "measure pair/left.png pair/right.png --rig pair/rig.toml --out out",
    "tolerance": "tolerance --preset oak-d --depth-error 20mm@3m --rigs 100 --out out",
}
MAY_FAIL = {"verify": 3}  # the program triangulates nothing


def run() -> None:
    """Print what was left after each kill; 0 is the aim."""
    # a shell that starts this in the background ignores Ctrl-C, and what is started here would inherit that
    signal.signal(signal.SIGINT, signal.default_int_handler)
    rng = random.Random(SEED)
    with tempfile.TemporaryDirectory(prefix="bench-kills-") as folder:
        place = Path(folder)
        (place / "program.py").write_text(PROGRAM)
        render = ["render", "--scene", "artifact", "--resolution", "320x240", "--out", "pair"]
        subprocess.run([sys.executable, "-m", "rigsim", *render], cwd=place, check=True, capture_output=True)
        lasts = {name: _once(place, name) for name in COMMANDS}
        print("seconds of a whole run: " + ", ".join(f"{name} {s:.1f}" for name, s in lasts.items()))
        left: list[str] = []
        for i in range(KILLS):
            name = list(COMMANDS)[i % len(COMMANDS)]
            left += _killed(place / f"{i}-{name}", place, name, SIGNALS[i % 3], rng.uniform(0.1, lasts[name]))
        print(f"{KILLS} kills: {len(left)} things left or wrong   (limit 0)")
        for line in left:
            print(f"  {line}")


def _words(place: Path, name: str) -> list[str]:
    text = COMMANDS[name].replace("pair/", f"{place}/pair/")
    words = [sys.executable, "-m", "rigsim", *text.split()]
    return [word if word != "PROGRAM" else f"{sys.executable} {place}/program.py" for word in words]


def _once(place: Path, name: str) -> float:
    with tempfile.TemporaryDirectory(dir=place) as folder:
        begin = time.perf_counter()
        done = subprocess.run(_words(place, name), cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode in (0, MAY_FAIL.get(name, 0)), done.stderr
        return time.perf_counter() - begin


def _killed(folder: Path, place: Path, name: str, sent: signal.Signals, after_s: float) -> list[str]:
    """What is wrong after one kill, a line each."""
    temporary = folder / "tmp"
    temporary.mkdir(parents=True)
    (folder / "older.txt").write_text("older")
    mark = secrets.token_hex(8)
    environment = {**os.environ, "TMPDIR": str(temporary), "BENCH_MARK": mark}
    shared = set(os.listdir("/dev/shm"))
    process = subprocess.Popen(
        _words(place, name),
        cwd=folder,
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    time.sleep(after_s)
    if sent == signal.SIGINT:
        os.killpg(process.pid, sent)  # as a terminal does
    else:
        process.send_signal(sent)
    begin = time.monotonic()
    _, complained = process.communicate(timeout=60)
    took_s = time.monotonic() - begin
    what = f"{name}, {sent.name} after {after_s:.1f} s"
    time.sleep(GRACE_S)
    wrong = [f"{what}: it ended only {took_s:.1f} s later"] if took_s > GRACE_S else []
    wrong += [f"{what}: process {pid} ({words})" for pid, words in _marked(mark)]
    wrong += [f"{what}: /dev/shm/{entry}" for entry in _unused(set(os.listdir("/dev/shm")) - shared)]
    wrong += [f"{what}: {entry}" for entry in temporary.rglob("*")]
    wrong += [f"{what}: {entry.name}" for entry in folder.glob(".rigsim*")]
    if "Traceback" in complained:
        wrong.append(f"{what}: a traceback")
    if (folder / "older.txt").read_text() != "older":
        wrong.append(f"{what}: an older file has changed")
    finished = _checksums(folder / "out")
    again = subprocess.run(
        _words(place, name), cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    if finished:  # it had ended before the signal came, or what came until then was shown
        if "already holds" not in again.stderr:
            wrong.append(f"{what}: finished files were overwritten without --force")
        if _checksums(folder / "out") != finished:
            wrong.append(f"{what}: finished files have changed")
    elif again.returncode not in (0, MAY_FAIL.get(name, 0)):
        wrong.append(f"{what}: the same command again: {again.stderr.strip()[:200]}")
    return wrong


def _checksums(folder: Path) -> dict[str, str]:
    files = (path for path in folder.rglob("*") if path.is_file())
    return {str(path): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def _marked(mark: str) -> list[tuple[int, str]]:
    found = []
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and mark.encode() in (entry / "environ").read_bytes():
                words = (entry / "cmdline").read_bytes().replace(b"\0", b" ").decode()[:80]
                found.append((int(entry.name), words))
        except OSError:
            continue
    return found


def _unused(names: set[str]) -> set[str]:
    """Shared memory that no living process has mapped: what others work with at the moment is not ours."""
    for maps in Path("/proc").glob("[0-9]*/maps"):
        try:
            mapped = maps.read_text(errors="replace")
        except OSError:
            continue
        names = {name for name in names if f"/dev/shm/{name}" not in mapped}
    return names
