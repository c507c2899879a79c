"""How often `sweep` flags a right rig: 10 rigs, 5 scenes, 40 seeds, 400 runs; at most 1 may be flagged.

Each seed runs every rig, in a scene that turns with the seed. The rigs are simulated by the pixel noise
that suits them worst: far points, zoomed lenses, distortion. Every tenth run is measured as well, with a
sensor of two grey levels of noise.
"""

from __future__ import annotations

import time
from dataclasses import replace

from rigsim import BrownConrady, Intrinsics, PixelNoise, Plan, Pose, StereoRig
from rigsim.present.kit.agreement import text
from rigsim.rig.sensor import Sensor
from rigsim.sim.simulator import Simulator
from rigsim.study.agreement.agreement import Agreement
from rigsim.study.sweep.processes import run_all

SCENES = ("boards", "branch", "artifact", "corridor", "bin")
SEEDS = 40
_LENS = Intrinsics(640, 480, 500.0, 500.0, 319.5, 239.5)
_WIDE = Intrinsics(640, 480, 260.0, 260.0, 319.5, 239.5, BrownConrady(k1=-0.2, k2=0.03))
_BENT = replace(_LENS, lens=BrownConrady(k1=-0.3, k2=0.1, p1=0.001, p2=-0.002))


def _zoomed(factor: float) -> Intrinsics:
    return replace(_LENS, fx=_LENS.fx * factor, fy=_LENS.fy * factor)


def rigs() -> dict[str, tuple[StereoRig, PixelNoise]]:
    """The rigs and the noise of each."""
    crooked = Pose.from_rotvec((0.01, -0.03, 0.02), (-0.08, 0.005, 0.01))
    return {
        "equal": (StereoRig.rectified(_LENS, 0.08), PixelNoise(0.25)),
        "short and noisy": (StereoRig.rectified(_LENS, 0.06), PixelNoise(0.5)),
        "far": (StereoRig.rectified(_LENS, 0.03), PixelNoise(1.0)),
        "offset principal point": (
            StereoRig.rectified(_LENS, 0.08, right=replace(_LENS, cx=350.0)),
            PixelNoise(0.3),
        ),
        "unequal lenses": (
            StereoRig(_LENS, replace(_zoomed(1.3), cy=250.0), crooked),
            PixelNoise(0.4),
        ),
        "right zoomed 3 times": (StereoRig.rectified(_LENS, 0.08, right=_zoomed(3)), PixelNoise(3.0)),
        "distorted": (StereoRig.rectified(_BENT, 0.08), PixelNoise(0.5)),
        "wide": (StereoRig.rectified(_WIDE, 0.08), PixelNoise(0.5)),
        "verged": (StereoRig.verged(_LENS, 0.08, 8.0), PixelNoise(0.5)),
        "correlated": (StereoRig.rectified(_LENS, 0.08), PixelNoise(0.5, correlation=0.5)),
    }


def run() -> None:
    """Print the runs flagged, by rig and scene, and how many agree or tell nothing."""
    count(SEEDS)


def count(seeds: int) -> int:
    """Run `seeds` seeds of every rig, scene after scene; the number of runs flagged."""
    started = time.monotonic()
    kinds = {"agrees": 0, "flagged": 0, "untold": 0}
    for scene in SCENES:
        with Simulator(scene) as simulator:
            for seed in range(seeds):
                for i, (name, (rig, noise)) in enumerate(rigs().items()):
                    if SCENES[(seed + i) % len(SCENES)] != scene:
                        continue
                    measured = (seed + i) % 10 == 0 and rig.left.lens is None
                    agreement = _agreement(rig, _plan(scene, noise, seed, measured), simulator)
                    kinds[agreement.kind] += 1
                    if agreement.kind != "agrees":
                        print(f"{name} in {scene}, seed {seed}: {text(agreement)}", flush=True)
        print(f"{scene}: {sum(kinds.values())} runs so far, {kinds['flagged']} flagged", flush=True)
    total = sum(kinds.values())
    print(f"{kinds['flagged']} of {total} correct runs flagged, at most 1 of 400 allowed; ", end="")
    print(f"{kinds['agrees']} agree, {kinds['untold']} tell nothing; {time.monotonic() - started:.0f} s")
    return kinds["flagged"]


def _plan(scene: str, noise: PixelNoise, seed: int, measured: bool) -> Plan:
    return Plan(
        scene=scene,
        noises=(noise,),
        n_points=500,
        n_trials=40,
        seed=seed,
        measure="auto" if measured else "none",
        sensors={"2 grey": Sensor(grey_noise=2.0)},
        supersample=2 if measured else 1,
    )


def _agreement(rig: StereoRig, plan: Plan, simulator: Simulator) -> Agreement:
    """The agreement of one rig, also where nothing comes of it, which ends a sweep."""
    (outcome,) = run_all([rig], plan, 1, simulator)
    agreement: Agreement = outcome.rows[0]["agreement"]
    return agreement
