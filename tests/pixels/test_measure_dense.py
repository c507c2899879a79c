"""Dense matchers: the one that comes along, and everything a user's may do wrong."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np
import pytest

from rigsim.errors import InvalidImage, InvalidRange, MeasurementFailed
from rigsim.pixels.dense.dense import dense_disparity
from rigsim.pixels.dense.metrics import disparity_errors
from rigsim.pixels.dense.pfm import pfm_bytes
from rigsim.pixels.reading import read_image
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig
from tests.helpers.textured_images import Pair, affine_pair

RANGE = (0.0, 48.0)


def eight_bit(image: Array) -> np.ndarray:
    return np.clip(np.round(image), 0, 255).astype(np.uint8)


@pytest.fixture(scope="module")
def pair() -> Pair:
    return affine_pair(21, d=18.3, a=0.04, b=-0.02)


@pytest.fixture(scope="module")
def images(pair: Pair) -> tuple[np.ndarray, np.ndarray]:
    return eight_bit(pair.left), eight_bit(pair.right)


@pytest.fixture(scope="module")
def seen(pair: Pair) -> np.ndarray:
    """Left pixels whose match lies on the right image."""
    return np.arange(pair.left.shape[1]) - pair.disparity >= 3


# --- semi-global matching -----------------------------------------------------------------------


def test_sgbm_finds_a_slanted_plane(
    pair: Pair, images: tuple[np.ndarray, np.ndarray], seen: np.ndarray
) -> None:
    found = dense_disparity(*images, pair.rig, disparity_range=RANGE)
    errors = disparity_errors(found, pair.disparity, seen)
    assert found.shape == pair.left.shape
    assert errors.fill_pct > 97
    assert errors.bad_1_pct < 1
    assert abs(errors.mean_px) < 0.1


def test_sgbm_sees_the_left_border_and_nothing_outside(
    pair: Pair, images: tuple[np.ndarray, np.ndarray], seen: np.ndarray
) -> None:
    found = dense_disparity(*images, pair.rig, disparity_range=(0.0, 160.0))
    border = seen & (np.arange(pair.left.shape[1]) < 100)
    assert disparity_errors(found, pair.disparity, border).fill_pct > 90
    with np.errstate(invalid="ignore"):
        outside = np.arange(pair.left.shape[1]) - found < -0.5
    assert not outside.any()


@pytest.mark.parametrize(
    ("shift", "mean"), [(0.5, 0.5), (-0.5, -0.5)], ids=["right image half a pixel left", "and right"]
)
def test_half_a_pixel_is_not_lost(
    pair: Pair, images: tuple[np.ndarray, np.ndarray], shift: float, mean: float
) -> None:
    # the other disparities of the same texture: a right image shifted against its truth
    moved = affine_pair(21, d=18.3 + shift, a=0.04, b=-0.02)
    found = dense_disparity(images[0], eight_bit(moved.right), pair.rig, disparity_range=RANGE)
    assert disparity_errors(found, pair.disparity).mean_px == pytest.approx(mean, abs=0.05)


def test_swapped_pictures_are_caught(pair: Pair, images: tuple[np.ndarray, np.ndarray]) -> None:
    try:
        found = dense_disparity(images[1], images[0], pair.rig, disparity_range=RANGE)
    except MeasurementFailed:
        return
    errors = disparity_errors(found, pair.disparity)
    assert errors.fill_pct - errors.bad_1_pct < 2


def test_a_wrong_row_is_caught(pair: Pair, images: tuple[np.ndarray, np.ndarray], seen: np.ndarray) -> None:
    honest = dense_disparity(*images, pair.rig, disparity_range=RANGE)
    found = dense_disparity(images[0], np.roll(images[1], 3, axis=0), pair.rig, disparity_range=RANGE)
    good, bad = (disparity_errors(d, pair.disparity, seen) for d in (honest, found))
    assert bad.invalid_pct + bad.bad_1_pct > 10 * (good.invalid_pct + good.bad_1_pct)


def test_negative_disparities_are_found_where_doffs_puts_them() -> None:
    pair = affine_pair(22, d=-12.4, doffs=30.0)
    images = eight_bit(pair.left), eight_bit(pair.right)
    known = np.broadcast_to(np.arange(320) < 300, pair.left.shape)
    errors = disparity_errors(dense_disparity(*images, pair.rig), pair.disparity, known)
    assert errors.fill_pct > 97
    assert errors.bad_1_pct < 1


def test_deeper_pictures_and_colour_give_the_same(pair: Pair, images: tuple[np.ndarray, np.ndarray]) -> None:
    plain = dense_disparity(*images, pair.rig, disparity_range=RANGE)
    deep = [image.astype(np.uint16) * 257 for image in images]
    colour = [np.repeat(image[..., None], 3, axis=2) for image in images]
    assert disparity_errors(dense_disparity(*deep, pair.rig, disparity_range=RANGE), plain).bad_1_pct < 1
    same = dense_disparity(*colour, pair.rig, disparity_range=RANGE)
    assert np.array_equal(same, plain, equal_nan=True)


# --- a user's function --------------------------------------------------------------------------


def test_a_callable_gets_the_pictures_and_the_rig(pair: Pair, images: tuple[np.ndarray, np.ndarray]) -> None:
    def honest(left: np.ndarray, right: np.ndarray, rig: StereoRig) -> np.ndarray:
        assert left.dtype == np.uint8
        assert (left == images[0]).all()
        assert (right == images[1]).all()
        assert rig == pair.rig
        left[:] = 0  # what it does to its copy must not matter
        found = pair.disparity.astype(np.float32)
        found[0, :3] = np.inf, -np.inf, np.nan
        return found

    found = dense_disparity(*images, pair.rig, honest)
    assert found.dtype == np.float64
    assert np.isnan(found[0, :3]).all()
    assert found[1:] == pytest.approx(pair.disparity[1:], abs=1e-5)
    assert images[0].any()


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (
            lambda left, right, rig: left[1:],
            r"lambda.* returned shape \(239, 320\): must be \(H, W\) = \(240, 320\)",
        ),
        (lambda left, right, rig: np.full(left.shape, np.nan), "no finite disparity"),
        (lambda left, right, rig: None, r"lambda.* returned (NoneType|shape \(\))"),
        (lambda left, right, rig: "disparity", "returned str"),
        (lambda left, right, rig: [[1], [2, 3]], "returned list"),
        (lambda left, right, rig: 1 / 0, "raised ZeroDivisionError: division by zero"),
    ],
)
def test_what_a_callable_does_wrong_is_one_line(
    answer: object, message: str, pair: Pair, images: tuple[np.ndarray, np.ndarray]
) -> None:
    with pytest.raises(MeasurementFailed, match=message) as caught:
        dense_disparity(*images, pair.rig, answer)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("broken", "fault"),
    [
        (lambda truth: truth + 0.5, "mean_px"),
        (lambda truth: -truth, "bad_4_pct"),
        (lambda truth: np.round(truth), "bad_0_5_pct"),
        (lambda truth: np.roll(truth, 40, axis=0), "median_abs_px"),
    ],
    ids=["half a pixel", "swapped", "whole pixels", "wrong row"],
)
def test_a_broken_matcher_shows_in_its_metrics(
    broken: object, fault: str, pair: Pair, images: tuple[np.ndarray, np.ndarray]
) -> None:
    found = dense_disparity(*images, pair.rig, lambda left, right, rig: broken(pair.disparity))
    errors = disparity_errors(found, pair.disparity)
    limits = {"mean_px": 0.1, "bad_4_pct": 1.0, "bad_0_5_pct": -1.0, "median_abs_px": 0.2}
    assert abs(getattr(errors, fault)) > limits[fault]
    if fault == "bad_0_5_pct":
        assert errors.rms_px == pytest.approx(1 / np.sqrt(12), abs=0.02)


MODULE = """
import time
import numpy as np

def flat(left, right, rig):
    return np.full(left.shape[:2], rig.baseline_m * 100)

class Matchers:
    @staticmethod
    def flat(left, right, rig):
        return flat(left, right, rig)

def raises(left, right, rig):
    raise RuntimeError("no luck\\nat all")

def hangs(left, right, rig):
    time.sleep(600)

def dies(left, right, rig):
    import os
    os._exit(7)
"""


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    (tmp_path / "users_matcher.py").write_text(MODULE)
    monkeypatch.chdir(tmp_path)
    return "users_matcher"


@pytest.mark.parametrize("name", ["flat", "Matchers.flat"])
def test_a_named_function_is_found_in_the_working_folder(
    name: str, module: str, pair: Pair, images: tuple[np.ndarray, np.ndarray]
) -> None:
    found = dense_disparity(*images, pair.rig, f"{module}:{name}")
    assert found == pytest.approx(np.full(pair.left.shape, 10.0))


@pytest.mark.parametrize(
    ("name", "timeout_s", "message"),
    [
        ("raises", 60.0, "users_matcher:raises raised RuntimeError: no luck$"),
        ("missing", 60.0, "cannot be imported: AttributeError"),
        ("hangs", 1.0, "took longer than 1 s: killed"),
        ("dies", 60.0, "exit code 7"),
    ],
)
def test_a_named_function_that_fails_is_one_line(
    name: str, timeout_s: float, message: str, module: str, pair: Pair, images: tuple[np.ndarray, np.ndarray]
) -> None:
    with pytest.raises(MeasurementFailed, match=message):
        dense_disparity(*images, pair.rig, f"{module}:{name}", timeout_s=timeout_s)


@pytest.mark.parametrize(
    "matcher", ["nowhere.at.all:function", "bm", "", "{left} {right}", "'{left} {right} {out}"]
)
def test_an_unknown_matcher_is_one_line(
    matcher: str, pair: Pair, images: tuple[np.ndarray, np.ndarray]
) -> None:
    with pytest.raises(MeasurementFailed) as caught:
        dense_disparity(*images, pair.rig, matcher)
    assert "\n" not in str(caught.value)


# --- a command ----------------------------------------------------------------------------------


def command(tmp_path: Path, body: str, words: str = "{left} {right} {out}") -> str:
    script = tmp_path / "matcher with a space.py"
    script.write_text(
        "import sys, os, time, pathlib\nleft, right, out = map(pathlib.Path, sys.argv[1:4])\n" + body
    )
    return f"{sys.executable} '{script}' {words}"


def test_a_command_writes_pfm(tmp_path: Path, pair: Pair, images: tuple[np.ndarray, np.ndarray]) -> None:
    answer = tmp_path / "answer.pfm"
    answer.write_bytes(pfm_bytes(pair.disparity))
    body = f"out.write_bytes(pathlib.Path({str(answer)!r}).read_bytes())"
    found = dense_disparity(*images, pair.rig, command(tmp_path, body))
    assert found == pytest.approx(pair.disparity, abs=1e-5)


def test_a_command_gets_the_pictures_and_may_write_npy(
    tmp_path: Path, pair: Pair, images: tuple[np.ndarray, np.ndarray]
) -> None:
    body = f"(pathlib.Path({str(tmp_path)!r}) / 'left.png').write_bytes(left.read_bytes())\n"
    body += "import numpy\nnumpy.save(out, numpy.full((240, 320), 3))"
    colour = np.stack([images[0], images[0] // 2, images[0] // 3], axis=-1)
    words = "{left} {right} {out_npy}"
    found = dense_disparity(colour, colour, pair.rig, command(tmp_path, body, words))
    assert (found == 3).all()
    assert (read_image(tmp_path / "left.png") == colour).all()


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("sys.exit('out of memory')", "failed with exit code 1: out of memory"),
        ("os.kill(os.getpid(), 9)", "failed with signal 9"),
        ("pass", "wrote no {out} file"),
        ("out.write_bytes(b'nonsense')", "neither PFM nor NPY"),
        ("out.write_bytes(b'Pf\\n320 240\\n-1.0\\nshort')", "neither PFM nor NPY"),
        ("out.write_bytes(b'Pf\\n2 1\\n-1.0\\n' + bytes(8))", r"returned shape \(1, 2\)"),
    ],
)
def test_a_command_that_fails_is_one_line(
    body: str, message: str, tmp_path: Path, pair: Pair, images: tuple[np.ndarray, np.ndarray]
) -> None:
    with pytest.raises(MeasurementFailed, match=message) as caught:
        dense_disparity(*images, pair.rig, command(tmp_path, body))
    assert "\n" not in str(caught.value)


def test_a_command_that_hangs_is_killed_with_its_children(
    tmp_path: Path, pair: Pair, images: tuple[np.ndarray, np.ndarray]
) -> None:
    pids = tmp_path / "pids"
    body = (
        "import subprocess\n"
        "child = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(600)'])\n"
        f"pathlib.Path({str(pids)!r}).write_text(f'{{os.getpid()}} {{child.pid}}')\n"
        "time.sleep(600)"
    )
    with pytest.raises(MeasurementFailed, match="took longer than 2 s: killed"):
        dense_disparity(*images, pair.rig, command(tmp_path, body), timeout_s=2.0)
    for pid in map(int, pids.read_text().split()):
        assert not _alive(pid)


def _alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    # a killed orphan may wait for its new parent to notice
    return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] not in ("Z", "X")


def test_a_command_that_is_not_there_is_one_line(pair: Pair, images: tuple[np.ndarray, np.ndarray]) -> None:
    with pytest.raises(MeasurementFailed, match="cannot be started: No such file"):
        dense_disparity(*images, pair.rig, "/nowhere/matcher {left} {right} {out}")


def test_no_shell_reads_a_command(tmp_path: Path, pair: Pair, images: tuple[np.ndarray, np.ndarray]) -> None:
    with pytest.raises(MeasurementFailed):
        dense_disparity(*images, pair.rig, f"/bin/true {{left}} {{right}} {{out}} ; touch {tmp_path}/here")
    assert not (tmp_path / "here").exists()


# --- bad input ----------------------------------------------------------------------------------


def test_a_rig_that_is_not_rectified_is_refused(images: tuple[np.ndarray, np.ndarray]) -> None:
    rig = StereoRig.verged(Intrinsics.from_focal(320, 240, 400.0), 0.1, 5.0)
    with pytest.raises(MeasurementFailed, match="not rectified"):
        dense_disparity(*images, rig)


def test_pictures_too_small_to_match_are_refused() -> None:
    tiny = affine_pair(1, width=5, height=4, d=0.0)
    with pytest.raises(MeasurementFailed):
        dense_disparity(eight_bit(tiny.left), eight_bit(tiny.right), tiny.rig, disparity_range=(0.0, 3.0))


def test_bad_numbers_and_sizes_are_refused(pair: Pair, images: tuple[np.ndarray, np.ndarray]) -> None:
    with pytest.raises(InvalidRange, match="time limit 0 s"):
        dense_disparity(*images, pair.rig, timeout_s=0.0)
    with pytest.raises(InvalidRange, match="40 to 20 px"):
        dense_disparity(*images, pair.rig, disparity_range=(40.0, 20.0))
    with pytest.raises(InvalidImage, match="one size"):
        dense_disparity(images[0], images[1][:, 1:], pair.rig)
    with pytest.raises(InvalidImage, match="320 x 240 px: the rig's"):
        dense_disparity(*images, affine_pair(1, width=300).rig)
