"""poses.json: read back bit for bit; what is none is one line that names the file."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from rigsim.errors import InvalidRange, OutputError
from rigsim.interop.documents.text import json_text
from rigsim.interop.files.poses import poses_document, read_poses
from rigsim.rig.board import Board
from rigsim.theory.calibration.boards import BoardPoses

ROWS = [[0.1, -0.2, 0.3, 0.01, -0.02, 0.8], [0.0, 0.0, 0.0, -0.12, -0.075, 0.6]]


def ended(last: str) -> str:
    """One pose whose last number is `last`."""
    return '{"left_from_board": [[0.1, 0.2, 0.3, 0.1, 0.2, ' + last + "]]}"


def test_what_is_written_is_read(tmp_path: Path) -> None:
    path = tmp_path / "poses.json"
    document = poses_document(Board(9, 6, 0.03), BoardPoses.of(ROWS), ["so", "so"])
    path.write_text(json_text(document))
    assert list(document) == ["board", "left_from_board", "holdings"]
    np.testing.assert_allclose(read_poses(path).rows, ROWS, rtol=0, atol=1e-13)


def test_others_keys_are_passed_over(tmp_path: Path) -> None:
    path = tmp_path / "poses.json"
    path.write_text(json.dumps({"of": "somebody else", "left_from_board": ROWS}))
    poses = read_poses(path)
    # R x + t by hand, of the second: the point (30, 0, 0) mm lands 30 mm right of its first corner
    np.testing.assert_allclose(poses.points_left(np.array([[0.03, 0, 0]]))[1, 0], [-0.09, -0.075, 0.6])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "no JSON"),
        ("{", "no JSON"),
        ("[]", "no left_from_board (found [])"),
        ('{"poses": 1}', "no left_from_board (found poses)"),
        ('{"left_from_board": 3}', "left_from_board 3: must be"),
        ('{"left_from_board": []}', "left_from_board is empty: give two poses at least"),
        ('{"left_from_board": [1, 2]}', "pose 1: 1: must be six"),
        ('{"left_from_board": [[1, 2, 3, 4, 5, 6], [1, 2, 3, 4, 5]]}', "pose 2: 5 numbers: must be six"),
        (ended("NaN"), "pose 1: nan: must be a finite number"),
        (ended("Infinity"), "pose 1: inf: must be a finite number"),
        (ended('"x"'), "pose 1: x: must be a finite number"),
        (ended("true"), "pose 1: True: must be a finite number"),
        (ended("9" * 5000), "poses.json: "),
        ("[" * 100_000, "no JSON"),
    ],
)
def test_what_is_none_is_one_line_that_names_the_file(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "poses.json"
    path.write_text(text)
    with pytest.raises(InvalidRange) as told:
        read_poses(path)
    assert says in str(told.value)
    assert str(path) in str(told.value)
    assert "\n" not in str(told.value)
    assert len(str(told.value)) < 300 + len(str(path))


def test_other_encodings_and_degrees_are_one_line(tmp_path: Path) -> None:
    path = tmp_path / "poses.json"
    path.write_bytes(json.dumps({"left_from_board": ROWS}).encode("utf-16"))
    with pytest.raises(InvalidRange, match="not UTF-8 text"):
        read_poses(path)
    path.write_text(json.dumps({"left_from_board": [[20, -11, 6, 0, 0, 1]]}))
    with pytest.raises(InvalidRange, match=r"rotation vector of 23\.6 rad.*degrees"):
        read_poses(path)


def test_a_file_that_is_not_there_is_said(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"nofile\.json.*left_from_board"):
        read_poses(tmp_path / "nofile.json")
