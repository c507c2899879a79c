"""Mistakes that a sweep names with their amount, in words."""

from __future__ import annotations

from rigsim.present.kit.sayings import Sentences

_TAKES = "than the triangulation takes it to be"
_TO = "than the triangulation takes it to"
_SIZE, _LENGTH = ("too large", "too small"), ("longer", "shorter")
_SIDES = {"both": "both cameras", "right": "the right camera", "left": "the left camera"}

_ALL: dict[str, tuple[str, tuple[str, str]]] = {
    "disparity-offset": ("a constant disparity offset: disparities are taken {amount} WAY", _SIZE),
    "scale": ("scale: all coordinates come back {amount} WAY", _SIZE),
    "depth-scale": ("scale of depth: Z comes back {amount} WAY, X and Y are right", _SIZE),
    "lateral-scale": ("scale: X and Y come back {amount} WAY, Z is right", _SIZE),
    "baseline": (f"baseline: it is {{amount}} WAY {_TAKES}", _LENGTH),
    "yaw": (f"yaw: the right camera looks {{amount}} further WAY {_TO}", ("right", "left")),
    "pitch": (f"pitch: the right camera looks {{amount}} further WAY {_TO}", ("up", "down")),
    "roll": (
        "roll: the right camera is turned {amount} WAY against what the triangulation takes",
        ("clockwise", "anticlockwise"),
    ),
    "axial": (
        f"the right camera stands {{amount}} further WAY along the optical axis {_TO}",
        ("forward", "back"),
    ),
    "vertical": (f"the right camera stands {{amount}} further WAY {_TO}", ("down", "up")),
}
_LENS: dict[str, tuple[str, tuple[str, str]]] = {
    "focal": (f"focal length of SIDE: it is {{amount}} WAY {_TAKES}", _LENGTH),
    "cx": (f"principal point of SIDE: it lies {{amount}} further WAY {_TAKES}", ("right", "left")),
    "cy": (f"principal point of SIDE: it lies {{amount}} further WAY {_TAKES}", ("down", "up")),
    "k1": (f"lens distortion k1 of SIDE: it is {{amount}} WAY {_TAKES}", ("greater", "less")),
    "fx": (f"a stretch of the image: fx of SIDE is {{amount}} WAY {_TAKES}, fy is right", _LENGTH),
    "fy": (f"a stretch of the image: fy of SIDE is {{amount}} WAY {_TAKES}, fx is right", _LENGTH),
}
_OFFSET = "a constant disparity offset, by the "


def _amount(amount: float, amount_se: float, unit: str) -> str:
    error = f" +- {amount_se:.1g}" if amount_se > 0.005 * abs(amount) else ""
    return f"{abs(amount):#.3g}{error} {unit}".rstrip()


def _lenses() -> dict[str, tuple[str, tuple[str, str]]]:
    """The mistakes with a lens, for both cameras and for each."""
    return {
        f"{side}-{name}": (_OFFSET * ((side, name) == ("left", "cx")) + sentence.replace("SIDE", words), ways)
        for side, words in _SIDES.items()
        for name, (sentence, ways) in _LENS.items()
    }


AMOUNTS: Sentences = {
    "amount": _amount,
    **{
        f"{name}: {sign}": sentence.replace("WAY", way)
        for name, (sentence, ways) in {**_ALL, **_lenses()}.items()
        for sign, way in zip(("more", "less"), ways, strict=True)
    },
}
"""Every mistake that has an amount: what it is, how large, and which way."""
