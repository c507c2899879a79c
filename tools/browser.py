"""A real browser before a real server: headless Chromium, and `rigsim studio` in a process of its own."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from selenium import webdriver
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.remote.webelement import WebElement

PATIENCE_S = 60.0
"""How long a page may take until it shows what is waited for: machines are shared."""
_ARGUMENTS = ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--enable-unsafe-swiftshader")


def free_port() -> int:
    """A port that nobody listens at."""
    with socket.socket() as tried:
        tried.bind(("127.0.0.1", 0))
        return int(tried.getsockname()[1])


@dataclass(frozen=True)
class Server:
    """A running `rigsim studio`."""

    process: subprocess.Popen[str]
    address: str
    said: str

    @property
    def origin(self) -> str:
        """Where it is, without a path."""
        return self.address.split("/point")[0].split("/rig")[0]

    def interrupt(self) -> tuple[int, str]:
        """Press Ctrl-C; returns the exit code and what it said since."""
        self.process.send_signal(signal.SIGINT)
        _, err = self.process.communicate(timeout=PATIENCE_S)
        return self.process.returncode, err


@contextmanager
def serving(*words: str) -> Iterator[Server]:
    """``rigsim studio WORDS`` at a free port, ready."""
    command = [sys.executable, "-m", "rigsim", "studio", "--no-browser", "--port", str(free_port()), *words]
    # a test's own warnings and nets do not concern the server
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
    )
    assert process.stdout is not None
    try:
        line = process.stdout.readline()
        assert line.startswith("rigsim studio: http://"), (line, process.poll())
        yield Server(process, line.split()[-1], line)
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(PATIENCE_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        for stream in (process.stdout, process.stderr):
            assert stream is not None
            stream.close()


class Page:
    """A browser's tab, by what a person sees in it."""

    def __init__(self, driver: webdriver.Chrome, origin: str) -> None:
        self.driver = driver
        self.origin = origin

    def open(self, path: str) -> None:
        """Open a page, and wait until it answers."""
        self.driver.get(path if path.startswith("http") else self.origin + path)
        self.until(lambda: self.driver.execute_script("return !!(window.socket && window.socket.connected)"))

    def until(self, holds: Callable[[], object], says: str = "") -> None:
        """Wait until something holds."""
        end = time.monotonic() + PATIENCE_S
        seen: object = None
        while time.monotonic() < end:
            try:
                seen = holds()
            except Exception as error:  # elements come and go while the page works
                seen = error
            if seen and not isinstance(seen, Exception):
                return
            time.sleep(0.05)
        raise AssertionError(f"{says or 'what is waited for'} did not come: {seen!r}")

    def box(self, label: str) -> WebElement:
        """The box that a screen reader calls `label`."""
        return self.driver.find_element(By.CSS_SELECTOR, f'input[aria-label="{label}"]')

    def type(self, label: str, text: str) -> None:
        """Type into a box in place of what is in it."""
        box = self.box(label)
        box.send_keys(Keys.CONTROL, "a")
        box.send_keys(text or Keys.DELETE)

    def click(self, name: str) -> None:
        """Click the button of that name."""
        xpath = f'//button[@aria-label="{name}" or .//span[normalize-space(text())="{name}"]]'
        self.driver.find_element(By.XPATH, xpath).click()

    def text(self, testid: str) -> str:
        """What stands where `data-testid` says."""
        return self.driver.find_element(By.CSS_SELECTOR, f'[data-testid="{testid}"]').text

    def shows(self, testid: str, text: str) -> None:
        """Wait until `text` stands there."""
        self.until(lambda: self.text(testid) == text, f"{testid} {text}")

    def size(self, width: int, height: int, *, dark: bool = False) -> None:
        """Be a screen of that size."""
        metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [scheme]})

    def logged(self) -> list[str]:
        """Errors of the browser's console."""
        return [
            str(entry["message"]) for entry in self.driver.get_log("browser") if entry["level"] == "SEVERE"
        ]


def start_browser() -> webdriver.Chrome:
    """A new headless Chromium."""
    options = webdriver.ChromeOptions()
    for argument in _ARGUMENTS:
        options.add_argument(argument)
    options.binary_location = shutil.which("chromium") or ""
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(options=options, service=webdriver.ChromeService(shutil.which("chromedriver")))
