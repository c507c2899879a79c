"""Programs that triangulate: what they are given, what is taken from them, and every way to get it wrong."""

from __future__ import annotations

import csv
import json
import math
import shlex
import sys
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigsim.errors import OutputError, TriangulatorError
from rigsim.interop.exec.contract import ExecTriangulator
from rigsim.interop.exec.files import parse_points, task_files
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from tests.helpers.processes import children, wait_for_end
from tests.helpers.sampling import RIGS, points_in_view

RIG = RIGS["distorted"]
POINTS = points_in_view(RIG, 4, 1.0, 4.0)
PIXELS = RIG.project(POINTS)
HEADER = "id,x_m,y_m,z_m\n"
GOOD = HEADER + "".join(f"{i},{x!r},{y!r},{z!r}\n" for i, (x, y, z) in enumerate(POINTS.tolist()))


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A working folder of its own; nothing of a program's processes or folders may be left."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tmp").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "tmp"))
    before = children()
    yield tmp_path
    assert children() == before
    assert list((tmp_path / "tmp").iterdir()) == []


def program(body: str) -> str:
    """The command of a program that is given `folder`, a Path, and the text of the `good` answer."""
    head = f"import os, pathlib, sys, time\nfolder = pathlib.Path(sys.argv[-1])\ngood = {GOOD!r}\n"
    Path("program.py").write_text(head + body)
    return f"{shlex.quote(sys.executable)} program.py"


def answer(text: str | bytes) -> str:
    """The command of a program that leaves `text`."""
    content = text if isinstance(text, bytes) else text.encode()
    return program(f"(folder / 'points.csv').write_bytes({content!r})")


# --- what a program is given ---------------------------------------------------------------------


def test_calibration_by_hand() -> None:
    rig = StereoRig(
        Intrinsics(640, 480, 500.25, 510.5, 300.0, 250.0),
        Intrinsics(800, 600, 600.0, 610.0, 400.0, 310.0, BrownConrady(0.1, -0.2, 0.003, -0.004, 0.05)),
        Pose(np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]), np.array([-0.12, 0.01, 0.5])),
    )
    files = task_files(rig, np.zeros((0, 2)), np.zeros((0, 2)))
    assert set(files) == {"calibration.json", "stereo.yml", "observations.csv"}
    document = json.loads(files["calibration.json"])
    assert (document["format"], document["version"]) == ("rigsim calibration", 1)
    assert document["left"] == {
        "width_px": 640,
        "height_px": 480,
        "fx_px": 500.25,
        "fy_px": 510.5,
        "cx_px": 300.0,
        "cy_px": 250.0,
        "distortion": {"k1": 0.0, "k2": 0.0, "p1": 0.0, "p2": 0.0, "k3": 0.0},
    }
    assert document["right"]["fy_px"] == 610.0
    assert document["right"]["distortion"] == {"k1": 0.1, "k2": -0.2, "p1": 0.003, "p2": -0.004, "k3": 0.05}
    assert document["right_from_left"] == {
        "R": [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]],
        "t_m": [-0.12, 0.01, 0.5],
    }
    assert "centre" in document["conventions"]["pixels"]
    assert document["conventions"]["right_from_left"].startswith("x_right = R x_left + t")


def test_observations_by_hand() -> None:
    left, right = np.array([[1.5, 1 / 3], [np.nan, 2.0]]), np.array([[0.1, -2e-17], [np.inf, -np.inf]])
    assert task_files(RIG, left, right)["observations.csv"] == (
        "id,u_left,v_left,u_right,v_right\n0,1.5,0.3333333333333333,0.1,-2e-17\n1,nan,2.0,inf,-inf\n"
    )


@given(st.lists(st.tuples(*4 * [st.floats()]), min_size=1))
def test_observations_lose_no_digit(rows: list[tuple[float, ...]]) -> None:
    values = np.array(rows)
    text = task_files(RIG, values[:, :2], values[:, 2:])["observations.csv"]
    read = [[float(row[name]) for name in row if name != "id"] for row in csv.DictReader(text.splitlines())]
    assert np.array_equal(read, values, equal_nan=True)


def test_the_program_s_folder_is_its_last_word_and_opencv_reads_it(elsewhere: Path) -> None:
    body = "import shutil; shutil.copytree(folder, 'seen'); (folder / 'points.csv').write_text(good)\n"
    body += "pathlib.Path('words').write_text(repr(sys.argv[1:-1]))"
    ExecTriangulator(program(body) + " --fast 'two words' $HOME ';'", 30.0)(RIG, *PIXELS)
    assert Path("words").read_text() == "['--fast', 'two words', '$HOME', ';']"
    seen = elsewhere / "seen"
    assert sorted(path.name for path in seen.iterdir()) == [
        "calibration.json",
        "observations.csv",
        "stereo.yml",
    ]
    storage = cv2.FileStorage(str(seen / "stereo.yml"), cv2.FILE_STORAGE_READ)
    assert np.array_equal(storage.getNode("K2").mat(), RIG.right.K)
    assert np.array_equal(storage.getNode("T").mat().ravel(), RIG.right_from_left.t)
    storage.release()


# --- what is taken -------------------------------------------------------------------------------


def test_the_answer_arrives_as_it_was_written() -> None:
    triangulator = ExecTriangulator(answer(GOOD), 30.0)
    assert np.array_equal(triangulator(RIG, *PIXELS), POINTS)
    assert triangulator.notes == []
    assert triangulator.seconds > 0


@pytest.mark.parametrize(
    "text",
    [
        HEADER + "1,4,5,6\n0,1,2,3\n",
        HEADER + "0,1,2,3\n1,4.0,5e0,+6\n\n",
        "\ufeffid, x_m, y_m, z_m\r\n0, 1, 2, 3\r\n1, 4, 5, 6\r\n",
        '"id","x_m","y_m","z_m"\n"0",1,2,3\n"1",4,"5",6\n',
        HEADER + "0.000000000000000000e+00,1,2,3\n1.000000000000000000e+00,4,5,6\n",
    ],
)
def test_spellings_of_the_same_answer(text: str) -> None:
    assert parse_points(text.encode(), 2).tolist() == [[1, 2, 3], [4, 5, 6]]


@pytest.mark.parametrize("cell", ["nan", "NaN", "-nan", "-nan(ind)", "", " ", "inf", "-Infinity"])
def test_spellings_of_no_answer(cell: str) -> None:
    for row in (f"0,1,{cell},3", f"0,{cell},{cell},{cell}"):
        points = parse_points(f"{HEADER}{row}\n1,4,5,6\n".encode(), 2)
        assert np.isnan(points[0]).all()
        assert points[1].tolist() == [4, 5, 6]


def test_no_observations_need_no_rows() -> None:
    assert parse_points(HEADER.encode(), 0).shape == (0, 3)


@given(st.lists(st.tuples(*3 * [st.floats(allow_nan=False, allow_infinity=False)]), min_size=1))
def test_no_digit_is_lost_in_any_order(rows: list[tuple[float, ...]]) -> None:
    lines = [f"{i},{x!r},{y!r},{z!r}\n" for i, (x, y, z) in enumerate(rows)]
    text = HEADER + "".join(lines[1::2] + lines[::2])
    assert np.array_equal(parse_points(text.encode(), len(rows)), np.array(rows))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty: must hold id,x_m,y_m,z_m and a row for each of 2 ids"),
        (" \n", "is empty"),
        ("x,y,z\n1,2,3\n", "begins with 'x,y,z': its first line must be id,x_m,y_m,z_m"),
        ("0,1,2,3\n1,4,5,6\n", "begins with '0,1,2,3'"),
        ("id;x_m;y_m;z_m\n", "begins with 'id;x_m;y_m;z_m'"),
        ("id,y_m,x_m,z_m\n", "begins with"),
        ("\x00\x1b[31m", r"begins with '\?\?\[31m'"),
        ("id,x_mm,y_mm,z_mm\n0,1,2,3\n1,4,5,6\n", "is in mm, .*: must be in metres, .*; divide by 1000"),
        ("id,x_cm,y_cm,z_cm\n", "is in cm, .*; divide by 100"),
        (HEADER + "0,1,2,3\n1,4,5", r"stops within line 3, '1,4,5': every line must end in a newline"),
        (HEADER + "0,1,2,3\n1,4,5,6", r"stops within line 3, '1,4,5,6'"),
        ("id,x_m", "begins with 'id,x_m'"),
        (HEADER + "0,1,2,3\n1,4,5\n", r"line 3, '1,4,5': has 3 numbers, must have 4"),
        (HEADER + "0,1,2,3,4\n1,4,5,6\n", r"line 2, '0,1,2,3,4': has 5 numbers"),
        (HEADER + "0,1,2\n\n1,4,5,6,7\n", "line 2"),
        (HEADER + "\n0,1,two,3\n1,4,5,6\n", "line 3: y_m is 'two', must be a number, or nan where"),
        (HEADER + "0,1,1_000,3\n1,4,5,6\n", "line 2: y_m is '1_000', must be a number"),
        (HEADER + "a,1,2,3\n1,4,5,6\n", "line 2: id is 'a', must be a number"),
        (HEADER + "0,1,2,3\n,4,5,6\n", "line 3: id '' was not asked for"),
        (HEADER + "nan,1,2,3\n1,4,5,6\n", "line 2: id 'nan' was not asked for"),
        (HEADER + "1,1,2,3\n2,4,5,6\n", "line 3: id '2' was not asked for; those of .* are 0 to 1"),
        (HEADER + "-1,1,2,3\n", "line 2: id '-1' was not asked for"),
        (HEADER + "0.5,1,2,3\n", "line 2: id '0.5' was not asked for"),
        (HEADER + "0,1,2,3\n0,1,2,3\n1,4,5,6\n", "more than one row of id 0: must have one each"),
        (HEADER + "1,1,2,3\n", "has 1 rows: must be 2, nan where there is no answer; id 0 missing"),
        (HEADER, "has 0 rows: must be 2, .*; id 0, 1 missing"),
    ],
)
def test_what_is_no_answer_is_one_line(text: str, message: str) -> None:
    with pytest.raises(TriangulatorError, match=message) as caught:
        parse_points(text.encode(), 2)
    assert str(caught.value).isprintable()
    assert len(str(caught.value)) < 200


def test_what_is_missing_is_listed_shortly() -> None:
    with pytest.raises(TriangulatorError, match=r"has 2 rows: must be 100, .*; id 1, 3, 4, \.\.\. missing"):
        parse_points((HEADER + "0,1,2,3\n2,1,2,3\n").encode(), 100)


def test_a_half_file_is_told_from_a_whole_one_wherever_it_ends() -> None:
    content = GOOD.encode()
    for length in range(len(content)):
        with pytest.raises(TriangulatorError, match=r"points\.csv"):
            parse_points(content[:length], len(POINTS))


# --- programs that misbehave -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("sys.exit('no such lens')", "failed with exit code 1: no such lens"),
        ("print('only words'); sys.exit(7)", "failed with exit code 7: only words"),
        ("print('x', file=sys.stderr); print('y'); sys.exit(7)", "failed with exit code 7: x"),
        ("sys.exit(7)", "failed with exit code 7$"),
        ("os.kill(os.getpid(), 11)", r"failed with signal 11 \(SIGSEGV\)$"),
        ("raise ValueError('bad\\nluck')", "failed with exit code 1: luck"),
        ("pass", r"ended well, but left no points.csv in the folder"),
        ("pathlib.Path('points.csv').write_text(good)", "left no points.csv in the folder"),
        ("os.mkdir(folder / 'points.csv')", "left no points.csv"),
        ("os.mkfifo(folder / 'points.csv')", "left no points.csv"),
        ("import shutil; shutil.rmtree(folder)", "left no points.csv"),
        ("(folder / 'points.csv').write_text(good[:-9])", "stops within line 5"),
        ("(folder / 'points.csv').write_text('0' * 10**6)", "is larger than 6000 bytes: must hold 4 rows"),
        ("time.sleep(600)", "took longer than 0.5 s: ended; make it faster, or allow more with --timeout"),
    ],
)
def test_a_program_that_fails_is_one_line(body: str, message: str) -> None:
    command = program(body)
    triangulator = ExecTriangulator(command, 0.5 if "600" in body else 30.0)
    with pytest.raises(TriangulatorError, match=message) as caught:
        triangulator(RIG, *PIXELS)
    assert str(caught.value).startswith(f"program {command!r}: ")
    assert "\n" not in str(caught.value)
    assert math.isnan(triangulator.seconds) == (message.startswith("failed") or "longer" in message)


def test_a_program_that_hangs_is_ended_with_its_children(elsewhere: Path) -> None:
    body = (
        "import subprocess\n"
        "child = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(600)'])\n"
        "pathlib.Path('pids').write_text(f'{os.getpid()} {child.pid}')\n"
        "time.sleep(600)"
    )
    with pytest.raises(TriangulatorError, match="took longer than 2 s"):
        ExecTriangulator(program(body), 2.0)(RIG, *PIXELS)
    for pid in map(int, (elsewhere / "pids").read_text().split()):
        wait_for_end(pid)


def test_what_a_program_prints_goes_nowhere(capfd: pytest.CaptureFixture[str]) -> None:
    body = (
        "print('at work')\nprint('careful\\nnow', file=sys.stderr)\n(folder / 'points.csv').write_text(good)"
    )
    triangulator = ExecTriangulator(program(body), 30.0)
    assert np.array_equal(triangulator(RIG, *PIXELS), POINTS)
    assert triangulator.notes == ["on stderr, printed 'careful', 2 lines"]
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("", "must name a program"),
        ("'unfinished", "No closing quotation; quote it as for a shell"),
        ("nowhere-at-all --fast", "nowhere-at-all is not there; install it, or give its path, as ./nowhere"),
        ("./nowhere", r"\./nowhere is not there; check its path$"),
        ("./plain.txt", r"\./plain.txt is not executable; name its interpreter first"),
        ("./tmp", r"\./tmp is not executable"),
    ],
)
def test_a_command_that_cannot_run_is_refused_at_once(command: str, message: str) -> None:
    Path("plain.txt").write_text("words")
    with pytest.raises(TriangulatorError, match=message) as caught:
        ExecTriangulator(command, 30.0)
    assert "\n" not in str(caught.value)


def test_a_script_that_names_no_interpreter_is_one_line() -> None:
    Path("script").write_text("print('no shebang')")
    Path("script").chmod(0o755)
    with pytest.raises(TriangulatorError, match=r"cannot be started \(Exec format error\); name its interpr"):
        ExecTriangulator("./script", 30.0)(RIG, *PIXELS)


# --- keeping the folders ---------------------------------------------------------------------------


def test_folders_are_kept_when_asked_for_and_never_used_twice(elsewhere: Path) -> None:
    good = ExecTriangulator(answer(GOOD), 30.0, keep=Path("kept"))
    good(RIG, *PIXELS)
    assert good.folder == elsewhere / "kept" / "call-001"
    assert (good.folder / "points.csv").read_text() == GOOD
    idle = ExecTriangulator(program("pass"), 30.0, keep=Path("kept"))
    with pytest.raises(TriangulatorError, match=r"left no points.csv .* \(kept in .*/kept/call-002\)$"):
        idle(RIG, *PIXELS)
    assert sorted(path.name for path in (elsewhere / "kept").iterdir()) == ["call-001", "call-002"]


def test_a_folder_that_cannot_be_made_is_one_line(elsewhere: Path) -> None:
    (elsewhere / "file").write_text("")
    with pytest.raises(OutputError, match=r"file.*; choose another one"):
        ExecTriangulator(answer(GOOD), 30.0, keep=Path("file"))(RIG, *PIXELS)
