"""One rig in one scene, looked at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rigsim.rig.arrays import Array
from rigsim.rig.remark import Remark
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig
from rigsim.sim.frame import StereoFrame
from rigsim.sim.simulator import SUPERSAMPLE, Simulator
from rigsim.study.scene.pictures import expose_pair
from rigsim.study.scene.provenance import simulator_provenance


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """A rendered stereo pair with its truth."""

    scene: str
    """Name of the scene."""
    rig: StereoRig
    """The rig that looked."""
    frame: StereoFrame
    """Both pictures, depth and segmentation."""
    disparity: Array
    """``u_left - u_right``, (H, W), px; NaN where the right camera does not see the point."""
    provenance: dict[str, object]
    """Versions, renderer, command: JSON values only."""
    remarks: tuple[Remark, ...] = ()
    """What a person should know of the scene and the rig's place in it."""


def take_snapshot(
    rig: StereoRig, scene: str, mount: str | None, renderer: str, extra: Mapping[str, object]
) -> Snapshot:
    """Render `rig` in a scene; `extra` goes into the provenance.

    Raises:
        InvalidScene: scene or mount cannot be used.
        RenderUnavailable: the renderer asked for does not work here.
    """
    with Simulator(scene, mount, renderer) as simulator:
        simulator.place(rig)
        frame = expose_pair(simulator, rig, Sensor(), SUPERSAMPLE).frame
        return Snapshot(
            scene=simulator.scene.name,
            rig=rig,
            frame=frame,
            disparity=simulator.true_disparity(frame),
            provenance={**simulator_provenance(simulator), **extra},
            remarks=simulator.remarks,
        )
