"""What `measure` says of a pair's rows: false alarms on rendered pairs, power for vertical shifts."""

from __future__ import annotations

from collections import Counter

import numpy as np

from rigsim.errors import MeasurementFailed
from rigsim.rig.arrays import AnyImage, Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.presets import preset
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig
from rigsim.sim.exposure import digitise
from rigsim.study.measure.run import Wanted, measure_pair

SCENES = ("boards", "branch", "artifact", "corridor", "bin")
SEEDS = 20
POWER_SEEDS = 5
NOISE_GREY = 2.0
SIZE = (640, 480)
SHIFTS = (0.3, 1.0, 10.0, 0.1 * SIZE[1])


def run() -> None:
    """Print both tables."""
    print(f"{SIZE[0]} x {SIZE[1]} px, {NOISE_GREY:g} grey noise, {SEEDS} seeds; shifted before the noise")
    print("scene       right pairs: agrees / flagged / untold   told within 0.1 px of", end="")
    print("".join(f"{shift:8.4g} px" for shift in SHIFTS))
    for name in SCENES:
        rig, light = _light(name)
        kinds = Counter(_kind(rig, light, 0.0, seed)[0] for seed in range(SEEDS))
        print(f"{name:10}  {kinds['agrees']:14} / {kinds['flagged']} / {kinds['untold']}", end="")
        print(" " * 37, end="")
        for shift in SHIFTS:
            found = [_kind(rig, light, shift, seed)[1] for seed in range(POWER_SEEDS)]
            right = sum(abs(px - shift) < 0.1 for px in found)
            print(f"{right:6} of {POWER_SEEDS}", end="", flush=True)
        print()


def _light(name: str) -> tuple[StereoRig, tuple[Array, Array]]:
    from rigsim.sim.simulator import Simulator
    from rigsim.study.scene.pictures import expose_pair

    own = preset(name).rig
    lens = Intrinsics.from_focal(*SIZE, own.left.fx * SIZE[0] / own.left.width)
    rig = StereoRig.rectified(lens, own.baseline_m)
    with Simulator(name) as simulator:
        simulator.place(rig)
        return rig, expose_pair(simulator, rig, Sensor(), 2).light


def _kind(rig: StereoRig, light: tuple[Array, Array], shift_px: float, seed: int) -> tuple[str, float]:
    """The verdict, and how far too low the right picture is said to be, px; 0 where it says nothing."""
    rng = np.random.default_rng(seed)
    sensor = Sensor(grey_noise=NOISE_GREY)
    left = digitise(light[0], sensor, rng)
    right = digitise(_lower(light[1], shift_px), sensor, rng)
    try:
        rows = measure_pair(left, right, rig, Wanted(matcher=None)).verdicts[0]
        return rows.kind, rows.numbers["shift_px"] if rows.kind == "flagged" else 0.0
    except MeasurementFailed as error:
        kind, says = "flagged" if "right picture is" in str(error) else "refused", str(error)
    if "right picture is " not in says or kind != "flagged":
        return kind, 0.0
    number, rest = says.split("right picture is ")[1].split(" px too ", 1)
    return kind, float(number) * (1 if rest.startswith("low") else -1)


def _lower(light: AnyImage, rows: float) -> Array:
    from scipy.ndimage import shift

    return np.asarray(shift(light, (rows, 0), order=3, mode="nearest"))
