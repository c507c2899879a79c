"""The noise said as a disparity's, wherever it can be said as a pixel coordinate's."""

from __future__ import annotations

import inspect
import json
import shlex
from collections.abc import Iterator
from typing import Any

import pytest
import typer

import rigsim
from rigsim.cli.app import app, run
from rigsim.errors import InvalidNoise, InvalidRange, RigsimError

RIG = "--baseline 100 --focal 1000"
SMALL = "--resolution 64x48 --points 100 --trials 2 --measure none --renderer rays --supersample 1"
BUILT = f"tolerance {RIG} --resolution 640x480 --class none --tolerance baseline=0.1mm --no-recalibrate"
BOTH = "noise 0.25 px and disparity noise 0.35 px both given: a disparity's is sqrt(2) times a coordinate's, "
NOISES = {"noise_px": "disparity_noise_px", "noises_px": "disparity_noises_px"}


def options(command: Any, name: str) -> Iterator[tuple[str, set[str]]]:
    """Every command of `command`, with its options."""
    if hasattr(command, "commands"):
        for sub in command.commands:
            yield from options(command.commands[sub], f"{name} {sub}".strip())
    else:
        yield name, {word for parameter in command.params for word in parameter.opts}


def answer(capsys: pytest.CaptureFixture[str], words: str) -> dict[str, Any]:
    capsys.readouterr()
    assert run([*shlex.split(words), "--json"]) == 0, capsys.readouterr().err
    document: dict[str, Any] = json.loads(capsys.readouterr().out)
    return document


def test_every_command_with_a_noise_takes_a_disparitys() -> None:
    found = dict(options(typer.main.get_command(app), ""))
    with_noise = {name for name, words in found.items() if "--noise" in words}
    assert with_noise >= {
        "sweep",
        "tolerance",
        "design",
        "compare",
        "calc point",
        "calc depth",
        "calc motion",
    }
    assert with_noise == {name for name, words in found.items() if "--disparity-noise" in words}


def test_every_function_with_a_noise_takes_a_disparitys() -> None:
    functions = [getattr(rigsim, name) for name in rigsim.__all__]
    taken = [set(inspect.signature(one).parameters) for one in functions if inspect.isfunction(one)]
    assert sum(bool(set(NOISES) & words) for words in taken) >= 5
    for words in taken:
        for noise, of_disparity in NOISES.items():
            assert (noise in words) == (of_disparity in words), words


def test_of_one_point_and_one_depth(capsys: pytest.CaptureFixture[str]) -> None:
    # Z^2 / (f B) per pixel of disparity: 4 / (1000 x 0.1) m at 2 m is 40 mm, of 0.5 px 20 mm
    half = "--disparity-noise 0.5"
    assert answer(capsys, f"calc depth {RIG} --z 2m {half}")["depth_std"] == pytest.approx(20, rel=1e-9)
    point = answer(capsys, f"calc point {RIG} --left 0,0 --right=-50,0 {half}")
    assert point["depth_std"] == pytest.approx(20, rel=1e-9)
    moved = "--time-offset 2ms --speed 1m/s --moving object"
    motion = answer(capsys, f"calc motion {RIG} --z 2m {moved} {half}")
    assert motion["depth_std"] == pytest.approx(20, rel=1e-9)
    # 1 m/s shifts a point at 2 m by 500 px/s, and by half a pixel in a millisecond
    assert motion["allowed_ms"] == pytest.approx(1, rel=1e-9)
    noise = answer(capsys, f"calc depth {RIG} --z 2m --noise 0.25")["depth_std"]
    assert answer(capsys, f"calc depth {RIG} --z 2m")["depth_std"] == noise
    said = answer(capsys, f"calc depth {RIG} --z 2m --disparity-noise 0.35355339")["depth_std"]
    assert said == pytest.approx(noise, rel=1e-7)
    assert noise == pytest.approx(14.1421356, rel=1e-7)


def test_of_a_sweep_lists_and_ranges_are_levels(capsys: pytest.CaptureFixture[str]) -> None:
    (near,) = answer(capsys, f"sweep {SMALL} --disparity-noise 0.35355339")["rows"]
    (row,) = answer(capsys, f"sweep {SMALL} --disparity-noise 0.3535533905932738")["rows"]
    (same,) = answer(capsys, f"sweep {SMALL} --noise 0.25")["rows"]
    assert row == same
    assert near["noise_px"] == pytest.approx(0.25, rel=1e-7)
    # another number draws other noise
    assert near["predicted_depth_rmse_mm"] == pytest.approx(same["predicted_depth_rmse_mm"], rel=1e-6)
    assert not [key for key in row if "disparity_noise" in key]
    several = answer(capsys, f"sweep {SMALL} --disparity-noise 0.1:0.3/3")
    assert several["swept"] == ["noise_px"]
    levels = [row["noise_px"] for row in several["rows"]]
    assert levels == pytest.approx([0.0707106781, 0.1414213562, 0.2121320344])


def test_of_built_rigs(capsys: pytest.CaptureFixture[str]) -> None:
    few = "--range 1:2m --rigs 100 --points 50"
    said = answer(capsys, f"{BUILT} {few} --disparity-noise 0.35355339")
    noise = answer(capsys, f"{BUILT} {few} --noise 0.25")
    assert said["noise_px"] == pytest.approx(0.25, rel=1e-7)
    assert said["depths"][-1]["noise_mm"] == pytest.approx(noise["depths"][-1]["noise_mm"], rel=1e-6)
    # 40 mm per pixel of disparity at 2 m, times 0.35355; what a second order adds is a thousandth
    assert said["depths"][-1]["noise_mm"] == pytest.approx(14.142, rel=2e-3)


def test_of_compared_triangulators(capsys: pytest.CaptureFixture[str]) -> None:
    few = "compare dlt --geometry rectified --points 200"
    rows = answer(capsys, f"{few} --disparity-noise 0.5,1")["rows"]
    assert [row["noise_px"] for row in rows] == pytest.approx([0.353553391, 0.707106781])


def test_of_functions() -> None:
    about: dict[str, Any] = {"tolerance_class": "none", "tolerances": {"baseline_mm": 0.1}, "rigs": 100}
    built = rigsim.tolerance("oak-d", **about, points=50, recalibrate=False, disparity_noise_px=0.5)
    assert built.document()["noise_px"] == pytest.approx(0.353553391)
    small: dict[str, Any] = {"resolutions_px": (64, 40), "measure": "none", "points": 100, "trials": 2}
    swept = rigsim.sweep(rig="oak-d", **small, renderer="rays", disparity_noises_px=[0.5, 1])
    assert swept.table["noise_px"].tolist() == pytest.approx([0.353553391, 0.707106781])
    compared = rigsim.compare("dlt", geometries="rectified", points=200, disparity_noises_px=0.5)
    assert compared.table["noise_px"].tolist() == pytest.approx([0.353553391])


@pytest.mark.parametrize(
    "words",
    [
        f"calc depth {RIG} --z 2m",
        f"calc point {RIG} --left 0,0 --right=-50,0",
        f"calc motion {RIG} --z 2m --time-offset 2ms",
        BUILT,
        "compare dlt --geometry rectified",
        "design --range 1:3m --depth-error 20mm@3m --no-proof",
    ],
)
def test_both_are_one_clear_error(words: str, capsys: pytest.CaptureFixture[str]) -> None:
    # be it with the value that is meant anyway
    assert run([*shlex.split(words), "--noise", "0.25", "--disparity-noise", "0.35"]) == 2
    assert capsys.readouterr().err == f"rigsim: error: {BOTH}give one\n"


def test_both_are_one_clear_error_of_a_sweep(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["sweep", "--noise", "0.25", "--disparity-noise", "0.1:0.3"]) == 2
    same = "they say the same thing, give one"
    assert capsys.readouterr().err == f"rigsim: error: --noise and --disparity-noise both given: {same}\n"


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (f"calc depth {RIG} --z 2m --disparity-noise=-0.1", "disparity noise -0.1 px: must be >= 0"),
        ("sweep --disparity-noise 0.1,-0.1", "disparity noise -0.1 px: must be >= 0"),
        ("sweep --disparity-noise 0.1,0.1", "disparity noise 0.1,0.1: 0.1 px is given twice; remove one"),
        ("compare dlt --disparity-noise 0", "disparity noise 0 px: must be > 0"),
        (
            f"{BUILT} --disparity-noise much",
            "disparity noise much: must be a number, in px or with a unit (px)",
        ),
    ],
)
def test_a_wrong_one_is_called_what_it_is(words: str, says: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(shlex.split(words)) == 2
    assert capsys.readouterr().err == f"rigsim: error: {says}\n"


@pytest.mark.parametrize(
    ("given", "error", "says"),
    [
        (
            {"noises_px": 0.25, "disparity_noises_px": [0.3, 0.4]},
            InvalidRange,
            r"disparity noise 0.3, 0.4 px",
        ),
        ({"disparity_noises_px": -0.3}, InvalidNoise, r"disparity noise -0.3 px: must be >= 0 and finite"),
        ({"disparity_noises_px": "much"}, InvalidNoise, r"disparity noise 'much': must be a number"),
        (
            {"plan": rigsim.Plan(), "disparity_noises_px": 0.3},
            InvalidRange,
            r"a plan and disparity_noises_px",
        ),
    ],
)
def test_functions_refuse_it_in_a_line(given: dict[str, Any], error: type[RigsimError], says: str) -> None:
    rig = {} if "plan" in given else {"rig": "oak-d"}
    with pytest.raises(error, match=says):
        rigsim.sweep(**rig, **given)
