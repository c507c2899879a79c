"""Picture files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from rigsim import foreign
from rigsim.errors import InvalidImage
from rigsim.pixels.opencv import load_cv2
from rigsim.rig.arrays import AnyImage


def read_image(path: str | Path) -> AnyImage:
    """The picture in a file of 8 or 16 bit, (H, W) or (H, W, 3) with red first; nothing is turned or scaled.

    Raises:
        OutputError: the file cannot be read.
        InvalidImage: it is no picture OpenCV can read.
        MeasurementFailed: OpenCV is not installed.
    """
    cv2 = load_cv2()
    content = foreign.read_bytes(path, "a picture (PNG, TIFF or JPEG)")
    foreign.check_pixels(content, path)
    # the file's own orientation tag is ignored: a calibration is the sensor's, not the viewer's
    image = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED) if content else None
    if image is None:
        raise InvalidImage(f"{path}: no picture that can be read: give a PNG, TIFF or JPEG file")
    if image.ndim == 3:
        image = image[..., 2::-1]
    return np.ascontiguousarray(image)
