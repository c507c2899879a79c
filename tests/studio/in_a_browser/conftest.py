"""One server and one browser for all tests of a process; each test has a tab of its own."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.helpers.browser import Page, Server, require_browser, serving, start_browser


@pytest.fixture(scope="session")
def server() -> Iterator[Server]:
    with serving() as running:
        yield running


@pytest.fixture(scope="session")
def _driver() -> Iterator[object]:
    require_browser()
    driver = start_browser()
    try:
        yield driver
    finally:
        driver.quit()


@pytest.fixture
def page(_driver: object, server: Server) -> Iterator[Page]:
    from selenium import webdriver

    assert isinstance(_driver, webdriver.Chrome)
    before = _driver.current_window_handle
    _driver.switch_to.new_window("tab")
    shown = Page(_driver, server.origin)
    shown.size(1280, 1000)
    try:
        yield shown
    finally:
        _driver.close()
        _driver.switch_to.window(before)
