"""A rig typed in words, on the command line and in Python: where its right camera stands and looks."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest
import typer.main

import rigsim
from rigsim.cli.app import app
from rigsim.errors import InvalidRange, InvalidRig, OutputError
from rigsim.interop.formats.registry import RIG_FORMATS, rig_files
from rigsim.rig.sensor import Sensor
from rigsim.typed.rigs import RigOptions
from tests.helpers.cli import rigsim as run
from tests.helpers.sampling import close

PLAIN: dict[str, Any] = {"baseline_mm": 100, "focal_px": 500, "resolution_px": (641, 481)}
TYPED = {"baseline": "100", "focal": "500", "resolution": "641x481"}
AHEAD = [[0.0, 0.0, 2.0]]
TURN_DEG = math.degrees(math.atan(0.05))
"""By this the axis of a camera 0.1 m to the side meets the point 2 m ahead."""

CASES = {
    # f = 500, principal point (320, 240), the point 0.1 m left of the right camera and 2 m ahead of it
    "yaw": (TURN_DEG, (320 + 500 * math.tan(2 * math.atan(-0.05)), 240.0)),
    "pitch": (math.degrees(math.atan(0.1)), (320 - 500 * 0.1 / (2 * math.cos(math.atan(0.1))), 290.0)),
    "roll": (90.0, (320.0, 240.0 + 25.0)),
    "vertical": (50.0, (295.0, 240.0 - 12.5)),
    "forward": (1000.0, (270.0, 240.0)),
}
UNITS = {"yaw": "deg", "pitch": "deg", "roll": "deg", "vertical": "mm", "forward": "mm"}


@pytest.mark.parametrize("word", CASES)
def test_each_turn_and_shift_by_hand(word: str) -> None:
    value, seen = CASES[word]
    rig = rigsim.make_rig(**PLAIN, **{f"{word}_{UNITS[word]}": value})
    uv_left, uv_right = rig.project(AHEAD)
    close(uv_left, [[320.0, 240.0]])
    close(uv_right, [seen], atol=1e-9)
    assert RigOptions.of({**TYPED, word: f"{value!r}{UNITS[word]}"}).single("boards") == rig


def test_a_camera_turned_inwards_looks_at_the_point() -> None:
    _, uv_right = rigsim.make_rig(**PLAIN, yaw_deg=-TURN_DEG).project(AHEAD)
    close(uv_right, [[320.0, 240.0]], atol=1e-9)


@pytest.mark.parametrize("vergence_deg", [5.0, -3.0])
def test_vergence_is_half_a_yaw_of_each_camera(vergence_deg: float) -> None:
    """Seen from the left camera, which has turned by the other half, the right one stands a little ahead."""
    half = math.radians(vergence_deg) / 2
    verged = rigsim.make_rig(**PLAIN, vergence_deg=vergence_deg)
    turned = rigsim.make_rig(
        **{**PLAIN, "baseline_mm": 100 * math.cos(half)},
        yaw_deg=-vergence_deg,
        forward_mm=100 * math.sin(half),
    )
    close(turned.right_from_left.R, verged.right_from_left.R, atol=1e-15)
    close(turned.right_from_left.t, verged.right_from_left.t, atol=1e-15)
    assert turned.vergence_deg == pytest.approx(vergence_deg)


def test_words_are_the_quantities_of_a_perturbation() -> None:
    base = rigsim.make_rig(**PLAIN, vergence_deg=4)
    words = rigsim.make_rig(base, yaw_deg=1, pitch_deg=-2, roll_deg=3, vertical_mm=-4, forward_mm=5)
    turns = {"yaw_rad": math.radians(1), "pitch_rad": math.radians(-2), "roll_rad": math.radians(3)}
    assert words == rigsim.Perturbation(**turns, vertical_m=-0.004, axial_m=0.005).apply(base)
    assert rigsim.make_rig(base, yaw_deg=0, vertical_mm=0) == base


def test_lenses_in_words() -> None:
    size = {"baseline_mm": 100, "resolution_px": (1000, 500)}
    by_pitch = rigsim.make_rig(**size, focal_mm=8, pixel_pitch_um=4)
    by_width = rigsim.make_rig(**size, focal_mm=8, sensor_width_mm=4)
    by_angle = rigsim.make_rig(**size, hfov_deg=2 * math.degrees(math.atan(0.25)))
    for rig in (by_pitch, by_width, by_angle):
        assert rig.left.fx == pytest.approx(2000)
        assert (rig.left.cx, rig.left.cy, rig.right) == (499.5, 249.5, rig.left)
    assert rigsim.make_rig("oak-d", baseline_mm=150).left == rigsim.preset("oak-d").rig.left


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ({"focal_px": 500, "resolution_px": (64, 48)}, "baseline_mm is missing"),
        ({"baseline_mm": 100, "resolution_px": (64, 48)}, "no lens: give focal_px"),
        ({**PLAIN, "hfov_deg": 60}, "focal_px and hfov_deg both given"),
        ({**PLAIN, "pixel_pitch_um": 3}, "pixel_pitch_um: needs a focal_mm"),
        ({"rig": "oak-d", "focal_mm": 8}, "focal_mm: needs one of pixel_pitch_um and sensor_width_mm"),
        ({**PLAIN, "yaw_deg": math.inf}, "yaw_deg inf: must be a finite number"),
        ({**PLAIN, "baseline_mm": -1}, "baseline -1 mm: must be > 0"),
    ],
)
def test_words_that_say_no_rig(words: dict[str, Any], told: str) -> None:
    with pytest.raises((InvalidRange, InvalidRig), match=told.replace("(", r"\(")):
        rigsim.make_rig(**words)


def test_every_command_that_takes_a_rig_takes_these_words() -> None:
    def walk(command: Any, name: str) -> None:
        for sub, inner in getattr(command, "commands", {}).items():
            walk(inner, f"{name} {sub}")
        options = {option for item in command.params for option in item.opts}
        if "--vergence" in options:
            found[name] = {f"--{word}" for word in CASES} - options

    found: dict[str, set[str]] = {}
    walk(typer.main.get_command(app), "rigsim")
    assert len(found) >= 10
    assert {name: missing for name, missing in found.items() if missing} == {}


def test_a_sweep_follows_the_word_that_was_typed(tmp_path: Path) -> None:
    small = ["--resolution", "160x120", "--points", "60", "--trials", "5", "--measure", "none"]
    words = ["--yaw=-3,0deg", "--vertical", "2mm", "--supersample", "1", "--renderer", "rays"]
    done = run("sweep", *small, *words, "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    document = json.loads(done.stdout)
    assert document["swept"] == ["yaw_deg"]
    for row, yaw in zip(document["rows"], (-3, 0), strict=True):
        assert (row["yaw_deg"], row["vertical_mm"]) == (pytest.approx(yaw), pytest.approx(2))
        assert row["vergence_deg"] == pytest.approx(-yaw)  # toe-in is the right camera looking left


def test_a_rig_is_written_to_a_file_and_read_as_the_command_line_does(tmp_path: Path) -> None:
    rig = rigsim.make_rig(**PLAIN, yaw_deg=0.3, vertical_mm=1.5)
    path = tmp_path / "rig.toml"
    assert rigsim.write_rig(path, rig, comment="mine", sensor=Sensor(blur_px=0.5)) == path
    assert path.read_text() == rigsim.write_rig(rig, comment="mine", sensor=Sensor(blur_px=0.5))
    assert rigsim.write_rig(rig, "mine", Sensor(blur_px=0.5)) == path.read_text()
    for name in (path, str(path), tmp_path):
        assert rigsim.read_rig(name) == rig == RigOptions(rig=Path(name)).base("boards")
    rigsim.write_rig(str(path), rigsim.preset("bin").rig)  # over the one that is there
    assert rigsim.read_rig(path) == rigsim.preset("bin").rig


@pytest.mark.parametrize("format", RIG_FORMATS)
def test_read_rig_reads_what_the_option_reads(format: str, tmp_path: Path) -> None:
    for name, content in rig_files(rigsim.make_rig(**PLAIN), format).items():
        (tmp_path / name).write_bytes(content)
    assert rigsim.read_rig(str(tmp_path)) == RigOptions(rig=tmp_path).base("boards")


def test_files_that_cannot_be_written(tmp_path: Path) -> None:
    rig = rigsim.make_rig(**PLAIN)
    with pytest.raises(InvalidRange, match=r"must end in \.toml; rigsim\.export_rig"):
        rigsim.write_rig(tmp_path / "stereo.yml", rig)
    with pytest.raises(OutputError):
        rigsim.write_rig(tmp_path / "none" / "rig.toml", rig)
    no_rig: Any = tmp_path / "rig.toml"
    with pytest.raises(InvalidRig, match="must be a StereoRig: the rig to write"):
        rigsim.write_rig(no_rig)
