"""A noise that is said is the noise that is used, whichever way it is said."""

from __future__ import annotations

from typing import Any

import pytest

import rigsim
from rigsim.errors import InvalidRange, InvalidRig

FEW: dict[str, Any] = {"points": 40, "trials": 4, "measure": "none", "renderer": "rays", "rig": "oak-d"}


def test_a_sensor_is_not_measured_where_the_noise_of_a_disparity_is_said() -> None:
    words: dict[str, Any] = {"range_m": (1, 2), "depth_error_mm": 1e-3, "sensors": "OV9282", "lenses_mm": 2.8}
    drawn: list[bool] = []
    # what cannot be is said before anything is drawn, unless the noise is yet to be measured
    with pytest.raises(InvalidRig, match="noise"):
        rigsim.design(**words, disparity_noise_px=0.3, ready=lambda: drawn.append(True))
    assert drawn == []


def test_the_noise_of_an_axis_is_not_replaced_by_the_usual_one() -> None:
    said = rigsim.sweep(more={"noise": [0.125]}, resolutions_px=(160, 100), **FEW)
    assert said.rows["noise_px"].tolist() == [0.125]
    with pytest.raises(InvalidRange, match="disparity_noises_px and noise both given"):
        rigsim.sweep(disparity_noises_px=0.3, more={"noise": 0.25}, **FEW)
