"""Whole calibrations of rendered pictures: boards drawn where they are held, corners found, OpenCV asked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigsim import interrupts
from rigsim.errors import InvalidRange, InvalidRig, MeasurementFailed
from rigsim.pixels.calibration.models import camera_model
from rigsim.pixels.calibration.stereo import calibrate_stereo
from rigsim.rig.arrays import Array, Mask
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig
from rigsim.study.agreement.agreement import Agreement
from rigsim.study.calibrate.progress import Stage
from rigsim.study.calibrate.witness.bench import CalibrationBench
from rigsim.study.calibrate.witness.conclude import Calibrated, Met, conclude
from rigsim.study.calibrate.witness.judge import MEASURED
from rigsim.study.calibrate.witness.pictures import SENSOR, found_corners
from rigsim.study.calibrate.witness.result import CalibrationWitness
from rigsim.theory.calibration.adjust import adjust
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.covariance import Undetermined
from rigsim.theory.calibration.parameters import RigParameters


def measure_calibrations(
    bench: CalibrationBench,
    *,
    count: int = 20,
    seed: int = 0,
    sensor: Sensor = SENSOR,
    progress: Stage | None = None,
) -> CalibrationWitness:
    """Calibrate `count` times from rendered pictures, with new noise in the pictures each time.

    OpenCV calibrates, from the boards that both cameras saw whole and starting from the planned rig; where it
    knows no such lens model, or cannot hold what is held, `adjust` does from all boards. The covariance is
    that of the same boards, which are flat, at the noise of the corners that were found.

    Args:
        bench: What is calibrated; its corner noise does not matter.
        count: How often.
        seed: Of the pictures' noise.
        sensor: Takes the pictures.
        progress: Told of ``pictures`` and ``calibrations`` as they are made. When it is interrupted
            (KeyboardInterrupt) while calibrating, what is done by then is concluded from.
    """
    if fix_for_opencv(bench.parameters) is not None:
        bench = bench.chosen(np.asarray(bench.seen.all(axis=1)))
    told = None if progress is None else lambda done, total: progress("pictures", done, total)
    return calibrate_found(bench, found_corners(bench, sensor, count, seed, told), progress)


def calibrate_found(
    bench: CalibrationBench, observed: Array, progress: Stage | None = None
) -> CalibrationWitness:
    """What as many calibrations as there are sets of corners (k, n, 2, m, 2), px, say; NaN was not found.

    As `measure_calibrations`, whose boards are flat.
    """
    bench, count = replace(bench, flatness_m=0.0), len(observed)
    by_opencv = fix_for_opencv(bench.parameters) is not None
    # what the detector did not find in the first picture is in none
    seen: Mask = np.asarray(np.isfinite(observed[..., 0]).any(axis=(0, 3)))
    kept: Mask = np.asarray(seen.all(axis=1) if by_opencv else seen.any(axis=1))
    unfound = int((bench.seen & ~seen).sum())
    bench, observed = replace(bench.chosen(kept), seen=seen[kept]), observed[:, kept]
    if not kept.any():
        return _nothing(count, f"of {len(kept)} boards none was found in both pictures")
    noise_px = float(np.sqrt(np.nanmean((observed - bench.exact) ** 2)))
    try:
        predicted = bench.covariance(noise_px)
    except Undetermined as error:
        return _nothing(count, str(error))
    done: list[Calibrated | None] = []
    try:
        for k in range(count):
            done.append(_calibrated(bench, observed[k], by_opencv))
            if progress:
                progress("calibrations", k + 1, count)
    except KeyboardInterrupt:
        if not done:
            raise
        interrupts.caught()
    met = Met("measured", len(done), noise_px, MEASURED)
    witness = conclude(met, [one for one in done if one is not None], bench, predicted)
    return replace(witness, boards=len(bench.poses), unfound=unfound, by_opencv=by_opencv)


def fix_for_opencv(parameters: RigParameters) -> tuple[str, ...] | None:
    """What OpenCV is to hold; None where it cannot calibrate this."""
    held = [name for name, free in zip(parameters.names, parameters.free, strict=True) if not free]
    held += [
        f"{side}.aspect" for side, on in zip(("left", "right"), parameters.square_pixels, strict=True) if on
    ]
    try:
        camera_model(parameters.lenses, held)
    except InvalidRange:
        return None
    return None if parameters.warped else tuple(held)


def _calibrated(bench: CalibrationBench, observed: Array, by_opencv: bool) -> Calibrated | None:
    """One calibration; None where no rig is found."""
    rig, poses = bench.rig, bench.poses
    parameters = bench.parameters
    if by_opencv:
        try:
            rig, poses = _by_opencv(bench, observed)
        except (MeasurementFailed, InvalidRig):
            return None
        # OpenCV's rig stays; each board is laid where both pictures together have it
        held = np.zeros_like(parameters.free)
        parameters = replace(parameters, free=held, square_pixels=(False, False))
    found = adjust(rig, parameters, bench.board, poses, observed)
    errors = bench.errors(found.rig, found.poses, found.board)
    if not (found.settled and np.isfinite(errors.depth_m).all()):
        return None
    return Calibrated(errors, found.rms_px, int(np.isfinite(observed).sum()))


def _by_opencv(bench: CalibrationBench, observed: Array) -> tuple[StereoRig, BoardPoses]:
    left, right = bench.rig.left, bench.rig.right
    found = calibrate_stereo(
        bench.board,
        observed,
        ((left.width, left.height), (right.width, right.height)),
        bench.parameters.lenses,
        fix_for_opencv(bench.parameters) or (),
        start=bench.rig,
    )
    return found.rig, BoardPoses.of(found.left_from_board)


def _nothing(count: int, cause: str) -> CalibrationWitness:
    nan = float("nan")
    return CalibrationWitness(
        name="measured",
        calibrations=count,
        failed=count,
        corner_noise_px=nan,
        rms_px=nan,
        misfit=nan,
        depths=(),
        parameter_ratio=nan,
        parameter_interval=(nan, nan),
        agreement=Agreement("untold", "measured", "nothing-measured", "depth spread", cause=cause),
    )
