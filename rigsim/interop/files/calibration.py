"""Files of a rig that was calibrated from pictures."""

from __future__ import annotations

import numpy as np

from rigsim.interop.corner_files.read import PictureCorners
from rigsim.interop.corner_files.table import table_text
from rigsim.interop.documents.calibrate.covariance import covariance_document
from rigsim.interop.documents.calibrate.pictures import covariance_source_of
from rigsim.interop.files.tables import json_bytes
from rigsim.interop.formats.rig_toml import write_rig
from rigsim.study.calibrate.pictures.result import CalibratedPictures


def calibration_files(result: CalibratedPictures, headline: str) -> dict[str, bytes]:
    """rig.toml, covariance.json and corners.csv."""
    covariance = covariance_document(result.covariance, covariance_source_of(result))
    return {
        "rig.toml": write_rig(result.rig, comment=headline).encode(),
        "covariance.json": json_bytes(covariance),
        "corners.csv": table_text(_corners(result)).encode(),
    }


def _corners(result: CalibratedPictures) -> list[PictureCorners]:
    """All corners as they were used, under the pairs' names."""
    found = result.sightings
    pictures = []
    for k, name in enumerate(found.names):
        for side, camera in enumerate(("left", "right")):
            uv, level = found.observed[k, side], -np.log2(found.weights[k, side])
            pictures.append(PictureCorners(name, camera, uv, level, found.claimed_px[k, side]))
    return pictures
