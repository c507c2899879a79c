"""What a design's pictures are taken with, and the room they are taken in."""

from __future__ import annotations

import importlib.util
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from rigsim.api.kit.rendering import NO_OPENCV
from rigsim.api.kit.sensors import TYPICAL_NOISE_GREY, SensorOptions, sensor_labels
from rigsim.rig.catalogue.sensors import sensor_preset
from rigsim.rig.noise import PixelNoise
from rigsim.rig.remark import Remark
from rigsim.sim.scenes.made import MadeScene
from rigsim.study.design.made import proof_distances_m, scene_for
from rigsim.study.design.proof import Proof, prove, settle_and_prove
from rigsim.study.design.room import Fitting, Room
from rigsim.study.design.solve import Candidate, Design, Specification, solve
from rigsim.study.scene.plan import Plan
from rigsim.theory.inverse import Camera

Fittings = Mapping[tuple[str, float], Fitting]
"""What pictures are taken with, by the sensor's name, empty for none, and how many pixels make one."""


def fittings(cameras: Sequence[Camera], optics: SensorOptions) -> Fittings:
    """Label and sensor for each kind of camera.

    A sensor whose noise nobody published, and for which none is given, gets an ordinary camera's.
    """
    kinds = sorted({(camera.sensor, camera.merged) for camera in cameras})
    return {(name, merged): _fitting(name, merged, optics) for name, merged in kinds}


def has_own_noise(name: str, optics: SensorOptions) -> bool:
    """Whether the noise of the sensor's pictures is published or given."""
    if not name:
        return bool(optics.image_noise_grey) or optics.full_well_e is not None
    preset = sensor_preset(name)
    return not (
        (preset.full_well_e is None and optics.full_well_e is None)
        or (preset.read_noise_e is None and optics.read_noise_e is None)
    )


def _fitting(name: str, merged: float, optics: SensorOptions) -> Fitting:
    own = has_own_noise(name, optics)
    levels = optics.image_noise_grey or (() if own else (TYPICAL_NOISE_GREY,))
    chosen = name if name and own else None
    sensor = replace(optics, sensor=chosen, image_noise_grey=levels).one()
    label = sensor_labels((sensor,), chosen)[0]
    if name and not own:
        label = f"{name.upper()} ({label}: its own noise is not published)"
    if merged != 1:
        return Fitting(f"{label}, {merged:.3g} x {merged:.3g} pixels as one", sensor.merged(merged))
    return Fitting(label, sensor)


MADE = "auto"
"""In place of a scene's name: one is made for the range."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where and how candidates are tried."""

    scene: str
    """A bundled scene's name, the path of an MJCF file, or `MADE`."""
    seed: int
    """Seed of every random number."""
    renderer: str
    """auto, egl, osmesa or rays."""
    measure: str
    """What is measured in the pictures."""


def try_out(
    specification: Specification,
    cameras: Sequence[Camera],
    preference: str,
    place: Place,
    fits: Fittings,
    measures_noise: bool,
) -> tuple[Design, tuple[Proof, ...], tuple[Remark, ...]]:
    """The design, with its sensor's noise measured where that is asked for, its proofs, and remarks."""
    remarks: tuple[Remark, ...] = ()
    measure = place.measure
    if importlib.util.find_spec("cv2") is None:
        measure, remarks = "none", (NO_OPENCV,)
    plan = Plan(
        scene=place.scene,
        noises=(PixelNoise(specification.noise_px),),
        range_m=(specification.near_m, specification.far_m),
        seed=place.seed,
        renderer=place.renderer,
        measure=measure,
        sensors={fit.label: fit.sensor for fit in fits.values()},
    )

    def fit(camera: Camera) -> Fitting:
        return fits[camera.sensor, camera.merged]

    distances_m = proof_distances_m(specification)

    def make(candidate: Candidate) -> MadeScene:
        return scene_for(distances_m, candidate)

    made = place.scene == MADE
    surfaces = measures_noise and measure == "auto"
    with Room(plan, fit, surfaces=surfaces, make=make if made else None) as room:
        if measures_noise:
            found, proofs = settle_and_prove(specification, cameras, preference, room)
        else:
            found = solve(specification, cameras, preference)
            proofs = prove(found, room)
        return found, proofs, (*remarks, *room.remarks)
