"""What a lens and a sensor do to an ideal picture: blur, vignetting, mismatch, noise, grey levels.

A rendered picture is linear light, 0 to 1 (1 fills the exposure). `optics` is what is the same in every
frame, `digitise` what differs: a noise level costs no new render. Every number at zero is the ideal pinhole:
then only the rounding to grey levels is left, and with `bits` 0 nothing.

Noise: electrons ``e = signal * full_well_e / gain`` carry photon shot noise (Poisson) and Gaussian read
noise, as in the linear camera model of EMVA Standard 1288, release 4.0; a pixel's own gain (PRNU) and dark
level (DSNU) stay the same from frame to frame, and each camera has its own.
"""

from __future__ import annotations

import math

import numpy as np

from rigsim.errors import InvalidImage, InvalidRig
from rigsim.rig.arrays import AnyImage, Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.sensor import Sensor, Side
from rigsim.sim.lens import distort_image


def expose(
    linear_image: AnyImage,
    sensor: Sensor,
    rng: np.random.Generator,
    side: Side = "left",
    *,
    supersample: int = 1,
) -> AnyImage:
    """`optics`, then `digitise`: a picture in grey levels of linear light (k H, k W[, 3]), 0 to 1."""
    return digitise(optics(linear_image, sensor, side, supersample=supersample), sensor, rng, side)


def optics(
    linear_image: AnyImage,
    sensor: Sensor,
    side: Side = "left",
    *,
    supersample: int = 1,
    wide: Intrinsics | None = None,
    camera: Intrinsics | None = None,
) -> Array:
    """Lens blur, distortion, the pixels' squares, vignetting, and the right picture's gain and offset.

    A lens blurs before pixels sample: with `blur_px` below 0.7 give a picture `supersample` 2 or finer, or
    the blur comes out too small and uneven.

    Args:
        linear_image: Linear light (k H, k W) or (k H, k W, 3), k pixels rendered for one along each side.
        sensor: What to apply; its `distortion` is not looked at, `camera`'s is.
        side: Whether it is the right picture, which may differ in brightness.
        supersample: k.
        wide: The pinhole camera the picture is of, from `rigsim.sim.lens.wider_intrinsics`; only
            with `camera`.
        camera: The camera with distortion whose picture is wanted; None leaves the geometry as it is.

    Returns:
        Linear light (H, W) or (H, W, 3).

    Raises:
        InvalidImage: no picture, grey levels instead of linear light, or a size k does not divide.
        InvalidRig: `wide` without `camera` or the other way round, or too narrow for it.
    """
    light = np.asarray(linear_image, dtype=np.float64)
    if light.ndim not in (2, 3) or 0 in light.shape or np.asarray(linear_image).dtype.kind != "f":
        raise InvalidImage(
            f"linear image of shape {light.shape} and type {np.asarray(linear_image).dtype}: "
            "must be (height, width) or (height, width, 3), floating point, 0 to 1"
        )
    if (wide is None) != (camera is None):
        raise InvalidRig(
            "distortion: give both the wide camera that was rendered and the camera that is wanted"
        )
    if sensor.blur_px:
        from scipy.ndimage import gaussian_filter  # heavy, and a sensor is often only described

        light = gaussian_filter(light, sensor.blur_px * supersample, mode="nearest", axes=(0, 1))
    if wide is not None and camera is not None:
        light = distort_image(light, wide, camera)
    else:
        light = average_pixels(light, supersample)
    if sensor.vignetting:
        height, width = light.shape[:2]
        v, u = np.ogrid[0:height, 0:width]
        r2 = (u - (width - 1) / 2) ** 2 + (v - (height - 1) / 2) ** 2
        shade = 1 - sensor.vignetting * r2 / max((((width - 1) / 2) ** 2 + ((height - 1) / 2) ** 2), 1.0)
        light = light * (shade if light.ndim == 2 else shade[..., None])
    if side == "right" and (sensor.right_gain != 1 or sensor.right_offset != 0):
        light = sensor.right_gain * light + sensor.right_offset
    return light


def average_pixels(image: AnyImage, k: int) -> Array:
    """The mean (H, W[, 3]) of every k x k pixels.

    Raises:
        InvalidImage: k does not divide the picture's size.
    """
    pixels = np.asarray(image, dtype=np.float64)
    height, width = pixels.shape[:2]
    if k < 1 or height % k or width % k:
        raise InvalidImage(f"image {width} x {height} px: no whole multiple of the supersampling {k}")
    if k == 1:
        return pixels
    return np.asarray(pixels.reshape(height // k, k, width // k, k, *pixels.shape[2:]).mean(axis=(1, 3)))


def digitise(
    light: Array, sensor: Sensor, rng: np.random.Generator, side: Side = "left", *, frames: int | None = None
) -> AnyImage:
    """Grey levels of linear light (H, W) or (H, W, 3), with new noise at every call.

    Args:
        light: What `optics` returned.
        sensor: Its electrons and bits.
        rng: Where the noise comes from.
        side: Whose pattern of PRNU and DSNU it is; a camera of one size has one pattern for good.
        frames: Return so many noisy pictures, (frames, H, W[, 3]), instead of one.

    Returns:
        uint8 for 8 bits, uint16 for 10, 12 and 16 (0 to 2^bits - 1), float64 0 to 1 for 0 bits.
    """
    shape = light.shape if frames is None else (frames, *light.shape)
    gains, darks = _pattern(light.shape, sensor, side)
    signal = light * gains
    white_var = (sensor.grey_noise / 255) ** 2
    level = np.broadcast_to(signal, shape)
    if sensor.full_well_e:
        per_light = sensor.full_well_e / sensor.gain
        white_var += (sensor.read_noise_e / per_light) ** 2
        # an offset below zero, as a mismatched right picture may have, is no light
        level = np.minimum(signal, 0.0) + rng.poisson(np.maximum(signal, 0.0) * per_light, shape) / per_light
        level = level + darks / per_light
    if white_var:
        noisy = rng.standard_normal(shape)
        noisy *= math.sqrt(white_var)
        noisy += level
        level = noisy
    if sensor.black_level:
        level = level + sensor.black_level / 255
    if not sensor.bits:
        return np.array(level)
    grey = np.rint(level * sensor.full_scale)
    np.clip(grey, 0.0, sensor.full_scale, out=grey)
    return grey.astype(np.uint8 if sensor.bits == 8 else np.uint16)


def _pattern(shape: tuple[int, ...], sensor: Sensor, side: Side) -> tuple[Array, Array]:
    """What one camera's pixels of `shape` multiply light by, and the electrons they add to it."""
    rng = np.random.default_rng(np.random.SeedSequence(1288, spawn_key=(side == "right", *shape)))
    gains, darks = np.ones(()), np.zeros(())
    # both are always drawn, so that one does not change with the other
    if sensor.prnu_pct or sensor.dsnu_e:
        first, second = rng.standard_normal((2, *shape))
        gains, darks = np.maximum(1 + sensor.prnu_pct / 100 * first, 0.0), sensor.dsnu_e * second
    return gains, darks
