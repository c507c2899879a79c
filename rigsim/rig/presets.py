"""Rigs by name: the one each bundled scene is made for, and commercial cameras."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from rigsim.errors import InvalidScene
from rigsim.rig import given
from rigsim.rig.catalogue.commercial import CAMERAS, CommercialCamera, Figure, first
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig

_SAME_ANGLE_DEG = 1.0
_SAME_BASELINE = 0.01


@dataclass(frozen=True, slots=True)
class Preset:
    """A named rig and where its numbers come from."""

    name: str
    """Name on the command line."""
    rig: StereoRig
    """The rig."""
    about: str
    """What it is for, one line."""
    source: str
    """Where the numbers come from."""
    figures: tuple[Figure, ...] = ()
    """What is published of it, number by number; empty for a scene's rig."""

    def first(self, quantity: str) -> float | None:
        """The published figure of `quantity` that counts, as ``min_depth_mm``; None where there is none."""
        return first(self.figures, quantity)

    @property
    def claims(self) -> tuple[Figure, ...]:
        """The accuracies that the maker claims, near to far; of two at one distance the first."""
        at = {item.at_mm: item for item in reversed(self.figures) if item.quantity == "accuracy_pct"}
        return tuple(sorted(at.values(), key=lambda item: item.at_mm or 0.0))

    def claim_near(self, depth_mm: float) -> Figure | None:
        """The claim whose distance is nearest to `depth_mm` in proportion; None where there is none."""
        return min(self.claims, key=lambda item: abs(math.log(depth_mm / (item.at_mm or 1.0))), default=None)

    @property
    def sizes(self) -> tuple[tuple[int, int], ...]:
        """Image sizes (width, height) px that are published."""
        widths, heights = (
            [int(item.value) for item in self.figures if item.quantity == name]
            for name in ("width_px", "height_px")
        )
        return tuple(zip(widths, heights, strict=True))

    def lens_at(self, width: int, height: int) -> Intrinsics | None:
        """The lens of the published mode of that size whose focal length or field of view is published too;
        None where there is none."""
        for (wide, high), label in zip(self.sizes, self._labels, strict=True):
            if (wide, high) != (width, height) or not label:
                continue
            told = {
                item.quantity: item.value for item in self.figures if item.note.split(",")[0] == f"at {label}"
            }
            if "focal_px" in told:
                return Intrinsics.from_focal(width, height, told["focal_px"])
            if "hfov_deg" in told:
                return Intrinsics.from_hfov(width, height, told["hfov_deg"])
        return None

    @property
    def _labels(self) -> tuple[str, ...]:
        """What the maker calls each of `sizes`; empty where nothing is published."""
        return tuple(item.note for item in self.figures if item.quantity == "width_px")

    def mode(self, rig: StereoRig) -> str:
        """The image size of a rig that started from this camera, and what its maker calls that."""
        size = f"{rig.left.width}x{rig.left.height} px"
        named = (
            item for item in self.figures if item.quantity == "width_px" and item.value == rig.left.width
        )
        note = next((item.note for item in named if item.note), "")
        return f"{size} ({note})" if note else size

    def odd_mode(self, rig: StereoRig) -> Remark | None:
        """Whether a rig that started from this camera is one that it has no mode for; None for a scene's."""
        if not self.figures:
            return None
        lens, own = rig.left, self.rig.left
        odd = []
        if (lens.width, lens.height) not in self.sizes:
            published = " or ".join(f"{width}x{height}" for width, height in self.sizes)
            odd.append(f"{lens.width}x{lens.height} px instead of {published}")
        angles = (own.hfov_deg, *(item.value for item in self.figures if item.quantity == "hfov_deg"))
        if min(abs(lens.hfov_deg - angle) for angle in angles) > _SAME_ANGLE_DEG:
            odd.append(f"{lens.hfov_deg:.3g} deg wide instead of {own.hfov_deg:.3g}")
        if abs(rig.baseline_m / self.rig.baseline_m - 1) > _SAME_BASELINE:
            odd.append(f"{rig.baseline_m * 1e3:.4g} mm of baseline instead of {self.rig.baseline_m * 1e3:g}")
        if not odd:
            return None
        claims = " What its maker claims is of the published one" if self.claims else ""
        return Remark(
            "mode", f"{self.name}: {', '.join(odd)}, as published: does the camera have such a mode?{claims}"
        )


def _preset(
    name: str, width: int, height: int, focal_px: float, baseline_m: float, about: str, source: str = "rigsim"
) -> Preset:
    rig = StereoRig.rectified(Intrinsics.from_focal(width, height, focal_px), baseline_m)
    return Preset(name, rig, about, source)


def _bought(camera: CommercialCamera) -> Preset:
    """The rectified rig that the camera's first figures describe."""
    width, height, baseline_mm = (
        first(camera.figures, quantity) or 0.0 for quantity in ("width_px", "height_px", "baseline_mm")
    )
    focal_px = first(camera.figures, "focal_px")
    if focal_px is None:
        lens = Intrinsics.from_hfov(int(width), int(height), first(camera.figures, "hfov_deg") or 0.0)
    else:
        lens = Intrinsics.from_focal(int(width), int(height), focal_px)
    source = "published figures; rigsim presets " + camera.name
    return Preset(
        camera.name, StereoRig.rectified(lens, baseline_mm / 1e3), camera.about, source, camera.figures
    )


PRESETS: dict[str, Preset] = {
    preset.name: preset
    for preset in (
        _preset("boards", 1280, 720, 900.0, 0.120, "general indoor rig, 71 deg wide"),
        _preset(
            "branch",
            1280,
            960,
            1200.0,
            0.150,
            "drone that keeps clear of a branch at 2.57 m",
            "Multiview Calculator, first worked example",
        ),
        _preset(
            "artifact",
            1600,
            1200,
            2000.0,
            0.080,
            "desktop scan of an object at 1.07 m",
            "Multiview Calculator, second worked example",
        ),
        _preset("corridor", 1280, 720, 1000.0, 0.300, "mobile robot looking down a corridor"),
        _preset("bin", 1280, 960, 1100.0, 0.060, "bin picking from above"),
        *(_bought(camera) for camera in CAMERAS),
    )
}
"""Every preset by its name.

Example:
    >>> import rigsim
    >>> rigsim.PRESETS["bin"].rig.baseline_m
    0.06
"""


def preset(name: str) -> Preset:
    """The preset called `name`, in any case; ``OAK-D Lite`` and ``RealSense D435`` are understood too.

    Raises:
        InvalidScene: no preset has that name; the message lists those that exist.

    Example:
        >>> import rigsim
        >>> rigsim.preset("OAK-D").rig.baseline_m
        0.075
    """
    given.a(str, name, "the name of a preset, as text", InvalidScene)
    plain = re.sub(r"[\s_]+", "-", name.strip().lower())
    for maker in ("intel-", "realsense-", "luxonis-", "stereolabs-"):
        plain = plain.removeprefix(maker)
    try:
        return PRESETS[plain]
    except KeyError:
        raise InvalidScene(f"unknown preset {name!r}: choose one of {', '.join(PRESETS)}") from None


def published_lens(rig: StereoRig, width: int, height: int) -> Intrinsics | None:
    """The lens that a camera one can buy has in its mode of another size; None where `rig` is none of them,
    or nothing is published of such a mode."""
    bought = (item for item in PRESETS.values() if item.figures and item.rig == rig)
    return next((lens for item in bought if (lens := item.lens_at(width, height)) is not None), None)
