"""What OpenCV's calibration can estimate, and hold, of a camera: its flags."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from rigsim.errors import InvalidRange
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.rational import Rational

_PRISM = ("s1", "s2", "s3", "s4")
_TILT = ("tau_x", "tau_y")
_WORDS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"focal": ("fx", "fy"), "principal": ("cx", "cy"), "tangential": ("p1", "p2")}
)
_POLYNOMIAL: Mapping[tuple[str, ...], str] = MappingProxyType(
    {
        ("aspect",): "CALIB_FIX_ASPECT_RATIO",
        ("fx", "fy"): "CALIB_FIX_FOCAL_LENGTH",
        ("cx", "cy"): "CALIB_FIX_PRINCIPAL_POINT",
        ("p1", "p2"): "CALIB_FIX_TANGENT_DIST",
        **{(f"k{k}",): f"CALIB_FIX_K{k}" for k in range(1, 7)},
        _PRISM: "CALIB_FIX_S1_S2_S3_S4",
        _TILT: "CALIB_FIX_TAUX_TAUY",
    }
)
_FISHEYE: Mapping[tuple[str, ...], str] = MappingProxyType(
    {
        ("fx", "fy"): "CALIB_FIX_FOCAL_LENGTH",
        ("cx", "cy"): "CALIB_FIX_PRINCIPAL_POINT",
        **{(f"k{k}",): f"CALIB_FIX_K{k}" for k in range(1, 5)},
    }
)
"""What one flag holds, together, in the lens models of either kind."""


@dataclass(frozen=True, slots=True)
class CameraModel:
    """A lens model as OpenCV calibrates it."""

    lens: type[Lens] | None
    """The model; None is a pinhole."""
    terms: tuple[str, ...]
    """Its coefficients in OpenCV's order, as many as are passed."""
    flags: tuple[str, ...]
    """Names of the flags that choose it and hold what is held."""

    @property
    def fisheye(self) -> bool:
        """Whether it is of ``cv2.fisheye``."""
        return self.lens is KannalaBrandt

    def flag(self, cv2: Any, *others: str) -> int:
        """All flags, and `others`, as one number."""
        return sum(int(getattr(cv2, name)) for name in dict.fromkeys((*self.flags, *others)))


def camera_model(lenses: tuple[type[Lens] | None, type[Lens] | None], fix: Sequence[str] = ()) -> CameraModel:
    """The model of both cameras.

    Args:
        lenses: Brown-Conrady, rational, Kannala-Brandt or None (a pinhole), the same of both.
        fix: What is held: ``aspect``, ``focal``, ``principal``, ``tangential``, ``lens``, a coefficient.
            Flags of OpenCV hold both cameras, and fx and fy, cx and cy, p1 and p2 together.

    Raises:
        InvalidRange: OpenCV knows no such model, or cannot hold this.
    """
    lens = lenses[0]
    if lenses[1] is not lens:
        names = " and ".join("pinhole" if each is None else each.model for each in lenses)
        raise InvalidRange(f"lens models {names}: OpenCV calibrates both cameras in the same one")
    if lens not in (None, BrownConrady, Rational, KannalaBrandt):
        assert lens is not None
        raise InvalidRange(
            f"lens model {lens.model}: OpenCV calibrates pinhole, brown, rational and kannala_brandt"
        )
    known = _FISHEYE if lens is KannalaBrandt else _POLYNOMIAL
    terms = BrownConrady.names() if lens is None else lens.names()
    held = _held(fix, terms, known)
    if lens is None:
        held |= set(terms)
    flags = ["CALIB_RECOMPUTE_EXTRINSIC", "CALIB_FIX_SKEW"] if lens is KannalaBrandt else []
    if lens is Rational:
        flags.append("CALIB_RATIONAL_MODEL")
        more = [_PRISM not in _groups(held, known), _TILT not in _groups(held, known)]
        terms = terms[: 14 if more[1] else 12 if more[0] else 8]
        flags += [
            f"CALIB_{name}_MODEL" for name, on in (("THIN_PRISM", any(more)), ("TILTED", more[1])) if on
        ]
    allowed = {"aspect", "fx", "fy", "cx", "cy", *terms}
    flags += [known[group] for group in _groups(held, known) if set(group) <= allowed]
    return CameraModel(lens, terms, tuple(flags))


def _held(fix: Sequence[str], terms: Sequence[str], known: Mapping[tuple[str, ...], str]) -> set[str]:
    """Names that are held, of both cameras."""
    by_side: dict[str, set[str]] = {"left": set(), "right": set()}
    for word in fix:
        side, dot, name = word.partition(".")
        name = name if dot else word
        members = terms if name == "lens" else _WORDS.get(name, (name,))
        for each in (side,) if dot else by_side:
            by_side.setdefault(each, set()).update(members)
    held = by_side["left"]
    if by_side["right"] != held or len(by_side) > 2:
        raise InvalidRange(f"fix {','.join(fix)}: OpenCV holds what it holds of both cameras alike")
    left_over = held - {name for group in _groups(held, known) for name in group}
    if left_over:
        ways = ", ".join(" with ".join(group) for group in known)
        raise InvalidRange(
            f"fix {', '.join(sorted(left_over))}: OpenCV cannot hold this; with this lens it holds {ways}"
        )
    return held


def _groups(held: set[str], known: Mapping[tuple[str, ...], str]) -> list[tuple[str, ...]]:
    return [group for group in known if set(group) <= held]


Solver = Callable[..., Any]
