"""The rig's page as a person uses it: in a real browser before the real server."""

from __future__ import annotations

from pathlib import Path

from selenium.webdriver.common.by import By
from selenium.webdriver.remote.webelement import WebElement

from rigsim.interop.formats.rig_toml import write_rig
from rigsim.rig.presets import PRESETS
from tests.helpers.browser import Page


def element(page: Page, testid: str) -> WebElement:
    return page.driver.find_element(By.CSS_SELECTOR, f'[data-testid="{testid}"]')


def is_there(page: Page, testid: str) -> bool:
    return bool(page.driver.find_elements(By.CSS_SELECTOR, f'[data-testid="{testid}"]'))


def whole(page: Page, testid: str) -> float:
    data = element(page, testid).find_element(By.TAG_NAME, "data")
    return float(data.get_attribute("value") or "nan")


def test_a_longer_baseline_reaches_numbers_badge_command_and_picture(page: Page) -> None:
    page.open("/rig?preset=boards&range=0.5:5m&require=10mm@2m")
    page.shows("requirement", "not met")
    # 2 m^2 / (900 px 0.12 m) 0.25 sqrt 2 px
    assert abs(whole(page, "depth-std") - 13.0946) < 1e-3
    page.until(lambda: element(page, "pair-left").get_attribute("data-drawn") == "1280x720")
    page.type("Baseline", "24cm")
    page.shows("requirement", "met")
    page.until(lambda: abs(whole(page, "depth-std") - 13.0946 / 2) < 1e-3)
    page.until(lambda: "--baseline=24cm" in page.text("command-depth"))
    before = element(page, "pair-left").find_element(By.TAG_NAME, "img").get_attribute("src")
    page.until(
        lambda: element(page, "pair-left").find_element(By.TAG_NAME, "img").get_attribute("src") != before
    )
    page.until(lambda: "baseline=24cm" in page.driver.current_url)
    assert page.logged() == []


def test_a_calibration_is_loaded_and_a_broken_one_is_explained(page: Page, tmp_path: Path) -> None:
    good, broken = tmp_path / "mine.toml", tmp_path / "broken.toml"
    good.write_text(write_rig(PRESETS["bin"].rig, "mine"))
    broken.write_bytes(b"\xff\xfe\x00")
    page.open("/rig?preset=boards&range=0.4:0.9m")
    chooser = page.driver.find_element(By.CSS_SELECTOR, "input[type=file]")
    chooser.send_keys(str(broken))
    page.until(lambda: "broken.toml" in page.text("upload-fault"))
    page.driver.find_element(By.CSS_SELECTOR, "input[type=file]").send_keys(str(good))
    page.until(lambda: "--rig=rig.toml" in page.text("command-depth"))
    page.until(lambda: not is_there(page, "upload-fault"))
    page.until(lambda: abs(whole(page, "hfov-deg") - PRESETS["bin"].rig.left.hfov_deg) < 1e-6)
    page.until(lambda: "rig=" in page.driver.current_url)
    page.open(page.driver.current_url)
    page.until(lambda: abs(whole(page, "hfov-deg") - PRESETS["bin"].rig.left.hfov_deg) < 1e-6)


def test_a_path_in_the_address_is_not_opened(page: Page) -> None:
    page.open("/rig?preset=boards&range=0.5:5m&scene=/etc/hostname")
    page.until(lambda: element(page, "pair-left").get_attribute("data-drawn"))
    assert page.box("Scene").get_attribute("value") == "boards"


def test_lens_by_focal_length_takes_the_place_of_the_field_of_view(page: Page) -> None:
    page.open("/rig?baseline=100mm&hfov=60deg&resolution=1280x720&range=0.5:5m")
    page.until(lambda: abs(whole(page, "hfov-deg") - 60) < 1e-6)
    page.click("focal length")
    page.type("Focal length", "1000px")
    page.until(lambda: "focal=1000px" in page.driver.current_url)
    assert "hfov" not in page.driver.current_url

    def back() -> bool:
        page.click("Undo")  # a slow hand types in several steps
        return "hfov=60deg" in page.driver.current_url

    page.until(back)


def test_proving_puts_three_witnesses_beside_each_other_until_the_rig_is_another(page: Page) -> None:
    page.open("/rig?preset=boards&range=0.5:5m")
    page.click("Prove it")
    page.until(lambda: page.text("proof-verdict") == "agrees")
    rows = [row.text for row in element(page, "proof").find_elements(By.TAG_NAME, "tr")]
    assert "predicted, mm simulated, mm measured, mm" in rows[0]
    assert rows[-1].startswith("all points")
    assert page.text("command-proof").startswith("rigsim sweep --rig rig.toml --scene boards --noise 0.25")
    page.type("Baseline", "130mm")
    page.until(lambda: is_there(page, "proof-stale"))
    page.type("Baseline", "120mm")
    page.until(lambda: not is_there(page, "proof-stale"))
    page.shows("proof-verdict", "agrees")


def test_a_proof_can_be_cancelled(page: Page) -> None:
    page.open("/rig?preset=boards&range=0.5:5m")
    page.click("Prove it")
    page.until(lambda: page.text("proof-said").endswith("…"))
    page.click("Cancel")
    page.until(lambda: "Cancelled" in page.text("proof-said"))
