"""The pages' main ways in a real browser; and that all of them can be read by everybody, on any screen."""

from __future__ import annotations

from importlib.resources import files

import pytest

from tests.helpers.browser import Page

PATHS = ("/point", "/rig?preset=oak-d", "/design", "/tolerance?preset=oak-d", "/compare")
AXE = (
    "const done = arguments[0]; axe.run().then(found => done(found.violations), error => done(String(error)))"
)


def _settled(page: Page, path: str) -> None:
    page.open(path)
    page.until(lambda: page.driver.find_elements("css selector", "h1"))
    page.until(lambda: page.driver.find_elements("css selector", "svg, canvas"))


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
@pytest.mark.parametrize("path", PATHS)
def test_nobody_is_kept_out(page: Page, path: str, dark: bool) -> None:
    page.size(1280, 1000, dark=dark)
    _settled(page, path)
    page.driver.set_script_timeout(60)
    page.driver.execute_script(files("axe_core_python").joinpath("axe.min.js").read_text(encoding="utf-8"))
    violations = page.driver.execute_async_script(AXE)
    grave = [
        (found["id"], found["nodes"][0]["html"][:200])
        for found in violations
        if found["impact"] in ("serious", "critical")
    ]
    assert grave == []


@pytest.mark.parametrize("path", PATHS)
def test_a_phone_needs_no_sideways_scrolling(page: Page, path: str) -> None:
    page.size(360, 780)
    _settled(page, path)
    assert page.driver.execute_script("return document.documentElement.scrollWidth") <= 360


def test_two_cameras_are_compared_and_one_is_taken_away(page: Page) -> None:
    page.open("/compare")
    page.until(lambda: "zed-2i is the more accurate" in page.text("says"))
    assert "oak-d" in page.text("beside")
    page.click("Remove zed-2i")
    page.until(lambda: "zed-2i" not in page.text("beside"))
    page.click("Undo")
    page.until(lambda: "zed-2i" in page.text("beside"))


def test_a_rig_is_pinned_with_what_was_changed(page: Page) -> None:
    page.open("/compare?preset=d435&baseline=80mm")
    page.click("Pin the rig of page Rig")
    page.until(lambda: "d435, baseline 80mm" in page.text("beside"))
    page.until(lambda: "pin3=" in page.driver.current_url)


def test_requirements_lead_to_a_rig_and_the_rig_to_its_page(page: Page) -> None:
    page.open("/design?range=0.5:3m&depth-error=20mm@3m&fov=60deg")
    page.until(lambda: "mm" in page.text("recommended"))
    page.until(lambda: "--depth-error=20mm@3m" in page.text("command"))
    page.driver.find_element("css selector", "tbody button, tbody a").click()
    page.until(lambda: "/rig?" in page.driver.current_url)
    page.until(lambda: float(page.text("depth-std")) > 0)
    assert "baseline=" in page.driver.current_url


def test_a_yaw_of_the_built_rig_reaches_verdict_and_command(page: Page) -> None:
    page.open("/tolerance?preset=oak-d&range=0.5:2m&depth-error=20mm@2m&off-yaw=0")
    before = page.text("verdict")
    page.type("Yaw, deg", "0.2deg")
    page.until(lambda: page.text("verdict") != before or "misses" in page.text("verdict"))
    page.until(lambda: "off-yaw=0.2deg" in page.driver.current_url)


def test_pages_hand_the_rig_on(page: Page) -> None:
    page.open("/rig?preset=oak-d&baseline=90mm")
    page.until(lambda: float(page.text("depth-std")) > 0)
    page.driver.find_element("link text", "Tolerance").click()
    page.until(lambda: "/tolerance?" in page.driver.current_url)
    assert "baseline=90mm" in page.driver.current_url
    assert "preset=oak-d" in page.driver.current_url
