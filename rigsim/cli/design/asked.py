"""What `rigsim design` is asked for, as typed: ranges, errors with a distance, cameras to try."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from rigsim.cli.kit import quantity
from rigsim.errors import InvalidRange, InvalidRig
from rigsim.rig import extent

if TYPE_CHECKING:
    from rigsim.rig.catalogue.sensors import SensorPreset
    from rigsim.theory.inverse import Camera, Requirement

_PERCENT = re.compile(r"([0-9]*\.?[0-9]+)\s*%")
_UNIT = quantity.UNIT


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


def depth_error(text: str, far_m: float) -> Requirement:
    """``10mm@3m``, ``1%`` or ``p95:20mm@3m``."""
    from rigsim.theory.inverse import Requirement
    from rigsim.theory.inverse_error import P95_OVER_STD

    body, n_p95 = re.subn(r"\s*:?\bp95\b:?\s*", "", text.strip(), flags=re.IGNORECASE)
    what, at_m = at_distance(body, far_m, "depth error")
    per_std = P95_OVER_STD if n_p95 else 1.0
    match = _PERCENT.fullmatch(what)
    if match:
        share = float(match[1]) / 100
        if share > 1:
            raise InvalidRange(f"depth error {what}: must be <= 100 % of the distance")
        return Requirement("depth_error", share * at_m, at_m, per_std)
    if not _UNIT.search(what):
        raise InvalidRange(f"depth error {text}: mm or %? Write the unit, as in 10mm@3m or 1%")
    return Requirement("depth_error", metres(what, "depth error"), at_m, per_std)


def overlap(text: str, near_m: float) -> Requirement:
    """``80%`` at the near end, or ``80%@1m``."""
    from rigsim.theory.inverse import Requirement

    what, at_m = at_distance(text, near_m, "min overlap")
    return Requirement("overlap", _share(what), at_m)


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


def cameras(resolution: str | None, sensor: str | None, lens: str | None, fov: str | None) -> list[Camera]:
    """Every camera to try: each image size or sensor with each lens."""
    from rigsim.study.design.solve import HFOVS_DEG, LENSES_MM, RESOLUTIONS
    from rigsim.theory.inverse import Camera

    if resolution is not None and sensor is not None:
        raise InvalidRange("--resolution and --sensor both given: a sensor has its own resolution, give one")
    unit, lenses = _lenses(lens)
    extent.CAMERAS.check(max(1, len(lenses)))
    if sensor is not None and unit in ("", "mm"):
        return [
            _behind(chip, mm * 1e3 / chip.pitch_um) for chip in _chips(sensor) for mm in (lenses or LENSES_MM)
        ]
    if unit == "mm":
        raise InvalidRange(f"lens {lens}: mm need a --sensor with its pixel pitch; or give px or deg")
    wanted = (quantity.value(fov, quantity.HFOV),) if fov is not None else ()
    angles = lenses or tuple(sorted({*HFOVS_DEG, *wanted}))

    def focals_px(width_px: int) -> tuple[float, ...]:
        if unit == "px":
            return lenses
        return tuple(width_px / 2 / math.tan(math.radians(deg) / 2) for deg in angles)

    if sensor is not None:
        return [_behind(chip, focal) for chip in _chips(sensor) for focal in focals_px(chip.width)]
    sizes = quantity.resolutions(resolution) if resolution is not None else RESOLUTIONS
    return [Camera(w, h, focal) for w, h in sizes for focal in focals_px(w)]


def _chips(names: str) -> list[SensorPreset]:
    from rigsim.rig.catalogue.sensors import sensor_preset

    chips: list[SensorPreset] = []
    for name in names.split(","):
        chip = sensor_preset(name.strip())
        if chip in chips:
            raise InvalidRange(f"sensor {names}: {chip.name} stands there twice; remove one")
        chips.append(chip)
    return chips


def _behind(chip: SensorPreset, focal_px: float) -> Camera:
    from rigsim.theory.inverse import Camera

    mm = focal_px * chip.pitch_um / 1e3
    name = f"{chip.name.upper()} with {mm:.3g} mm"
    return Camera(chip.width, chip.height, focal_px, name, chip.name, mm, chip.pitch_um)


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
