"""`rigsim verify` from the shell: verdicts, files, other people's functions, and what is refused."""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from rigsim.cli.app import run
from rigsim.study.verify import session
from tests.helpers.documents import valid
from tests.helpers.verify_results import quick

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "reference" / "verify.md").read_text(encoding="utf-8")
FEW = ["verify", "--scene", "none"]

MODULE = """
import time

from rigsim.theory.triangulation import METHODS


def good(rig, uv_left, uv_right):
    return METHODS["optimal"](rig, uv_left, uv_right)


def millimetres(rig, uv_left, uv_right):
    return 1000 * good(rig, uv_left, uv_right)


def prints(rig, uv_left, uv_right):
    print("so far so good")
    return good(rig, uv_left, uv_right)


def hangs(rig, uv_left, uv_right):
    time.sleep(60 if len(uv_left) == 1 else 0)
    return good(rig, uv_left, uv_right)


def two_columns(rig, uv_left, uv_right):
    return uv_left
"""


@pytest.fixture(autouse=True)
def beside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of the user's own, with a module in it."""
    (tmp_path / "mine.py").write_text(MODULE, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    return tmp_path


def document(capsys: pytest.CaptureFixture[str], *words: str, code: int = 0) -> dict[str, Any]:
    assert run([*FEW, "--json", *words]) == code
    return valid("verify", capsys.readouterr().out)


def test_the_default_passes(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(FEW) == 0
    said = capsys.readouterr().out
    assert said.startswith("optimal: all 78 cases passed.")
    assert len(said.splitlines()) <= 40
    assert max(map(len, said.splitlines())) <= 100


def test_every_known_triangulator_passes(capsys: pytest.CaptureFixture[str]) -> None:
    said = document(capsys, "--triangulator", "optimal,dlt,midpoint", "--triangulator", "cv2,rectified")
    found = {one["triangulator"]: one for one in said["triangulators"]}
    assert list(found) == ["optimal", "dlt", "midpoint", "cv2", "rectified"]
    assert all(one["passed"] for one in found.values())
    assert found["optimal"]["counts"]["passed"] == 78
    assert found["midpoint"]["counts"]["inefficient"] >= 1
    assert found["rectified"]["counts"]["not_applicable"] > 20
    # the worst of the midpoint is the one rig with very different lenses
    assert run([*FEW, "--triangulator", "midpoint", "--strict", "--cases", "unequal"]) == 3
    assert "unequal noisy" in capsys.readouterr().out


def test_a_function_of_ones_own(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--triangulator", "mine:good", "--triangulator", "mine:millimetres", "--cases", "rectified"]
    assert run([*FEW, *words]) == 3
    said = capsys.readouterr().out
    assert "mine:good: all 2 cases passed." in said
    assert "mine:millimetres: 2 of 2 cases failed." in said
    assert "Again: rigsim verify --scene none --triangulator mine:millimetres --cases" in said
    assert "1 of 2 triangulators passed." in said
    assert "mine" not in sys.modules


def test_how_to_run_it_again_runs_it_again(capsys: pytest.CaptureFixture[str]) -> None:
    words = [
        "--triangulator",
        "mine:millimetres",
        "--seed",
        "7",
        "--cases",
        "near,nowhere",
        "--timeout",
        "9s",
    ]
    assert run([*FEW, *words]) == 3
    (again,) = re.findall(r"^Again: rigsim (.*)$", capsys.readouterr().out, re.MULTILINE)
    assert again == (
        "verify --scene none --seed 7 --timeout 9s --triangulator mine:millimetres "
        "--cases 'near exact,near noisy'"
    )


def test_what_a_function_does_wrong_stays_in_its_case(capsys: pytest.CaptureFixture[str]) -> None:
    words = [
        "--triangulator",
        "mine:hangs,mine:two_columns,mine:prints",
        "--cases",
        "rows",
        "--timeout",
        "1s",
    ]
    said = document(capsys, *words, code=3)
    hangs, shape, prints = ({case["case"]: case for case in one["cases"]} for one in said["triangulators"])
    assert "took longer than 1 s" in hangs["one pixel pair"]["error"]
    assert hangs["missing pixels"]["status"] == hangs["no pixels"]["status"] == "passed"
    assert "returned shape (1, 2): must be (1, 3)" in shape["one pixel pair"]["error"]
    assert prints["missing pixels"]["status"] == "passed"
    assert prints["missing pixels"]["notes"] == ["printed 'so far so good'"]


def test_a_function_runs_in_this_process_where_that_is_asked_for(
    beside: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (beside / "whereabouts.py").write_text(
        "import os\n\n\ndef told(rig, uv_left, uv_right):\n    raise ValueError(f'in {os.getpid()}')\n",
        encoding="utf-8",
    )
    words = [*FEW, "--cases", "rows", "--triangulator", "whereabouts:told"]
    pids = []
    for more in ([], ["--in-process"]):
        assert run([*words, *more]) == 3
        said = capsys.readouterr().out
        pids.append(set(map(int, re.findall(r"ValueError: in\s+(\d+)", said))))
        (again,) = re.findall(r"^Again: (.*) --triangulator", said, re.MULTILINE)
        assert again == " ".join(["rigsim verify --scene none", *more])
    apart, here = pids
    assert apart
    assert os.getpid() not in apart
    assert here == {os.getpid()}


def test_a_program(beside: Path, capsys: pytest.CaptureFixture[str]) -> None:
    script = beside / "nothing.py"
    script.write_text("print('no idea')\n", encoding="utf-8")
    command = f"{sys.executable} {script}"
    said = document(capsys, "--exec", command, "--cases", "one pixel pair", code=3)
    (one,) = said["triangulators"]
    assert one["triangulator"] == command
    assert "points.csv" in one["cases"][0]["error"]


def test_the_files(beside: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = [
        "--triangulator",
        "mine:millimetres",
        "--cases",
        "verged,rows",
        "--out",
        "out",
        "--junit",
        "j.xml",
    ]
    assert run([*FEW, *words]) == 3
    assert "Report: out/verify.html" in capsys.readouterr().out
    assert {path.name for path in (beside / "out").iterdir()} == {"verify.html", "verify.json", "junit.xml"}
    said = valid("verify", (beside / "out" / "verify.json").read_text(encoding="utf-8"))
    (one,) = said["triangulators"]
    assert not said["passed"]
    suite = ElementTree.parse(beside / "j.xml").getroot()[0]
    assert suite.get("failures") == str(one["counts"]["failed"])
    assert (beside / "out" / "junit.xml").read_text() == (beside / "j.xml").read_text()
    page = (beside / "out" / "verify.html").read_text(encoding="utf-8")
    assert "verged exact" in page
    # once more into the same folder is refused before anything runs, and --force replaces
    assert run([*FEW, *words]) == 1
    assert run([*FEW, *words, "--force"]) == 3


def test_nothing_is_written_unasked(beside: Path) -> None:
    assert run([*FEW, "--cases", "near"]) == 0
    assert [path.name for path in beside.iterdir() if path.name != "__pycache__"] == ["mine.py"]


def test_json_by_hand(capsys: pytest.CaptureFixture[str]) -> None:
    said = document(capsys, "--triangulator", "mine:millimetres", "--cases", "verged exact", code=3)
    (case,) = said["triangulators"][0]["cases"]
    worst = case["worst_rows"][0]
    assert worst["found_m"] == pytest.approx([1000 * x for x in worst["expected_m"]])
    distance = sum(x**2 for x in worst["expected_m"]) ** 0.5
    assert worst["distance_m"] == pytest.approx(999 * distance)
    (exact,) = [check for check in case["checks"] if check["check"] == "exact"]
    assert not exact["ok"]
    assert exact["unit"] == "m"
    assert exact["value"] > 999 * 0.5
    assert exact["high"] < 1e-8
    assert case["depth_rms_mm"] > 999 * 500
    assert case["predicted_depth_rms_mm"] == 0
    assert case["efficiency"] is None
    assert said["provenance"]["command"].startswith("rigsim")


def test_the_page_says_what_every_key_means(capsys: pytest.CaptureFixture[str]) -> None:
    said = document(capsys, "--triangulator", "mine:millimetres", "--cases", "verged", code=3)
    keys: set[str] = set()

    def collect(value: object) -> None:
        if isinstance(value, dict):
            keys.update(value)
            for name, item in value.items():
                if name != "provenance":
                    collect(item)
        elif isinstance(value, list):
            for item in value:
                collect(item)

    collect(said)
    section = PAGE[PAGE.index("## JSON") :]
    assert {key for key in keys if f"`{key}`" not in section} == set()


@pytest.mark.parametrize("place", [0, 1], ids=["as it is first", "mended once"])
def test_the_pages_function_fails_as_shown(
    place: int, beside: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(session, "gather", lambda *_: quick())
    (source,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    wrong, right = "(right, left, uv_left.T", "(left, right, uv_left.T"
    assert source.count(wrong) == 1
    text = (source, source.replace(wrong, right))[place]
    both_shown = re.findall(r"```console\n\$ rigsim [^\n]*\n(.*?)```", PAGE, re.DOTALL)
    assert len(both_shown) == 2
    shown = both_shown[place]
    (beside / "my_stereo.py").write_text(text, encoding="utf-8")
    assert run(["verify", "--triangulator", "my_stereo:triangulate"]) == 3
    said = capsys.readouterr().out
    # shares and runners-up may change as more mistakes become known; the table and the first may not
    for part in (said, shown):
        assert part.count("\nDiagnosis: ") >= 1
    assert said.partition("\nDiagnosis: ")[0] == shown.partition("\nDiagnosis: ")[0]
    named = [part.split("\nDiagnosis: ")[1].split(":")[0] for part in (said, shown)]
    assert named[0] == named[1]


def test_a_rig_of_ones_own(beside: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rig = beside / "rig.toml"
    rig.write_text("baseline_mm = 100\nwidth_px = 640\nheight_px = 480\nfocal_px = 500\n", encoding="utf-8")
    assert run([*FEW, "--rig", str(rig), "--cases", "your rig"]) == 0
    assert "your rig" in capsys.readouterr().out
    assert run(["verify", "--rig", str(rig), "--scene", "bin", "--cases", "bin"]) == 0
    assert "optimal: all 2 cases passed." in capsys.readouterr().out


def test_the_list(capsys: pytest.CaptureFixture[str]) -> None:
    assert run([*FEW, "--list"]) == 0
    said = capsys.readouterr().out
    assert said.startswith("78 cases")
    assert "random*" in said


def test_the_same_seed_says_the_same(capsys: pytest.CaptureFixture[str]) -> None:
    first, second, other = (
        document(capsys, "--cases", "verged noisy", "--seed", seed)["triangulators"][0]["cases"][0]
        for seed in ("3", "3", "4")
    )
    assert first["efficiency"] == second["efficiency"] != other["efficiency"]


@pytest.mark.parametrize(
    ("words", "message", "code"),
    [
        (["--suite", "slow"], "suite 'slow': choose one of quick, full", 2),
        (["--cases", "vergd"], "cases 'vergd': matches none; the groups are rectified, doffs", 2),
        (["--cases", "near,"], "cases: empty; name one, or several with commas", 2),
        (["--triangulator", "best"], "unknown triangulator 'best': choose one of", 1),
        (["--triangulator", "nowhere_to_be_seen:f"], "cannot import nowhere_to_be_seen", 1),
        (["--triangulator", "mine:nothing"], "has no attribute 'nothing'", 1),
        (["--triangulator", "dlt,dlt"], "triangulator 'dlt': given twice; remove one", 2),
        (["--exec", "no-such-program"], "program 'no-such-program'", 1),
        (["--seed", "-1"], "seed -1: must be >= 0", 2),
        (["--timeout", "0"], "timeout 0 s: must be > 0", 2),
        (["--list", "--json"], "list: prints no JSON; leave out --json", 2),
        (["--timeout", "soon"], "timeout soon: must be a number", 2),
        (["--scene", "boards"], "scene none: given with others; remove one or the other", 2),
        (["--rig", "no.toml"], "no.toml: cannot be read", 1),
        (["--junit", "no/j.xml"], "junit no/j.xml: its folder does not exist", 1),
        (["--out", "mine.py"], "output folder mine.py: is a file", 1),
    ],
)
def test_slips_are_one_line_and_leave_nothing(
    words: list[str], message: str, code: int, beside: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run([*FEW, *words]) == code
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("rigsim: error: ")
    assert said.err.count("\n") == 1
    assert message in said.err
    assert [path.name for path in beside.iterdir() if path.name != "__pycache__"] == ["mine.py"]


def test_unknown_scenes_and_scenes_without_the_case(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["verify", "--scene", "attic"]) == 1
    assert "unknown scene 'attic'" in capsys.readouterr().err
    assert run(["verify", "--scene", "bin", "--cases", "bin corners"]) == 2
    assert "no case could be made; cases 'bin corners'" in capsys.readouterr().err
