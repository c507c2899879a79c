"""What is odd about a plan that stands all the same."""

from __future__ import annotations

import math

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.remark import Remark
from rigsim.study.calibrate.plan.asked import PlanAsked
from rigsim.study.calibrate.plan.choose import LEAST_SHARED
from rigsim.study.calibrate.plan.explain import focal_openness, largest_tilt_rad
from rigsim.study.calibrate.plan.reach import ReachedPoses
from rigsim.theory.calibration.covariance import CalibrationCovariance

_LITTLE_TILT_RAD = math.radians(15)
_HARDLY_SURE = 1e-3
"""Of a focal length: what its calibration is well known to reach."""
_SMALL_PART = 0.5
_CELLS = (12, 9)
_MANY = 20
"""Pictures that usually reach all over."""
FEW = 8
"""Pictures among which a bad one stands out."""
_FEW_PLACES = 60


def oddities(
    reached: ReachedPoses, covariance: CalibrationCovariance, asked: PlanAsked
) -> tuple[Remark, ...]:
    """Remarks on the boards that are held."""
    remarks, chosen = [], isinstance(asked.poses, int)
    tilt, open_to = largest_tilt_rad(asked.rig, reached.poses), focal_openness(covariance)
    if tilt < _LITTLE_TILT_RAD and open_to > _HARDLY_SURE:
        remarks.append(
            Remark(
                "little_tilt",
                f"no board is tilted by more than {math.degrees(tilt):.2g} deg: focal lengths stay open"
                f" to {100 * open_to:.2g} %, and distances with them; "
                + ("allow more (`--tilt 40deg`)" if chosen else "tilt some by 30 deg or more, any way"),
            )
        )
    remarks += _small_part(asked, reached)
    if len(reached) < FEW:
        more = f" (`--poses {FEW}`)" if chosen else ""
        remarks.append(
            Remark(
                "few_pictures",
                f"{len(reached)} pictures leave nothing to notice a bad one by: take {FEW} and more{more}",
            )
        )
    shared = int(reached.both.sum())
    if shared < LEAST_SHARED:
        remarks.append(
            Remark(
                "few_shared",
                f"{shared} boards are seen whole by both cameras: how these stand to each other hangs on them"
                f" alone; hold {LEAST_SHARED} and more where both see them",
            )
        )
    return tuple(remarks)


def _small_part(asked: PlanAsked, reached: ReachedPoses) -> list[Remark]:
    """A remark where corners reach little of the pictures."""
    left, right = covered(asked, reached)
    if min(left, right) >= _SMALL_PART:
        return []
    way = "hold boards near rims and corners"
    if isinstance(asked.poses, int):
        near, far = asked.reach.near_m / 2, asked.reach.far_m
        more = f"more pictures (`--poses {_MANY}`) or " if asked.poses < _MANY else ""
        way = f"{more}a board held nearer (`--range {near:.3g}:{far:.3g}m`) or larger would show more of it"
    return [
        Remark(
            "small_part_of_picture",
            f"corners of the {len(reached)} boards reach {100 * left:.0f} % of the left picture and"
            f" {100 * right:.0f} % of the right one: what lenses do in the rest is extrapolated, by a model"
            f" that may not hold there; {way}",
        )
    ]


def little_room(found: int) -> tuple[Remark, ...]:
    """A remark where a board fits both pictures in few places only."""
    if found >= _FEW_PLACES:
        return ()
    return (
        Remark(
            "little_room",
            f"of thousands of places that were tried the board fits both views in {found}: hold it farther"
            " off, or take a smaller one",
        ),
    )


def covered(asked: PlanAsked, reached: ReachedPoses) -> tuple[float, float]:
    """Share of each picture that corners reach: cells of a grid with one in it or beside one in it."""
    uv = reached.poses.project(asked.rig, asked.board)
    sizes = [(camera.width, camera.height) for camera in (asked.rig.left, asked.rig.right)]
    left, right = (_share(uv[reached.seen[:, side], side].reshape(-1, 2), sizes[side]) for side in (0, 1))
    return left, right


def _share(uv: Array, size: tuple[int, int]) -> float:
    cells = np.floor((uv + 0.5) / np.array(size) * np.array(_CELLS)).astype(int)
    cells = np.clip(cells, 0, np.array(_CELLS) - 1)
    hit = np.zeros(_CELLS, dtype=bool)
    hit[cells[:, 0], cells[:, 1]] = True
    return float(hit.mean())
