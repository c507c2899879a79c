"""Golden results of a verification: what scenes and triangulators give."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from rigsim.rig.stereo import StereoRig
from rigsim.sim.simulator import Simulator
from rigsim.study.golden.compare import COLOUR, Number, Record, rounded
from rigsim.study.verify.result import CaseResult, TriangulatorResult

DEPTH_ALLOWED_M = 1e-9
"""What a depth found by rays may differ by, m: other processors round differently."""
GREY_ALLOWED = 2.0
"""What a rendered colour may differ by, grey levels of 255: other drivers shade differently."""

_GRID = (6, 4)
_BLOCK = 4


def scene_record(simulator: Simulator, rig: StereoRig, about: Mapping[str, str]) -> Record:
    """Depth of a grid of left pixels by rays, and the colour of the picture around them where there is GL."""
    simulator.place(rig)
    columns, rows = _GRID
    u = np.round((np.arange(columns) + 0.5) * rig.left.width / columns)
    v = np.round((np.arange(rows) + 0.5) * rig.left.height / rows)
    uv = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    points_left, _ = simulator.points_at(uv)
    numbers = [
        Number(f"depth {_at(pixel)}", float(point[2]), "m", DEPTH_ALLOWED_M)
        for pixel, point in zip(uv, points_left, strict=True)
    ]
    if simulator.backend != "rays":
        light = simulator.render(supersample=1).left.light
        for pixel in uv.astype(int):
            x, y = (int(part) for part in pixel)
            block = light[y - _BLOCK : y + _BLOCK + 1, x - _BLOCK : x + _BLOCK + 1]
            for colour, level in zip(("red", "green", "blue"), block.mean(axis=(0, 1)), strict=True):
                numbers.append(Number(f"{colour} {_at(pixel)}", float(level) * 255, COLOUR, GREY_ALLOWED))
    return Record(f"scene-{simulator.scene.name}", about, tuple(map(rounded, numbers)))


def triangulator_record(result: TriangulatorResult, about: Mapping[str, str]) -> Record:
    """Size of the errors in every noisy or measured case, and how many rows did not come back in any case."""
    numbers = (number for case in result.results for number in _case_numbers(case))
    name = "".join(letter if letter.isalnum() else "-" for letter in result.triangulator)
    return Record(f"triangulator-{name}", about, tuple(map(rounded, numbers)))


def rig_words(rig: StereoRig) -> str:
    """A rig in a few words, as the head of a golden file has it."""
    left = rig.left
    return f"{left.width}x{left.height} px, focal {left.fx:g} px, baseline {rig.baseline_m * 1e3:g} mm"


def _case_numbers(result: CaseResult) -> Iterator[Number]:
    case, found = result.case, result.found_left
    if found is None or not case.answerable.any():
        return
    asked = case.answerable & np.isfinite(found).all(axis=1)
    yield Number(f"{case.name}, unanswered", float(case.answerable.sum() - asked.sum()), "rows")
    if case.kind not in ("noisy", "measured") or not math.isfinite(result.efficiency):
        return
    square = (found[asked, 2] - case.points_left[asked, 2]) ** 2
    n = len(square)
    error_m = float(square.std()) / math.sqrt(n) / (2 * result.depth_rms_m) if result.depth_rms_m else 0.0
    yield Number(
        f"{case.name}, depth RMS", result.depth_rms_m * 1e3, "mm", standard_error=max(error_m, 0.0) * 1e3
    )
    yield Number(f"{case.name}, error over bound", result.efficiency, "", standard_error=1 / math.sqrt(6 * n))


def _at(pixel: np.ndarray) -> str:
    return f"({pixel[0]:.0f}, {pixel[1]:.0f})"
