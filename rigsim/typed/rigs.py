"""From options about rigs to a grid of rigs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rigsim.errors import InvalidRange
from rigsim.study.scene.axes import registry
from rigsim.typed import quantity
from rigsim.typed.axes import numbers_of, values_of

if TYPE_CHECKING:
    from rigsim.interop.formats.kit.reading import Reading, RigFiles
    from rigsim.rig.remark import Remark
    from rigsim.rig.stereo import PixelGrid, StereoRig
    from rigsim.study.scene.plan import RigGrid

DEFAULT_PRESET = "boards"
_SAME_WIDTH = 0.01
"""By which a sensor's width and its pixels' may differ: data sheets round."""


@dataclass(frozen=True, slots=True)
class RigOptions:
    """The words that describe rigs, as typed; None where nothing was."""

    rig: Path | tuple[Path, ...] | None = None
    """A calibration's file or folder, or its files."""
    rig_unit: str | None = None
    rig_size: str | None = None
    rig_swap: bool = False
    rig_cameras: str | None = None
    rig_mode: str | None = None
    preset: str | None = None
    crop: str | None = None
    binning: str | None = None
    resize: str | None = None
    baseline: str | None = None
    focal: str | None = None
    hfov: str | None = None
    sensor_width: str | None = None
    pixel_pitch: str | None = None
    resolution: str | None = None
    vergence: str | None = None
    more: tuple[tuple[str, str], ...] = ()
    """Other axes that change the rig, by name."""
    read: StereoRig | None = None
    """A rig that was read already, in place of a file's."""
    found: Reading | None = field(default=None, compare=False)
    """The calibration that was named, where it was read already."""

    @classmethod
    def of(cls, typed: Mapping[str, Any], **others: Any) -> RigOptions:
        """From what was typed, by the options' names; axes that do not change the rig are left out."""
        own = {name: text for name, text in typed.items() if name in cls.__dataclass_fields__}
        paths = others.get("rig")
        if isinstance(paths, list):
            others["rig"] = tuple(paths) if len(paths) > 1 else paths[0] if paths else None
        more = ((axis.name, typed.get(axis.name)) for axis in registry.OF_RIG if axis.name not in own)
        return cls(**own, **others, more=tuple((name, text) for name, text in more if text is not None))

    def typed(self) -> list[tuple[str, str]]:
        """The options that were typed, with their values."""
        own = (
            (name, getattr(self, name))
            for name in type(self).__dataclass_fields__
            if name not in ("more", "read", "found", "rig", "rig_swap")
        )
        said = [(name.replace("_", "-"), str(value)) for name, value in own if value is not None]
        files = self.files
        paths = [] if files is None else [("rig", str(path)) for path in files.paths]
        return [*paths, *([("rig-swap", "")] if self.rig_swap else []), *said, *self.more]

    @property
    def files(self) -> RigFiles | None:
        """The calibration that was named, with what was said of it; None where none was.

        Raises:
            InvalidRange: what was said cannot be read, or nothing was named that it is about.
        """
        from rigsim.interop.formats.kit.reading import RigFiles, RigReading

        size = None if self.rig_size is None else _one_size(self.rig_size, "rig size")
        said = RigReading(
            *(self.rig_unit, size, self.rig_swap, _two_names(self.rig_cameras), self.rig_mode),
            grid=self.pixel_grid,
        )
        if self.rig is None:
            if replace(said, grid=RigReading().grid) != RigReading():
                raise InvalidRange("--rig-... says something of a calibration: name its file with --rig")
            return None
        return RigFiles(self.rig if isinstance(self.rig, tuple) else (self.rig,), said)

    @property
    def pixel_grid(self) -> PixelGrid:
        """What is done to the pictures of the rig that was named.

        Raises:
            InvalidRange: it cannot be read, is said twice, or no rig was named that it is about.
        """
        from rigsim.rig.stereo import PixelGrid

        words = (("crop", self.crop), ("binning", self.binning), ("resize", self.resize))
        typed = [name for name, word in words if word is not None]
        if typed and not any((self.rig, self.preset, self.read)):
            raise InvalidRange(f"--{typed[0]} changes the pictures of a rig: name one with --rig or --preset")
        if self.resize is not None and self.resolution is not None:
            raise InvalidRange("--resize and --resolution both given: both set the picture's size, give one")
        return PixelGrid(
            None if self.crop is None else quantity.rectangle(self.crop, "crop"),
            None if self.binning is None else quantity.count(self.binning, "binning"),
            None if self.resize is None else _one_size(self.resize, "resize"),
        )

    def reading(self) -> Reading | None:
        """The calibration that was named, as it was read; None where none was.

        Raises:
            RigsimError: it cannot be read.
        """
        files = self.files
        if files is None or self.found is not None:
            return self.found
        from rigsim.interop.formats.calibration import read

        return read(files.paths, files.said)

    @property
    def has_size(self) -> bool:
        """Whether anything says how large the images are."""
        given = (self.rig, self.read, self.preset, self.resolution)
        return any(word is not None for word in given)

    def base(self, scene: str) -> StereoRig:
        """The rig that is varied: the file's, the preset's, or the one made for the scene."""
        from rigsim.rig.presets import PRESETS, preset

        if self.rig is not None and self.preset is not None:
            raise InvalidRange("--rig and --preset both given: give one")
        if self.read is not None:
            return self.pixel_grid.apply(self.read)
        found = self.reading()
        if found is not None:
            return found.rig
        name = self.preset or (scene if scene in PRESETS else DEFAULT_PRESET)
        return self.pixel_grid.apply(preset(name).rig)

    def each(self) -> list[tuple[str, RigOptions]]:
        """One for each rig of ``--preset a,b`` or ``--rig a.toml,b.toml``, and what it is called.

        Raises:
            InvalidRange: a name is empty, or given twice.
        """
        if isinstance(self.rig, tuple):
            return [("rig", self)]
        field, text = ("preset", self.preset) if self.rig is None else ("rig", str(self.rig))
        if text is None:
            return [("rig", self)]
        whole = "," not in text or (field == "rig" and Path(text).exists())
        names = [text] if whole else [part.strip() for part in text.split(",")]
        if not all(names):
            raise InvalidRange(f"--{field} {text}: a name is missing; write them with commas between")
        twice = next((name for place, name in enumerate(names) if name in names[:place]), None)
        if twice is not None:
            raise InvalidRange(f"--{field} {text}: {twice} is given twice; remove one")
        if field == "rig":
            return [(name, replace(self, rig=Path(name), found=None)) for name in names]
        from rigsim.rig.presets import preset

        return [(preset(name).name, replace(self, preset=name)) for name in names]

    def mode_remarks(self, rig: StereoRig) -> list[Remark]:
        """What is odd about a rig that started from a file, or from a camera one can buy."""
        found, shape = self.reading(), self.shape_remarks()
        if found is not None:
            return [*found.remarks, *shape]
        if self.preset is None:
            return []
        from rigsim.rig.presets import preset

        odd = preset(self.preset).odd_mode(rig)
        return [*([] if odd is None else [odd]), *shape]

    def shape_remarks(self) -> list[Remark]:
        """What becomes of the named rig's pictures that shall have another shape, unless the lens is said."""
        unnamed = self.rig is None and self.preset is None
        if unnamed or self.resolution is None or self.focal is not None or self.hfov is not None:
            return []
        from rigsim.study.scene.axes.resolution import shape_remark

        base = self.base(DEFAULT_PRESET)
        found = (shape_remark(base, *size) for size in quantity.resolutions(self.resolution))
        return [remark for remark in found if remark is not None]

    def disparity_range(self) -> tuple[float, float] | None:
        """Disparities to search, px, as a Middlebury calib.txt says; None where nothing says."""
        files = self.files
        if files is None:
            return None
        from rigsim.interop.formats.calibration import disparity_range

        return disparity_range(files.paths, files.said.grid)

    def published_search(self) -> tuple[tuple[float, float], str] | None:
        """Disparities that the rig's own matcher searches, px, and who says so; None where nobody does."""
        if self.preset is not None:
            from rigsim.rig.presets import preset

            named = preset(self.preset)
            most_px = named.first("max_disparity_px")
            return None if most_px is None else ((0.0, most_px), f"as published of {named.name}")
        told = self.disparity_range()
        return None if told is None else (told, f"as {self.files} says")

    def grid(self, scene: str) -> RigGrid:
        """All rigs asked for.

        Raises:
            InvalidRange: a value cannot be read, or two options contradict each other.
        """
        from rigsim.study.scene.plan import RigGrid

        base = self.base(scene)
        resolutions_px = quantity.resolutions(self.resolution) if self.resolution is not None else ()
        widths_px = tuple(width for width, _ in resolutions_px) or (base.left.width,)
        focals_px, hfovs_deg = self._lenses(widths_px)
        return RigGrid(
            base=base,
            baselines_m=tuple(
                mm / 1e3
                for mm in (
                    quantity.values(self.baseline, quantity.BASELINE) if self.baseline is not None else ()
                )
            ),
            focals_px=focals_px,
            hfovs_deg=hfovs_deg,
            resolutions_px=resolutions_px,
            vergences_deg=quantity.values(self.vergence, quantity.VERGENCE)
            if self.vergence is not None
            else (),
            more=values_of(dict(self.more), registry.OF_RIG),
        )

    def axes(self, scene: str) -> dict[str, Any]:
        """The same, as `rigsim.sweep` takes them: the rig, and the values of its own axes."""
        grid = self.grid(scene)
        baselines = () if self.baseline is None else quantity.values(self.baseline, quantity.BASELINE)
        return {
            "rig": self.files or grid.base,
            "baselines_mm": baselines,
            "focals_px": grid.focals_px,
            "hfovs_deg": grid.hfovs_deg,
            "resolutions_px": grid.resolutions_px,
            "vergences_deg": grid.vergences_deg,
        }

    def other_axes(self) -> dict[str, tuple[float, ...]]:
        """The values of the other axes that change the rig, by name."""
        return numbers_of(dict(self.more), registry.OF_RIG)

    def single(self, scene: str) -> StereoRig:
        """The one rig asked for.

        Raises:
            InvalidRange: the options describe several.
        """
        grid = self.grid(scene)
        if len(grid) != 1:
            raise InvalidRange(f"{len(grid)} rigs given: this command takes one; `rigsim sweep` takes many")
        return next(iter(grid))

    def _lenses(self, widths_px: Sequence[int]) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Focal lengths in px and fields of view in deg; one of the two is empty."""
        hfovs_deg = quantity.values(self.hfov, quantity.HFOV) if self.hfov is not None else ()
        if self.focal is None:
            if self.sensor_width or self.pixel_pitch:
                raise InvalidRange("--sensor-width and --pixel-pitch need a --focal in mm")
            return (), hfovs_deg
        focals, unit = quantity.focal_lengths(self.focal)
        if unit == "px":
            if self.sensor_width or self.pixel_pitch:
                raise InvalidRange(
                    f"focal length {self.focal} is in px, and needs no --sensor-width or --pixel-pitch: "
                    f"write the unit, as in {self.focal.removesuffix('px').strip()}mm, or leave those out"
                )
            return focals, hfovs_deg
        if self.pixel_pitch:
            pitch_mm = quantity.value(self.pixel_pitch, quantity.PIXEL_PITCH)
            self._check_width(pitch_mm, widths_px)
            return tuple(mm / pitch_mm for mm in focals), hfovs_deg
        if self.sensor_width:
            # behind the same sensor the lens keeps its field of view, whatever the resolution
            from math import atan, degrees

            width_mm = quantity.value(self.sensor_width, quantity.SENSOR_WIDTH)
            lens = tuple(2 * degrees(atan(width_mm / 2 / mm)) for mm in focals)
            if hfovs_deg:
                raise InvalidRange("--focal and --hfov both given: they say the same thing, give one")
            return (), lens
        raise InvalidRange(
            f"focal length {self.focal}: mm needs --sensor-width or --pixel-pitch; or give it in px"
        )

    def _check_width(self, pitch_mm: float, widths_px: Sequence[int]) -> None:
        """Raise when --sensor-width is not what the pixels add up to."""
        if not self.sensor_width:
            return
        width_mm = quantity.value(self.sensor_width, quantity.SENSOR_WIDTH)
        for width_px in widths_px:
            if abs(width_px * pitch_mm - width_mm) > _SAME_WIDTH * width_mm:
                raise InvalidRange(
                    f"sensor width {width_mm:g} mm: {width_px} px of {pitch_mm * 1e3:g} um make "
                    f"{width_px * pitch_mm:.4g} mm; give --sensor-width or --pixel-pitch, not both"
                )


def _one_size(text: str, name: str) -> tuple[int, int]:
    sizes = quantity.resolutions(text, name)
    if len(sizes) != 1:
        raise InvalidRange(f"{name} {text}: must be one width and height, as 1280x720")
    return sizes[0]


def _two_names(text: str | None) -> tuple[str, str] | None:
    if text is None:
        return None
    names = [word.strip() for word in text.split(",")]
    if len(names) != 2 or not all(names):
        raise InvalidRange(f"rig cameras {text!r}: name the left and the right one, as 0,1")
    return names[0], names[1]


def single_rig(options: RigOptions, principal: str | None, *, size_for: str = "") -> StereoRig:
    """The one rig described by `options`, which have to say all that matters unless they name a rig.

    Args:
        options: the rig options as typed.
        principal: ``u,v`` of both cameras; None for the image's middle, or 0,0 when no size is known.
        size_for: what needs the image size; it may be left out when empty.

    Raises:
        InvalidRange: something is missing, cannot be read, or describes several rigs.
    """
    if options.rig is None and options.read is None and options.preset is None:
        if options.baseline is None:
            raise InvalidRange("--baseline is missing: give it, or a whole rig by --rig or --preset")
        if options.focal is None and options.hfov is None:
            raise InvalidRange("--focal or --hfov is missing: give one, or a whole rig by --rig or --preset")
        if options.resolution is None:
            for name, word in (("--hfov", options.hfov), ("--sensor-width", options.sensor_width)):
                if word is not None:
                    raise InvalidRange(
                        f"{name} {word} needs --resolution: the focal length in px follows from both"
                    )
            if size_for:
                raise InvalidRange(f"{size_for} needs --resolution, or a whole rig by --rig or --preset")
            principal = principal or "0,0"
    rig = options.single(DEFAULT_PRESET)
    if principal is None:
        return rig
    cx, cy = quantity.point(principal, "principal point")
    return replace(rig, left=replace(rig.left, cx=cx, cy=cy), right=replace(rig.right, cx=cx, cy=cy))
