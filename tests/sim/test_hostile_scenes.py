"""Scenes that mean harm, or that nobody can have meant: one line, at once, and nothing left in the folder."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from rigsim.cli.app import run
from rigsim.sim.scenes import gate
from rigsim.sim.scenes.library import models_dir
from rigsim.sim.scenes.scene import load_scene

BOARD = '<geom name="b" type="box" size="1 1 .1" pos="0 0 -3"/>'


def mjcf(body: str = "", head: str = "", camera: str = '<camera name="rig" pos="0 0 1"/>') -> str:
    return f'<mujoco>{head}<worldbody>{camera}<geom type="box" size="1 1 .1"/>{body}</worldbody></mujoco>'


def board(data: str) -> str:
    return mjcf(BOARD, f'<custom><text name="board:b" data="{data}"/></custom>')


def texture(words: str) -> str:
    return mjcf(head=f'<asset><texture name="t" type="2d" {words}/></asset>')


REFUSED = {
    "a board's rows": (board("rows=x cols=3 square_mm=20"), "rows=x: must be a whole number from 1 to 1000"),
    "a board's half row": (board("rows=4.5 cols=3 square_mm=20"), "rows=4.5: must be a whole number"),
    "a board's square": (board("rows=4 cols=3 square_mm=nan"), "square_mm=nan: must be a number above 0"),
    "a board's keys": (board("rows=4"), "text board:b: rows=4: must be as rows=6 cols=9 square_mm=40"),
    "a board's words": (board("hello world"), "must be as rows=6"),
    "a board without a geom": (
        mjcf(head='<custom><text name="board:b" data="rows=4 cols=3 square_mm=20"/></custom>'),
        "no geom is called 'b'",
    ),
    "a camera of ours": (
        mjcf('<camera name="rigsim_left"/>'),
        "camera rigsim_left: the name is rigsim's own",
    ),
    "a million copies": (
        mjcf('<replicate count="1000000" offset="0 0 .1"><geom size=".1"/></replicate>'),
        "1e+06 bodies, geoms, sites, cameras and lights, must be <= 20000",
    ),
    "copies of copies": (
        mjcf('<replicate count="1000"><replicate count="1000"><geom size=".1"/></replicate></replicate>'),
        "1e+06 bodies",
    ),
    "a grid of cells": (
        mjcf('<flexcomp name="f" type="grid" count="2000 2000 100" spacing=".1 .1 .1" dim="3"/>'),
        "takes more than",
    ),
    "a texture of terabytes": (
        texture('builtin="checker" width="1000000" height="1000000"'),
        "asks for 3e+06 MB of memory, must be <= 1000: make <texture> t smaller",
    ),
    "a height field": (
        mjcf(head='<asset><hfield name="h" nrow="50000" ncol="50000" size="1 1 1 1"/></asset>'),
        "asks for 2e+04 MB",
    ),
    "a reserve": (mjcf(head='<size memory="8G"/>'), "asks for 8590 MB"),
    "a size of nan": (mjcf('<geom size="nan"/>'), "nan size in geom"),
    "a place of nan": (mjcf('<geom size="1" pos="nan 0 0"/>'), "nan in its place, must be from"),
    "a size of 1e300": (mjcf('<geom size="1e300"/>'), "1e+300 in its size, must be from"),
    "a mount far away": (
        mjcf(camera='<camera name="rig" pos="1e200 0 0"/>'),
        "camera rig: 1e+200 in its place, must be from -1e+09 to 1e+09 m",
    ),
    "a mesh that is missing": (
        mjcf(head='<asset><mesh name="m" file="gone.obj"/></asset>'),
        "Error opening file 'gone.obj'",
    ),
    "a texture that is a pipe": (texture('file="pipe.png"'), "pipe.png is no regular file"),
    "a mesh that is a device": (
        mjcf(head='<asset><mesh file="/dev/zero"/></asset>'),
        "/dev/zero is no regular",
    ),
    "a part that is missing": (
        '<mujoco><include file="gone.xml"/></mujoco>',
        "Error opening file 'gone.xml'",
    ),
    "a part that is a device": ('<mujoco><include file="/dev/zero"/></mujoco>', "/dev/zero: is a device"),
    "itself as a part": ('<mujoco><include file="scene.xml"/></mujoco>', "already included"),
    "itself as a model": (
        mjcf(
            '<body><attach model="x" body="b" prefix="p"/></body>',
            '<asset><model name="x" file="scene.xml"/></asset>',
        ),
        "MuJoCo dies of it",
    ),
    "deep nesting": (f"<mujoco><worldbody>{'<body>' * 5000}", "XML: element depth exceeded"),
    "an entity": (
        '<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]><x/>',
        "Unrecognized XML model type",
    ),
    "no XML": ("hello there", "XML: parsing text"),
    "nothing": ("", "empty file"),
    "an ending": ("</mujoco>", "XML root element not found"),
    "other XML": ("<html><body>x</body></html>", "Unrecognized XML model type: 'html'"),
    "a texture's number": (
        mjcf(
            head='<asset><texture name="m" type="2d" builtin="flat" width="8" height="8"/></asset>'
            f'<custom><text name="texture:m" data="bark size={"9" * 6000}"/></custom>'
        ),
        "texture bark: size=999",
    ),
    "a plugin": (mjcf(head='<extension><plugin plugin="gone"/></extension>'), "plugin gone not found"),
}


def refused(path: Path, folder: Path, capfd: pytest.CaptureFixture[str]) -> str:
    code = run(["render", "--scene", str(path), "--renderer", "rays", "--out", str(folder / "out")])
    told = capfd.readouterr().err
    assert code == 1
    assert told.count("\n") == 1
    assert len(told) < 700
    assert list(Path.cwd().iterdir()) == []
    return told


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where scenes are; the working folder is another one, empty."""
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    return tmp_path


@pytest.mark.parametrize("name", REFUSED)
def test_a_scene_is_refused_in_one_line(name: str, folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    text, said = REFUSED[name]
    os.mkfifo(folder / "pipe.png")
    path = folder / "scene.xml"
    path.write_text(text)
    told = refused(path, folder, capfd)
    assert told.startswith(f"rigsim: error: {path}: ")
    assert said in told


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (mjcf('<body name="é"/>').encode("latin-1"), "line 1 is not UTF-8 text: save it as UTF-8"),
        (mjcf().encode("utf-16"), "is not UTF-8 text"),
        (bytes(100), "empty document"),
        (bytes(range(256)) * 10, "is not UTF-8 text"),
    ],
)
def test_bytes_are_refused(
    content: bytes, said: str, folder: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    path = folder / "scene.xml"
    path.write_bytes(content)
    assert said in refused(path, folder, capfd)


def test_what_is_no_file_is_refused(folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    os.mkfifo(folder / "pipe.xml")
    (folder / "empty").mkdir()
    with (folder / "big.xml").open("wb") as file:
        file.truncate(10**10)  # sparse: it takes no room
    assert "is no regular file" in refused(folder / "pipe.xml", folder, capfd)
    assert "is a folder without a scene.xml" in refused(folder / "empty", folder, capfd)
    assert "1e+04 MB, must be <= 100 MB" in refused(folder / "big.xml", folder, capfd)
    assert "cannot be read (File name too long)" in refused(folder / ("n" * 300), folder, capfd)


def test_a_warning_of_mujoco_is_a_remark_and_no_file(folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = folder / "scene.xml"
    path.write_text(mjcf(head='<custom><numeric name="n" data="nan"/></custom>'))
    scene = load_scene(str(path))
    assert [remark.code for remark in scene.remarks] == ["mujoco_warning"]
    assert "XML contains a 'NaN'" in scene.remarks[0].text
    assert capfd.readouterr() == ("", "")
    assert list(Path.cwd().iterdir()) == []


def test_scenes_that_people_write_pass(folder: Path) -> None:
    """Replicates, parts, comments with two dashes, and a name of any letters."""
    (folder / "part.xml").write_text('<mujoco><worldbody><geom name="漢" size=".1"/></worldbody></mujoco>')
    path = folder / "scene.xml"
    path.write_text(
        mjcf(
            '<!-- -- a head -- --><replicate count="30" offset=".1 0 0"><geom size=".05"/></replicate>',
            '<include file="part.xml"/>',
        )
    )
    scene = load_scene(str(path))
    assert scene.model.ngeom == 32
    assert scene.remarks == ()


def test_a_bundled_scene_is_not_read_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gate, "outline", None)
    gate.check(models_dir() / "boards" / "scene.xml")


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ("Caught an unknown exception!", "a size or count is too large, or a file is broken"),
        ("Error: engine error: Could not allocate memory", "does not fit into memory"),
        (
            "XML parse error 7:\nError=XML_ERROR_PARSING_ATTRIBUTE ErrorID=7 (0x7) Line number=3: x",
            "XML: parsing attribute, line 3: x",
        ),
        ("XML Error: Error: repeated name 'a'", "repeated name 'a'"),
    ],
)
def test_what_mujoco_says_is_put_in_words(said: str, words: str) -> None:
    assert words in gate.in_words(said)
