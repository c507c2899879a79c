"""OpenCV, when it is installed."""

from __future__ import annotations

from typing import Any

from rigsim.errors import MeasurementFailed


def load_cv2() -> Any:
    """The module ``cv2``.

    Raises:
        MeasurementFailed: OpenCV is not installed; the message says how to install it.
    """
    try:
        import cv2
    except ImportError:
        raise MeasurementFailed("OpenCV is not installed: pip install 'rigsim[vision]'") from None
    # what goes wrong is said by an exception, in one line
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    return cv2
