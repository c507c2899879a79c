"""A rig with its lenses in the model that a calibration uses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.rational import Rational
from rigsim.rig.lens.registry import ALL, BY_NAME
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.study.export.approximate import FAMILIES, Fitted, nearest

_WORDS: Mapping[str, type[Lens]] = MappingProxyType({"fisheye": KannalaBrandt})
"""What people call models besides their own names."""
_SELDOM = ("s1", "s2", "s3", "s4", "tau_x", "tau_y")
"""Of the rational model: thin prism and tilted sensor."""
_A_LOT_PX = 0.1


def lens_model(name: str) -> type[Lens]:
    """The lens model of a name: of the registry, or ``fisheye``.

    Raises:
        InvalidRange: there is none.
    """
    models = {**BY_NAME, **_WORDS}
    if name not in models:
        raise InvalidRange(f"lens model {name!r}: must be one of {', '.join(models)}")
    return models[name]


def own_model(rig: StereoRig) -> type[Lens]:
    """The model that a rig is calibrated in if nobody says: its lens's; brown where it has none."""
    lens = rig.left.lens or rig.right.lens
    return BrownConrady if lens is None else type(lens)


def seldom_estimated(rig: StereoRig, model: type[Lens]) -> tuple[str, ...]:
    """Coefficients that calibrations in `model` leave at 0 unless told otherwise, and that are 0 here."""
    lenses = [lens for lens in (rig.left.lens, rig.right.lens) if isinstance(lens, Rational)]
    if model is not Rational or any(getattr(lens, name) for lens in lenses for name in _SELDOM):
        return ()
    return _SELDOM


def in_model(rig: StereoRig, model: type[Lens]) -> tuple[StereoRig, tuple[Remark, ...]]:
    """The rig with both lenses in `model`, and a remark where it can only stand for it.

    Raises:
        InvalidRange: the model shows less than the rig does.
    """
    left, right = _in_model(rig.left, model), _in_model(rig.right, model)
    if left is None or right is None:
        title = own_model(rig).title
        raise InvalidRange(
            f"lens model {model.model}: shows no picture as wide as the rig's {title} lens does"
            f"{_better(rig, model)}"
        )
    made = StereoRig(left.camera, right.camera, rig.right_from_left)
    largest = max(left.largest_px, right.largest_px)
    if largest == 0:
        return made, ()
    rms = max(left.rms_px, right.rms_px)
    way_out = f", too much for a trustworthy plan{_better(rig, model, rms)}" if rms > _A_LOT_PX else ""
    return made, (
        Remark(
            "lens_model",
            f"the rig's lenses are fitted by the {model.title} model with {rms:.2g} px rms, {largest:.2g} px"
            f" at most{way_out}",
        ),
    )


def _better(rig: StereoRig, model: type[Lens], rms_px: float = np.inf) -> str:
    """The model that fits both lenses best, the simpler one of equals, as a way out."""
    own = own_model(rig)
    fits: list[tuple[float, str]] = []
    # the rig's own is exact where both lenses are of it, and spares the others
    for other in (own, *(each for each in ALL if each is not own)):
        left, right = (
            (None, None) if other is model else (_in_model(rig.left, other), _in_model(rig.right, other))
        )
        if left is None or right is None:
            continue
        fits.append((max(left.rms_px, right.rms_px), other.model))
        if fits[-1][0] == 0:
            break
    best_px, name = min(fits, key=lambda fit: fit[0], default=(np.inf, ""))
    if not best_px < rms_px:
        return ", and no other model does better"
    how = "holds them exactly" if best_px == 0 else f"fits them with {best_px:.2g} px rms"
    return f": --model {name} {how}"


def _bends_nothing(lens: Lens) -> bool:
    """Whether a pinhole shows the same."""
    across = np.linspace(-1.0, 1.0, 9)
    image = np.stack(np.meshgrid(across, across), axis=-1).reshape(-1, 2)
    return bool(np.allclose(lens.bent(image), image, rtol=0, atol=1e-12))


def _in_model(camera: Intrinsics, model: type[Lens]) -> Fitted | None:
    """The camera in `model`, exactly if that holds it."""
    lens = camera.lens
    if isinstance(lens, model):
        return Fitted(camera, 0.0, 0.0)
    if lens is None and _bends_nothing(model()):
        return Fitted(camera, 0.0, 0.0)
    if isinstance(lens, BrownConrady) and issubclass(model, Rational):
        wider = model(**{name: getattr(lens, name) for name in lens.names()})
        return Fitted(replace(camera, lens=wider), 0.0, 0.0)
    if isinstance(lens, Rational) and issubclass(model, BrownConrady):
        own = BrownConrady.names()
        if not any(getattr(lens, name) for name in lens.names() if name not in own):
            return Fitted(
                replace(camera, lens=model(**{name: getattr(lens, name) for name in own})), 0.0, 0.0
            )
    fits = [nearest(camera, family) for family in FAMILIES if family.lens is model]
    made = [fit for fit in fits if fit is not None]
    return min(made, key=lambda fit: fit.rms_px, default=None)
