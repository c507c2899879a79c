"""covariance.json: read back bit for bit, and refused in one line where it is none."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rigsim.errors import RigsimError
from rigsim.interop.documents.calibrate.covariance import CovarianceDocument, covariance_document
from rigsim.interop.documents.text import json_text
from rigsim.interop.files.covariance import read_covariance, read_sourced
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from tests.helpers.calibrate.covariances import SOURCE, calibrated, written


@pytest.mark.parametrize("kind", ["pinhole", "brown", "fisheye", "warped"])
def test_a_covariance_comes_back_bit_for_bit(tmp_path: Path, kind: str) -> None:
    covariance = calibrated(
        lens={"brown": BrownConrady(k1=-0.1 / 3, p1=1e-3 / 7), "fisheye": KannalaBrandt(0.01 / 3)}.get(kind),
        model={"fisheye": KannalaBrandt}.get(kind, BrownConrady),
        fix=("k3", "right.p1", "aspect") if kind == "brown" else (),
        warped=kind == "warped",
    )
    back = read_covariance(written(covariance, tmp_path / "covariance.json"))
    assert back.rig == covariance.rig
    assert back.names == covariance.names
    assert back.parameters.lenses == covariance.parameters.lenses
    assert back.parameters.square_pixels == covariance.parameters.square_pixels
    assert back.parameters.warped == covariance.parameters.warped
    assert np.array_equal(back.parameters.free, covariance.parameters.free)
    assert np.array_equal(back.matrix, covariance.matrix)
    points = [[0.1, -0.2, 2.0]]
    assert back.depth_std(points) == covariance.depth_std(points)


@pytest.mark.parametrize("name", ["plan.json", "calibration.json"])
def test_one_inside_a_larger_document_keeps_every_digit_too(tmp_path: Path, name: str) -> None:
    covariance = calibrated()
    part = covariance_document(covariance, SOURCE)
    (tmp_path / name).write_text(json_text({"depth_std": [{"z_m": 1 / 3}], "covariance": part}))
    found = read_sourced(tmp_path / name)
    assert found.covariance.rig == covariance.rig
    assert np.array_equal(found.covariance.matrix, covariance.matrix)
    assert (found.of, found.board, found.pictures, found.corner_noise_px) == ("plan", "9x6@30mm", 12, 0.1)
    # and what is beside it is as clean as ever
    assert json.loads((tmp_path / name).read_text())["depth_std"][0]["z_m"] == 0.333333333333333


def test_units_stand_beside_the_names() -> None:
    document = covariance_document(calibrated(), SOURCE)
    unit = dict(zip(document["names"], document["unit"], strict=True))
    assert unit["left.fx"] == unit["right.cy"] == "px"
    assert unit["left.k1"] == unit["right.p2"] == ""
    assert unit["ry_rad"] == unit["frame.rz_rad"] == "rad"
    assert unit["tx_m"] == unit["frame.tz_m"] == "m"
    assert CovarianceDocument.model_json_schema()["additionalProperties"] is False


def _set(*place: Any, to: Any) -> Callable[[dict[str, Any]], None]:
    def spoil(document: dict[str, Any]) -> None:
        node: Any = document
        for step in place[:-1]:
            node = node[step]
        node[place[-1]] = to

    return spoil


def _drop(key: str) -> Callable[[dict[str, Any]], None]:
    return lambda document: document.pop(key) and None


def _indefinite(document: dict[str, Any]) -> None:
    matrix = document["matrix"]
    # a correlation of 3
    matrix[0][1] = matrix[1][0] = 3 * (matrix[0][0] * matrix[1][1]) ** 0.5


def _scaled(by: float) -> Callable[[dict[str, Any]], None]:
    def spoil(document: dict[str, Any]) -> None:
        document["matrix"] = [[by * value for value in row] for row in document["matrix"]]

    return spoil


def _short(document: dict[str, Any]) -> None:
    document["matrix"] = [row[:-1] for row in document["matrix"][:-1]]


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (_indefinite, "an eigenvalue of its correlations is -"),
        (_set("matrix", 0, 1, to=1e9), "must be symmetric"),
        (_set("matrix", 2, 2, to=-1.0), "variance of left.cx is -1: must be >= 0"),
        (_set("matrix", 2, 2, to=0.0), "left.cx has no variance, but covariances"),
        (_short, "29 rows of 29 numbers: must be 30 x 30"),
        (_set("matrix", 0, 0, to=float("nan")), "NaN is no number of JSON"),
        (_set("matrix", 0, 0, to=None), "matrix.0.0: input should be a valid number"),
        (_set("matrix", to=[]), "0 rows of 0 numbers"),
        (_set("matrix", 0, 0, to="1"), "matrix.0.0: input should be a valid number"),
        (_set("matrix", 0, 0, to=True), "matrix.0.0: input should be a valid number"),
        (_set("rig", "left", "fx_px", to="500"), "rig.left.fx_px: input should be a valid number"),
        (_set("unit", 0, to="mm"), "unit: 'mm' of left.fx, must be 'px'"),
        (_set("unit", to=["px"]), "unit: 1 where 30 must be"),
        (_scaled(0.0), "all of the rig's are 0: nothing was estimated"),
        (_scaled(1e12), "std of a focal length is "),
        (_drop("rig"), "covariance: rig: field required"),
        (_drop("kind"), "holds no covariance"),
        (_drop("names"), "names: field required"),
        (_set("names", 4, to="left.k9"), "'left.k9' where 'left.k1' must be"),
        (_set("parameters", "free", to=[True]), "free: 1 values, must be 24"),
        (_set("parameters", "lens_models", to=["brown", "odd"]), "lens model 'odd': must be one of brown"),
        (_set("rig", "left", "fx_px", to=-1.0), "focal length fx -1 px: must be > 0"),
        (_set("rig", "t_m", to=[0.0, 0.0, 0.0]), "baseline 0 mm"),
        (_set("rig", "rotation", to=[[1.0, 0.0]]), "rotation must be 3 rows of 3 numbers"),
        (
            _set("rig", "right", "lens", to={"model": "brown", "coefficients": {"k1": 0.0}}),
            "must have k1, k2",
        ),
        (
            _set("rig", "right", "lens", to={"model": "fov", "coefficients": {"w": 0.9}}),
            "is no brown; fit one first",
        ),
    ],
)
def test_what_is_no_covariance_is_told_in_one_line(
    tmp_path: Path, spoil: Callable[[dict[str, Any]], None], says: str
) -> None:
    document = copy.deepcopy(covariance_document(calibrated(), SOURCE))
    spoil(document)
    path = tmp_path / "covariance.json"
    path.write_text(json.dumps(document))
    with pytest.raises(RigsimError) as caught:
        read_covariance(path)
    assert says in str(caught.value)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["left.fx", "right.fy", "tx_m", "tz_m"])
def test_a_focal_length_or_baseline_is_known_to_a_fifth_at_least(tmp_path: Path, name: str) -> None:
    covariance = calibrated()
    at = covariance.names.index(name)
    rig = covariance.rig
    whole = {"left.fx": rig.left.fx, "right.fy": rig.right.fy}.get(name, rig.baseline_m)
    diagonal = np.zeros_like(covariance.matrix)
    diagonal[at, at] = (0.199 * whole) ** 2
    read_covariance(written(replace(covariance, matrix=diagonal), tmp_path / "some.json"))
    diagonal[at, at] = (0.21 * whole) ** 2
    with pytest.raises(RigsimError, match=r"std of .* is 21 % of .*: must be <= 20 %"):
        read_covariance(written(replace(covariance, matrix=diagonal.copy()), tmp_path / "most.json"))


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "no JSON"),
        (b"[1, 2]", "holds no covariance"),
        (b'{"covariance": 3}', "holds no covariance"),
        (b"\xff\xfe\x00", "no JSON"),
        (b"[" * 100_000, "nested too deep"),
        (b" " * 20_000_001, "must be <= 20 MB"),
    ],
    ids=["empty", "list", "number", "binary", "deep", "huge"],
)
def test_other_files_are_refused_in_one_line(tmp_path: Path, content: bytes, says: str) -> None:
    path = tmp_path / "some.json"
    path.write_bytes(content)
    with pytest.raises(RigsimError, match=says) as caught:
        read_covariance(path)
    assert "\n" not in str(caught.value)


def test_there_is_none_where_there_is_no_file(tmp_path: Path) -> None:
    with pytest.raises(RigsimError, match=r"name a covariance\.json, plan\.json or calibration\.json"):
        read_covariance(tmp_path / "none.json")
    with pytest.raises(RigsimError, match=r"Is a directory|is a folder"):
        read_covariance(tmp_path)


def test_held_parameters_stay_held(tmp_path: Path) -> None:
    covariance = calibrated(fix=("k3", "principal"))
    back = read_covariance(written(covariance, tmp_path / "covariance.json"))
    held = [name for name, free in zip(back.parameters.names, back.parameters.free, strict=True) if not free]
    assert held == ["left.cx", "left.cy", "left.k3", "right.cx", "right.cy", "right.k3"]
    assert not back.matrix[[covariance.names.index(name) for name in held]].any()
    assert replace(back.parameters, free=covariance.parameters.free).names == covariance.parameters.names
