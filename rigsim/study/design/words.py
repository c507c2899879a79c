"""Requirements and their values as a person says them."""

from __future__ import annotations

import math

from rigsim import digits as digits_of
from rigsim.rig.catalogue.sensors import sensor_preset
from rigsim.study.tolerance.first_order.needed import GOOD
from rigsim.theory.inverse import Camera, Relaxation, Requirement
from rigsim.theory.inverse_error import P95_OVER_STD


def rounded(value: float, up: bool, digits: int = 3) -> float:
    """`value` with `digits` significant digits, rounded up or down."""
    if value == 0 or not math.isfinite(value):
        return value
    scale = 10.0 ** (digits - 1 - math.floor(math.log10(abs(value))))
    return (math.ceil if up else math.floor)(value * scale * (1 - 1e-12 if up else 1 + 1e-12)) / scale


def distance(depth_m: float) -> str:
    """A distance in m."""
    return f"{depth_m:.4g} m"


def span(near_m: float, far_m: float) -> str:
    """A stretch of distances in m: ``1.63 to 1.65 m``."""
    near, far = f"{near_m:.3g}", f"{far_m:.3g}"
    return f"{near} m" if near == far else f"{near} to {far} m"


def share(of_rigs: float) -> str:
    """A share of rigs in whole percent, without the sign; 0 and 100 only where all agree, and 95, which are
    required, only where it is no less."""
    if 0 < of_rigs <= 0.005:
        return "< 1"
    if 0.945 <= of_rigs < GOOD:
        return f"{math.floor(of_rigs * 1000) / 10:.1f}"
    return "> 99" if 0.995 <= of_rigs < 1 else f"{of_rigs * 100:.0f}"


def size(length_m: float, digits: int = 3) -> str:
    """A length in mm, or in m from 1 m on."""
    return digits_of.length(1e3 * length_m, digits)


def value(requirement: Requirement, amount: float, digits: int = 4) -> str:
    """A value of the requirement's limit with its unit."""
    match requirement.kind:
        case "depth_error" | "cover" | "cover_height" | "max_baseline" | "min_baseline":
            return size(amount, digits)
        case "max_disparity":
            return f"{digits_of.short(amount, digits)} px"
        case "overlap":
            return f"{digits_of.short(amount * 100, digits)} %"
        case "fov" | "vfov":
            return f"{math.degrees(amount):.{digits}g}°"
        case "pixels":
            return f"{amount / 1e6:.{digits}g} MP"
        case _:
            return f"{digits_of.short(amount, digits)} sigma"


def name(requirement: Requirement) -> str:
    """What a requirement speaks of: ``depth error at 3 m``."""
    at = f" at {distance(requirement.depth_m)}" if requirement.depth_m > 0 else ""
    if requirement.kind == "depth_error":
        return ("p95 depth error" if requirement.per_std == P95_OVER_STD else "depth error") + at
    return {
        "far_disparity": "disparity over its noise",
        "max_disparity": "disparity search",
        "overlap": "overlap",
        "cover": "coverage",
        "cover_height": "coverage down",
        "max_baseline": "baseline limit",
        "min_baseline": "shortest baseline",
        "fov": "field of view",
        "vfov": "vertical field of view",
        "pixels": "image size",
    }[requirement.kind] + at


def whole(requirement: Requirement | None) -> str:
    """A requirement with its limit: ``depth error at 3 m <= 10 mm``."""
    if requirement is None:
        return "nothing"
    sign = ">=" if requirement.at_least else "<="
    return f"{name(requirement)} {sign} {value(requirement, requirement.limit)}"


def camera(which: Camera) -> str:
    """A camera in a few words."""
    lens = f"{which.name}, " if which.name else ""
    return (
        f"{lens}{which.width_px}x{which.height_px} px, focal length {which.focal_px:.4g} px, "
        f"{math.degrees(which.hfov_rad):.3g}° wide"
    )


def body(which: Camera) -> str:
    """Whose width keeps two cameras apart where none was said: an assumption, with its source."""
    housing = sensor_preset(which.sensor).housing
    if housing is None:
        return ""
    return (
        f"{which.sensor.upper()} cameras are taken to be {size(which.body_m)} wide, as is {housing.camera} "
        f"({housing.source}); --body-width says another width, 0 none"
    )


def relaxation(found: Relaxation, noise_px: float) -> str:
    """One way out: ``disparity search at 0.5 m from 128 px to 637 px``; rounded to the safe side."""
    asked = found.requirement
    if asked is None:
        return f"noise from {noise_px:.4g} px to {rounded(found.needed, up=False):.4g} px"
    scale = math.degrees(1) if asked.kind in ("fov", "vfov") else 1.0
    needed = rounded(found.needed * scale, up=not asked.at_least) / scale
    return f"{name(asked)} from {value(asked, asked.limit)} to {value(asked, needed)}"
