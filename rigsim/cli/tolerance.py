"""`rigsim tolerance`: what must be held how tightly, and how many built rigs are good."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Annotated

import typer

from rigsim.cli.kit.answer import claim, deliver
from rigsim.cli.kit.golden import GoldenWords, held, leave_where_moved
from rigsim.cli.kit.options import DisparityNoise, Json, takes, takes_rig
from rigsim.cli.kit.tolerances import MaxRowError, ToleranceWord
from rigsim.typed import quantity
from rigsim.typed.noise import pixel_noise
from rigsim.typed.rigs import DEFAULT_PRESET, RigOptions
from rigsim.typed.tolerances import (
    row_error,
    tolerance_range,
    tolerance_requirement,
    tolerance_values,
)

_LENGTHS = quantity.BASELINE.factors
_SPEED = quantity.QuantityKind("speed", "m/s", quantity.SPEEDS, at_least=0)
_EXPANSION = quantity.QuantityKind("expansion", "ppm", {"ppm": Fraction(1)}, at_least=0)
_LENGTH = quantity.QuantityKind("known length's std", "mm", _LENGTHS, above=0)


@dataclass(frozen=True, slots=True)
class ToleranceWords:
    """The options of `rigsim tolerance`, as typed."""

    depth_error: Annotated[
        str,
        typer.Option(
            metavar="ERROR[@DISTANCE]",
            help="Largest root mean square depth error of one rig over the image and its noise: 10mm@3m, 1%;"
            " at the far end by default.",
        ),
    ] = "1%"
    max_row_error: MaxRowError = None
    depth_range: Annotated[
        str, typer.Option("--range", metavar="NEAR:FAR", help="Working range: 0.5:3m.")
    ] = "1:5m"
    class_name: Annotated[
        str,
        typer.Option(
            "--class",
            metavar="NAME|FILE",
            help="printed, machined, calibrated, or none; or the covariance.json, plan.json or"
            " calibration.json of rigsim calibrate, whose rig is taken where none is named.",
        ),
    ] = "machined"
    tolerance: ToleranceWord = None
    distribution: Annotated[
        str, typer.Option(help="uniform makes a bound, +-, of every tolerance, evenly filled.")
    ] = "normal"
    speed: Annotated[
        str | None,
        typer.Option(
            metavar="M/S",
            help="Speed along the baseline, for a time offset.  [default: 1, unless there is another motion]",
        ),
    ] = None
    forward_speed: Annotated[
        str, typer.Option(metavar="M/S", help="Speed straight ahead, for a time offset.")
    ] = "0"
    turn_rate: Annotated[
        str, typer.Option(metavar="DEG/S", help="How fast the rig turns to the right, for a time offset.")
    ] = "0"
    moving: Annotated[
        str, typer.Option(metavar="WHAT", help="What the two speeds are of: object or rig.")
    ] = "object"
    expansion: Annotated[
        str, typer.Option(metavar="PPM", help="Expansion of the bar, ppm/K, for a temperature.")
    ] = "23"
    recalibrate: Annotated[
        bool, typer.Option(help="Recalibrate each rig on epipolar errors and known lengths as well.")
    ] = True
    features: Annotated[
        int,
        typer.Option("--recalibration-features", metavar="N", help="Features per calibration image."),
    ] = 60
    pictures: Annotated[
        int,
        typer.Option("--recalibration-pictures", metavar="N", help="Images averaged per feature."),
    ] = 10
    noise: Annotated[
        str | None,
        typer.Option(
            metavar="PX",
            help="Noise per pixel coordinate, standard deviation: when rigs measure, and in a calibration"
            f" picture.  [default: {quantity.NOISE_PX}]",
        ),
    ] = None
    disparity_noise: DisparityNoise = None
    length_std: Annotated[
        str, typer.Option(metavar="LENGTH", help="Standard deviation of each known length.")
    ] = "0.5mm"
    rigs: Annotated[int, typer.Option(metavar="N", help="Rigs to build.")] = 10_000
    points: Annotated[int, typer.Option(metavar="N", help="Points per rig.")] = 500
    seed: Annotated[int, typer.Option(min=0, help="Seed of every random number.")] = 0
    out: Annotated[
        Path | None, typer.Option(help="Folder for tolerance.csv, .json, .png and places.png.")
    ] = None
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False
    as_json: Json = False


@takes_rig
@takes(ToleranceWords)
@takes(GoldenWords)
def tolerance(options: RigOptions, words: ToleranceWords, golden: GoldenWords) -> None:
    """Rank a rig's tolerances by what they do to the depth, and count the built rigs that are good.

    A rig is good when its own depth error, of its build and its pixel noise, meets the requirement, and with
    --max-row-error its rows do as well.
    """
    near_m, far_m = tolerance_range(words.depth_range)
    asked = tolerance_requirement(words.depth_error)
    claim(words.out, words.force)
    golden.check("tolerance")
    from rigsim.api.kit.calibrations import names_calibration

    calibrated = names_calibration(words.class_name) and not options.typed()
    rig = None if calibrated else options.single(DEFAULT_PRESET)
    values, bounds = tolerance_values(words.tolerance or [])

    from rigsim.api.tolerance import tolerance as run

    result = run(
        rig,
        **asked,
        max_row_error_px=row_error(words.max_row_error),
        range_m=(near_m, far_m),
        tolerance_class=words.class_name,
        tolerances=values,
        bounds=bounds,
        distribution=words.distribution,
        speed_m_s=None if words.speed is None else quantity.value(words.speed, _SPEED),
        forward_speed_m_s=quantity.value(words.forward_speed, quantity.FORWARD_SPEED),
        turn_rate_deg_s=quantity.value(words.turn_rate, quantity.TURN_RATE),
        moving=words.moving,
        expansion_ppm=quantity.value(words.expansion, _EXPANSION),
        recalibrate=words.recalibrate,
        recalibration_features=words.features,
        recalibration_pictures=words.pictures,
        noise_px=pixel_noise(words.noise, words.disparity_noise).std_px,
        length_std_mm=quantity.value(words.length_std, _LENGTH),
        rigs=words.rigs,
        points=words.points,
        seed=words.seed,
    )
    result = held(result, golden, "tolerance", {"seed": str(words.seed)})
    deliver(result, words.out, words.force, words.as_json)
    leave_where_moved(result.golden)
