"""Pictures and proofs of the rig's page without a browser: what is asked for, and what is said of it."""

from __future__ import annotations

import numpy as np
import pytest

from rigsim.rig.presets import PRESETS
from rigsim.studio.draw.proof import ProofRow
from rigsim.studio.draw.request import Pair
from rigsim.studio.logic.numbers import numbers_of
from rigsim.studio.logic.pictures import NOTHING, at_pixel, pair_wanted, points_seen, source
from rigsim.studio.logic.proof import line_of, proof_wanted
from rigsim.studio.pages.rig.page import DEFAULTS
from rigsim.study.calc.cloud import points_of_depth


def pair_of(depth_m: np.ndarray, disparity_px: np.ndarray, std_m: np.ndarray) -> Pair:
    height, width = depth_m.shape
    arrays = (array.astype(np.float32) for array in (depth_m, disparity_px, std_m))
    depth, disparity, std = arrays
    return Pair(b"", b"", width, height, True, None, None, depth, disparity, std, 0.0, ())


def test_the_pair_and_the_proof_are_of_the_rig_and_the_noise_that_are_shown() -> None:
    found = numbers_of(DEFAULTS.with_words(baseline="7cm", noise="0.4"))
    pair, proof = pair_wanted(found, "bin", "error", coarse=True), proof_wanted(found, "bin")
    assert pair is not None
    assert proof is not None
    assert pair.rig == proof.rig
    assert pair.rig.baseline_m == pytest.approx(0.07)
    assert (pair.scene, pair.overlay, pair.coarse, pair.noise_px) == ("bin", "error", True, 0.4)
    assert (proof.scene, proof.noise_px) == ("bin", 0.4)
    broken = numbers_of(DEFAULTS.with_words(baseline="0"))
    assert pair_wanted(broken, "bin", "none", coarse=False) is None
    assert proof_wanted(broken, "bin") is None


def test_asked_again_for_the_same_rig_the_request_is_the_same() -> None:
    one, again, other = (
        proof_wanted(numbers_of(DEFAULTS.with_words(baseline=text)), "boards")
        for text in ("12cm", "120mm", "121mm")
    )
    assert one == again
    assert one != other


def test_a_pixel_says_depth_disparity_and_std() -> None:
    nan = np.nan
    pair = pair_of(
        np.array([[2.0, nan], [3.0, 4.0]]),
        np.array([[54.0, nan], [nan, 27.0]]),
        np.array([[0.0131, nan], [nan, 0.05]]),
    )
    assert at_pixel(pair, 0.4, 0.9) == "depth 2.000 m · disparity 54.00 px · std 13.1 mm"
    assert at_pixel(pair, 1.0, 0.0) == NOTHING
    assert "right camera does not see it" in at_pixel(pair, 0.0, 1.0)
    assert at_pixel(pair, 2.0, 0.0) == at_pixel(pair, -0.1, 0.0) == ""


def test_points_of_a_small_picture_lie_where_the_rigs_own_camera_sees_them() -> None:
    rig = PRESETS["boards"].rig
    depth = np.full((180, 320), 2.5, dtype=np.float32)
    depth[:, :160] = np.nan
    points = points_of_depth(rig, depth)
    assert len(points) == 40
    assert (points[:, 2] == 2.5).all()
    # centres of pixels of a quarter's size, in the right half
    uv, _ = rig.project(points)
    assert uv[:, 0].min() > 640
    assert uv[:, 0].max() == pytest.approx(4 * (round(0.95 * 319) + 0.5) - 0.5)
    found = numbers_of(DEFAULTS)
    request = pair_wanted(found, "boards", "none", coarse=True)
    assert request is not None
    pair = pair_of(depth, depth, depth)
    np.testing.assert_array_equal(points_seen(pair, request), points)


def test_pictures_say_what_they_are() -> None:
    assert source(b"\x89PNG\r\n").startswith("data:image/png;base64,iVBORw")
    assert source(b"\xff\xd8\xff").startswith("data:image/jpeg;base64,/9j/")


@pytest.mark.parametrize(
    ("agreement", "verdict", "why"),
    [
        ("agrees", "agrees", ""),
        ("untold: 40 measured points are too few", "untold", "40 measured points are too few"),
        ("flagged: simulated over predicted 1.31", "flagged", "simulated over predicted 1.31"),
    ],
)
def test_a_row_says_its_verdict_and_why(agreement: str, verdict: str, why: str) -> None:
    line = line_of(ProofRow(500.0, 1250.0, 800.0, 1.234, 1.26, None, None, 0, agreement))
    assert (line.where, line.verdict, line.why) == ("500 mm to 1.25 m", verdict, why)
    assert (line.predicted, line.simulated, line.measured, line.expected) == ("1.23", "1.26", "–", "–")
    assert line_of(ProofRow(None, None, None, 1.0, 1.0, 1.0, 1.0, 9, agreement)).where == "all points"
