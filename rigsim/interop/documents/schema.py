"""The JSON Schemas of docs/schema, made from the documents' own types."""

from __future__ import annotations

from typing import Any

from rigsim.interop.documents.base import Part
from rigsim.interop.documents.calc import (
    CalcDepthDocument,
    CalcLimitsDocument,
    CalcMotionDocument,
    CalcPointDocument,
)
from rigsim.interop.documents.calibrate.pictures_models import PicturesDocument
from rigsim.interop.documents.calibrate.plan_models import PlanDocument
from rigsim.interop.documents.compare import CompareDocument
from rigsim.interop.documents.design.models import DesignDocument
from rigsim.interop.documents.export import ExportDatasetDocument, ExportRigDocument
from rigsim.interop.documents.infer import InferDocument
from rigsim.interop.documents.listings import (
    DoctorDocument,
    PresetDocument,
    PresetsDocument,
    ScenesDocument,
)
from rigsim.interop.documents.measure.models import MeasureDocument
from rigsim.interop.documents.points import CalcPointsDocument
from rigsim.interop.documents.render import RenderDocument
from rigsim.interop.documents.rig import RigDocument
from rigsim.interop.documents.sweep import SweepDocument
from rigsim.interop.documents.tolerance.models import ToleranceDocument
from rigsim.interop.documents.verify import VerifyDocument

DRAFT = "https://json-schema.org/draft/2020-12/schema"

DOCUMENTS: dict[str, tuple[str, type[Part]]] = {
    "sweep": ("rigsim sweep --json", SweepDocument),
    "design": ("rigsim design --json", DesignDocument),
    "tolerance": ("rigsim tolerance --json", ToleranceDocument),
    "calibrate-plan": ("rigsim calibrate plan --json", PlanDocument),
    "calibrate-pictures": ("rigsim calibrate pictures --json", PicturesDocument),
    "rig": ("rigsim rig --json", RigDocument),
    "infer": ("rigsim infer --json", InferDocument),
    "verify": ("rigsim verify --json", VerifyDocument),
    "compare": ("rigsim compare --json", CompareDocument),
    "calc-point": ("rigsim calc point --json", CalcPointDocument),
    "calc-points": ("rigsim calc points --json", CalcPointsDocument),
    "calc-depth": ("rigsim calc depth --json", CalcDepthDocument),
    "calc-limits": ("rigsim calc limits --json", CalcLimitsDocument),
    "calc-motion": ("rigsim calc motion --json", CalcMotionDocument),
    "render": ("rigsim render --json", RenderDocument),
    "measure": ("rigsim measure --json", MeasureDocument),
    "export-rig": ("rigsim export rig --json", ExportRigDocument),
    "export-dataset": ("rigsim export dataset --json", ExportDatasetDocument),
    "scenes": ("rigsim scenes --json", ScenesDocument),
    "presets": ("rigsim presets --json", PresetsDocument),
    "preset": ("rigsim presets NAME --json", PresetDocument),
    "doctor": ("rigsim doctor --json", DoctorDocument),
}
"""Name of the schema: the command that prints such a document, and its type."""


def schema(name: str) -> dict[str, Any]:
    """The JSON Schema, draft 2020-12, of the document called `name` in `DOCUMENTS`.

    Every key is required, and no other is allowed.
    """
    command, document = DOCUMENTS[name]
    made = _brief(document.model_json_schema())
    return {"$schema": DRAFT, "title": command, **made}


def _brief(node: Any) -> Any:
    """Without the titles that only repeat a key or a class (`title` is never a key of a document), and with
    one list of types where simple types stand beside each other."""
    if isinstance(node, list):
        return [_brief(item) for item in node]
    if not isinstance(node, dict):
        return node
    brief = {key: _brief(item) for key, item in node.items() if key != "title"}
    if all(item.keys() == {"type"} for item in brief.get("anyOf", [{}])):
        brief = {"type": [item["type"] for item in brief.pop("anyOf")], **brief}
    return brief
