"""Row misalignment by formula against projection, all quantities; yields within it by brute force."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from rigsim.pixels.dense.rectify import Rectification, rectify
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.perturbation import Perturbation
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance.classes import CLASSES
from rigsim.study.tolerance.count import count_good
from rigsim.study.tolerance.inputs import QUANTITIES, BuildRequirement, Tolerances, causes
from rigsim.study.tolerance.recalibration.session import Build
from rigsim.study.tolerance.rows import first_order_rows
from rigsim.study.tolerance.sensitivities import shared_points

_LENS = Intrinsics.from_focal(1280, 720, 900.0)
_BENT = replace(_LENS, lens=BrownConrady(k1=-0.12, k2=0.03, p1=0.001, p2=-0.0015))
_OTHER = replace(_BENT, fx=905.0, fy=901.0, cx=652.0, cy=351.0)
RIGS = {
    "rectified": StereoRig.rectified(_LENS, 0.12),
    "verged by 10 deg": StereoRig.verged(_LENS, 0.12, 10.0),
    "distorted": StereoRig.rectified(_BENT, 0.12),
    "all of it, unequal": StereoRig.verged(_BENT, 0.12, 6.0, right=_OTHER),
}
SMALL = {
    "yaw_deg": 0.01,
    "pitch_deg": 0.01,
    "roll_deg": 0.01,
    "baseline_mm": 0.03,
    "axial_mm": 0.03,
    "vertical_mm": 0.03,
    "right_focal_px": 0.57,
    "both_focal_px": 0.57,
    "right_cx_px": 0.35,
    "right_cy_px": 0.19,
    "right_k1": 8e-4,
    "both_k1": 8e-4,
    "left_focal_px": 0.57,
    "left_cx_px": 0.35,
    "left_cy_px": 0.19,
    "left_k1": 8e-4,
    "time_offset_ms": 0.1,
    "temperature_k": 5.0,
}
"""About what class ``calibrated`` leaves of each, in the key's unit."""
_MM, _DEG = 1e-3, np.pi / 180


def run() -> None:
    """Print the tables."""
    print("3 mm of vertical shift at 1 m, 900 px                                     (2.7 px)")
    shifted = first_order_rows(
        RIGS["rectified"],
        causes(RIGS["rectified"], Tolerances(vertical_mm=3.0)),
        shared_points(RIGS["rectified"], 1.0, 60),
    )
    print(f"  by formula, off by at most {np.abs(np.abs(shifted) - 2.7).max():.1e} px")
    print("largest difference of formula and projection over image, 1 to 5 m, px     (limit 1e-3)")
    worst_of_all = 0.0
    for kind, rig in RIGS.items():
        found = {key: difference_px(rig, key, SMALL[key]) for key in QUANTITIES}
        largest, key = max((off_px, key) for key, off_px in found.items())
        worst_of_all = max(worst_of_all, largest)
        print(f"  {kind:20} {len(found)} quantities, worst {largest:.1e} ({key})")
    print(f"  all {worst_of_all:.1e}")
    print("share of rigs as built within a row misalignment: count against brute force (limit 3 points)")
    for kind in ("rectified", "all of it, unequal"):
        for name, limit_px in (("calibrated", 0.35), ("machined", 5.0)):
            ours, brute = yields(RIGS[kind], name, limit_px)
            print(f"  {kind:20}{name:12}{limit_px:5g} px {100 * ours:6.1f} % {100 * brute:6.1f} %")


def difference_px(rig: StereoRig, key: str, amount: float) -> float:
    """Largest difference between the formula and rectified projections, px."""
    worst = 0.0
    off = causes(rig, replace(Tolerances(), **{key: amount}))
    rectified = rectify(rig)
    for depth_m in (1.0, 2.0, 5.0):
        points = shared_points(rig, depth_m, 200)
        formula = first_order_rows(rig, off, points)[:, 0]
        seen = rows_px(rectified, built(rig, {key: amount}), points)
        worst = max(worst, float(np.abs(seen - formula).max()))
    return worst


def rows_px(assumed: Rectification, true: StereoRig, points: Array) -> Array:
    """Right row minus left row (n,) px of what `true` sees, in the pair that is rectified as assumed."""
    rows = []
    for uv, camera, turn in zip(
        true.project(points),
        (assumed.source.left, assumed.source.right),
        (assumed.rectified_from_left, assumed.rectified_from_right),
        strict=True,
    ):
        rays = np.column_stack([camera.normalize(uv), np.ones(len(uv))]) @ turn.T
        rows.append(assumed.rig.left.fy * rays[:, 1] / rays[:, 2])
    return np.asarray(rows[1] - rows[0])


def built(rig: StereoRig, amounts: dict[str, float]) -> StereoRig:
    """The rig that is off by these amounts, one after the other."""
    for key, amount in amounts.items():
        rig = _off_by(rig, key, amount)
    return rig


def _off_by(rig: StereoRig, key: str, amount: float) -> StereoRig:
    name = key.rpartition("_")[0]
    match key:
        case "yaw_deg" | "pitch_deg" | "roll_deg":
            return Perturbation(**{f"{name}_rad": amount * _DEG}).apply(rig)
        case "baseline_mm" | "axial_mm" | "vertical_mm":
            return Perturbation(**{f"{name}_m": amount * _MM}).apply(rig)
        case "time_offset_ms":  # at 1 m/s
            return Perturbation(baseline_m=-amount * 1e-3).apply(rig)
        case "temperature_k":
            return Perturbation(baseline_m=amount * 23e-6 * rig.baseline_m).apply(rig)
        case "both_focal_px":
            share = 1 + amount / rig.left.fx
            longer = (replace(lens, fx=lens.fx * share, fy=lens.fy * share) for lens in (rig.left, rig.right))
            return StereoRig(*longer, rig.right_from_left)
        case "both_k1" | "left_k1" | "right_k1":
            return _with_k1(rig, name, amount)
    side, what = key.split("_", 1)
    lens = rig.left if side == "left" else rig.right
    if what == "focal_px":
        # in proportion, as fx is what is told; the right one's fx and fy grow by the same
        taller = amount * lens.fy / lens.fx if side == "left" else amount
        lens = replace(lens, fx=lens.fx + amount, fy=lens.fy + taller)
    else:
        lens = replace(lens, **{what.removesuffix("_px"): getattr(lens, what.removesuffix("_px")) + amount})
    left, right = (lens, rig.right) if side == "left" else (rig.left, lens)
    return StereoRig(left, right, rig.right_from_left)


def _with_k1(rig: StereoRig, which: str, amount: float) -> StereoRig:
    cameras = []
    for side, lens in (("left", rig.left), ("right", rig.right)):
        bent = lens.lens or BrownConrady()
        more = amount if which in (side, "both") else 0.0
        cameras.append(replace(lens, lens=replace(bent, k1=bent.k1 + more)))
    return StereoRig(*cameras, rig.right_from_left)


def yields(rig: StereoRig, name: str, limit_px: float, n_rigs: int = 2000) -> tuple[float, float]:
    """Share of rigs within `limit_px` at 1 and 5 m as counted, and by building each of `n_rigs`."""
    tolerances = CLASSES[name].tolerances(rig)
    # at 1 m no depth error is too large: rows alone decide
    required = BuildRequirement(0.999, 1.0, row_px=limit_px)
    ours = count_good(Build(rig, tolerances), required, (1.0, 5.0)).share
    rng = np.random.default_rng(1)
    planes = [shared_points(rig, depth_m, 60) for depth_m in (1.0, 5.0)]
    assumed = rectify(rig)
    kept = 0
    for amounts in _drawn(tolerances, n_rigs, rng):
        true = built(rig, amounts)
        largest = max(float(np.sqrt((rows_px(assumed, true, points) ** 2).mean())) for points in planes)
        kept += largest <= limit_px
    return ours, kept / n_rigs


def _drawn(tolerances: Tolerances, n_rigs: int, rng: np.random.Generator) -> Iterator[dict[str, float]]:
    keys = [key for key in QUANTITIES if getattr(tolerances, key) > 0]
    for _ in range(n_rigs):
        yield {
            key: float(
                rng.uniform(-1, 1) * getattr(tolerances, key)
                if tolerances.is_bound(key)
                else rng.normal(0, tolerances.std(key))
            )
            for key in keys
        }
