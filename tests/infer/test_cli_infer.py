"""`rigsim infer` as a user types it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import rigsim
from rigsim.cli.app import run
from rigsim.interop.formats.rig_toml import write_rig
from rigsim.rig.presets import preset

W7 = "--focal 500 --baseline 0.1m --resolution 1000x800"
WALL = "distance_mm,depth_std_mm,depth_bias_mm,n\n1000,3.1,1,400\n2000,12.4,9,400\n3000,26.9,24,400\n"


@pytest.fixture
def infer(capsys: pytest.CaptureFixture[str]) -> Any:
    """Run ``infer ... --json`` and return what it says."""

    def answer(words: str) -> dict[str, Any]:
        capsys.readouterr()
        assert run(["infer", *words.split(), "--json"]) == 0
        return dict(json.loads(capsys.readouterr().out))

    return answer


def test_w7_backwards(infer: Any) -> None:
    # changh95, visual-slam-roadmap: 0.02, 0.5 and 2 m at 2, 10 and 20 m come of 0.25 px of disparity
    answer = infer(f"--claim 0.02m@2m,0.5m@10m,2m@20m {W7}")
    assert answer["disparity_std_px"] == pytest.approx(0.25, rel=1e-9)
    assert answer["noise_px"] == pytest.approx(0.25 / 2**0.5, rel=1e-9)
    assert answer["verdict"] == "consistent"
    # the same claims in percent
    assert infer(f"--claim 1%@2m,5%@10m,10%@20m {W7}")["disparity_std_px"] == pytest.approx(0.25, rel=1e-9)


def test_w8_backwards(infer: Any) -> None:
    # g-rousseau, pinhole-stereo-error: [8.10, 13.06] m at 10 m come of +-1.5 px
    answer = infer("--claim 8.10:13.06m@10m --hfov 90 --resolution 1280x720 --baseline 0.1m")
    assert answer["disparity_std_px"] == pytest.approx(1.5, abs=2e-3)


def test_the_claim_of_a_data_sheet_by_hand(infer: Any) -> None:
    # OAK-D: f B = 882.5 px x 75 mm = 66.1875 px m; 2 % of 4 m is 80 mm: 0.08 x 66.1875 / 16
    answer = infer("--claim 2%@4m,4%@7m,6%@10.5m --preset oak-d")
    assert answer["rows"][0]["disparity_std_px"] == pytest.approx(0.3309375, rel=1e-9)
    assert answer["disparity_std_ci_low_px"] < 0.3309375 < answer["disparity_std_ci_high_px"]
    assert answer["fit"]["best"] == "quadratic"
    assert answer["transfer"] is answer["bias"] is None


def test_p95_is_1_96_standard_deviations(infer: Any) -> None:
    one = infer(f"--claim 1%@2m {W7}")["disparity_std_px"]
    assert infer(f"--claim 1%@2m --p95 {W7}")["disparity_std_px"] == pytest.approx(one / 1.959964, rel=1e-6)


@pytest.mark.parametrize("claim", ["1%@4m", "1%@4m,2%@7m"])
def test_few_claims_give_a_value_alone(infer: Any, claim: str) -> None:
    answer = infer(f"--claim {claim} --preset oak-d")
    assert answer["disparity_std_px"] > 0
    assert answer["fit"] is answer["disparity_std_ci_low_px"] is None
    assert (answer["verdict"], answer["interval_from"]) == ("untested", "none")


def test_one_wall_test_is_answered_first_and_has_no_interval_to_show(
    capsys: pytest.CaptureFixture[str],
) -> None:
    # by hand: 4 mm at 1 m are 4 x 60 / 1000 = 0.24 px, 0.17 a coordinate; 16 times at 4 m
    words = "infer --measured 4mm@1m --baseline 75 --focal 800 --resolution 1280x800 --at 4m"
    assert run(words.split()) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert printed.startswith(
        "A disparity noise of 0.240 px, 0.170 px per pixel coordinate, would explain it."
    )
    assert "distance depth std note" in printed
    assert "4.00 m 64.0 mm" in printed


@pytest.mark.parametrize(
    ("claim", "law"), [("1%@1m,1%@2m,1%@4m", "linear"), ("5mm@1m,5mm@2m,5mm@4m", "constant")]
)
def test_what_cannot_be_stereo_noise_is_said(infer: Any, claim: str, law: str) -> None:
    answer = infer(f"--claim {claim} --preset oak-d")
    assert answer["verdict"] == "inconsistent"
    assert answer["fit"]["best"] == law
    assert answer["says"].startswith(f"This cannot be stereo noise: a {law} law fits better")


def test_a_wall_test_and_another_rig(infer: Any, tmp_path: Path) -> None:
    wall, rig = tmp_path / "wall.csv", tmp_path / "other.toml"
    wall.write_text(WALL)
    rig.write_text(write_rig(preset("oak-d").rig))
    answer = infer(f"--data {wall} --preset D455 --to {rig} --at 1m,2m")
    assert answer["interval_from"] == "samples"
    # relative squares in 1e-6: bias 1 + 20.25 + 64, noise 9.61 + 38.44 + 80.40
    assert answer["bias"]["share_of_mean_square_pct"] == pytest.approx(100 * 85.25 / 213.70, abs=0.01)
    carried = answer["transfer"]
    assert carried["rig"]["baseline_mm"] == pytest.approx(75)
    assert [row["distance_mm"] for row in carried["rows"]] == [1000, 2000]
    far = carried["rows"][1]
    assert far["depth_std_mm"] == pytest.approx(answer["disparity_std_px"] * 4 / 66.1875 * 1e3, rel=1e-9)
    assert far["depth_std_ci_low_mm"] < far["depth_std_mm"] < far["depth_std_ci_high_mm"]
    assert far["trusted"]
    # a preset says the same as its file, and the distances are the test's own by default
    again = infer(f"--data {wall} --preset D455 --to OAK-D")["transfer"]
    assert again["rows"][1] == far
    assert len(again["rows"]) == 3


def test_the_same_rig_at_another_distance(infer: Any, capsys: pytest.CaptureFixture[str]) -> None:
    words = "6mm@1m,25mm@2m,110mm@4m --preset oak-d --at 6m"
    answer = infer(f"--claim {words}")
    # 6, 25/4 and 110/16 mm per m^2 of distance by f B = 66.1875 px m
    implied = [66.1875e-3 * 6, 66.1875e-3 * 25 / 4, 66.1875e-3 * 110 / 16]
    assert min(implied) < answer["disparity_std_px"] < max(implied)
    (row,) = answer["transfer"]["rows"]
    assert row["depth_std_mm"] == pytest.approx(answer["disparity_std_px"] * 36 / 66.1875 * 1e3)
    assert answer["transfer"]["rig"] == answer["rig"]
    assert infer(f"--claim {words} --to oak-d")["transfer"] == answer["transfer"]
    assert infer(f"--measured {words}") == answer
    assert run(["infer", "--measured", *words.split()]) == 0
    shown = capsys.readouterr().out
    assert "Same noise, same rig: baseline 75.0 mm" in shown
    assert "other rig" not in shown
    assert run(["infer", "--help"]) == 0
    assert "--measured" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("head", "per_mm"),
    [("distance_m", 1e-3), ("z_m", 1e-3), ("z_mm", 1), ("distance", 1), ("Distance_cm", 0.1), ("Z", 1)],
)
def test_a_distance_by_other_names_and_units(infer: Any, tmp_path: Path, head: str, per_mm: float) -> None:
    wall, other = tmp_path / "wall.csv", tmp_path / "other.csv"
    wall.write_text(WALL)
    lines = [line.split(",", 1) for line in WALL.splitlines()[1:]]
    rows = "".join(f"{float(z) * per_mm:.10g},{rest}\n" for z, rest in lines)
    other.write_text(f"{head},{WALL.splitlines()[0].split(',', 1)[1]}\n{rows}")
    expected, found = (infer(f"--data {path} --preset d455") for path in (wall, other))
    assert found["disparity_std_px"] == pytest.approx(expected["disparity_std_px"])
    assert [row["distance_mm"] for row in found["rows"]] == pytest.approx([1000, 2000, 3000])


def test_every_key_is_in_the_schema(infer: Any, tmp_path: Path) -> None:
    wall = tmp_path / "wall.csv"
    wall.write_text(WALL)
    schema = (Path(__file__).resolve().parents[2] / "docs" / "reference" / "infer.md").read_text()
    answer = infer(f"--data {wall} --preset d455 --to oak-d")
    for item in (answer, answer["fit"], answer["bias"], answer["rig"], answer["rows"][0], answer["transfer"]):
        for key in item:
            assert f"`{key}`" in schema, key
    for key in answer["transfer"]["rows"][0]:
        assert f"`{key}`" in schema, key


@pytest.mark.parametrize(
    "words",
    [
        "--claim 2%@4m --preset oak-d",
        "--claim 1%@1m,1%@2m,1%@4m --preset oak-d --to d455 --at 1m",
        "--data wall.csv --preset d455 --to oak-d --at 1m,2m,200m",
    ],
)
def test_a_folder_holds_the_document_and_a_picture(
    infer: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("wall.csv").write_text(WALL)
    answer = infer(f"{words} --out found")
    assert {path.name for path in Path("found").iterdir()} == {"infer.json", "infer.png"}
    assert json.loads(Path("found/infer.json").read_text(encoding="utf-8")) == answer
    assert Path("found/infer.png").read_bytes().startswith(b"\x89PNG")
    # what is there stays, unless said otherwise
    assert run(["infer", *words.split(), "--out", "found"]) == 1
    assert run(["infer", *words.split(), "--out", "found", "--force"]) == 0


def test_a_fault_writes_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "found"
    words = ["--claim", "1%@4m", "--preset", "oak-d", "--to", "kinect", "--out", str(out)]
    assert run(["infer", *words]) == 1
    assert not out.exists()
    assert capsys.readouterr().err.count("\n") == 1


def test_people_get_tables_that_fit(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    wall = tmp_path / "wall.csv"
    wall.write_text(WALL)
    assert run(["infer", "--data", str(wall), "--preset", "d455", "--to", "oak-d", "--at", "1m,200m"]) == 0
    shown = capsys.readouterr().out
    assert all(len(line) <= 80 for line in shown.splitlines())
    assert shown.startswith("Stereo noise can explain it: the error grows as distance to the power 1.958")
    for words in ("disparity std", "disparity offset", "bias share", "disparity under 4 sigma"):
        assert words in shown


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("--baseline 75 --focal 882", "give either --claim or --data"),
        ("--preset zed-2i", "zed-2i: no accuracy is published of it: give depth errors or data"),
        ("--preset bin", "bin: no accuracy is published of it"),
        ("--claim 1%@4m --data a.csv --preset oak-d", "give either --claim or --data"),
        ("--claim 1%@4m", "--baseline is missing"),
        ("--claim 1@4m --preset oak-d", "claim 1@4m: depth error 1 has no unit; write %, mm, cm or m"),
        ("--claim 1%@4 --preset oak-d", "claim 1%@4: distance 4 has no unit; write mm, cm or m"),
        ("--claim 8:13@10m --preset oak-d", "claim 8:13@10m: depth 13 has no unit"),
        ("--claim 101%@4m --preset oak-d", "percent of the distance must be > 0 and <= 100"),
        ("--claim=-1%@4m --preset oak-d", "percent of the distance must be > 0 and <= 100"),
        ("--claim x%@4m --preset oak-d", "percent of the distance must be > 0 and <= 100"),
        ("--claim=-1mm@4m --preset oak-d", "depth error -1 mm: must be > 0"),
        ("--claim 1%@-4m --preset oak-d", "distance -4000 mm: must be > 0"),
        ("--claim 1% --preset oak-d", "claim 1%: write error@distance, as in 1%@4m"),
        ("--claim 1%@4m,2%@4m --preset oak-d", "4m is given twice"),
        ("--claim 11:13m@10m --preset oak-d", "10m must lie between the two bounds"),
        ("--claim 1%@0m --preset oak-d", "distance 0 mm: must be > 0"),
        ("--claim 0%@4m --preset oak-d", "percent of the distance must be > 0 and <= 100"),
        ("--claim 1%@4m --to oak-d --at 0m --preset oak-d", "depth 0 mm: must be > 0"),
        ("--claim 1%@4m --to oak-d --at 1parsec --preset oak-d", "unknown unit 'parsec'"),
        ("--claim 1%@4m --to kinect --preset oak-d", "unknown preset 'kinect': choose one of boards"),
        ("--claim 1%@4m --to no.toml --preset oak-d", "no.toml: cannot be read"),
        ("--data no.csv --p95 --preset oak-d", "--p95 is about --claim"),
        ("--data no.csv --preset oak-d", "no.csv: cannot be read"),
    ],
)
def test_bad_words_are_one_line(capsys: pytest.CaptureFixture[str], words: str, says: str) -> None:
    assert run(["infer", *words.split()]) in (1, 2)
    captured = capsys.readouterr()
    assert captured.out == ""
    assert len(captured.err.splitlines()) == 1
    assert says in captured.err


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "column distance_mm is missing (found nothing)"),
        ("distance_mm,std\n1,2\n", "column depth_std_mm is missing (found distance_mm, std)"),
        ("distance_mm,depth_std_mm\n1000,3\n2000,12\n", "2 distance(s), must be >= 3"),
        ("distance_mm,depth_std_mm\n1000,3\n2000,\n3000,9\n", "line 3: depth_std_mm empty: must be a number"),
        (
            "distance_mm,depth_std_mm\n1000,3\n\n2000\n3000,9\n",
            "line 4: depth_std_mm empty: must be a number",
        ),
        ("distance_mm,depth_std_mm\n1000,-3\n", "line 2: depth_std_mm -3: must be > 0"),
        ("distance_mm,depth_std_mm\nnan,3\n", "line 2: distance_mm nan: must be a number"),
        ("Distance_m,depth_std_mm\n0,3\n", "line 2: Distance_m 0: must be > 0"),
        ("distance,depth_std_mm\n1.5,3\n", "line 2: distance 1.5: metres or millimetres? Call the column"),
        ("z_m,distance_mm,depth_std_mm\n1,1000,3\n", "columns z_m and distance_mm say the same; leave one"),
        ("distance_mm,depth_std_mm,n\n1000,3,1\n", "line 2: n 1: must be a whole number >= 2"),
        ("distance_mm,depth_std_mm,depth_bias_mm\n1,3,x\n", "line 2: depth_bias_mm x: must be a number"),
    ],
)
def test_bad_files_are_one_line(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, text: str, says: str
) -> None:
    wall = tmp_path / "wall.csv"
    wall.write_text(text)
    assert run(["infer", "--data", str(wall), "--preset", "oak-d"]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert len(captured.err.splitlines()) == 1
    assert says in captured.err


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        # 5 m of 10 m is 2 sigma
        (
            "--claim 50%@10m --preset oak-d",
            "far_too_noisy",
            "under 4 of its own standard deviations at 10000 mm (2",
        ),
        # f B 66.1875 px m: 132.375 - 6.61875 = 125.756 px nearer, 6.61875 - 4.4125 = 2.20625 px farther
        (
            "--claim 0.5:15m@10m --preset oak-d",
            "uneven_bounds",
            "126 px of disparity away and the far one 2.21 px",
        ),
        ("--claim 1m@20mm --preset oak-d", "unit", "check the distances, the errors and the rig"),
        ("--data metres.csv --preset d455", "unit", "are these metres? Columns are in mm; times 1000"),
        ("--data mixed.csv --preset d455", "unit", "is the standard deviation in metres"),
    ],
)
def test_odd_input_gets_a_remark_and_an_answer(
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    words: str,
    code: str,
    says: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("metres.csv").write_text("distance_mm,depth_std_mm\n1,0.003\n2,0.0125\n4,0.049\n")
    Path("mixed.csv").write_text("distance_mm,depth_std_mm\n1000,0.003\n2000,0.0125\n4000,0.049\n")
    assert run(["infer", *words.split(), "--json"]) == 0
    shown = capsys.readouterr()
    told = [remark for remark in json.loads(shown.out)["remarks"] if remark["code"] == code]
    assert len(told) == 1
    assert says in told[0]["text"]
    assert f"rigsim: note: {told[0]['text']}" in shown.err


def test_usual_input_gets_no_remark(infer: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    wall = tmp_path / "wall.csv"
    wall.write_text(WALL)
    assert infer(f"--data {wall} --preset d455")["remarks"] == []
    assert infer("--claim 8.1:13.1m@10m --preset oak-d")["remarks"] == []
    assert capsys.readouterr().err == ""


def test_a_bias_that_cannot_be_is_one_line(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    wall = tmp_path / "wall.csv"
    wall.write_text(WALL.replace("1000,3.1,1,", "1000,3.1,-1000,"))
    assert run(["infer", "--data", str(wall), "--preset", "oak-d"]) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err == (
        "rigsim: error: distance 1000 mm with a bias of -1000 mm: the mean measured depth must be > 0;"
        " a bias is measured minus true, in mm\n"
    )


def test_a_shift_of_all_disparities_is_told_as_it_is(infer: Any, tmp_path: Path) -> None:
    # D435, f B 424 px x 50 mm = 21.2 px m, all disparities .7 px too small: 21.2 / (21.2/Z - .7), by hand
    wall = tmp_path / "wall.csv"
    rows = ["distance_mm,depth_std_mm,depth_bias_mm,n"]
    for z_mm, measured_mm in ((500, 508.3933), (1000, 1034.1463), (2000, 2141.4141), (4000, 4608.6957)):
        rows.append(f"{z_mm},{0.01 * measured_mm**2 / 21200},{measured_mm - z_mm},400")
    wall.write_text("\n".join(rows))
    answer = infer(f"--data {wall} --focal 424 --baseline 50mm --resolution 848x480")["bias"]
    assert answer["disparity_offset_px"] == pytest.approx(-0.7, abs=1e-3)
    assert answer["scale_pct"] == pytest.approx(0.0, abs=0.01)
    assert answer["disparity_offset_ci_low_px"] < -0.7 < answer["disparity_offset_ci_high_px"]


def test_files_from_spreadsheets_are_read(infer: Any, tmp_path: Path) -> None:
    plain, spread = tmp_path / "plain.csv", tmp_path / "spread.csv"
    plain.write_text("distance_mm,depth_std_mm\n1000,3\n2000,12\n3000,27\n")
    spread.write_bytes(
        b"\xef\xbb\xbfnote, depth_std_mm ,distance_mm\r\na,3,1000\r\n,,\r\nb,12,2000\r\nc,27,3000\r\n"
    )
    assert infer(f"--data {spread} --preset oak-d") == infer(f"--data {plain} --preset oak-d")


def test_a_preset_has_its_makers_own_claims(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["infer", "--preset", "oak-d", "--json"]) == 0
    own = json.loads(capsys.readouterr().out)
    # what Luxonis publishes of the OAK-D: 2 % at 4 m, 4 % at 7 m, 6 % at 10.5 m
    assert [row["distance_mm"] for row in own["rows"]] == [4000, 7000, 10500]
    assert [row["depth_std_mm"] for row in own["rows"]] == pytest.approx([80, 280, 630])
    assert run(["infer", "--preset", "oak-d", "--claim", "2%@4m,4%@7m,6%@10.5m", "--json"]) == 0
    typed = json.loads(capsys.readouterr().out)
    (remark,) = own.pop("remarks")
    assert remark["code"] == "published"
    assert typed.pop("remarks") == []
    assert own == typed
    assert rigsim.infer("oak-d").document()["noise_px"] == pytest.approx(own["noise_px"])


def test_a_mode_that_the_camera_does_not_have_is_questioned(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["infer", "--preset", "oak-d", "--resolution", "640x400", "--claim", "1%@4m", "--json"]
    assert run(words) == 0
    said = capsys.readouterr()
    (remark,) = json.loads(said.out)["remarks"]
    assert remark["code"] == "mode"
    assert "640x400 px instead of 1280x800, as published: does the camera have such a mode?" in remark["text"]
    assert said.err.count("rigsim: note:") == 1
    # what is published in another mode is one: zed-mini's HD2K
    assert run(["infer", "--preset", "zed-mini", "--resolution", "2208x1242", "--claim", "1%@2m"]) == 0
    assert "instead of" not in capsys.readouterr().err
    assert run(["infer", "--preset", "d455", "--baseline", "50", "--hfov", "60", "--claim", "1%@2m"]) == 0
    assert "60 deg wide instead of 87, 50 mm of baseline instead of 95" in capsys.readouterr().err


def test_a_claim_on_a_users_word_is_said_to_be_one() -> None:
    found = rigsim.infer("d435")
    assert "2%@2m by an unconfirmed user report alone" in found.remarks[0].text
