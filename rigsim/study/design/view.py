"""What is odd about the view that a design was asked for."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from rigsim.rig.remark import Remark
from rigsim.study.design import words as words
from rigsim.study.design.solve import Candidate, Design

_NARROW_RAD = math.radians(30)
_VIEWS = ("fov", "vfov", "cover", "cover_height")


def view_remarks(design: Design, pick: Candidate, covers_far: bool) -> Iterator[Remark]:
    """Where nobody asked what must be seen and a long lens won; where what is to be covered is taken to be
    asked for at the far end (`covers_far`), where most is seen, and is not covered at the near one."""
    spec = design.specification
    asked = [one for one in spec.requirements if one.kind in _VIEWS]
    lenses = {round(one.camera.hfov_rad, 6) for one in design.intervals}
    if not asked and len(lenses) > 1 and pick.camera.hfov_rad < _NARROW_RAD:
        yield Remark(
            "narrow_view",
            f"the rig sees {math.degrees(pick.camera.hfov_rad):.3g}° across: no field of view was asked for, "
            "and long lenses measure best; --fov or --cover say what must be seen",
        )
    for one in asked:
        if covers_far and one.kind == "cover":
            near = replace(one, depth_m=spec.near_m)
            seen = near.achieved(pick.camera, pick.baseline_m, spec.disparity_std_px)
            if not near.is_met(seen):
                yield Remark(
                    "covered_far",
                    f"coverage of {words.size(one.limit)} is asked for at the far end, "
                    f"{words.distance(spec.far_m)}; at {words.distance(spec.near_m)} both cameras see "
                    f"{words.size(seen)}: --cover WxH@{spec.near_m:.4g}m asks for it there",
                )
