"""The page it began as, as a person uses it: in a real browser before the real server."""

from __future__ import annotations

from tests.helpers.browser import Page, Server, serving, start_browser

DRONE = {"Focal length": "1200", "Baseline": "150", "x1": "980", "y1": "500", "x2": "910", "y2": "500"}


def test_typing_the_drone_example_gives_its_depth(page: Page) -> None:
    page.open("/point?focal=800&baseline=60mm&left=10,10&right=5,10")
    for label, text in DRONE.items():
        page.type(label, text)
    page.shows("point-z", "2571.4")
    # X = x Z / f = 980 * 2571.43 / 1200, and Y likewise; a pixel is Z / f wide
    assert [page.text(name) for name in ("point-x", "point-y")] == ["2100.0", "1071.43"]
    assert [page.text(name) for name in ("disparity", "world-per-pixel")] == ["70.000", "2.1429"]
    # Z^2 / (f B) times sqrt(2) times 0.25 px
    assert page.text("depth-std") == "13.0"
    assert "Z = 2.57 m ± 13.0 mm" in page.driver.page_source
    assert page.logged() == []


def test_examples_are_buttons_and_undo_goes_back(page: Page) -> None:
    page.open("/point")
    page.click("Desktop scanner")
    page.shows("point-z", "1066.67")
    assert page.box("Baseline").get_attribute("value") == "80mm"
    page.click("Undo")
    page.shows("point-z", "2571.4")
    page.click("Redo")
    page.shows("point-z", "1066.67")
    page.click("Reset defaults")
    page.shows("point-z", "2571.4")
    assert page.box("x1").get_attribute("value") == "980"


def test_swapped_sides_no_parallax_and_rows_apart_are_explained_in_place(page: Page) -> None:
    page.open("/point")
    page.type("x2", "990")
    page.until(lambda: "left and right swapped" in page.text("fault"))
    assert page.text("point-z") == "–"
    page.type("x2", "980")
    page.until(lambda: "the point is at infinity" in page.text("fault"))
    page.type("x2", "910")
    page.type("y2", "530")
    page.until(lambda: "30 px" in page.driver.find_element("css selector", ".rig-note").text)
    page.shows("point-z", "2571.4")


def test_the_address_holds_the_state(page: Page) -> None:
    page.open("/point")
    page.type("Baseline", "20cm")
    page.type("Noise", "0.1")
    page.shows("point-z", "3428.57")
    page.until(lambda: "baseline=20cm" in page.driver.current_url and "noise=0.1" in page.driver.current_url)
    link, std = page.driver.current_url, page.text("depth-std")
    assert "left=980,500" in link
    page.open("/point")
    page.shows("point-z", "2571.4")
    page.open(link)
    page.shows("point-z", "3428.57")
    assert page.text("depth-std") == std
    assert page.box("Baseline").get_attribute("value") == "20cm"


def test_results_are_copied(page: Page) -> None:
    page.driver.execute_cdp_cmd(
        "Browser.grantPermissions",
        {"permissions": ["clipboardReadWrite", "clipboardSanitizedWrite"], "origin": page.origin},
    )
    page.open("/point")
    page.click("Copy results")
    page.until(lambda: "Results copied" in page.driver.page_source)
    text = page.driver.execute_async_script(
        "const done = arguments[0]; navigator.clipboard.readText().then(done, error => done(String(error)))"
    )
    assert "Z                      2571.4 mm\n" in text
    assert "rigsim calc point --focal=1200 --baseline=150mm --left=980,500 --right=910,500\n" in text


def test_a_narrow_screen_needs_no_sideways_scrolling(page: Page) -> None:
    page.size(360, 780)
    page.open("/point")
    page.shows("point-z", "2571.4")
    assert page.driver.execute_script("return document.documentElement.scrollWidth") <= 360


def test_two_browsers_have_two_states(page: Page, server: Server) -> None:
    other = start_browser()
    try:
        second = Page(other, server.origin)
        page.open("/point")
        second.open("/point")
        page.type("Baseline", "300")
        page.shows("point-z", "5142.9")
        second.shows("point-z", "2571.4")
        second.type("x2", "840")
        second.shows("point-z", "1285.71")
        page.shows("point-z", "5142.9")
    finally:
        other.quit()


def test_nothing_is_asked_of_other_hosts(page: Page) -> None:
    page.open("/point")
    page.shows("point-z", "2571.4")
    hosts = page.driver.execute_script(
        "return performance.getEntriesByType('resource').map(entry => new URL(entry.name).host)"
    )
    assert set(hosts) == {page.origin.split("//")[1]}


def test_an_interrupt_ends_it_without_a_word() -> None:
    with serving() as running:
        code, err = running.interrupt()
    assert (code, err) == (130, "")
