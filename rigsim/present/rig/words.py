"""A rig in a sentence."""

from __future__ import annotations

from collections.abc import Sequence

from rigsim.present.kit.format import length
from rigsim.rig.remark import Remark
from rigsim.study.rig.facts import RigFacts, model_of


def sentence(facts: RigFacts, format: str, remarks: Sequence[Remark]) -> str:
    """What the rig is, whose format says so, and how much is odd about it."""
    rig = facts.rig
    models = list(dict.fromkeys(model_of(camera) for camera in (rig.left, rig.right)))
    sizes = list(dict.fromkeys(f"{camera.width}x{camera.height}" for camera in (rig.left, rig.right)))
    odd = {0: "nothing odd", 1: "1 remark"}.get(len(remarks), f"{len(remarks)} remarks")
    return (
        f"{format}: a {facts.arrangement} pair, {'' if rig.is_rectified else 'not '}rectified, "
        f"baseline {length(rig.baseline_m)}, {' and '.join(models)} lenses, {' and '.join(sizes)} px; {odd}."
    )
