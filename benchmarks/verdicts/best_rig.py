"""The best rig of a sweep in five open scenes, against an answer found by brute force.

The brute force shares nothing with the sweep but MuJoCo's rays: every third pixel of every rig's left image
is cast on its own, the scene's geometry and the cameras are set up here, pixels are disturbed and
triangulated here by the textbook formula. The definition is the one that docs/explanation/verdicts.md
states, over the same world points instead of bins of depth: among the rigs that keep 80 % of the best
coverage, the one with the smallest RMS depth error per pixel over points that all of them see with Z /
sigma_Z >= 4.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
import numpy.typing as npt

from rigsim import Intrinsics, PixelNoise, Plan, RigGrid, StereoRig, sweep

Array = npt.NDArray[np.float64]

_NOISE_PX = 0.25
_TRIALS = 60
_WIDTH, _HEIGHT = 320, 240
_SKY = """<asset>
  <texture type="skybox" builtin="gradient" rgb1=".4 .6 .9" rgb2="1 1 1" width="64" height="64"/>
</asset>"""
_FLOOR = '<geom name="floor" type="plane" size="0 0 .1"/>'
_TREES = "".join(
    f'<geom type="cylinder" pos="{x} {y} 1" size=".12 1"/>'
    for x, y in ((2, 0.5), (3, -0.7), (4, 1.2), (6, -1.5), (8, 2.2), (12, -3), (16, 3.5))
)
_TWINS = "".join(
    f'<geom type="box" pos="{x} {y} .5" size=".2 .3 .5" group="{group}" contype="{contype}"/>'
    for x, y in ((1.5, 0.4), (2.5, -0.6), (4, 0.8), (7, -1.0))
    for group, contype in ((2, 0), (1, 1))
)


@dataclass(frozen=True)
class Case:
    """An open scene and what is swept in it; the rig sits at `eye` and looks along +X."""

    name: str
    world: str
    eye: tuple[float, float, float]
    mount: str
    baselines_mm: tuple[float, ...]
    hfovs_deg: tuple[float, ...] = (70.0,)
    before: str = ""
    own: str = ""


CASES = (
    Case(
        "infinite floor",
        f'<site name="rig" pos="0 0 1.2"/>{_FLOOR}{_TREES}',
        (0, 0, 1.2),
        "site:rig",
        (50, 100, 200, 400, 800, 1600, 3200),
    ),
    Case(
        "skybox",
        f'<site name="rig" pos="0 0 1.2"/>{_TREES}<geom type="box" pos="3 0 .05" size="2 2 .05"/>',
        (0, 0, 1.2),
        "site:rig",
        (30, 60, 120, 240, 480, 960),
        before=_SKY,
    ),
    Case(
        "mount in a body",
        '<body name="head" pos="0 0 1.5"><geom name="skull" type="sphere" size=".12"/></body>'
        f"{_FLOOR}{_TREES}",
        (0, 0, 1.5),
        "body:head",
        (40, 80, 120, 160),
        (50.0, 80.0, 110.0),
        own="skull",
    ),
    Case(
        "twins",
        f'<site name="rig" pos="0 0 1"/>{_FLOOR}{_TWINS}',
        (0, 0, 1),
        "site:rig",
        (60, 120, 240, 480, 960),
    ),
    Case(
        "far wall",
        '<site name="rig" pos="0 0 2"/>'
        f'<geom type="box" pos="60 0 5" size=".5 200 20" euler="0 0 20"/>{_FLOOR}',
        (0, 0, 2),
        "site:rig",
        (50, 150, 450, 1350),
        (40.0, 70.0),
    ),
)


def run() -> None:
    """Print both answers for each scene, and in how many they are the same."""
    same = 0
    print(f"{'scene':17}{'rigs':>5}  {'sweep says':>18}  {'brute force says':>18}  same")
    for case in CASES:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "open.xml"
            path.write_text(_xml(case))
            said = swept(case, path)
        found = brute_force(case)
        same += said == found
        print(
            f"{case.name:17}{len(case.baselines_mm) * len(case.hfovs_deg):5}  {_words(said):>18}  "
            f"{_words(found):>18}  {'yes' if said == found else 'NO'}",
            flush=True,
        )
    print(f"the same best rig in {same} of {len(CASES)} scenes")


def swept(case: Case, path: Path) -> tuple[float, float]:
    """(baseline mm, hfov deg) that `sweep` calls best."""
    lens = Intrinsics.from_hfov(_WIDTH, _HEIGHT, case.hfovs_deg[0])
    grid = RigGrid(
        StereoRig.rectified(lens, 0.1),
        baselines_m=[b / 1e3 for b in case.baselines_mm],
        hfovs_deg=case.hfovs_deg if len(case.hfovs_deg) > 1 else (),
    )
    plan = Plan(
        scene=str(path),
        mount=case.mount,
        noises=(PixelNoise(_NOISE_PX),),
        renderer="rays",
        measure="none",
        supersample=1,
        n_points=1000,
        n_trials=_TRIALS,
    )
    result = sweep(grid, plan)
    best = result.rows.iloc[result.best[0]]
    return round(best["baseline_mm"], 6), round(best["hfov_deg"], 6)


def brute_force(case: Case) -> tuple[float, float]:
    """The same by dense rays: world points of all rigs' images, seen by all rigs that cover enough."""
    model = mujoco.MjModel.from_xml_string(_xml(case))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    if case.own:
        # the rig sits inside: what is around the cameras is no part of what they see
        model.geom(case.own).group = 5
    rigs = [(b / 1e3, h) for h in case.hfovs_deg for b in case.baselines_mm]
    points, covered = [], []
    for rig in rigs:
        own, seen = _dense(model, data, case, rig)
        points.append(own)
        covered.append(seen)
    enough = [i for i, seen in enumerate(covered) if seen >= 0.8 * max(covered)]
    pool = np.concatenate([points[i] for i in enough])
    both = np.ones(len(pool), dtype=bool)
    for i in enough:
        both &= _answers(model, data, case, rigs[i], pool)
    rng = np.random.default_rng(7)
    errors = [_rms(case, rigs[i], pool[both], rng) for i in enough]
    baseline_m, hfov = rigs[enough[int(np.argmin(errors))]]
    return round(baseline_m * 1e3, 6), hfov


def _dense(
    model: mujoco.MjModel, data: mujoco.MjData, case: Case, rig: tuple[float, float]
) -> tuple[Array, float]:
    """World points that a third of the left pixels in each direction show, and the share that both see."""
    f = _WIDTH / 2 / np.tan(np.radians(rig[1]) / 2)
    v, u = (part.ravel() for part in np.mgrid[:_HEIGHT:3, :_WIDTH:3])
    # x forward, y left, z up
    rays = np.column_stack([np.ones(u.size), -(u - (_WIDTH - 1) / 2) / f, -(v - (_HEIGHT - 1) / 2) / f])
    left = np.add(case.eye, (0, rig[0] / 2, 0))
    hits = _cast(model, data, left, rays)
    hits[hits > _reach(case)] = np.nan
    points = left + rays[np.isfinite(hits)] * hits[np.isfinite(hits), None]
    return points, float(_sees(model, data, case, rig, points, -1).mean())


def _reach(case: Case) -> float:
    """Beyond this no rig of the case has Z / sigma_Z of 4."""
    f = _WIDTH / 2 / np.tan(np.radians(min(case.hfovs_deg)) / 2)
    return float(f * max(case.baselines_mm) / 1e3 / (4 * np.sqrt(2) * _NOISE_PX))


def _answers(
    model: mujoco.MjModel, data: mujoco.MjData, case: Case, rig: tuple[float, float], points: Array
) -> npt.NDArray[np.bool_]:
    f = _WIDTH / 2 / np.tan(np.radians(rig[1]) / 2)
    depth = points[:, 0] - case.eye[0]
    certain = f * rig[0] / depth >= 4 * np.sqrt(2) * _NOISE_PX
    certain &= _sees(model, data, case, rig, points, 1) & _sees(model, data, case, rig, points, -1)
    return np.asarray(certain)


def _sees(
    model: mujoco.MjModel, data: mujoco.MjData, case: Case, rig: tuple[float, float], points: Array, side: int
) -> npt.NDArray[np.bool_]:
    """Whether the left (1) or right (-1) camera sees each world point."""
    f = _WIDTH / 2 / np.tan(np.radians(rig[1]) / 2)
    eye = np.add(case.eye, (0, side * rig[0] / 2, 0))
    x, y, z = (points - eye).T
    inside = (x > 0) & (np.abs(y / x * f) <= _WIDTH / 2) & (np.abs(z / x * f) <= _HEIGHT / 2)
    # the ray goes to the point at 1
    hits = _cast(model, data, eye, points - eye)
    return np.asarray(inside & ~(hits < 1 - 1e-6))


def _cast(model: mujoco.MjModel, data: mujoco.MjData, eye: Array, rays: Array) -> Array:
    groups = np.array([1, 1, 1, 1, 1, 0], dtype=np.uint8)
    geom = np.zeros(1, dtype=np.int32)
    length = np.linalg.norm(rays, axis=1)
    found = np.empty(len(rays))
    for i, ray in enumerate(rays):
        found[i] = mujoco.mj_ray(model, data, eye, ray / length[i], groups, 1, -1, geom)
    return np.where(found < 0, np.nan, found / length)


def _rms(case: Case, rig: tuple[float, float], points: Array, rng: np.random.Generator) -> float:
    f = _WIDTH / 2 / np.tan(np.radians(rig[1]) / 2)
    depth = points[:, 0] - case.eye[0]
    shift = rng.normal(0, _NOISE_PX, (_TRIALS, len(depth))) - rng.normal(0, _NOISE_PX, (_TRIALS, len(depth)))
    found = f * rig[0] / (f * rig[0] / depth + shift)
    return float(np.sqrt(np.mean((found - depth) ** 2)))


def _xml(case: Case) -> str:
    return f"<mujoco>{case.before}<worldbody>{case.world}</worldbody></mujoco>"


def _words(rig: tuple[float, float]) -> str:
    return f"{rig[0]:g} mm, {rig[1]:g} deg"
