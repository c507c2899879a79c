"""Every use case from Python: plain arguments in, numbers worked out by hand out."""

from __future__ import annotations

import inspect
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rigsim
from rigsim.api.kit.asked import DepthError
from rigsim.api.result import Result
from rigsim.errors import InvalidRange, InvalidRig, OutputError, RigsimError
from rigsim.testing import render_stereo

Call: Any = rigsim  # a person's script is checked by nothing
OAK_D = rigsim.preset("oak-d").rig  # 882.5 px, 75 mm
SMALL = rigsim.StereoRig.rectified(rigsim.Intrinsics.from_focal(320, 240, 280.0), 0.06)
TINY = rigsim.StereoRig.rectified(rigsim.Intrinsics.from_focal(80, 60, 70.0), 0.06)
QUICK_DESIGN = {"range_m": (0.5, 3), "at_m": 3, "resolutions_px": (1280, 960), "proof": False}


def _measured() -> Result:
    pair = render_stereo("bin", SMALL)
    return rigsim.measure(pair.left, pair.right, SMALL, matcher=None)


def _dataset(folder: Path) -> Result:
    return rigsim.export_dataset(TINY, "opencv", 2, folder / "data", scene="bin", renderer="rays", seed=3)


MADE: dict[str, Callable[[Path], Result]] = {
    "design": lambda _: rigsim.design(depth_error_mm=10, **QUICK_DESIGN),
    "tolerance": lambda _: rigsim.tolerance("oak-d", range_m=(1, 3), rigs=100, points=60),
    "infer": lambda _: rigsim.infer("oak-d", depth_error_pct=[1, 2], at_m=[4, 7], to="bin"),
    "measure": lambda _: _measured(),
    "verify": lambda _: rigsim.verify("dlt", cases="rectified", scenes=[]),
    "compare": lambda _: rigsim.compare(["dlt", "midpoint"], geometries="far", noises_px=0.5, points=500),
    "render": lambda _: rigsim.render(TINY, scene="bin", renderer="rays"),
    "export_rig": lambda _: rigsim.export_rig("oak-d", "ros"),
    "export_dataset": _dataset,
}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Result]:
    kept: dict[str, Result] = {}

    def get(name: str) -> Result:
        if name not in kept:
            kept[name] = MADE[name](tmp_path_factory.mktemp(name))
        return kept[name]

    return get


@pytest.mark.parametrize("name", MADE)
def test_every_result_has_the_same(name: str, made: Callable[[str], Result], tmp_path: Path) -> None:
    found = made(name)
    assert isinstance(found, Result)
    assert len(found.table) > 0
    assert len(found.table.columns) > 1
    assert found.headline
    assert found.verdict is not None
    assert found.figure().get_size_inches()[0] > 1
    with pytest.raises(InvalidRange, match="figure 'pie': choose one of"):
        found.figure("pie")
    written = found.write(tmp_path / "out")
    there = sorted(str(p.relative_to(tmp_path / "out")) for p in (tmp_path / "out").rglob("*") if p.is_file())
    assert written.files == there
    assert isinstance(json.loads(found.to_json(written)), dict)
    assert isinstance(json.loads(found.to_json()), dict)
    assert "<table" in found._repr_html_()
    with pytest.raises(OutputError):
        found.write(tmp_path / "out")


@pytest.mark.parametrize("name", [*MADE, "sweep"])
def test_its_arguments_are_explained(name: str) -> None:
    function = getattr(rigsim, name)
    said = inspect.getdoc(function) or ""
    for argument in inspect.signature(function).parameters:
        assert f"\n    {argument}: " in said, argument


def test_the_example_of_every_name_of_the_issue_is_there() -> None:
    assert {*MADE, "sweep", "read_rig"} <= set(rigsim.__all__)


def test_infer_by_hand() -> None:
    # one error: sigma_d = std f B / Z^2 = .04 * 882.5 * .075 / 16
    expected = 0.04 * 882.5 * 0.075 / 16
    for words in (
        {"depth_error_pct": 1, "at_m": 4},
        {"depth_error_mm": 40, "at_m": 4},
        {"errors": DepthError(at_m=4, mm=40)},
        {"depth_error_mm": 40 * 1.959963984540054, "at_m": 4, "p95": True},
    ):
        assert Call.infer(OAK_D, **words).inference.disparity_std_px == pytest.approx(expected, rel=1e-12)
    carried = rigsim.infer(OAK_D, depth_error_mm=40, at_m=4, to=SMALL, to_at_m=2).carried
    assert carried is not None
    # the same disparity noise at 2 m with 280 px and 60 mm
    assert carried.stds_m[0] == pytest.approx(expected * 4 / (280 * 0.06), rel=1e-9)


def test_infer_takes_bounds_and_a_wall_test(tmp_path: Path) -> None:
    # 1 px either way at 4 m: d = 882.5 * .075 / 4 = 16.546875 px
    near, far = (1e3 * 882.5 * 0.075 / (16.546875 + step) for step in (1, -1))
    found = rigsim.infer(OAK_D, errors=[DepthError(at_m=4, bounds_mm=(near, far))])
    assert found.inference.disparity_std_px == pytest.approx(1.0, rel=1e-6)
    assert found.remarks == ()
    path = tmp_path / "wall.csv"
    path.write_text("distance_mm,depth_std_mm\n1000,2.5\n2000,10\n4000,40\n")
    by_data = rigsim.infer(OAK_D, data=path)
    assert by_data.inference.disparity_std_px == pytest.approx(0.04 * 882.5 * 0.075 / 16, rel=1e-9)


def test_tolerance_by_hand() -> None:
    # a baseline 1 % too long makes every depth 1 % too short; in first order exactly
    found = rigsim.tolerance(
        OAK_D,
        tolerance_class="none",
        tolerances={"baseline_mm": 0.75},
        range_m=(1, 3),
        depth_error_mm=60,
        recalibrate=False,
        noise_px=0.0,
        rigs=2000,
        points=60,
    )
    row = found.table.iloc[0]
    assert row["quantity"] == "baseline_mm"
    assert row["depth_error_at_3000_mm"] == pytest.approx(30.0)
    assert row["depth_error_at_1000_mm"] == pytest.approx(10.0)
    # 60 mm is two standard deviations: 95.45 % of rigs, +- 0.5 % of sampling
    assert found.verdict.as_built == pytest.approx(0.9545, abs=0.02)
    assert found.verdict.recalibrated is None
    bound = rigsim.tolerance(
        OAK_D,
        tolerance_class="none",
        tolerances={"baseline_mm": 0.75},
        bounds={"baseline_mm"},
        rigs=10,
        points=60,
    )
    assert bound.table["form"].tolist() == ["bound"]


def test_design_by_hand() -> None:
    found = rigsim.design(depth_error_mm=10, **QUICK_DESIGN)
    rig = found.rig
    # Z^2 / (f B) sqrt(2) .25 px is at most 10 mm at 3 m
    error_m = 9 / (rig.left.fx * rig.baseline_m) * np.sqrt(2) * 0.25
    assert error_m <= 0.010
    assert found.document()["recommended"]["baseline_mm"] == pytest.approx(rig.baseline_m * 1e3)
    with pytest.raises(InvalidRig, match=r"depth error at 3 m from 5 mm to 9.95 mm"):
        rigsim.design(depth_error_mm=5, **QUICK_DESIGN)


def test_a_percentage_is_one_of_the_distance() -> None:
    said = []
    for words in (
        {"depth_error_pct": 0.1, "at_m": 3},
        {"depth_error_mm": 3, "at_m": 3},
        {"errors": DepthError(at_m=3, pct=0.1)},
        {"depth_error_pct": 0.1},  # the far end
    ):
        with pytest.raises(InvalidRig) as told:
            Call.design(range_m=(0.5, 3), resolutions_px=(1280, 960), proof=False, **words)
        said.append(str(told.value))
    assert len(set(said)) == 1
    assert "depth error at 3 m <= 3 mm" in said[0]


def test_render_is_f_b_over_z() -> None:
    found = rigsim.render(TINY, scene="bin", renderer="rays")
    depth_m = found.snapshot.frame.left.depth
    expected = 70.0 * 0.06 / depth_m
    seen = np.isfinite(found.snapshot.disparity)
    np.testing.assert_allclose(found.snapshot.disparity[seen], expected[seen], rtol=1e-6)
    assert found.verdict == pytest.approx(seen.sum() / np.isfinite(depth_m).sum())
    assert found.table["median"].iloc[1] == pytest.approx(np.median(found.snapshot.disparity[seen]), rel=1e-6)


def test_measure_finds_the_true_disparities(made: Callable[[str], Result]) -> None:
    pair, table = render_stereo("bin", SMALL), made("measure").table
    v, u = (table[f"{axis}_left_px"].round().astype(int) for axis in "vu")
    true = pair.disparity[v, u]
    off = np.abs(table["disparity_px"] - true)[np.isfinite(true)]
    assert off.median() < 0.1
    with pytest.raises(InvalidRange, match="give the board"):
        rigsim.measure(pair.left, pair.right, SMALL, square_mm=25)


def test_verify_takes_functions_and_tells_which_failed() -> None:
    def swapped(rig: Any, uv_left: Any, uv_right: Any) -> Any:
        return rigsim.triangulate(rig, uv_right, uv_left)

    said: list[tuple[str, int, int]] = []
    found = rigsim.verify(
        ["dlt", swapped], cases="rectified", scenes=[], progress=lambda *told: said.append(told)
    )
    assert found.verdict == "failed"
    by_name = found.table.groupby("triangulator")["status"].agg(set)
    assert by_name["dlt"] == {"passed"}
    (other,) = set(by_name.index) - {"dlt"}
    assert "swapped" in other
    assert by_name[other] == {"failed"}
    assert next(iter(found.figures)).startswith(other)  # what failed comes first
    assert said[-1] == ("cases", len(found.table), len(found.table))


def test_compare_counts_everyone_once() -> None:
    found = rigsim.compare(
        ["dlt", "optimal"], geometries=["rectified", "far"], noises_px=[0.5, 1], points=300
    )
    assert len(found.table) == 8
    first = found.table[found.table["triangulator"] == "dlt"]
    assert (first["pixel_error_over_first"] == 1).all()
    assert set(found.verdict) == {"dlt", "optimal"}
    with pytest.raises(InvalidRange, match="'dlt': given twice"):
        rigsim.compare(["dlt", "dlt"])


def test_a_dataset_is_where_it_says(made: Callable[[str], Result]) -> None:
    found: Any = made("export_dataset")
    assert rigsim.read_rig(found.folder) == TINY
    assert found.table["frame"].tolist() == [0, 1]
    assert found.table[["x_mm", "y_mm", "z_mm"]].diff().iloc[1].abs().max() > 1  # it has moved


@pytest.mark.parametrize(
    ("name", "words", "says"),
    [
        ("infer", {"rig": OAK_D}, "give either depth errors or data"),
        ("infer", {"rig": OAK_D, "depth_error_mm": 10}, "at which distance"),
        ("infer", {"rig": OAK_D, "depth_error_mm": [1, 2], "at_m": [1, 2, 3]}, "3 distances for 2 errors"),
        ("infer", {"rig": OAK_D, "depth_error_mm": 1, "depth_error_pct": 1, "at_m": 1}, "give one"),
        ("tolerance", {"rig": OAK_D, "tolerance_class": "gold"}, "class 'gold': choose one of"),
        ("tolerance", {"rig": OAK_D, "tolerances": {"yaw": 1}}, "tolerance 'yaw': choose one of yaw_deg"),
        ("tolerance", {"rig": OAK_D, "range_m": 3}, "must be (near, far)"),
        ("design", {"range_m": (0.5, 3)}, "no depth error is asked for"),
        ("design", {"range_m": (0.5, 3), "depth_error_mm": 9, "lenses_mm": 4}, "how large is a pixel"),
        ("verify", {"triangulators": 3}, "must be a name or a function"),
        ("verify", {"update": True, "cases": "far"}, "golden results hold every case"),
        ("compare", {"methods": "dlt", "geometries": "round"}, "geometry 'round'"),
        ("render", {"rig": "oak-d", "scene": 3}, "scene 3: must be a path"),
        ("export_rig", {"rig": "oak-d", "format": "word"}, "format 'word': must be one of"),
        ("measure", {"left": 3, "right": 4, "rig": OAK_D}, "left picture 3: must be a path"),
    ],
)
def test_what_cannot_be_is_one_line(name: str, words: dict[str, Any], says: str) -> None:
    with pytest.raises(RigsimError) as told:
        getattr(Call, name)(**words)
    assert says in str(told.value)
    assert "\n" not in str(told.value)
