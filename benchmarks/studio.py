"""The live page in a real browser: how fast it follows a hand, or ten, and whether its numbers are true.

Needs Chromium and its driver; ``./check`` installs them.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from benchmarks.subjects.live_page import HAND
from rigsim.cli.app import run as command_line
from tools.browser import Page, Server, serving, start_browser

KEYS, DRAGS, FULL, STARTS = 60, 40, 8, 7
HANDS, HANDS_S = 10, 60.0
CHANGES = 1000
SEED = 20261129
RIG = "/rig?preset=boards&range=0.5:5m"
CHECKOUT = Path(__file__).resolve().parents[1]


def run() -> None:
    """Print one table."""
    print(f"{'what':66} {'measured':>28}")
    _starts()
    with serving("--preset", "boards") as server:
        driver = start_browser()
        try:
            page = Page(driver, server.origin)
            page.size(1280, 1000)
            _keys(page)
            _pairs(page)
            _killed(page, server)
            _truth(page)
            _hosts(page)
        finally:
            driver.quit()
    with serving("--preset", "boards") as server:
        _hands(server)


def _tell(what: str, found: str) -> None:
    print(f"{what:66} {found:>28}", flush=True)


def _starts() -> None:
    """From the command to its line, warm; and to a page that answers."""
    seconds = []
    for _ in range(STARTS):
        begin = time.perf_counter()
        with serving():
            seconds.append(time.perf_counter() - begin)
    _tell("the command to its line, warm, median", f"{median(seconds):.2f} s")


def _keys(page: Page) -> None:
    """A key on two pages, until all numbers and curves are there."""
    for path, label, testid, curve in (
        ("/point", "Baseline", "point-z", False),
        (RIG, "Baseline", "depth-std", True),
    ):
        page.open(path)
        _quiet(page)
        milliseconds = [_time(page, label, f"{100 + turn}mm", testid, curve) for turn in range(KEYS)]
        p95 = float(np.percentile(milliseconds, 95))
        what = f"{path.split('?')[0]}: key to numbers{' and curves' if curve else ''}, median / p95"
        _tell(what, f"{median(milliseconds):.0f} / {p95:.0f} ms")


def _time(page: Page, label: str, text: str, testid: str, curve: bool) -> float:
    found = page.driver.execute_async_script(
        "const [label, text, testid, curve, done] = arguments;"
        "rigTime(label, text, testid, curve).then(done, error => done(String(error)))",
        label,
        text,
        testid,
        curve,
    )
    time.sleep(0.12)
    return _number(found)


def _quiet(page: Page) -> None:
    """Let a new page come to rest, and give it a hand."""
    time.sleep(4.0)
    page.driver.set_script_timeout(90)
    page.driver.execute_script(HAND)


def _number(found: object) -> float:
    assert isinstance(found, int | float), found
    return float(found)


def _pairs(page: Page) -> None:
    """A drag to a coarse pair, and the full one after the hand rests."""
    page.open(f"{RIG}&resolution=1280x720")
    _quiet(page)
    _pair(page, "101mm", "1280x720")
    coarse = [_pair(page, f"{110 + turn}mm", "320x180") for turn in range(DRAGS)]
    _tell("drag to a new coarse pair of 320x180, median", f"{median(coarse):.0f} ms")
    full = []
    for turn in range(FULL):
        _pair(page, f"{200 + turn}mm", "320x180")
        full.append(_pair(page, "", "1280x720"))
    _tell("the full pair of 1280x720 after it, median", f"{median(full) / 1e3:.2f} s")


def _pair(page: Page, text: str, drawn: str) -> float:
    found = page.driver.execute_async_script(
        "const [text, drawn, done] = arguments;"
        "rigPair('Baseline', text, drawn).then(done, error => done(String(error)))",
        text,
        drawn,
    )
    return _number(found)


def _killed(page: Page, server: Server) -> None:
    """Kill the renderer while dragging: the page has to say so, and the next drag to draw."""
    renderer = _children(server.process.pid, "spawn")
    assert renderer, "no render process"
    page.driver.execute_script("rigType('Baseline', '150mm')")
    for pid in renderer:
        os.kill(pid, signal.SIGKILL)
    page.driver.execute_script("rigType('Baseline', '151mm')")
    said = False
    try:
        page.until(lambda: "stopped" in page.text("pair-said"))
        said = True
    finally:
        seconds = _pair(page, "152mm", "") / 1e3
        _tell(
            "kill -9 of the renderer while dragging",
            f"{'said' if said else 'unsaid'}, next after {seconds:.1f} s",
        )


def _children(pid: int, word: str) -> list[int]:
    """Processes below `pid` whose command line has `word`."""
    listed = subprocess.run(["ps", "-eo", "pid,ppid,args"], capture_output=True, text=True, check=True)
    rows = [line.split(None, 2) for line in listed.stdout.splitlines()[1:]]
    return [int(child) for child, parent, args in rows if int(parent) == pid and word in args]


def _truth(page: Page) -> None:
    """Random changes of controls, each compared with the command line's numbers."""
    rng = np.random.default_rng(SEED)
    page.open(f"{RIG}&z=2m")
    _quiet(page)
    wrong = []
    words = {"preset": "boards", "z": "2m"}
    for _ in range(CHANGES):
        label, word, text = _change(rng)
        words[word] = text
        page.driver.execute_script("rigType(arguments[0], arguments[1])", label, text)
        expected = _printed(words)
        try:
            page.until(lambda expected=expected: _differ(page, expected) == [])
        except AssertionError:
            wrong.append((dict(words), _differ(page, expected)))
    for state, differ in wrong[:3]:
        print(f"  {state}: {differ}")
    _tell(f"{CHANGES} random changes against calc --json, to the last digit", f"{len(wrong)} differ")


def _change(rng: np.random.Generator) -> tuple[str, str, str]:
    """A control's label, its word, and what is typed."""
    choices = (
        ("Baseline", "baseline", f"{rng.uniform(30, 900):.4g}mm"),
        ("Noise", "noise", f"{rng.uniform(0.01, 2):.3g}"),
        ("Field of view", "hfov", f"{rng.uniform(30, 110):.4g}"),
        ("Vergence", "vergence", f"{rng.uniform(0, 8):.3g}"),
        ("Distance", "z", f"{rng.uniform(0.3, 20):.4g}m"),
        ("Resolution", "resolution", str(rng.choice(["640x480", "1280x720", "1920x1080", "2448x2048"]))),
    )
    return choices[int(rng.integers(len(choices)))]


def _printed(words: dict[str, str]) -> dict[str, float | None]:
    """What the command line prints for a state, by the page's names."""
    depth = _document("depth", words)
    limits = _document("limits", {name: text for name, text in words.items() if name != "noise"})
    return {
        **{name.replace("_", "-"): depth[name] for name in ("depth_std", "world_per_pixel")},
        **{name.replace("_", "-"): limits[name] for name in _OF_LIMITS},
    }


_OF_LIMITS = ("depth_step", "overlap_share", "hfov_deg", "overlap_fov_deg", "blind_zone", "min_depth")


def _document(command: str, words: dict[str, str]) -> dict[str, Any]:
    out = io.StringIO()
    options = [f"--{name}={text}" for name, text in words.items()]
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()):
        code = command_line(["calc", command, *options, "--json"])
    assert code == 0, (command, words)
    found: dict[str, Any] = json.loads(out.getvalue())
    return found


def _differ(page: Page, expected: dict[str, float | None]) -> list[str]:
    """Numbers that the page shows otherwise than the command line prints them."""
    shown = page.driver.execute_script(
        "return Object.fromEntries(arguments[0].map(name => [name, rigShown(name)]))", list(expected)
    )
    return [name for name, value in expected.items() if _as_number(shown[name]) != value]


def _as_number(text: str | None) -> float | None:
    try:
        return float(f"{float(text or ''):.15g}")  # the digits that the command line prints
    except ValueError:
        return None


def _hosts(page: Page) -> None:
    """Hosts that any page asks anything of."""
    asked = set()
    for path in ("/point", RIG, "/design", "/tolerance", "/compare"):
        page.driver.get_log("performance")
        page.open(path)
        time.sleep(5.0)
        for entry in page.driver.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            url = message.get("params", {}).get("request", {}).get("url", "")
            if url.startswith(("http", "ws")):
                asked.add(url.split("/")[2])
    others = asked - {page.origin.split("//")[1]}
    _tell("other hosts asked by the five pages", ", ".join(sorted(others)) or "none")


def _hands(server: Server) -> None:
    """Ten tabs that drag at once."""
    driver = start_browser()
    try:
        page = Page(driver, server.origin)
        tabs = []
        for _ in range(HANDS):
            driver.switch_to.new_window("tab")
            tabs.append(driver.current_window_handle)
            page.open(RIG)
        time.sleep(6.0)
        for tab in tabs:
            driver.switch_to.window(tab)
            driver.execute_script(HAND)
            texts = [f"{100 + 3 * turn}mm" for turn in range(40)]
            script = "rigDrag('Baseline', arguments[0], 'depth-std', 150, performance.now() + arguments[1])"
            driver.execute_script(script, texts, HANDS_S * 1e3)
        time.sleep(0.2 * HANDS_S)
        first = _memory_mb(server.process.pid)
        time.sleep(0.8 * HANDS_S)
        last = _memory_mb(server.process.pid)
        times, faults = [], []
        for tab in tabs:
            driver.switch_to.window(tab)
            page.until(lambda: driver.execute_script("return window.rigDone"))
            times += driver.execute_script("return window.rigTimes")
            faults += driver.execute_script("return window.rigFaults")
        ended = "" if server.process.poll() is None else ", server ended"
        typical, p95 = median(times), float(np.percentile(times, 95))
        what = f"{HANDS} tabs dragging for {HANDS_S:.0f} s: numbers, median / p95"
        _tell(what, f"{typical:.0f} / {p95:.0f} ms")
        _tell(f"  of {len(times)} changes, errors", f"{len(faults)}{ended}")
        _tell("  memory of the server, after 12 s and after 60 s", f"{first:.0f} and {last:.0f} MB")
    finally:
        driver.quit()


def _memory_mb(pid: int) -> float:
    text = Path(f"/proc/{pid}/status").read_text()
    return next(float(line.split()[1]) for line in text.splitlines() if line.startswith("VmRSS")) / 1e3


if __name__ == "__main__":
    sys.exit(run())
