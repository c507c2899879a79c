"""The pictures a rig would take: drawn, through a lens, onto a sensor, and rectified again."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig.arrays import GREY_WEIGHTS, AnyImage, Array, Light
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.lens import Lens
from rigsim.rig.sensor import Sensor, Side
from rigsim.rig.stereo import StereoRig
from rigsim.sim.exposure import digitise, optics
from rigsim.sim.faces import needs_faces
from rigsim.sim.frame import StereoFrame
from rigsim.sim.lens import rectify_image, wider_intrinsics
from rigsim.sim.simulator import Simulator
from rigsim.sim.supersampling import box_average

_SIDES: tuple[Side, Side] = ("left", "right")


@dataclass(frozen=True, slots=True, eq=False)
class Pictures:
    """What a user's program gets: two grey pictures, (H, W)."""

    left: AnyImage
    """Left picture."""
    right: AnyImage
    """Right picture."""


@dataclass(frozen=True, slots=True, eq=False)
class Exposure:
    """The light on both sensors; noisy pictures are drawn from it as often as one likes."""

    frame: StereoFrame
    """Colour, depth and segmentation of both views."""
    light: tuple[Array, Array]
    """Grey light on the left and right pixels, lens included, (H, W), 0 to 1."""
    cameras: tuple[Intrinsics, Intrinsics]
    """The cameras as they are, lens distortion included."""
    rig: StereoRig
    """The calibration that the pictures are handed on with."""

    def pictures(self, sensor: Sensor, rng: np.random.Generator) -> Pictures:
        """Take both pictures, with new noise, and rectify them where the sensor's lens distorts."""
        taken: list[AnyImage] = []
        for side, light, camera, target in zip(
            _SIDES, self.light, self.cameras, (self.rig.left, self.rig.right), strict=True
        ):
            image = digitise(light, sensor, rng, side)
            taken.append(image if camera == target else rectify_image(image, camera, target))
        return Pictures(taken[0], taken[1])


def without_noise(sensor: Sensor) -> Sensor:
    """The sensor's lens alone: sensors that share it share their `Exposure`."""
    return Sensor(
        blur_px=sensor.blur_px,
        distortion=sensor.distortion,
        right_gain=sensor.right_gain,
        right_offset=sensor.right_offset,
        vignetting=sensor.vignetting,
    )


def expose_pair(simulator: Simulator, rig: StereoRig, sensor: Sensor, supersample: int) -> Exposure:
    """Draw both views of the placed rig through the sensor's lens; the sensor is monochrome.

    A lens blurs before pixels sample, and no renderer knows one that distorts: then a finer picture is drawn,
    where one pinhole is enough a wider one that is resampled after the blur.

    Args:
        simulator: the scene, with `rig` placed in it.
        rig: the rig; its own distortion stays in the pictures.
        sensor: lens and sensor; its distortion is rectified away again.
        supersample: samples along each side of a pixel.

    Raises:
        InvalidRig: the rig and the sensor both distort, or the distortion folds the picture.
    """
    own = (rig.left, rig.right)
    cameras = (_through(rig.left, sensor.distortion), _through(rig.right, sensor.distortion))
    distorts = any(camera.lens is not None for camera in cameras)
    if not (distorts or sensor.blur_px):
        frame = simulator.render(supersample)
        grey = [_grey(view.light) for view in (frame.left, frame.right)]
        light = [optics(part, sensor, side) for part, side in zip(grey, _SIDES, strict=True)]
        return Exposure(frame, (light[0], light[1]), cameras, rig)
    resampled = [distorts and not needs_faces(camera) for camera in cameras]
    drawn = [
        wider_intrinsics(camera, supersample) if later else camera.supersampled(supersample)
        for camera, later in zip(cameras, resampled, strict=True)
    ]
    frame = simulator.render(1, (drawn[0], drawn[1]))
    light, views = [], []
    for i, view in enumerate((frame.left, frame.right)):
        geometry = {"wide": drawn[i], "camera": cameras[i]} if resampled[i] else {}
        light.append(optics(_grey(view.light), sensor, _SIDES[i], supersample=supersample, **geometry))
        views.append(replace(view, light=_for_looking(view.light, light[-1], resampled[i], supersample)))
    return Exposure(StereoFrame(views[0], views[1]), (light[0], light[1]), cameras if distorts else own, rig)


def _grey(light: Light) -> Array:
    return np.asarray(light.astype(np.float64) @ np.asarray(GREY_WEIGHTS))


def _for_looking(fine: Light, grey: Array, distorts: bool, supersample: int) -> Light:
    """A picture for people: colour where the geometry is a pinhole's, else what the sensor sees."""
    if not distorts:
        return box_average(fine, supersample)
    return np.asarray(np.repeat(np.clip(grey, 0, 1)[..., None], 3, axis=2), dtype=np.float32)


def _through(camera: Intrinsics, lens: Lens | None) -> Intrinsics:
    if lens is None:
        return camera
    if camera.lens is not None:
        raise InvalidRig("the rig's lens and the sensor both distort: leave one of the two out")
    return replace(camera, lens=lens)
