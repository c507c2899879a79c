"""A real browser before a real server, or why there is none."""

from __future__ import annotations

import os
import shutil

import pytest

from tools.browser import Page as Page
from tools.browser import Server as Server
from tools.browser import serving as serving
from tools.browser import start_browser as start_browser


def require_browser() -> None:
    """Leave a test out where no browser is installed, but not where continuous integration runs it."""
    if shutil.which("chromium") and shutil.which("chromedriver"):
        return
    assert not os.environ.get("CI"), "no chromium and chromedriver: tools/setup.sh installs them as root"
    pytest.skip("chromium and chromedriver are not installed")
