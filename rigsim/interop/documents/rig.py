"""What `rigsim rig --json` prints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

from pydantic import Field

from rigsim.interop.documents.base import Part, RemarkPart
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.remark import Remark
from rigsim.study.rig.facts import RigFacts, model_of


class RigCamera(Part):
    """One camera."""

    model: str
    """Its lens model: pinhole, brown, rational, kannala_brandt, mei, double_sphere, eucm or fov."""
    width_px: int = Field(gt=0)
    """Image width, px."""
    height_px: int = Field(gt=0)
    """Image height, px."""
    fx_px: float = Field(gt=0)
    """Focal length along u, px, as the lens model counts it."""
    fy_px: float = Field(gt=0)
    """The same along v, px."""
    cx_px: float
    """Principal point u, px; integers are pixel centres."""
    cy_px: float
    """Principal point v, px."""
    hfov_deg: float
    """What the lens shows in the principal point's row, deg."""
    vfov_deg: float
    """What it shows in the principal point's column, deg."""


class RigOverlap(Part):
    """What both cameras see at one distance."""

    z_m: float
    """Distance along the left camera's optical axis, m."""
    share: float
    """Share of the left picture that the right one shows too, 0 to 1."""


class RigDocument(Part):
    """What a rig is, and what is odd about it."""

    format: str
    """The format that its files are of; ``preset`` of a rig by name."""
    files: list[str]
    """Its files; none of a rig by name."""
    baseline_mm: float = Field(gt=0)
    """Distance between the cameras, mm."""
    arrangement: Literal["horizontal", "vertical", "diagonal"]
    """How the cameras lie to each other, in the left picture's directions."""
    vergence_deg: float
    """Angle between the optical axes across, deg; positive when they meet in front."""
    pitch_deg: float
    """By which the right camera looks further up than the left one, deg."""
    roll_deg: float
    """By which it is turned clockwise against it, as it looks, deg."""
    rectified: bool
    """Whether the axes are parallel, the lenses equal and without distortion, and the rows correspond."""
    doffs_px: float | None
    """``cx_right - cx_left``, px; null where it is not rectified."""
    left: RigCamera
    right: RigCamera
    overlap: list[RigOverlap]
    """One for each distance."""
    remarks: list[RemarkPart]
    """What is odd about it; also on standard error."""


def rig_document(
    facts: RigFacts, format: str, files: Sequence[str], remarks: Sequence[Remark]
) -> dict[str, Any]:
    """The document that ``rigsim rig --json`` prints; docs/reference/rig.md describes it."""
    rig = facts.rig
    return RigDocument(
        format=format,
        files=list(files),
        baseline_mm=rig.baseline_m * 1e3,
        arrangement=facts.arrangement,
        vergence_deg=facts.vergence_deg,
        pitch_deg=facts.pitch_deg,
        roll_deg=facts.roll_deg,
        rectified=rig.is_rectified,
        doffs_px=facts.doffs_px,
        left=_camera(rig.left),
        right=_camera(rig.right),
        overlap=[RigOverlap(z_m=z_m, share=share) for z_m, share in facts.overlap],
        remarks=[RemarkPart(code=remark.code, text=remark.text) for remark in remarks],
    ).model_dump()


def _camera(camera: Intrinsics) -> RigCamera:
    return RigCamera(
        model=model_of(camera),
        width_px=camera.width,
        height_px=camera.height,
        fx_px=camera.fx,
        fy_px=camera.fy,
        cx_px=camera.cx,
        cy_px=camera.cy,
        hfov_deg=camera.hfov_deg,
        vfov_deg=camera.vfov_deg,
    )
