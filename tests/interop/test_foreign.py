"""Files that mean harm, or that nobody can have meant: one line, at once, and no memory taken."""

from __future__ import annotations

import io
import os
import struct
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest

from rigsim import foreign, strangers
from rigsim.cli.app import run
from rigsim.errors import InvalidImage, InvalidRig, OutputError
from rigsim.interop.formats.middlebury import read_disparity
from rigsim.interop.formats.rig_toml import parse_rig
from rigsim.interop.formats.values import shown
from rigsim.interop.formats.yaml_text import yaml_table
from rigsim.pixels.reading import read_image

LAUGHS = "a0: &a0 [x, x]\n" + "".join(
    f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 30)
)


def asked(path: str, capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    code = run(["calc", "depth", "--z", "3m", "--rig", path])
    return code, capsys.readouterr().err


def png(width: int, height: int) -> bytes:
    def chunk(kind: bytes, content: bytes) -> bytes:
        body = kind + content
        return struct.pack(">I", len(content)) + body + struct.pack(">I", zlib.crc32(body))

    head = struct.pack(">IIBBBBB", width, height, 1, 0, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(b"")) + chunk(b"IEND", b"")
    )


def test_a_billion_laughs_are_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "stereo.yml"
    path.write_text(LAUGHS)
    code, told = asked(str(path), capsys)
    assert code == 1
    assert "its aliases make more than 200000 values of it" in told
    assert told.count("\n") == 1


def test_a_value_is_quoted_in_few_letters_whatever_it_is() -> None:
    laughs: list[object] = ["x"]
    for _ in range(40):
        laughs = [laughs] * 9
    assert len(shown(laughs)) <= 40
    assert len(shown("y" * 10**7)) <= 40


def test_anchors_that_people_write_are_read() -> None:
    assert yaml_table("a: &size [640, 480]\nb: *size") == {"a": [640, 480], "b": [640, 480]}


def test_a_key_twice_holds_where_both_say_the_same() -> None:
    """OpenCV's writer may append what is there already; where the two differ nobody knows which one holds."""
    assert yaml_table("K1: 1\nb: 2\nK1: 1") == {"K1": 1, "b": 2}
    assert str(yaml_table("K1: 1\nb: 2\nK1: 3")["K1"]) == "given twice, differently"


def test_what_is_no_file_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pipe = tmp_path / "rig.toml"
    os.mkfifo(pipe)
    assert asked(str(pipe), capsys) == (1, f"rigsim: error: {pipe}: is a pipe: name a calibration file\n")
    assert asked("/dev/zero", capsys) == (
        1,
        "rigsim: error: /dev/zero: is a device: name a calibration file\n",
    )


def test_a_file_of_gigabytes_is_not_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "big.yaml"
    with path.open("wb") as file:
        file.truncate(10**10)  # sparse: it takes no room
    assert asked(str(path), capsys) == (
        1,
        f"rigsim: error: {path}: 1e+04 MB, must be <= 4 MB: name a calibration file\n",
    )


def test_deep_brackets_are_one_line() -> None:
    for text in ("a = " + "[" * 20_000, "a = " + "{a=" * 20_000):
        with pytest.raises(InvalidRig, match="is not TOML") as caught:
            parse_rig(text)
        assert len(str(caught.value)) < 200
    with pytest.raises(InvalidRig):
        yaml_table("a: " + "[" * 5000)


def test_a_picture_of_a_billion_pixels_is_not_unpacked(tmp_path: Path) -> None:
    path = tmp_path / "left.png"
    path.write_bytes(png(40_000, 40_000))
    with pytest.raises(InvalidImage, match="40000 x 40000 pixels, must be <= 300 megapixels"):
        read_image(path)
    with pytest.raises(InvalidImage, match="megapixels"):
        read_disparity(path)


@pytest.mark.parametrize(
    ("shape", "dtype", "message"),
    [
        ("(100000, 100000)", "<f8", "promises 80000000000 bytes of numbers, it has 16"),
        ("(-1, 2)", "<f8", "promises"),
        ("(2,)", "<c16", "must be real numbers"),
        ("(1,)", "<M8[s]", "must be real numbers"),
        ("(1,)", "|O", "must be real numbers"),
        ("(" * 300, "<f8", "no NPY file"),
    ],
)
def test_an_npy_header_that_lies(shape: str, dtype: str, message: str) -> None:
    head = f"{{'descr': '{dtype}', 'fortran_order': False, 'shape': {shape}, }}".encode()
    content = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head + bytes(16)
    with pytest.raises(InvalidImage, match=message):
        foreign.parse_npy(content, "answer")


def test_an_npy_file_of_numbers_is_read() -> None:
    file = io.BytesIO()
    values = np.arange(6, dtype=np.float32).reshape(2, 3)
    np.save(file, values)
    np.testing.assert_array_equal(foreign.parse_npy(file.getvalue(), "answer"), values)


def test_a_link_may_lead_to_a_file_but_not_where_a_program_was_to_write(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"secret")
    link = tmp_path / "link"
    link.symlink_to(tmp_path / "file")
    assert foreign.read_bytes(link, "a file") == b"secret"
    with pytest.raises(OutputError, match="is a link") as caught:
        foreign.read_bytes(link, "a file", follow=False)
    assert "secret" not in str(caught.value)


def test_modules_beside_the_user_hide_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`mine.py` is found, and its `colorsys` is Python's own, not the file beside it."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.path", list(sys.path))
    (tmp_path / "mine.py").write_text(
        "import colorsys\n\ndef hue():\n    return colorsys.rgb_to_hsv(0, 1, 0)[0]\n"
    )
    (tmp_path / "colorsys.py").write_text("raise SystemExit('executed')")
    assert strangers.find("mine:hue")() == pytest.approx(1 / 3)
