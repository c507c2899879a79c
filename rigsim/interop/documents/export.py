"""What `rigsim export rig --json` and `rigsim export dataset --json` print."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict
from typing import Annotated, Any

from pydantic import AfterValidator, Field

from rigsim.interop.documents.base import Part, Provenance, RemarkPart, SeenRig, Written, seen_rig
from rigsim.interop.documents.text import clean
from rigsim.interop.formats.registry import RIG_FORMATS
from rigsim.interop.layouts.registry import BY_NAME as LAYOUTS
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig


def _one_of(known: Mapping[str, object]) -> tuple[Any, Any]:
    """What makes a field take the names of a registry alone, and its schema list them."""

    def check(name: str) -> str:
        if name not in known:
            raise ValueError(f"{name!r}: must be one of {', '.join(known)}")
        return name

    return AfterValidator(check), Field(json_schema_extra={"enum": list(known)})


_RigFormat = Annotated[str, *_one_of(RIG_FORMATS)]
_Layout = Annotated[str, *_one_of(LAYOUTS)]


class ExportedRig(SeenRig):
    """A rig with what a format may be unable to hold."""

    rectified: bool
    """Whether it is rectified."""
    doffs_px: float
    """cx_right - cx_left, px."""
    distorted: bool
    """Whether a lens distorts."""


class ExportRigDocument(Part):
    """A rig as another program's calibration files."""

    command: str
    """The command that was typed."""
    format: _RigFormat
    """Whose files they are."""
    rig: ExportedRig
    remarks: list[RemarkPart]
    """What is odd about the rig, and what its lenses were approximated by; also on standard error."""
    written: Written
    """The files; their folder can be given to --rig."""


class ExportDatasetDocument(Part):
    """A data set of rendered stereo pairs with their truth."""

    command: str
    """The command that was typed."""
    format: _Layout
    """Whose layout it has."""
    rig: ExportedRig
    frames: int = Field(gt=0)
    """How many stereo pairs."""
    move_mm: float | None
    """Farthest move off the mount along each axis, mm; null for 5 % of the depth there."""
    turn_deg: float
    """Farthest turn off the mount about each axis, degrees."""
    seed: int
    """Seed of the viewpoints and the noise."""
    remarks: list[RemarkPart]
    """What is odd about the scene or the rig's place in it; also on standard error."""
    provenance: Provenance
    written: Written
    """The files, with their folders; the data set's own folder can be given to --rig."""


def export_rig_document(
    command: str, format: str, rig: StereoRig, written: Written, remarks: Iterable[Remark] = ()
) -> dict[str, Any]:
    """A rig that was written as calibration files."""
    document = ExportRigDocument.model_validate(
        {
            "command": command,
            "format": format,
            "rig": _rig(rig),
            "remarks": [asdict(remark) for remark in remarks],
            "written": written,
        }
    )
    return document.model_dump()


def export_dataset_document(
    command: str, format: str, rig: StereoRig, views: Mapping[str, Any], written: Written
) -> dict[str, Any]:
    """A data set that was written; `views` are its frames, where they were taken from, and provenance."""
    document = ExportDatasetDocument.model_validate(
        {"command": command, "format": format, "rig": _rig(rig), **views, "written": written}
    )
    return document.model_dump()


def _rig(rig: StereoRig) -> ExportedRig:
    return ExportedRig(
        **seen_rig(rig).model_dump(),
        rectified=rig.is_rectified,
        doffs_px=clean(rig.doffs_px),
        distorted=any(lens.lens is not None for lens in (rig.left, rig.right)),
    )
