"""The lens of the scene's own camera that a rig is mounted on."""

from __future__ import annotations

from rigsim.rig.stereo import StereoRig
from rigsim.sim.scenes import library
from rigsim.sim.scenes.cameras import read_scene_cameras


def with_lens_of_mount(
    rig: StereoRig, scene: str, mount: str | None, size_px: tuple[int, int] | None = None
) -> StereoRig | None:
    """`rig` with the lens of the scene's camera that it is mounted on, in both cameras.

    None where it is mounted on no camera, or on one that is not there.

    Args:
        rig: what is mounted: its baseline stays.
        scene: a bundled scene's name, or the path of an MJCF file.
        mount: as `rigsim.sim.scenes.scene.load_scene` takes it.
        size_px: image size of a camera that has no resolution, px; the rig's where it is None.

    Raises:
        InvalidScene: the scene cannot be used.
        InvalidRig: the camera is no perspective one.
    """
    kind, _, name = (mount or "").partition(":")
    if kind != "camera" or not name:
        return None
    cameras = read_scene_cameras(library.find(scene)).cameras
    camera = next((each for each in cameras if each.name == name), None)
    if camera is None:
        return None
    lens = camera.intrinsics(*(camera.size_px or size_px or (rig.left.width, rig.left.height)))
    return StereoRig(lens, lens, rig.right_from_left)
