"""`render --mount camera:NAME`: whose lens is drawn with."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from rigsim.cli.app import run
from rigsim.interop.formats.calibration import read_calibration

SCENE = """<mujoco><worldbody><light pos="0 0 3"/><geom type="plane" size="9 9 .1"/>
<camera name="eye" pos="0 -2 1" xyaxes="1 0 0 0 0 1" fovy="40" resolution="80 60"/>
<geom type="box" size=".3 .3 .3" pos="0 0 1" rgba="1 0 0 1"/></worldbody></mujoco>"""


@pytest.mark.parametrize(
    ("words", "says"), [([], "scene's camera eye"), (["--hfov", "50"], "that of --hfov, not")]
)
def test_the_camera_s_own_lens_unless_another_is_given(
    words: list[str], says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = tmp_path / "scene.xml"
    scene.write_text(SCENE)
    typed = ["render", "--scene", str(scene), "--mount", "camera:eye", "--renderer", "rays", "--json"]
    size = ["--resolution", "80x60"] if words else []
    assert run([*typed, *words, *size, "--baseline", "70", "--out", str(tmp_path / "out")]) == 0
    said = capsys.readouterr()
    assert said.err.count("rigsim: note: ") == said.err.count("\n")
    assert says in said.err
    document = json.loads(said.out)
    assert document["remarks"][0]["code"] == "lens"
    assert document["rig"]["baseline_mm"] == pytest.approx(70)
    expected = 50.0 if words else math.degrees(2 * math.atan(4 / 3 * math.tan(math.radians(20))))
    assert document["rig"]["hfov_deg"] == pytest.approx(expected, abs=0.01)


def test_a_camera_without_a_resolution_keeps_its_height_s_field(tmp_path: Path) -> None:
    scene = tmp_path / "scene.xml"
    scene.write_text(SCENE.replace(' resolution="80 60"', ""))
    typed = ["render", "--scene", str(scene), "--mount", "camera:eye", "--renderer", "rays"]
    assert run([*typed, "--resolution", "90x60", "--out", str(tmp_path / "out")]) == 0
    lens = read_calibration(tmp_path / "out" / "rig.toml").left
    # 20 degrees to each side of the height, whatever the width
    assert (lens.width, lens.height) == (90, 60)
    assert lens.fx == lens.fy == pytest.approx(30 / math.tan(math.radians(20)))
