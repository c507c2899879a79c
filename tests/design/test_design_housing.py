"""Cameras have bodies: two of them do not stand closer than they are wide."""

from __future__ import annotations

import math
from typing import Any

import pytest

import rigsim
from rigsim.errors import InvalidRig
from rigsim.present.design.console import sentences
from rigsim.rig.catalogue.sensors import SENSORS
from rigsim.theory.inverse import Camera, Requirement, baseline_interval, relaxations

NEAR: dict[str, Any] = {
    "range_m": (0.3, 0.6),
    "depth_error_mm": 2,
    "lenses_mm": 6,
    "noise_px": 0.1,
    "prefer": "smallest",
    "proof": False,
}


@pytest.fixture(autouse=True)
def _nothing_built(monkeypatch: pytest.MonkeyPatch) -> None:
    """No rig is built within tolerances: nothing here asks how many would hold."""
    monkeypatch.setattr("rigsim.api.design.design_tolerance", lambda *_: None)


def test_two_bodies_stand_beside_each_other_unless_another_width_is_said() -> None:
    # by hand: f = 6 mm / 3.45 um, B >= Z^2 sqrt(2) 0.1 px / (f 2 mm) = 14.64 mm, under the 29 mm of a body
    alone_mm = 0.6**2 * math.sqrt(2) * 0.1 / (6e-3 / 3.45e-6 * 2e-3) * 1e3
    assert alone_mm == pytest.approx(14.64, abs=0.005)

    def shortest_mm(**words: Any) -> float:
        found = rigsim.design(**NEAR, **words).document()
        return float(found["binding"]["shortest"]["baseline_mm"])

    assert shortest_mm(sensors="IMX273") == pytest.approx(29)
    # pixels twice as large
    assert shortest_mm(sensors="IMX273", binning=2) == pytest.approx(29.28, rel=2e-3)
    assert shortest_mm(sensors="IMX273", body_width_mm=0) == pytest.approx(14.64, rel=2e-3)
    assert shortest_mm(sensors="IMX273", body_width_mm=20) == pytest.approx(20)
    assert shortest_mm(sensors="IMX273", min_baseline_mm=18) == pytest.approx(18)
    assert shortest_mm(pixel_pitch_um=3.45, resolutions_px=(1440, 1080)) == pytest.approx(14.64, rel=2e-3)
    assert shortest_mm(sensors="OV9282", body_width_mm=None) < 29  # sold on boards, of no known width


def test_a_body_that_was_assumed_is_said_with_its_source() -> None:
    found = rigsim.design(**NEAR, sensors="IMX273")
    (said,) = [one for one in sentences(found.found, ()) if "--body-width" in one]
    assert "29 mm wide, as is a Basler acA1440-220uc" in said
    assert "docs.baslerweb.com/aca1440-220uc" in said
    document = found.document()
    assert document["housing"]["width_mm"] == 29
    rows = {row["requirement"]: row for row in document["requirements"]}
    assert (rows["min_baseline"]["required"], rows["min_baseline"]["verdict"]) == (29, "met")
    said_so = rigsim.design(**NEAR, sensors="IMX273", body_width_mm=29).document()
    assert said_so["housing"] is None


def test_each_sensor_has_a_body_of_its_own() -> None:
    found = rigsim.design(**NEAR, sensors=["IMX219", "IMX273"]).found
    shortest = {one.camera.sensor: one.lower.baseline_m for one in found.intervals}
    assert shortest == {"imx219": 0.025, "imx273": 0.029}


def test_a_body_too_wide_is_named_where_nothing_fits() -> None:
    with pytest.raises(InvalidRig, match=r"shortest baseline from 29 mm to .* Basler acA1440.* 0 none"):
        rigsim.design(**NEAR, sensors="IMX273", max_disparity_px=120)


def test_no_baseline_is_under_a_body() -> None:
    bare = Camera(1440, 1080, 1739.0)
    housed = Camera(1440, 1080, 1739.0, body_m=0.029)
    asked = (Requirement("depth_error", 0.002, 0.6), Requirement("max_disparity", 120.0, 0.3))
    assert baseline_interval(bare, asked, 0.1).lower.baseline_m == pytest.approx(0.01464, rel=2e-3)
    assert baseline_interval(housed, asked, 0.1).lower.baseline_m == 0.029
    assert relaxations([bare], asked, 0.1) == () or baseline_interval(bare, asked, 0.1).is_feasible
    kinds = {way.requirement.kind for way in relaxations([housed], asked, 0.1) if way.requirement}
    assert kinds == {"max_disparity", "min_baseline"}


def test_every_body_has_a_source() -> None:
    widths = {name: one.housing.width_mm for name, one in SENSORS.items() if one.housing is not None}
    assert {"imx219": 25, "imx477": 38, "imx265": 29, "imx267": 40, "mt9m031": 39}.items() <= widths.items()
    for name in widths:
        housing = SENSORS[name].housing
        assert housing is not None
        assert housing.camera
        assert "(" in housing.source
        # the usual 29 mm are claimed of no sensor larger than the largest that was seen in them
        if "as large or larger" in housing.camera:
            one = SENSORS[name]
            assert math.hypot(one.width, one.height) * one.pitch_um / 1e3 <= 15.9
