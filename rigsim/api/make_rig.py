"""`rigsim.make_rig`: a rig from plain words, the options of the command line with units in their names."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, dataclass

from rigsim.api.kit.plain import takes
from rigsim.api.rigs import RigLike, rig_for
from rigsim.errors import InvalidRange
from rigsim.rig import given
from rigsim.rig.stereo import StereoRig
from rigsim.study.scene.plan import RigGrid

_SHARE = 1e-3
_POSE = ("yaw_deg", "pitch_deg", "roll_deg", "vertical_mm", "forward_mm")


@dataclass(frozen=True, slots=True)
class MakeRigOptions:
    """The arguments of `make_rig`, which says what they mean."""

    rig: RigLike | None = None
    _: KW_ONLY
    baseline_mm: float | None = None
    focal_px: float | None = None
    focal_mm: float | None = None
    pixel_pitch_um: float | None = None
    sensor_width_mm: float | None = None
    hfov_deg: float | None = None
    resolution_px: tuple[int, int] | None = None
    vergence_deg: float | None = None
    yaw_deg: float | None = None
    pitch_deg: float | None = None
    roll_deg: float | None = None
    vertical_mm: float | None = None
    forward_mm: float | None = None


@takes(MakeRigOptions)
def make_rig(options: MakeRigOptions) -> StereoRig:
    """The rig that plain words say: those of every command that takes a rig, units in the names.

    What is not said is as in `rig`; without one, baseline, lens and image size have to be said. The right
    camera's turns and shifts come on top of the pose that it has by then, in the frames and with the signs of
    `Perturbation`: x right, y down, z forward.

    Args:
        rig: The rig to start from: a preset's name, a calibration's path or text, or a rig.
        baseline_mm: Distance between the cameras, mm, before any shift.
        focal_px: Focal length, px.
        focal_mm: The same in mm, with one of the next two, instead.
        pixel_pitch_um: Pixel pitch, um.
        sensor_width_mm: Active sensor width, mm.
        hfov_deg: Horizontal field of view, deg, instead.
        resolution_px: (width, height), px.
        vergence_deg: Toe-in: both cameras turn inwards by half of it.
        yaw_deg: Turn of the right camera about its y axis, deg: positive looks further right.
        pitch_deg: About its x axis, deg: positive looks further up.
        roll_deg: About its z axis, deg: positive turns clockwise as it looks.
        vertical_mm: Shift of the right camera along the left one's y axis, mm: positive is down.
        forward_mm: Shift along the left one's z axis, mm: positive is forward.

    Raises:
        InvalidRange: Something is missing, is no number, or is said twice.
        InvalidRig: There is no such rig; or as `read_rig`.

    Example:
        >>> import rigsim
        >>> rig = rigsim.make_rig(baseline_mm=120, focal_px=900, resolution_px=(1280, 720), vertical_mm=3)
        >>> uv_left, uv_right = rig.project([[0, 0, 1.0]])
        >>> round(float(uv_right[0, 1] - uv_left[0, 1]), 9)  # the right camera is lower: it sees it higher
        -2.7
    """
    if options.rig is None:
        for name, value in (("baseline_mm", options.baseline_mm), ("resolution_px", options.resolution_px)):
            if value is None:
                raise InvalidRange(f"{name} is missing: give it, or a whole rig, as in rig='oak-d'")
        if options.focal_px is options.focal_mm is options.hfov_deg is None:
            raise InvalidRange("no lens: give focal_px, focal_mm or hfov_deg, or a whole rig")
    base = rig_for(options.rig)
    focals_px, hfovs_deg = _lens(options)
    more = {
        name.rpartition("_")[0]: (_number(options, name) * (_SHARE if name.endswith("mm") else 1.0),)
        for name in _POSE
        if getattr(options, name) is not None
    }
    grid = RigGrid(
        base,
        baselines_m=_one(options, "baseline_mm", _SHARE),
        focals_px=focals_px,
        hfovs_deg=hfovs_deg,
        resolutions_px=() if options.resolution_px is None else (options.resolution_px,),
        vergences_deg=_one(options, "vergence_deg"),
        more=more,
    )
    return next(iter(grid))


def _number(options: MakeRigOptions, name: str) -> float:
    value = given.real(getattr(options, name), name)
    if not math.isfinite(value):
        raise InvalidRange(f"{name} {value}: must be a finite number")
    return value


def _one(options: MakeRigOptions, name: str, scale: float = 1.0) -> tuple[float, ...]:
    return () if getattr(options, name) is None else (_number(options, name) * scale,)


def _lens(options: MakeRigOptions) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Focal length in px and field of view in deg; at least one of the two is empty."""
    lenses = [name for name in ("focal_px", "focal_mm", "hfov_deg") if getattr(options, name) is not None]
    if len(lenses) > 1:
        raise InvalidRange(f"{' and '.join(lenses)} both given: they say the same thing, give one")
    chips = [name for name in ("pixel_pitch_um", "sensor_width_mm") if getattr(options, name) is not None]
    if options.focal_mm is None:
        if chips:
            raise InvalidRange(f"{chips[0]}: needs a focal_mm")
        return _one(options, "focal_px"), _one(options, "hfov_deg")
    if len(chips) != 1:
        raise InvalidRange("focal_mm: needs one of pixel_pitch_um and sensor_width_mm; or give focal_px")
    focal_mm, chip = _number(options, "focal_mm"), _number(options, chips[0])
    for name, value in (("focal_mm", focal_mm), (chips[0], chip)):
        if not value > 0:
            raise InvalidRange(f"{name} {value:g}: must be > 0")
    if chips == ["pixel_pitch_um"]:
        return (focal_mm * 1e3 / chip,), ()
    # behind the same sensor the lens keeps its field of view, whatever the resolution
    return (), (2 * math.degrees(math.atan(chip / 2 / focal_mm)),)
