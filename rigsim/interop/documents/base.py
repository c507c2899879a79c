"""What every document is made of."""

from __future__ import annotations

import math

from pydantic import BaseModel, ConfigDict, Field

from rigsim.interop.documents.text import clean
from rigsim.rig.stereo import StereoRig


class Part(BaseModel):
    """An object with fixed keys; the docstrings of its keys become the schema's descriptions."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, use_attribute_docstrings=True, populate_by_name=True
    )


class RemarkPart(Part):
    """What a person should know beside the answer."""

    code: str
    """Short name, snake_case."""
    text: str
    """One sentence: the value, why it is odd, and the way out."""


class Rig(Part):
    """A rig in short."""

    baseline_mm: float = Field(gt=0)
    """Distance between the cameras, mm."""
    focal_px: float = Field(gt=0)
    """Focal length of the left camera, px."""
    width_px: int = Field(gt=0)
    """Image width, px."""
    height_px: int = Field(gt=0)
    """Image height, px."""


class SeenRig(Rig):
    """A rig with its field of view."""

    hfov_deg: float = Field(gt=0, lt=180)
    """Horizontal field of view of the left camera, degrees."""


class Versions(Part):
    """Versions of what made the numbers."""

    rigsim: str
    """Version of rigsim."""
    mujoco: str
    """Version of MuJoCo."""
    numpy: str
    """Version of NumPy."""
    scipy: str
    """Version of SciPy."""
    pandas: str
    """Version of pandas."""
    matplotlib: str
    """Version of Matplotlib."""
    python: str
    """Version of Python."""


class Provenance(Versions):
    """What made the numbers: versions, renderer and scene."""

    renderer: str
    """What rendered: rays, or the GL library's own name for itself."""
    scene: str
    """Name of the scene."""
    mount: str
    """Where the rig sits in it."""


class Written(Part):
    """What was written to disk."""

    folder: str
    """The folder, as --out names it."""
    files: list[str]
    """Names of the files written there, sorted."""


def finite(value: float) -> float | None:
    """A number; None for what is none or has no bound."""
    return float(value) if math.isfinite(value) else None


def plain_rig(rig: StereoRig) -> Rig:
    """A rig's numbers, without a field of view."""
    return Rig(
        baseline_mm=rig.baseline_m * 1e3,
        focal_px=rig.left.fx,
        width_px=rig.left.width,
        height_px=rig.left.height,
    )


def seen_rig(rig: StereoRig) -> SeenRig:
    """A rig's numbers."""
    return SeenRig(
        baseline_mm=clean(rig.baseline_m * 1e3),
        focal_px=clean(rig.left.fx),
        width_px=rig.left.width,
        height_px=rig.left.height,
        hfov_deg=clean(rig.left.hfov_deg),
    )
