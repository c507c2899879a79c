"""The terminal's tables of `rigsim rig`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rigsim.present.kit.console import make_console, paragraph, print_table
from rigsim.present.kit.format import number
from rigsim.present.rig.words import sentence
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.remark import Remark
from rigsim.study.rig.facts import RigFacts, model_of


def print_rig(facts: RigFacts, format: str, remarks: Sequence[Remark], folder: Path | None = None) -> None:
    """Print what a rig is, and what is odd about it, on standard output."""
    console = make_console()
    paragraph(console, sentence(facts, format, remarks))
    console.print()
    _print_pair(facts)
    _print_cameras(facts)
    print_table(
        "Overlap",
        ("Z", "share %", "meaning"),
        [
            (f"{z_m:g} m", number(100 * share, 3), "of the left picture, seen by both" if place == 0 else "")
            for place, (z_m, share) in enumerate(facts.overlap)
        ],
        numeric=(True, True, False),
    )
    if remarks:
        print_table(
            "Remarks", ("code", "what is odd, and the way out"), [(item.code, item.text) for item in remarks]
        )
    if folder is not None:
        console.print(f"Files: {folder}", soft_wrap=True)


def _print_pair(facts: RigFacts) -> None:
    rig, none = facts.rig, "–"
    lies = rig.right_from_left.inverse.t * 1e3
    place = f"right camera at {', '.join(number(value) for value in lies)} mm (right, down, forward)"
    rows = [
        ("baseline", number(rig.baseline_m * 1e3), "mm", place),
        ("arrangement", facts.arrangement, "", "of the two, in the left picture's directions"),
        ("vergence", number(facts.vergence_deg), "deg", "+ the axes meet in front"),
        ("relative pitch", number(facts.pitch_deg), "deg", "+ the right camera looks further up"),
        ("relative roll", number(facts.roll_deg), "deg", "+ the right camera is turned clockwise"),
        ("rectified", "yes" if rig.is_rectified else "no", "", "parallel, equal lenses, rows correspond"),
        ("doffs", none if facts.doffs_px is None else number(facts.doffs_px), "px", "cx right - cx left"),
    ]
    print_table("Rig", ("quantity", "value", "unit", "meaning"), rows, numeric=(False, True, False, False))


def _print_cameras(facts: RigFacts) -> None:
    cameras = (("left", facts.rig.left), ("right", facts.rig.right))
    print_table(
        "Cameras",
        ("side", "lens", "image\npx", "fx\npx", "fy\npx", "cx\npx", "cy\npx", "HFOV\ndeg", "VFOV\ndeg"),
        [(name, model_of(camera), *_numbers(camera)) for name, camera in cameras],
        numeric=(False, False, False, *[True] * 6),
    )
    names = list(
        dict.fromkeys(
            name for _, camera in cameras if camera.lens is not None for name in camera.lens.names()
        )
    )
    terms = [(name, *(_term(camera, name) for _, camera in cameras)) for name in names]
    used = [row for row in terms if any(cell.strip("–0") for cell in row[1:])]
    if used:
        print_table("Lens coefficients", ("name", "left", "right"), used, numeric=(False, True, True))


def _term(camera: Intrinsics, name: str) -> str:
    """A coefficient of a camera's lens; a dash where its model has none of that name."""
    value = None if camera.lens is None else getattr(camera.lens, name, None)
    return "–" if value is None else f"{value:.5g}".replace("-", "−")


def _numbers(camera: Intrinsics) -> tuple[str, ...]:
    places = (camera.fx, camera.fy, camera.cx, camera.cy)
    return (
        f"{camera.width}x{camera.height}",
        *(number(value, 5) for value in places),
        number(camera.hfov_deg, 4),
        number(camera.vfov_deg, 4),
    )
