"""What `rigsim design` is asked for, as typed: ranges, errors with a distance, cameras to try."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from rigsim.errors import InvalidRange, InvalidRig
from rigsim.typed import quantity
from rigsim.typed.tolerances import row_error, tolerance_values

if TYPE_CHECKING:
    from rigsim.api.kit.asked import DepthError

_PERCENT = re.compile(r"([0-9]*\.?[0-9]+)\s*%")
_UNIT = quantity.UNIT
_BODY = quantity.QuantityKind("body width", "mm", quantity.BASELINE.factors, at_least=0)


def design_arguments(typed: Mapping[str, Any]) -> dict[str, Any]:
    """What `rigsim.design` is asked for, from the options of `rigsim design` by their names in Python.

    Args:
        typed: the options as typed, None where nothing was; ``depth_error``, ``min_overlap`` and
            ``tolerance`` are lists. ``depth_range`` and ``depth_error`` are needed.

    Raises:
        InvalidRange: a word cannot be read, or is out of bounds.
        InvalidRig: a lens has no unit.
    """
    near_mm, far_mm = working_range(typed["depth_range"])
    found = cameras(
        typed.get("resolution"),
        typed.get("sensor"),
        typed.get("lens"),
        pixel_pitch=typed.get("pixel_pitch"),
        sensor_width=typed.get("sensor_width"),
        crop=typed.get("crop"),
        binning=typed.get("binning", 1),
    )
    tolerances, bounds = tolerance_values(typed.get("tolerance") or [])
    named = {"prefer": "prefer", "class_name": "tolerance_class", "calibration": "calibration"}
    return {
        "range_m": (near_mm / 1e3, far_mm / 1e3),
        **found,
        **_required(typed, near_mm / 1e3, far_mm / 1e3),
        **{to: typed[word] for word, to in named.items() if typed.get(word) is not None},
        "tolerances": tolerances,
        "bounds": bounds,
    }


_READ: Mapping[str, tuple[str, quantity.QuantityKind]] = {
    "fov": ("fov_deg", quantity.HFOV),
    "vfov": ("vfov_deg", quantity.HFOV),
    "min_baseline": ("min_baseline_mm", quantity.BASELINE),
    "body_width": ("body_width_mm", _BODY),
    "max_baseline": ("max_baseline_mm", quantity.BASELINE),
    "max_disparity": ("max_disparity_px", quantity.DISPARITY),
    "noise": ("noise_px", quantity.NOISE),
    "disparity_noise": ("disparity_noise_px", quantity.DISPARITY_NOISE),
}


def _required(typed: Mapping[str, Any], near_m: float, far_m: float) -> dict[str, Any]:
    """What a rig has to do, as `rigsim.design` takes it."""
    said = {word: text for word, text in typed.items() if text is not None}
    found: dict[str, Any] = {"errors": [depth_error(text, far_m) for text in said["depth_error"]]}
    for word, (name, kind) in _READ.items():
        if word in said:
            found[name] = quantity.value(said[word], kind)
    if "cover" in said:
        found["cover_mm"], found["cover_at_m"] = cover(said["cover"], far_m)
    if "max_pixels" in said:
        found["max_pixels"] = pixels(said["max_pixels"])
    overlaps = [overlap(text, near_m) for text in said.get("min_overlap", ())]
    found["min_overlap"] = [share for share, _ in overlaps]
    found["min_overlap_at_m"] = [at_m for _, at_m in overlaps]
    if "nearest_focus" in said:
        found["nearest_focus_m"] = metres(said["nearest_focus"], "nearest focus")
    if "max_row_error" in said:
        found["max_row_error_px"] = row_error(said["max_row_error"])
    if "build_share" in said:
        found["build_share"] = build_share(said["build_share"])
    return found


def working_range(text: str) -> tuple[float, float]:
    """Near and far end, mm, of ``0.5:3m``."""
    if not _UNIT.search(text):
        raise InvalidRange(f"range {text or 'empty'}: m or mm? Write the unit, as in 0.5:3m")
    if re.match(r"\s*0*\.?0*\s*(mm|cm|m)?\s*:", text) and text.strip()[:1] in "0.":
        raise InvalidRange(
            f"range {text}: starts at 0, where no two cameras see anything; start it farther off"
        )
    return quantity.span(text, quantity.DEPTH)


def at_distance(text: str, otherwise_m: float, name: str) -> tuple[str, float]:
    """What stands before the @, and the distance after it, m; `otherwise_m` without one."""
    what, at, where = text.partition("@")
    return what.strip(), metres(where, f"{name} {text}, distance") if at else otherwise_m


def metres(text: str, name: str) -> float:
    """A length that needs its unit, m."""
    if not _UNIT.search(text):
        raise InvalidRange(f"{name} {text.strip() or 'empty'}: of what? Write the unit, as in 10mm or 3m")
    kind = quantity.QuantityKind(name, "mm", quantity.DEPTH.factors, above=0)
    return quantity.value(text.strip(), kind) / 1e3


def depth_error(text: str, far_m: float) -> DepthError:
    """``10mm@3m``, ``1%`` or ``p95:20mm@3m``."""
    from rigsim.api.kit.asked import DepthError

    body, n_p95 = re.subn(r"\s*:?\bp95\b:?\s*", "", text.strip(), flags=re.IGNORECASE)
    what, at_m = at_distance(body, far_m, "depth error")
    match = _PERCENT.fullmatch(what)
    if match:
        if float(match[1]) > 100:
            raise InvalidRange(f"depth error {what}: must be <= 100 % of the distance")
        return DepthError(at_m, pct=float(match[1]), p95=bool(n_p95))
    if not _UNIT.search(what):
        raise InvalidRange(f"depth error {text}: mm or %? Write the unit, as in 10mm@3m or 1%")
    return DepthError(at_m, metres(what, "depth error") * 1e3, p95=bool(n_p95))


def overlap(text: str, near_m: float) -> tuple[float, float]:
    """The share and the distance, m, of ``80%``, at the near end, or ``80%@1m``."""
    what, at_m = at_distance(text, near_m, "min overlap")
    return _share(what), at_m


def build_share(text: str) -> float:
    """``50%`` or ``0.5``."""
    return _share(text, "build share")


def _share(text: str, name: str = "min overlap") -> float:
    match = _PERCENT.fullmatch(text.strip())
    try:
        share = float(match[1]) / 100 if match else float(text)
    except ValueError:
        raise InvalidRange(f"{name} {text or 'empty'}: must be a percentage, as in 80%") from None
    if not match and share > 1:
        raise InvalidRange(f"{name} {text}: percent or share? Write {text}% or a number under 1")
    if name == "min overlap" and not 0 <= share < 1:
        raise InvalidRange(
            f"min overlap {text}: must be >= 0 % and < 100 %; only a rig without baseline has it"
        )
    return share


def pixels(text: str) -> float:
    """Pixels of ``2MP``."""
    match = re.fullmatch(r"\s*([0-9]*\.?[0-9]+)\s*(MP|Mpx|px)\s*", text, re.IGNORECASE)
    if match is None:
        raise InvalidRange(f"max pixels {text or 'empty'}: must be a number with MP or px, as in 2MP")
    return float(match[1]) * (1 if match[2].lower() == "px" else 1e6)


def cover(text: str, far_m: float) -> tuple[float | tuple[float, float], float]:
    """Width, or width and height, mm, and the distance, m, of ``2m@3m`` or ``0.8x0.6m@1.2m``."""
    what, at_m = at_distance(text, far_m, "cover")
    width, by, height = what.partition("x")
    if not by:
        return metres(what, "cover") * 1e3, at_m
    unit = _UNIT.search(what)
    if unit is not None and not _UNIT.search(width):
        width += unit[0].strip()
    return (metres(width, "cover") * 1e3, metres(height, "cover") * 1e3), at_m


def cameras(
    resolution: str | None,
    sensor: str | None,
    lens: str | None,
    *,
    pixel_pitch: str | None = None,
    sensor_width: str | None = None,
    crop: str | None = None,
    binning: int = 1,
) -> dict[str, Any]:
    """The cameras to try, as `rigsim.design` takes them."""
    unit, lenses = _lenses(lens)
    found: dict[str, Any] = {f"lenses_{unit}": lenses} if unit else {}
    if sensor is not None:
        found["sensors"] = [name.strip() for name in sensor.split(",")]
    if resolution is not None:
        found["resolutions_px"] = quantity.resolutions(resolution)
    if pixel_pitch is not None:
        found["pixel_pitch_um"] = quantity.value(pixel_pitch, quantity.PIXEL_PITCH) * 1e3
    if sensor_width is not None:
        found["sensor_width_mm"] = quantity.value(sensor_width, quantity.SENSOR_WIDTH)
    if crop is not None:
        (found["crop_px"],) = _one_size(crop)
    return {**found, "binning": binning}


def _one_size(crop: str) -> list[tuple[int, int]]:
    found = list(quantity.resolutions(crop))
    if len(found) != 1:
        raise InvalidRange(f"crop {crop}: {len(found)} sizes; give one, as in 1920x1080")
    return found


def _lenses(text: str | None) -> tuple[str, tuple[float, ...]]:
    """The unit of --lens, mm, px or deg, and its values in it; nothing when it is not given."""
    if text is None:
        return "", ()
    units = set(re.findall(r"[a-zA-Zµμ°]+", text))
    if not units:
        raise InvalidRig(f"lens {text or 'empty'}: mm, px or deg? Write the unit, as in 2.8,4,6,8mm")
    if units <= {"deg", "°"}:
        return "deg", quantity.values(text, quantity.HFOV)
    values, unit = quantity.focal_lengths(text)
    return unit, values
