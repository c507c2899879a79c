"""rig.toml: a stereo rig, and the sensor behind its lenses, as a file people write and read.

Short form, two equal cameras::

    baseline_mm = 120.0
    width_px = 1280
    height_px = 720
    focal_px = 900.0        # or hfov_deg, or focal_mm with sensor_width_mm
    vergence_deg = 0.0      # optional
    cx_px = 639.5           # optional, the image's middle by default
    cy_px = 359.5

Full form, any two cameras: ``[left]`` and ``[right]`` hold ``width_px, height_px, fx_px, fy_px,
cx_px, cy_px`` and optionally ``[left.distortion]`` ``k1, k2, p1, p2, k3``; ``[right_from_left]`` holds
``R`` (3 x 3) or ``rotvec_deg``, and ``t_mm``. A lens of another model than Brown-Conrady's is named by
``model``, one of `rigsim.rig.lens.registry`, beside the coefficients of that model.

Either form may hold a sensor, for both cameras; what is left out is ideal, or the named sensor's::

    [sensor]
    name = "IMX477"         # optional, one that `rigsim scenes` lists
    blur_px = 0.6           # and full_well_e, read_noise_e, grey_noise, gain, bits, right_gain,
                            # right_offset, vignetting, black_level, prnu_pct, dsnu_e: the fields of
                            # `rigsim.sim.exposure.Sensor`
    [sensor.distortion]     # optional, keys as in [left.distortion]
    k1 = -0.05

and how the rig that was built differs from the one above, which is then the assumed one; `rigsim sweep`
projects with the built rig and triangulates with the assumed one::

    [perturbation]
    yaw_deg = 0.02          # and pitch_deg, roll_deg, baseline_mm, axial_mm, vertical_mm, right_focal_px,
                            # right_cx_px, right_k1, both_k1: the fields of
                            # `rigsim.rig.perturbation.Perturbation`

Numbers are read and scaled as decimals, so what was written is read back bit for bit.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import fields
from decimal import Decimal
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from rigsim import foreign
from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File, Format, Found, alone, names_sides, swapped
from rigsim.interop.formats.tables.rig import (
    perturbation_from_table,
    rig_from_table,
    sensor_from_table,
)
from rigsim.interop.formats.toml_text import toml_table
from rigsim.rig import given
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens import registry as lenses
from rigsim.rig.lens.lens import Lens
from rigsim.rig.perturbation import Perturbation
from rigsim.rig.stereo import StereoRig

if TYPE_CHECKING:
    from rigsim.rig.sensor import Sensor

_T = TypeVar("_T")

_PREAMBLE = """\
# rigsim stereo rig. Lengths in mm, angles in deg, the rest in px; integer pixel = pixel centre.
# Camera axes: x right, y down, z forward; the left camera is the reference.
"""


def read_rig(path: Path) -> StereoRig:
    """The rig in the file `path`, short or full form.

    Raises:
        OutputError: the file cannot be read.
        InvalidRig: no TOML, unknown or missing keys, values out of bounds, a sensor that cannot be; the
            message names file and key.
    """
    return _read(path, parse_rig)


def read_sensor(path: Path) -> Sensor | None:
    """The sensor in the rig file `path`; None where the file says nothing of one.

    Raises:
        OutputError: the file cannot be read.
        InvalidRig: as `read_rig`.
    """
    return _read(path, parse_sensor)


def read_perturbation(path: Path) -> Perturbation | None:
    """How the built rig differs from the one in the rig file `path`; None where it says nothing of it.

    Raises:
        OutputError: the file cannot be read.
        InvalidRig: as `read_rig`.
    """
    return _read(path, parse_perturbation)


def parse_rig(text: str) -> StereoRig:
    """The rig that the TOML text `text` describes.

    Raises:
        InvalidRig: as `read_rig`.
    """
    return rig_from_table(_table(text))


def parse_sensor(text: str) -> Sensor | None:
    """The sensor in the TOML text `text` of a rig; None where it says nothing of one.

    Raises:
        InvalidRig: as `read_rig`.
    """
    return sensor_from_table(_table(text))


def parse_perturbation(text: str) -> Perturbation | None:
    """The perturbation in the TOML text `text` of a rig; None where it says nothing of one.

    Raises:
        InvalidRig: as `read_rig`.
    """
    return perturbation_from_table(_table(text))


def write_rig(rig: StereoRig, comment: str = "", sensor: Sensor | None = None) -> str:
    """TOML text that reads back as exactly `rig` and `sensor`; short form where that is possible.

    `comment` is put on top, as many lines as it has. The sensor is written number by number, without the
    name it may have had, so that it stays what it was.

    Example:
        >>> import rigsim
        >>> print(rigsim.write_rig(rigsim.preset("bin").rig, comment="over the bin").splitlines()[0])
        # over the bin
    """
    top = "".join(f"# {line}".rstrip() + "\n" for line in comment.splitlines())
    given.a(StereoRig, rig, "a StereoRig: the rig to write", InvalidRig)
    short = _short_text(rig)
    body = short if short is not None and parse_rig(short) == rig else _full_text(rig)
    return top + _PREAMBLE + body + ("" if sensor is None else _sensor_text(sensor))


def _read(path: Path, parse: Callable[[str], _T]) -> _T:
    try:
        text = foreign.read_text(path, "a rig.toml")
    except UnicodeDecodeError:
        raise InvalidRig(f"{path}: is not TOML (not UTF-8 text)") from None
    try:
        return parse(text)
    except InvalidRig as error:
        raise InvalidRig(f"{path}: {error}") from None


def _table(text: str) -> dict[str, object]:
    return toml_table(text, Decimal)


def _short_text(rig: StereoRig) -> str | None:
    """The short form nearest to `rig`, rounding undone; None when its cameras differ."""
    lens = rig.left
    if lens != rig.right or lens.fx != lens.fy or lens.lens is not None:
        return None
    middle = Intrinsics.from_focal(lens.width, lens.height, lens.fx)
    vergence_deg = round(rig.vergence_deg, 9)
    baseline_m = rig.baseline_m if vergence_deg == 0 else round(rig.baseline_m, 12)
    lines = [
        f"baseline_mm = {_millimetres(baseline_m)}",
        f"width_px = {lens.width}",
        f"height_px = {lens.height}",
        f"focal_px = {lens.fx!r}",
        f"vergence_deg = {vergence_deg!r}" if vergence_deg else "",
        f"cx_px = {lens.cx!r}" if lens.cx != middle.cx else "",
        f"cy_px = {lens.cy!r}" if lens.cy != middle.cy else "",
    ]
    return "\n".join(line for line in lines if line) + "\n"


def _full_text(rig: StereoRig) -> str:
    pose = rig.right_from_left
    return "\n".join(
        [
            *_camera_lines("left", rig.left),
            *_camera_lines("right", rig.right),
            "",
            "# x_right = R x_left + t",
            "[right_from_left]",
            "R = [",
            *(f"  {_row(row, repr)}," for row in pose.R),
            "]",
            f"t_mm = {_row(pose.t, _millimetres)}",
            "",
        ]
    )


def _camera_lines(name: str, camera: Intrinsics) -> list[str]:
    lines = [
        "",
        f"[{name}]",
        f"width_px = {camera.width}",
        f"height_px = {camera.height}",
        f"fx_px = {camera.fx!r}",
        f"fy_px = {camera.fy!r}",
        f"cx_px = {camera.cx!r}",
        f"cy_px = {camera.cy!r}",
    ]
    if camera.lens is not None:
        lines += _distortion_lines(name, camera.lens)
    return lines


def _distortion_lines(owner: str, lens: Lens) -> list[str]:
    model = [] if lens.model == lenses.DEFAULT else [f'model = "{lens.model}"']
    terms = (f"{name} = {getattr(lens, name)!r}" for name in lens.names())
    return ["", f"[{owner}.distortion]", *model, *terms]


def _sensor_text(sensor: Sensor) -> str:
    lines = [
        "",
        "# Electrons at gain 1; grey_noise and black_level in 1/255 of full scale,",
        "# right_offset and vignetting in shares.",
        "[sensor]",
    ]
    for field in fields(sensor):
        value = getattr(sensor, field.name)
        if field.name == "bits":
            lines.append(f"bits = {int(value)}")
        elif field.name != "distortion":
            lines.append(f"{field.name} = {float(value)!r}")
    if sensor.distortion is not None:
        lines += _distortion_lines("sensor", sensor.distortion)
    return "\n".join(lines) + "\n"


def _row(values: Array, text: Callable[[float], str]) -> str:
    return "[" + ", ".join(text(float(value)) for value in values) + "]"


def _millimetres(value_m: float) -> str:
    """Metres as a decimal of mm, moved by its point alone, so no digit is lost."""
    if value_m == 0:
        return repr(value_m)
    text = str(Decimal(repr(value_m)).scaleb(3).normalize())
    if "E" in text and abs(value_m) >= 1e-9:
        text = f"{Decimal(text):f}"
    return text if "." in text or "E" in text else f"{text}.0"


_OWN = re.compile(
    r"^\s*(?:\[\s*right_from_left\s*\]|(?:baseline_mm|width_px|height_px|focal_px|focal_mm|hfov_deg|vergence_deg"
    r"|fx_px|fy_px|t_mm|rotvec_deg)\s*=)",
    re.MULTILINE,
)


def knows(text: str) -> bool:
    """Whether a text is a rig.toml's: it has one of its keys, with its unit."""
    return _OWN.search(text) is not None


def _open(files: tuple[File, ...], asked: Asked) -> Found:
    rig = parse_rig(files[0].text)
    return Found(swapped(rig) if names_sides(asked) else rig)


FORMAT = Format(
    "rig.toml",
    "rigsim's own",
    (".toml",),
    "rig.toml",
    groups=alone(knows),
    open=_open,
    fixes_unit="mm",
)
