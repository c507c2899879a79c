"""Cases from scenes: truth on real surfaces with real occlusion, and pixels found in rendered pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from rigsim.rig.noise import PixelNoise
from rigsim.rig.presets import PRESETS
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig
from rigsim.sim.simulator import SUPERSAMPLE, Simulator
from rigsim.study.saying import saying
from rigsim.study.scene.pictures import expose_pair
from rigsim.study.scene.third_witness import measure
from rigsim.study.verify.case import Case

NOISE_PX = 0.25
"""Standard deviation per coordinate of the noisy cases, px."""
SENSOR = Sensor(blur_px=0.7, grey_noise=2.0)
"""Lens and sensor that the pictures are taken with: a common one."""

FEWEST_MATCHES = 30
"""With fewer matches the ratio of two errors is a matter of chance."""

Stream = Callable[[str], np.random.Generator]


def scene_rig(scene: str) -> StereoRig:
    """The rig that a bundled scene is made for; that of `boards` for any other."""
    return PRESETS.get(scene, PRESETS["boards"]).rig


def scene_cases(simulator: Simulator, rig: StereoRig, n: int, stream: Stream) -> Iterator[Case]:
    """Exact and noisy projections of what both cameras see of a scene.

    Args:
        simulator: the scene; the rig is placed in it.
        rig: the rig.
        n: truth points to draw; those that one camera hides are left out.
        stream: random stream of a name.

    Raises:
        NothingSeen: the left camera sees nothing.
    """
    scene = simulator.scene.name
    simulator.place(rig)
    truth = simulator.truth(n, stream(f"{scene} truth"))
    points_left = truth.points_left[truth.visible]
    hidden = int((truth.in_right_image & ~truth.visible_right).sum())
    uv_left, uv_right = rig.project(points_left)
    yield Case(
        f"{scene} exact",
        scene,
        "exact",
        saying("surfaces", scene=scene, hidden=hidden, points=len(truth.points_left)),
        rig,
        uv_left,
        uv_right,
        points_left,
    )
    noise = PixelNoise(NOISE_PX)
    noisy_left, noisy_right = noise.apply(uv_left, uv_right, stream(f"{scene} noisy"))
    yield Case(
        f"{scene} noisy",
        scene,
        "noisy",
        saying("surfaces: noisy", scene=scene, noise_px=NOISE_PX),
        rig,
        noisy_left,
        noisy_right,
        points_left,
        noise.covariance_px2,
    )


def measured_case(simulator: Simulator, rig: StereoRig, method: str, stream: Stream) -> Case | str:
    """Pixels found in rendered pictures, corners or patches; or why there are none.

    Gross mismatches are left out: no triangulator can mend them.
    """
    scene = simulator.scene.name
    simulator.place(rig)
    exposure = expose_pair(simulator, rig, SENSOR, SUPERSAMPLE)
    found = measure(method, simulator, rig, exposure.pictures(SENSOR, stream(f"{scene} picture")))
    kept = ~found.outlier & np.isfinite(found.error_px).all(axis=1)
    if not kept.any():
        return f"{scene} {method}: {found.why or 'nothing was found that both cameras see'}"
    if kept.sum() < FEWEST_MATCHES:
        return f"{scene} {method}: {kept.sum()} matches, too few to compare errors with"
    return Case(
        f"{scene} {method}",
        scene,
        "measured",
        saying("pictures", scene=scene, method=method),
        rig,
        found.uv_left[kept],
        found.uv_right[kept],
        found.points_left[kept],
        found.covariance_px2[kept],
    )
