"""What a design's pictures are taken with, and the room they are taken in, from the words of the command."""

from __future__ import annotations

import importlib.util
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import typer

from rigsim.cli.kit.answer import print_remarks
from rigsim.cli.kit.sensors import sensor_from, sensor_labels

if TYPE_CHECKING:
    from rigsim.rig.sensor import Sensor
    from rigsim.study.design.proof import Proof
    from rigsim.study.design.solve import Design, Specification
    from rigsim.study.scene.plan import Plan
    from rigsim.theory.inverse import Camera


@dataclass(frozen=True, slots=True)
class Optics:
    """Lens and sensor options as typed."""

    blur: str | None
    """px."""
    image_noise: str | None
    """Grey levels."""
    full_well: str | None
    """Electrons."""
    read_noise: str | None
    """Electrons."""


def fittings(names: Sequence[str], optics: Optics) -> dict[str, tuple[str, Sensor]]:
    """Label and sensor for each sensor's name; an empty name is a camera without one.

    A sensor whose noise nobody published, and for which none is given, gets an ordinary camera's.
    """
    return {name: _fitting(name, optics) for name in names}


def has_own_noise(name: str, optics: Optics) -> bool:
    """Whether the noise of the sensor's pictures is published or given."""
    if not name:
        return optics.image_noise is not None or optics.full_well is not None
    from rigsim.rig.catalogue.sensors import sensor_preset

    preset = sensor_preset(name)
    return not (
        (preset.full_well_e is None and optics.full_well is None)
        or (preset.read_noise_e is None and optics.read_noise is None)
    )


def _fitting(name: str, optics: Optics) -> tuple[str, Sensor]:
    from rigsim.cli.sweep import TYPICAL_NOISE_GREY

    own = has_own_noise(name, optics)
    sensor = sensor_from(
        name if name and own else None,
        blur=optics.blur,
        image_noise=optics.image_noise or (None if own else str(TYPICAL_NOISE_GREY)),
        full_well=optics.full_well,
        read_noise=optics.read_noise,
    )
    label = sensor_labels((sensor,), name if name and own else None)[0]
    return (
        f"{name.upper()} ({label}: its own noise is not published)" if name and not own else label
    ), sensor


def room_plan(
    specification: Specification,
    scene: str,
    seed: int,
    renderer: str,
    measure: str,
    fits: Mapping[str, tuple[str, Sensor]],
) -> Plan:
    """How candidates are tried; says so when nothing can be measured here."""
    from rigsim.rig.noise import PixelNoise
    from rigsim.study.scene.plan import Plan

    if importlib.util.find_spec("cv2") is None:
        measure = "none"
        typer.echo("OpenCV is not installed: nothing is measured (pip install 'rigsim[vision]')", err=True)
    return Plan(
        scene=scene,
        noises=(PixelNoise(specification.noise_px),),
        range_m=(specification.near_m, specification.far_m),
        seed=seed,
        renderer=renderer,
        measure=measure,
        sensors=dict(fits.values()),
    )


def try_out(
    specification: Specification,
    cameras: Sequence[Camera],
    preference: str,
    plan: Plan,
    fits: Mapping[str, tuple[str, Sensor]],
    measures_noise: bool,
) -> tuple[Design, tuple[Proof, ...]]:
    """The design, with its sensor's noise measured where that is asked for, and its proofs."""
    from rigsim.study.design.proof import prove, settle_and_prove
    from rigsim.study.design.room import Fitting, Room
    from rigsim.study.design.solve import solve

    def fit(camera: Camera) -> Fitting:
        return Fitting(*fits[camera.sensor])

    with Room(plan, fit, surfaces=measures_noise and plan.measure == "auto") as room:
        try:
            if measures_noise:
                return settle_and_prove(specification, cameras, preference, room)
            found = solve(specification, cameras, preference)
            return found, prove(found, room)
        finally:
            print_remarks(room.remarks)
