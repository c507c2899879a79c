"""Tables and provenance as files."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping

import numpy as np
import numpy.typing as npt
import pandas as pd

from rigsim.interop.documents.text import json_text
from rigsim.interop.formats.rig_toml import write_rig
from rigsim.study.scene.snapshot import Snapshot
from rigsim.study.sweep.requirement import verdicts
from rigsim.study.sweep.result import SweepResult

_DIGITS = "%.10g"
_FORMULA = ("=", "+", "-", "@", "\t", "\r")


def csv_bytes(table: pd.DataFrame) -> bytes:
    """A table as CSV: ten significant digits, empty for NaN, the same bytes for the same numbers.

    A name that a spreadsheet would take for a formula gets an apostrophe in front, by which it is text.
    """
    words = table.select_dtypes(include=["object", "string"]).columns
    safe = table.assign(**{column: table[column].map(as_text) for column in words})
    return bytes(safe.to_csv(index=False, float_format=_DIGITS, lineterminator="\n").encode())


def as_text(value: object) -> object:
    """A cell that no spreadsheet runs: words that begin like a formula get an apostrophe in front."""
    return f"'{value}" if isinstance(value, str) and value.startswith(_FORMULA) else value


def json_bytes(document: Mapping[str, object]) -> bytes:
    """A document as indented JSON, null for NaN."""
    return (json_text(document) + "\n").encode()


def npy_bytes(values: npt.NDArray[np.generic]) -> bytes:
    """An array as NPY."""
    buffer = io.BytesIO()
    np.save(buffer, values, allow_pickle=False)
    return buffer.getvalue()


def sweep_files(result: SweepResult, spelled: Callable[[pd.DataFrame], pd.DataFrame]) -> dict[str, bytes]:
    """The files of a sweep that programs read; `spelled` writes the agreements of a table as words."""
    return {
        "sweep.csv": csv_bytes(_with_requirement(spelled(result.rows), result)),
        "sweep_by_depth.csv": csv_bytes(spelled(result.by_depth)),
        "rig.toml": write_rig(
            result.showcase.rig, comment=_about(result), sensor=result.showcase.sensor
        ).encode(),
        "provenance.json": json_bytes(result.provenance),
    }


def _about(result: SweepResult) -> str:
    if not result.requirements:
        return "best rig of the sweep"
    if verdicts(result.requirements)[result.showcase.row] == "met":
        return "rig of the sweep that meets what was asked"
    return "rig of the sweep that comes nearest to what was asked, and is not shown to meet it"


def _with_requirement(table: pd.DataFrame, result: SweepResult) -> pd.DataFrame:
    """The rows with what they make of what was asked, where something was."""
    if not result.requirements:
        return table
    return table.assign(requirement=list(verdicts(result.requirements)))


def render_files(snapshot: Snapshot) -> dict[str, bytes]:
    """The files of a rendered pair that programs read."""
    frame = snapshot.frame
    return {
        "depth_left.npy": npy_bytes(frame.left.depth.astype(np.float32)),
        "depth_right.npy": npy_bytes(frame.right.depth.astype(np.float32)),
        "disparity.npy": npy_bytes(snapshot.disparity.astype(np.float32)),
        "segmentation_left.npy": npy_bytes(frame.left.segmentation),
        "rig.toml": write_rig(snapshot.rig, comment=f"rendered in {snapshot.scene}").encode(),
        "provenance.json": json_bytes(snapshot.provenance),
    }
