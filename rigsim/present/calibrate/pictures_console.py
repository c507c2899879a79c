"""A calibration from pictures in a terminal."""

from __future__ import annotations

import shlex
from pathlib import Path

from rigsim.present.calibrate.pictures_words import (
    VERDICTS,
    depth_sentence,
    headline,
    next_words,
    noise_sentence,
    opencv_sentence,
    picture_words,
)
from rigsim.present.calibrate.words import parameter_head
from rigsim.present.kit.console import make_console, paragraph, print_table
from rigsim.present.kit.format import number, plain, with_error
from rigsim.study.calibrate.pictures.result import CalibratedPictures
from rigsim.theory.calibration.parameters import CAMERA

_PICTURE_HEADS = ("pair", "corners\nleft right", "rms\npx", "over\npredicted", "", "")
_DEPTH_HEADS = ("distance\nm", "where", "calib-\nration", "pixel\nnoise", "both")


def print_pictures(result: CalibratedPictures, folder: Path | None = None) -> None:
    """Print the answer, every pair, the parameters, the depths, and what to do next."""
    console = make_console()
    paragraph(console, headline(result), style="bold")
    for sentence in (noise_sentence(result), opencv_sentence(result), depth_sentence(result)):
        paragraph(console, sentence)
    console.print()
    print_table(
        "Pairs: residual, and over what a rig from the others predicts (1 is right)",
        *(_PICTURE_HEADS, picture_rows(result)),
        numeric=(False, True, True, True, False, False),
    )
    print_table(
        "Cameras, with standard deviations",
        ("", "left", "right"),
        camera_rows(result),
        numeric=(False, True, True),
    )
    print_table(
        "Right camera in the left one's frame",
        ("", "", "unit"),
        pose_rows(result),
        numeric=(False, True, False),
    )
    print_table(
        "Depth std, mm: from calibration, from pixel noise, and from both",
        *(_DEPTH_HEADS, depth_rows(result)),
        numeric=(True, False, True, True, True),
    )
    if said := next_words(result):
        paragraph(console, said)
        console.print()
    if folder is not None:
        console.print(f"Files: {folder}", soft_wrap=True)
        rig, covariance = (shlex.quote(str(folder / name)) for name in ("rig.toml", "covariance.json"))
        paragraph(
            console,
            f"Next: `rigsim export rig --rig {rig} --format opencv` (or kalibr, ros, ...) writes it for other"
            f" programs; `rigsim tolerance --class {covariance}` counts what it leaves.",
        )


def picture_rows(result: CalibratedPictures) -> list[tuple[str, ...]]:
    """Rows of the table of pairs."""
    return [
        (
            check.name,
            f"{check.corners[0]:4d} {check.corners[1]:4d}",
            number(check.rms_px),
            number(check.ratio),
            VERDICTS[check.verdict],
            picture_words(check),
        )
        for check in result.pictures
    ]


def camera_rows(result: CalibratedPictures) -> list[tuple[str, str, str]]:
    """Rows of the table of both cameras' numbers."""
    std = dict(zip(result.covariance.names, result.covariance.std, strict=True))
    lens = result.covariance.parameters.lenses[0]
    rows = []
    for name in (*CAMERA, *(() if lens is None else lens.names())):
        cells = []
        for side, camera in (("left", result.rig.left), ("right", result.rig.right)):
            value = getattr(camera, name) if name in CAMERA else getattr(camera.lens, name, 0.0)
            held = std[f"{side}.{name}"] == 0
            cells.append(f"{plain(value)} held" if held else with_error(value, std[f"{side}.{name}"]))
        head = f"{name}, px" if name in CAMERA else name
        if not all(cell == "0 held" for cell in cells):
            rows.append((head, cells[0], cells[1]))
    return rows


def pose_rows(result: CalibratedPictures) -> list[tuple[str, str, str]]:
    """Rows of the table of the pose."""
    pose, covariance = result.rig.right_from_left, result.covariance
    rows = []
    values = (*pose.rotvec_rad, *pose.t)
    for k, name in enumerate(covariance.parameters.names[covariance.parameters.pose]):
        scale, unit = (180 / 3.141592653589793, "deg") if k < 3 else (1e3, "mm")
        std = covariance.std[covariance.parameters.pose][k]
        rows.append((_pose_head(name), with_error(scale * values[k], scale * std), unit))
    return rows


def _pose_head(name: str) -> str:
    own = name.partition("_")[0]
    return parameter_head(name) if own.startswith("r") else f"{own[1:]} shift"


def depth_rows(result: CalibratedPictures) -> list[tuple[str, ...]]:
    """Rows of the table of depths, mm."""
    rows, before = [], float("nan")
    for row in result.depths:
        values = (row.calibration_m, row.observation_m, row.joint_m)
        head = "" if row.z_m == before else plain(row.z_m)
        rows.append((head, row.place, *(number(value * 1e3) for value in values)))
        before = row.z_m
    return rows
