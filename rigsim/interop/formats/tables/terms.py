"""OpenCV's list of distortion terms, in files that have it in OpenCV's order."""

from __future__ import annotations

from rigsim.errors import InvalidRig
from rigsim.rig.arrays import Array
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.rational import Rational

_COUNTS = (0, 4, 5, 8, 12, 14)


def opencv_lens(D: Array, name: str) -> Lens | None:
    """The lens of OpenCV's k1, k2, p1, p2[, k3[, k4, k5, k6[, s1 to s4[, tau_x, tau_y]]]]; None for none.

    Brown-Conrady's where the terms beyond k3 are 0.

    Raises:
        InvalidRig: there are more or fewer.
    """
    if len(D) not in _COUNTS:
        raise InvalidRig(f"{name}: has {len(D)} numbers, must be 4, 5, 8, 12 or 14 (OpenCV's order)")
    terms = [float(value) for value in D] + [0.0] * (14 - len(D))
    if not any(terms):
        return None
    return Rational(*terms) if any(terms[5:]) else BrownConrady(*terms[:5])


def opencv_terms(lens: Lens | None, who: str) -> tuple[float, ...]:
    """The 14 terms of a lens in OpenCV's order; zeros for none.

    Raises:
        InvalidRig: the model is neither Brown-Conrady's nor the rational one; the message says what `who`
            takes.
    """
    if lens is None:
        return (0.0,) * 14
    if not isinstance(lens, BrownConrady | Rational):
        raise InvalidRig(f"lens {lens.said}: {who} takes OpenCV's terms alone (brown, rational)")
    terms = tuple(float(getattr(lens, name)) for name in lens.names())
    return terms + (0.0,) * (14 - len(terms))
