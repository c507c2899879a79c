"""The files between rigsim and a program that triangulates; docs/reference/exec.md is their contract."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

from rigsim.errors import InvalidRig, TriangulatorError
from rigsim.interop.formats.opencv_yaml import FILE_NAME as OPENCV
from rigsim.interop.formats.opencv_yaml import opencv_yaml
from rigsim.programs import plain
from rigsim.rig.arrays import Array, Mask
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.stereo import StereoRig

CALIBRATION = "calibration.json"
OBSERVATIONS = "observations.csv"
POINTS = "points.csv"

_VERSION = 1
_OBSERVED = "id,u_left,v_left,u_right,v_right"
_FOUND = "id,x_m,y_m,z_m"
_IN_A_METRE = {"mm": 1000, "cm": 100, "um": 1_000_000}
_LISTED = 3

_Row: TypeAlias = tuple[int, str]
"""Number of a line, counted from 1, and its text."""


def task_files(rig: StereoRig, uv_left: Array, uv_right: Array) -> dict[str, str]:
    """What a program is given, name to text: the rig twice, and pixels (N, 2), every digit kept.

    Raises:
        TriangulatorError: the files cannot hold the rig's lens.
    """
    try:
        calibration, opencv = calibration_json(rig), opencv_yaml(rig)
    except InvalidRig as error:
        raise TriangulatorError(
            f"{error}: try a Python function, package.module:function", "misused"
        ) from None
    return {CALIBRATION: calibration, OPENCV: opencv, OBSERVATIONS: _observations(uv_left, uv_right)}


def calibration_json(rig: StereoRig) -> str:
    """A rig as JSON, every digit kept: metres, pixels, and the conventions in words."""
    document = {
        "format": "rigsim calibration",
        "version": _VERSION,
        "conventions": {
            "pixels": "an integer coordinate is a pixel's centre, u to the right, v down",
            "axes": "x right, y down, z forward",
            "distortion": "Brown-Conrady, as OpenCV's k1, k2, p1, p2, k3; another lens says its model",
            "right_from_left": "x_right = R x_left + t, R row by row, t in metres",
        },
        "left": _camera(rig.left),
        "right": _camera(rig.right),
        "right_from_left": {"R": rig.right_from_left.R.tolist(), "t_m": rig.right_from_left.t.tolist()},
    }
    return json.dumps(document, indent=2) + "\n"


def parse_points(content: bytes, count: int) -> Array:
    """Points (N, 3), m, of a points.csv that answers ids 0 to N - 1; NaN where there is no answer.

    Raises:
        TriangulatorError: it is not what docs/reference/exec.md asks for; the message names the line.
    """
    text = content.decode("utf-8-sig", errors="replace").replace("\r\n", "\n")
    lines = text.split("\n")
    if not text.strip():
        raise TriangulatorError(
            f"{POINTS} is empty: must hold {_FOUND} and a row for each of {count} ids", "wrong-file"
        )
    _check_header(lines[0])
    if lines[-1]:
        raise TriangulatorError(
            f"{POINTS} stops within line {len(lines)}, {_shown(lines[-1])}: every line must end in a newline;"
            " was it written to the end?",
            "wrong-file",
        )
    rows = [row for row in enumerate(lines[1:], start=2) if row[1] and not row[1].isspace()]
    values = _values(rows)
    ids = _ids(rows, values[:, 0], count)
    points = np.empty((count, 3))
    points[ids] = values[:, 1:]
    points[~np.isfinite(points).all(axis=1)] = np.nan
    return points


def _camera(camera: Intrinsics) -> dict[str, object]:
    lens = camera.lens or BrownConrady()
    model = {} if isinstance(lens, BrownConrady) else {"model": lens.model}
    return {
        "width_px": camera.width,
        "height_px": camera.height,
        "fx_px": camera.fx,
        "fy_px": camera.fy,
        "cx_px": camera.cx,
        "cy_px": camera.cy,
        "distortion": {**model, **{name: getattr(lens, name) for name in lens.names()}},
    }


def _observations(uv_left: Array, uv_right: Array) -> str:
    rows = np.hstack([uv_left, uv_right]).tolist()
    lines = [f"{i},{ul!r},{vl!r},{ur!r},{vr!r}" for i, (ul, vl, ur, vr) in enumerate(rows)]
    return "\n".join([_OBSERVED, *lines]) + "\n"


def _check_header(line: str) -> None:
    names = [name.strip().strip('"') for name in line.split(",")]
    if names == _FOUND.split(","):
        return
    for unit, many in _IN_A_METRE.items():
        if names[1:] == [f"{axis}_{unit}" for axis in "xyz"]:
            raise TriangulatorError(
                f"{POINTS} is in {unit}, {_shown(line)}: must be in metres, {_FOUND}; divide by {many}",
                "wrong-file",
            )
    raise TriangulatorError(
        f"{POINTS} begins with {_shown(line)}: its first line must be {_FOUND}", "wrong-file"
    )


def _values(rows: Sequence[_Row]) -> Array:
    """The numbers of the rows, (N, 4)."""
    # float() rounds rightly and is fast; it also takes 1_000, which nothing else does
    cells = ",".join(line for _, line in rows)
    if all(line.count(",") == 3 for _, line in rows) and "_" not in cells:
        try:
            return np.array([float(cell or "nan") for cell in cells.split(",")] if rows else []).reshape(
                -1, 4
            )
        except ValueError:
            pass
    return np.array([_row(number, line) for number, line in rows]).reshape(-1, 4)


def _row(number: int, line: str) -> list[float]:
    """The same with a missing answer in any spelling, or the reason why there is none."""
    cells = [cell.strip().strip('"') for cell in line.split(",")]
    names = _FOUND.split(",")
    if len(cells) != len(names):
        raise TriangulatorError(
            f"{POINTS}, line {number}, {_shown(line)}: has {len(cells)} numbers, must have 4, {_FOUND}",
            "wrong-file",
        )
    values = []
    for name, cell in zip(names, cells, strict=True):
        missing = name != "id" and (not cell or cell.lower().lstrip("+-").startswith("nan"))
        try:
            values.append(float("nan" if missing else cell.replace("_", "?")))
        except ValueError:
            raise TriangulatorError(
                f"{POINTS}, line {number}: {name} is {_shown(cell)}, must be a number"
                + ("" if name == "id" else ", or nan where there is no answer"),
                "wrong-file",
            ) from None
    return values


def _ids(rows: Sequence[_Row], ids: Array, count: int) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Whose answer each row is; every id has one."""
    asked = f"0 to {count - 1}" if count else "none"
    known = (ids >= 0) & (ids < count) & (ids == np.floor(ids))
    if not known.all():
        number, line = rows[int(np.argmin(known))]
        asked = f"0 to {count - 1}" if count else "none"
        raise TriangulatorError(
            f"{POINTS}, line {number}: id {_shown(line.split(',')[0])} was not asked for; those of"
            f" {OBSERVATIONS} are {asked}",
            "wrong-file",
        )
    whose = ids.astype(np.intp)
    times = np.bincount(whose, minlength=count)
    if (times > 1).any():
        raise TriangulatorError(
            f"{POINTS} has more than one row of id {_some(times > 1)}: must have one each", "wrong-file"
        )
    if (times == 0).any():
        raise TriangulatorError(
            f"{POINTS} has {len(whose)} rows: must be {count}, nan where there is no answer; id"
            f" {_some(times == 0)} missing",
            "wrong-file",
        )
    return whose


def _some(which: Mask) -> str:
    ids = np.flatnonzero(which).tolist()
    return ", ".join(map(str, ids[:_LISTED])) + (", ..." if len(ids) > _LISTED else "")


def _shown(text: str) -> str:
    return repr(plain(text, 40))
