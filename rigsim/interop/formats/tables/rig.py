"""The keys, bounds and messages of rig.toml: what is refused here never reaches a rig."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from decimal import Decimal
from typing import TYPE_CHECKING, Annotated, Any, get_args

import numpy as np
from pydantic import BeforeValidator, Field, ValidationError

from rigsim.errors import InvalidRig
from rigsim.interop.formats.tables.lens import TABLES, AnyLens, Number, TomlTable
from rigsim.interop.formats.values import clipped, shown
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.perturbation import Perturbation
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

if TYPE_CHECKING:
    from rigsim.rig.sensor import Sensor


def rig_from_table(table: Mapping[str, object]) -> StereoRig:
    """The rig a TOML table describes, its floats given as `Decimal`; its sensor is looked at, no more.

    Raises:
        InvalidRig: unknown or missing keys, values out of bounds; the message names the key.
    """
    return _both(table)[0]


def sensor_from_table(table: Mapping[str, object]) -> Sensor | None:
    """The sensor in the TOML table of a rig, its floats given as `Decimal`; None where there is none.

    Raises:
        InvalidRig: as `rig_from_table`, for rig and sensor alike.
    """
    return _both(table)[1]


def perturbation_from_table(table: Mapping[str, object]) -> Perturbation | None:
    """How the built rig differs from the one in the TOML table; None where the table says nothing of it.

    Raises:
        InvalidRig: as `rig_from_table`, for rig and perturbation alike.
    """
    read = _read(table)
    return None if read.perturbation is None else read.perturbation.perturbation()


def _both(table: Mapping[str, object]) -> tuple[StereoRig, Sensor | None]:
    read = _read(table)
    return read.rig(), None if read.sensor is None else read.sensor.sensor()


def _read(table: Mapping[str, object]) -> _Short | _Full:
    is_full = {"left", "right", "right_from_left"} & set(table)
    form: type[_Short] | type[_Full] = _Full if is_full else _Short
    try:
        return form.model_validate(table)
    except ValidationError as error:
        raise InvalidRig(_explained(error, form)) from None


def _whole(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError("must be a whole number")
    return value


def _bits(value: object) -> object:
    if _whole(value) not in _BITS:
        raise ValueError(f"must be one of {', '.join(map(str, _BITS))}")
    return value


def _name(value: object) -> object:
    if not isinstance(value, str):
        raise ValueError('must be a name in quotes, as in "IMX477"')
    return value


_BITS = (0, 8, 10, 12, 16)

_Positive = Annotated[Number, Field(gt=0)]
_NotNegative = Annotated[Number, Field(ge=0)]
_Size = Annotated[int, BeforeValidator(_whole), Field(ge=1, le=10**6)]
_Vector = Annotated[list[Number], Field(min_length=3, max_length=3)]


class _Sensor(TomlTable):
    """What is not given is the named sensor's or, without a name, the ideal one's."""

    name: Annotated[str, BeforeValidator(_name)] | None = None
    blur_px: _NotNegative | None = None
    full_well_e: _NotNegative | None = None
    read_noise_e: _NotNegative | None = None
    grey_noise: _NotNegative | None = None
    gain: _Positive | None = None
    bits: Annotated[int, BeforeValidator(_bits)] | None = None
    right_gain: _Positive | None = None
    right_offset: Annotated[Number, Field(gt=-1, lt=1)] | None = None
    vignetting: Annotated[Number, Field(ge=0, lt=1)] | None = None
    black_level: Annotated[Number, Field(ge=0, lt=255)] | None = None
    prnu_pct: _NotNegative | None = None
    dsnu_e: _NotNegative | None = None
    distortion: AnyLens | None = None

    def sensor(self) -> Sensor:
        # only files that hold a sensor pay for what it loads
        from rigsim.rig.catalogue.sensors import sensor_preset
        from rigsim.rig.sensor import Sensor

        given: dict[str, Any] = {}
        for key in self.model_fields_set - {"name"}:
            value = getattr(self, key)
            given[key] = value.lens() if key == "distortion" else value if key == "bits" else float(value)
        if self.name is None:
            return Sensor(**given)
        electrons = {key: given.pop(key, None) for key in ("full_well_e", "read_noise_e")}
        return replace(sensor_preset(self.name).sensor(**electrons), **given)


class _Perturbation(TomlTable):
    """The fields of `rigsim.rig.perturbation.Perturbation`, in the units of files."""

    yaw_deg: Number = Decimal(0)
    pitch_deg: Number = Decimal(0)
    roll_deg: Number = Decimal(0)
    baseline_mm: Number = Decimal(0)
    axial_mm: Number = Decimal(0)
    vertical_mm: Number = Decimal(0)
    right_focal_px: Number = Decimal(0)
    right_cx_px: Number = Decimal(0)
    right_k1: Number = Decimal(0)
    both_k1: Number = Decimal(0)

    def perturbation(self) -> Perturbation:
        return Perturbation(
            *(math.radians(float(angle)) for angle in (self.yaw_deg, self.pitch_deg, self.roll_deg)),
            *(_metres(length) for length in (self.baseline_mm, self.axial_mm, self.vertical_mm)),
            *(float(n) for n in (self.right_focal_px, self.right_cx_px, self.right_k1, self.both_k1)),
        )


class _Short(TomlTable):
    baseline_mm: _Positive
    width_px: _Size
    height_px: _Size
    focal_px: _Positive | None = None
    hfov_deg: Annotated[Number, Field(gt=0, lt=180)] | None = None
    focal_mm: _Positive | None = None
    sensor_width_mm: _Positive | None = None
    vergence_deg: Annotated[Number, Field(gt=-180, lt=180)] = Decimal(0)
    cx_px: Number | None = None
    cy_px: Number | None = None
    sensor: _Sensor | None = None
    perturbation: _Perturbation | None = None

    def rig(self) -> StereoRig:
        lens = self._lens()
        if self.cx_px is not None:
            lens = replace(lens, cx=float(self.cx_px))
        if self.cy_px is not None:
            lens = replace(lens, cy=float(self.cy_px))
        return StereoRig.verged(lens, _metres(self.baseline_mm), float(self.vergence_deg))

    def _lens(self) -> Intrinsics:
        size = self.width_px, self.height_px
        given = [name for name in _LENS_KEYS if getattr(self, name) is not None]
        match given:
            case ["focal_px"]:
                return Intrinsics.from_focal(*size, _float(self.focal_px))
            case ["hfov_deg"]:
                return Intrinsics.from_hfov(*size, _float(self.hfov_deg))
            case ["focal_mm", "sensor_width_mm"]:
                return Intrinsics.from_lens(*size, _float(self.focal_mm), _float(self.sensor_width_mm))
        raise InvalidRig(
            f"lens given by {', '.join(given) or 'nothing'}: must be one of focal_px, hfov_deg, or focal_mm"
            " with sensor_width_mm"
        )


_LENS_KEYS = ("focal_px", "hfov_deg", "focal_mm", "sensor_width_mm")


class _Camera(TomlTable):
    width_px: _Size
    height_px: _Size
    fx_px: _Positive
    fy_px: _Positive
    cx_px: Number
    cy_px: Number
    distortion: AnyLens | None = None

    def intrinsics(self) -> Intrinsics:
        return Intrinsics(
            self.width_px,
            self.height_px,
            float(self.fx_px),
            float(self.fy_px),
            float(self.cx_px),
            float(self.cy_px),
            None if self.distortion is None else self.distortion.lens(),
        )


class _Pose(TomlTable):
    R: Annotated[list[_Vector], Field(min_length=3, max_length=3)] | None = None
    rotvec_deg: _Vector | None = None
    t_mm: _Vector

    def pose(self) -> Pose:
        t = np.array([_metres(value) for value in self.t_mm])
        if self.R is not None and self.rotvec_deg is None:
            return Pose(np.array(self.R, dtype=np.float64), t)
        if self.rotvec_deg is not None and self.R is None:
            return Pose.from_rotvec(np.radians(np.array(self.rotvec_deg, dtype=np.float64)), t)
        raise InvalidRig("right_from_left: must hold one of R (3 x 3) and rotvec_deg (3 numbers)")


class _Full(TomlTable):
    left: _Camera
    right: _Camera
    right_from_left: _Pose
    sensor: _Sensor | None = None
    perturbation: _Perturbation | None = None

    def rig(self) -> StereoRig:
        return StereoRig(self.left.intrinsics(), self.right.intrinsics(), self.right_from_left.pose())


def _float(value: Decimal | None) -> float:
    assert value is not None
    return float(value)


def _metres(value_mm: Decimal) -> float:
    return float(value_mm.scaleb(-3))


def _explained(error: ValidationError, form: type[TomlTable]) -> str:
    """One line for the error to mend first: a misspelt key before the one that is missing for it."""
    found = sorted(error.errors(), key=lambda item: item["type"] != "extra_forbidden")[0]
    path = found["loc"]
    if "distortion" in path:
        model = path.index("distortion") + 1
        form, path = TABLES[str(path[model])], (*path[:model], *path[model + 1 :])
    key = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in path)[1:]
    if found["type"] == "extra_forbidden":
        inner = [] if form in TABLES.values() else [str(part) for part in path[:-1]]
        known = _known_keys(form, inner)
        return f"unknown key {clipped(key)}: must be one of {', '.join(known)}"
    if found["type"] == "missing":
        return f"{key} is missing: add it"
    return f"{key} {_clipped(found['input'])}: {_bound(found)}"


def _known_keys(form: type[TomlTable], path: Sequence[str]) -> list[str]:
    for part in path:
        annotation = form.model_fields[part].annotation
        for inner in (annotation, *get_args(annotation)):
            if isinstance(inner, type) and issubclass(inner, TomlTable):
                form = inner
    return sorted(form.model_fields, key=lambda name: name == "model")


def _bound(found: Mapping[str, Any]) -> str:
    context = found.get("ctx", {})
    for name, sign in (("gt", ">"), ("ge", ">="), ("lt", "<"), ("le", "<=")):
        if name in context:
            return f"must be {sign} {context[name]}"
    match found["type"]:
        case "value_error":
            return str(context["error"])
        case "list_type" | "too_short" | "too_long":
            return "must be a list of 3"
        case "model_type":
            return "must be a table"
    return str(found["msg"])


def _quoted(value: object) -> str:
    return repr(value) if isinstance(value, str) else shown(value)


def _clipped(value: object) -> str:
    if isinstance(value, list):
        text = f"[{', '.join(_clipped(item) for item in value)}]"
    else:
        text = str(value) if isinstance(value, Decimal) else _quoted(value)
    return text if len(text) <= 40 else text[:37] + "..."
