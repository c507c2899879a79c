"""`rigsim calc points`, `rigsim.triangulate_points`: pixels to points, against hand, OpenCV and chance."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pandas as pd
import pytest

import rigsim
from rigsim.cli.app import run
from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array
from rigsim.study.calc.points import FALSE_ALARM, FEWEST, pair_points
from rigsim.theory.epipolar import pair_gap
from tests.helpers.documents import valid
from tests.helpers.processes import modules_after

PLAIN = rigsim.make_rig(baseline_mm=120, focal_px=900, resolution_px=(1280, 720))
LENSES = (
    rigsim.Intrinsics(
        1280, 720, 900.0, 905.0, 645.0, 352.0, rigsim.BrownConrady(-0.15, 0.05, 1e-3, -5e-4, 0.01)
    ),
    rigsim.Intrinsics(
        1280, 720, 880.0, 884.0, 630.0, 365.0, rigsim.BrownConrady(-0.12, 0.03, -8e-4, 6e-4, 0.0)
    ),
)
TOED = rigsim.make_rig(
    rigsim.StereoRig(*LENSES, rigsim.Pose(t=[-0.15, 0.0, 0.0])),
    yaw_deg=-8,
    pitch_deg=1,
    roll_deg=2,
    vertical_mm=4,
)
HEAD = "u_left,v_left,u_right,v_right\n"


def seen(rig: rigsim.StereoRig, count: int, seed: int) -> tuple[Array, Array]:
    """Points (N, 3) m that both cameras see, and their pixels (N, 4)."""
    rng = np.random.default_rng(seed)
    points = np.column_stack(
        [rng.uniform(-0.35, 0.35, count), rng.uniform(-0.25, 0.25, count), np.ones(count)]
    )
    points *= rng.uniform(1.2, 3.0, count)[:, None]
    return points, np.hstack(rig.project(points))


def printed(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    assert run(["calc", "points", *words]) == 0
    return capsys.readouterr().out


def test_by_hand() -> None:
    # Z = 900 x .12 / 54 = 2 m; x = (700 - 639.5) / 900 x 2 = 134.444 mm; y: rows 400 and 403, their mean
    pairs = [[700, 400, 646, 400], [700, 400, 646, 403], [646, 400, 700, 400], [700, 400, 699.9, 400.0]]
    found = rigsim.triangulate_points(PLAIN, pairs)
    table = found.table
    assert table.x_mm[0] == pytest.approx(134.4444444)
    assert table.y_mm[:2].tolist() == pytest.approx([(400 - 359.5) / 0.45, (401.5 - 359.5) / 0.45])
    assert table.z_mm[:2].tolist() == pytest.approx([2000, 2000])
    # Z^2 sqrt(2) sigma / (f B); y follows both rows' mean and the depth
    std_z = 2000**2 * 0.25 * 2**0.5 / (900 * 120)
    assert table.std_z_mm[0] == pytest.approx(std_z)
    assert table.std_y_mm[0] == pytest.approx(np.hypot(2000 / 900 * 0.25 / 2**0.5, 40.5 / 900 * std_z))
    assert table.off_px.tolist() == pytest.approx([0, 3 / 2**0.5, 0, 0], abs=1e-9)
    assert table.consistent.tolist() == [True, False, False, True]
    assert table.why.tolist() == ["", "", "behind", ""]
    assert np.isnan(table.z_mm[2])
    # 3.2905 x .25 px = .8226 px is the most that is right: 1.1634 px between the rows
    rows = [[700, 400, 646, 400 + 1.163], [700, 400, 646, 400 - 1.164]]
    assert rigsim.triangulate_points(PLAIN, rows).table.consistent.tolist() == [True, False]
    # parallel within the noise, 3.29 x .354 px, is no mistake
    far = rigsim.triangulate_points(
        PLAIN, [[700, 400, 701.16, 400], [700, 400, 701.17, 400], [700, 400, 700, 400]]
    )
    assert far.table.why.tolist() == ["infinity", "behind", "infinity"]
    assert far.table.consistent.tolist() == [True, False, True]


def test_a_toed_in_distorted_rig_against_opencv() -> None:
    points, uv = seen(TOED, 300, 1)
    found = rigsim.triangulate_points(TOED, uv).found
    np.testing.assert_allclose(found.points, points, atol=1e-9)
    assert found.off_px.max() < 1e-6
    noisy = uv + np.random.default_rng(2).normal(0, 0.05, uv.shape)
    rays = []
    for lens, pixels in zip((TOED.left, TOED.right), (noisy[:, :2], noisy[:, 2:]), strict=True):
        assert isinstance(lens.lens, rigsim.BrownConrady)
        bent = lens.lens
        lens_k = np.array([bent.k1, bent.k2, bent.p1, bent.p2, bent.k3])
        K = np.array([[lens.fx, 0, lens.cx], [0, lens.fy, lens.cy], [0, 0, 1]])
        rays.append(cv2.undistortPoints(pixels[:, None], K, lens_k)[:, 0])
    pose = TOED.right_from_left
    right = np.hstack([pose.R, pose.t[:, None]])
    homogeneous = cv2.triangulatePoints(np.eye(3, 4), right, rays[0].T, rays[1].T)
    witness = (homogeneous[:3] / homogeneous[3]).T
    found = rigsim.triangulate_points(TOED, noisy, noise_px=0.05).found
    # linear least squares is not the best point, but as near as the noise is small
    assert np.abs((found.points - witness) / found.stds).max() < 0.1
    assert np.abs((witness - points) / found.stds).max() > 2
    # e = q^T E r of the witness's rays, over its slope by differences of whole undistortions
    essential = (
        np.array([[0, -pose.t[2], pose.t[1]], [pose.t[2], 0, -pose.t[0]], [-pose.t[1], pose.t[0], 0]])
        @ pose.R
    )
    assert np.abs(_sampson(TOED, essential, noisy) - found.off_px).max() < 1e-5


def _sampson(rig: rigsim.StereoRig, essential: Array, uv: Array) -> Array:
    def gap(pixels: Array) -> Array:
        left, right = (
            np.column_stack([lens.normalize(part), np.ones(len(part))])
            for lens, part in ((rig.left, pixels[:, :2]), (rig.right, pixels[:, 2:]))
        )
        return np.einsum("ni,ij,nj->n", right, essential, left)

    step = 1e-3 * np.eye(4)
    slope = np.stack([(gap(uv + one) - gap(uv - one)) / 2e-3 for one in step], axis=1)
    return np.abs(gap(uv)) / np.linalg.norm(slope, axis=1)


@pytest.mark.parametrize("rig", [PLAIN, TOED], ids=["rectified", "toed in, distorted"])
def test_distribution_and_false_alarms_over_seeds(rig: rigsim.StereoRig) -> None:
    sigma, count, seeds = 0.3, 2000, 20
    points, uv = seen(rig, count, 3)
    alarms, squares, verdicts = 0, [], []
    for seed in range(seeds):
        noisy = uv + np.random.default_rng(seed).normal(0, sigma, uv.shape)
        found = pair_points(rig, noisy, rigsim.PixelNoise(sigma))
        alarms += found.n_inconsistent
        squares.append(((found.points - points) / found.stds) ** 2)
        squares[-1] = np.column_stack([squares[-1], (found.off_px / sigma) ** 2])
        verdicts.append(found.verdict)
        assert found.observed_noise_px == pytest.approx(sigma, rel=0.1)
    mean = np.mean(np.concatenate(squares), axis=0)
    # 40,000 squares of a normal number: 1 +- .007, and what curves beyond the first order
    np.testing.assert_allclose(mean, 1, atol=0.03)
    # 40 are expected of 40,000: Poisson
    assert abs(alarms - FALSE_ALARM * count * seeds) < 4 * (FALSE_ALARM * count * seeds) ** 0.5
    assert verdicts.count("agrees") >= seeds - 1


def test_correlated_noise_is_judged_by_what_it_leaves() -> None:
    # rows that move together differ less: sqrt(1 - .75) of as much, and a pair .5 px off is 4 of them
    gap = pair_gap(PLAIN, [[700, 400]], [[646, 400 + 2**-0.5]], rigsim.PixelNoise(0.25, 0.75).covariance_px2)
    assert float(gap.off_px[0]) == pytest.approx(0.5)
    assert float(gap.off_std_px[0]) == pytest.approx(0.125)
    lower = pair_gap(PLAIN, [[700, 400]], [[646, 399]], np.eye(4))
    assert float(lower.off_px[0]) == pytest.approx(-(2**-0.5))


def test_wrong_matches_are_found_and_told() -> None:
    rng = np.random.default_rng(5)
    told = []
    for seed in range(60):
        _, uv = seen(PLAIN, FEWEST, seed)
        uv += rng.normal(0, 0.25, uv.shape)
        wrong = rng.random(FEWEST) < 0.05
        uv[wrong, 3] += rng.uniform(20, 60, wrong.sum())
        found = rigsim.triangulate_points(PLAIN, uv)
        assert not found.table.consistent[wrong].any()
        told.append(found.verdict)
    # three are enough: of 110 pairs at 5 % there are as many in 92 of 100 sets
    assert 50 <= told.count("flagged") <= 59
    assert set(told) == {"flagged", "agrees"}
    uv[:6, 3] += 40
    found = rigsim.triangulate_points(PLAIN, uv)
    text = next(remark.text for remark in found.remarks if remark.code == "inconsistent")
    assert text.startswith(f"{found.found.n_inconsistent} of 110 pairs (")
    assert "%) are inconsistent, 0.1 % would be by chance" in text
    few = rigsim.triangulate_points(PLAIN, uv[-10:])
    assert few.verdict == "untold"
    assert few.remarks == ()


def test_a_file_keeps_its_columns(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "pairs.csv"
    path.write_text(
        "id,V_Left, U_left ,u_right,v_right,Z_mm\r\na,400,700,646,400,1999\r\n\r\nb,400,646,700,400,007\r\n"
    )
    words = ("--baseline", "120", "--focal", "900", "--resolution", "1280x720")
    rows = list(csv.DictReader(io.StringIO(printed(capsys, str(path), *words, "--csv"))))
    assert list(rows[0])[:6] == ["id", "V_Left", "U_left", "u_right", "v_right", "Z_mm_given"]
    assert [row["Z_mm_given"] for row in rows] == ["1999", "007"]
    assert float(rows[0]["z_mm"]) == pytest.approx(2000)
    assert (rows[1]["z_mm"], rows[1]["why"], rows[1]["consistent"]) == ("", "behind", "false")
    document = valid("calc-points", printed(capsys, str(path), *words, "--json"))
    assert document["points"][0]["z_mm"] == pytest.approx(2000)
    assert (document["n_pairs"], document["n_points"], document["n_inconsistent"]) == (2, 1, 1)
    assert {remark["code"] for remark in document["remarks"]} >= {"behind"}
    out = tmp_path / "out.csv"
    text = printed(capsys, str(path), *words, "--out", str(out))
    assert text.startswith("2 pairs of pixels, 1 point at 2.00 m; the median std")
    assert f"File: {out}" in text
    assert run(["calc", "points", str(path), *words, "--out", str(out)]) == 1
    assert "is there; choose another one, or add --force" in capsys.readouterr().err
    printed(capsys, str(path), *words, "--out", str(out), "--force")
    assert pd.read_csv(out).z_mm[0] == pytest.approx(2000)


@pytest.mark.parametrize(
    "text",
    [
        "700,400,646,400\n700,410,646,410\n",
        "# u_left,v_left,u_right,v_right\n700,400,646,400\n700,410,646,410\n",
        "v_right;u_right;v_left;u_left\n400;646;400;700\n410;646;410;700\n",
        "\ufeffu_left\tv_left\tu_right\tv_right\n700\t400\t646\t400\n700\t410\t646\t410\n",
    ],
)
def test_other_ways_to_write_it(text: str, tmp_path: Path) -> None:
    path = tmp_path / "pairs.txt"
    path.write_text(text, encoding="utf-8")
    table = rigsim.triangulate_points(PLAIN, path).table
    assert table.z_mm.tolist() == pytest.approx([2000, 2000])
    assert table.y_mm.tolist() == pytest.approx([90, 50.5 / 0.45])


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (HEAD + "1,2,3,4\n1,x,3,4\n", "line 3: v_left x: must be a number, px"),
        (HEAD + "\n1,2,nan,4\n", "line 3: u_right nan: must be a number, px"),
        (HEAD + "1,2,3\n", "line 2: v_right empty: must be a number, px"),
        (HEAD + "1,2,3,inf\n", "line 2: v_right inf: must be a number, px"),
        (HEAD + "1,2,3,4,5\n", "line 2: 5 cells, there are 4 columns"),
        (HEAD, "number of pairs 0: must be >= 1"),
        ("", "column u_left is missing (found nothing)"),
        ("u_left,v_left,u_right\n1,2,3\n", "column v_right is missing (found u_left, v_left, u_right)"),
        ("u_left,v_left,u_right,v_right,U_LEFT\n1,2,3,4,5\n", "column u_left is there 2 times"),
        ('"', "column u_left is missing"),
    ],
)
def test_what_no_pairs_are_is_one_line(
    text: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "pairs.csv"
    path.write_text(text)
    assert run(["calc", "points", str(path), "--preset", "oak-d"]) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1


def test_tables_in_memory() -> None:
    _, uv = seen(TOED, 5, 7)
    names = ("u_left", "v_left", "u_right", "v_right")
    expected = rigsim.triangulate_points(TOED, uv).table.z_mm.tolist()
    frame = pd.DataFrame({"name": list("abcde"), **dict(zip(names, uv.T, strict=True))}, index=range(3, 8))
    for pairs in (frame, dict(zip(names, uv.T, strict=True)), uv.tolist()):
        assert rigsim.triangulate_points(TOED, pairs).table.z_mm.tolist() == expected
    assert rigsim.triangulate_points(TOED, frame).table.name.tolist() == list("abcde")
    wrong: list[Any] = [
        None,
        1.0,
        object(),
        [[1, 2, 3]],
        [["a"] * 4],
        [[1, 2, 3, np.nan]],
        {"u_left": [1]},
        np.empty((0, 4)),
    ]
    for pairs in wrong:
        with pytest.raises(InvalidRange) as error:
            rigsim.triangulate_points(TOED, pairs)
        assert "\n" not in str(error.value)


def test_what_is_odd_is_counted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "pairs.csv"
    path.write_text("700,400,646,400\n1300,400,1246,400\n700,400,699,400\n700,400,699.5,400\n")
    words = ("--baseline", "120", "--focal", "900")
    document = json.loads(printed(capsys, str(path), *words, "--resolution", "1280x720", "--json"))
    said = {remark["code"]: remark["text"] for remark in document["remarks"]}
    assert said["outside"].startswith("1 of 4 pairs (25 %) have a pixel outside its image")
    assert said["too_noisy"].startswith("2 of 4 pairs (50 %) have a Z under 4 times its own std")
    assert document["uv_origin"] == "first pixel"
    document = json.loads(printed(capsys, str(path), *words, "--json"))
    assert "uv_origin" in {remark["code"] for remark in document["remarks"]}
    assert document["uv_origin"] == "optical axis"


def test_what_the_lens_does_not_show_has_no_point() -> None:
    bent = rigsim.Intrinsics(1280, 720, 900.0, 900.0, 639.5, 359.5, rigsim.BrownConrady(-0.6))
    rig = rigsim.StereoRig(bent, bent, rigsim.Pose(t=[-0.12, 0.0, 0.0]))
    # at k1 = -.6 nothing lies further than .497 from the axis: 447 px
    found = rigsim.triangulate_points(rig, [[1200, 359.5, 1190, 359.5], [700, 400, 640, 400]])
    assert found.table.why.tolist() == ["lens", ""]
    assert found.table.consistent.tolist() == [False, True]
    assert np.isnan(found.table.off_px[0])
    assert "lens" in {remark.code for remark in found.remarks}


def test_golden(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, golden = tmp_path / "pairs.csv", str(tmp_path / "golden")
    path.write_text("700,400,646,400\n700,410,646,410\n")
    words = ["calc", "points", str(path), "--preset", "oak-d", "--golden", golden]
    assert run([*words, "--update"]) == 0
    assert run(words) == 0
    path.write_text("700,400,646,400\n700,410,646.1,410\n")
    assert run(words) == 3
    assert "points[#2] z_mm" in capsys.readouterr().out


def test_nothing_heavy_is_loaded(tmp_path: Path) -> None:
    path = tmp_path / "pairs.csv"
    path.write_text("700,400,646,400\n")
    for words in (["--csv"], ["--json"], []):
        loaded = {
            name.partition(".")[0]
            for name in modules_after("calc", "points", str(path), "--preset", "oak-d", *words)
        }
        assert "numpy" in loaded
        assert not loaded & {"cv2", "matplotlib", "mujoco", "pandas", "scipy"}
