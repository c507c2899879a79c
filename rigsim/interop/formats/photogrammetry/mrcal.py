"""A calibration as mrcal's ``.cameramodel`` files, one a camera (mrcal.secretsauce.net, "Camera models").

A Python table, of which values alone are read: nothing in it is run. ``extrinsics`` (``rt_cam_ref`` in later
files) are a rotation vector and a translation that map the common frame to the camera's. Integer pixel =
pixel centre; terms in OpenCV's order; the unit is the one of the board.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping, Sequence

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File, Format, Found
from rigsim.interop.formats.tables.terms import opencv_lens, opencv_terms
from rigsim.interop.formats.values import clipped, member, numbers, pixels, reals, shown
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

FILE_NAMES = ("left.cameramodel", "right.cameramodel")

_PREFIX = "LENSMODEL_"
# how many of OpenCV's terms each model has
_MODELS = {"PINHOLE": 0, "OPENCV4": 4, "OPENCV5": 5, "OPENCV8": 8, "OPENCV12": 12}
_MOST_CHARACTERS = 200_000
_BYTES = re.compile(r"""b'[^'\n]*'|b"[^"\n]*\"""")  # what the calibration was made from, by the megabyte
_KNOWN = re.compile(
    r"""['"](?:lensmodel|lens_model|distortion_model)['"]\s*:\s*['"](?:LENSMODEL|DISTORTION)_"""
)


def mrcal_files(rig: StereoRig) -> dict[str, str]:
    """The texts of two models of `rig`, by file name, every digit kept; the left camera is the common frame.

    Raises:
        InvalidRig: a lens is neither a pinhole, Brown-Conrady's nor rational, or its sensor is tilted.
    """
    poses = (Pose(), rig.right_from_left)
    return {
        name: _text(camera, pose, side)
        for name, camera, pose, side in zip(
            FILE_NAMES, (rig.left, rig.right), poses, ("left", "right"), strict=True
        )
    }


def _text(camera: Intrinsics, pose: Pose, side: str) -> str:
    terms = opencv_terms(camera.lens, f"mrcal's OPENCV model of the {side} camera")
    if any(terms[12:]):
        raise InvalidRig(f"{side} tau_x, tau_y {terms[12]:g}, {terms[13]:g}: must be 0, mrcal has no tilt")
    used = max((i + 1 for i, term in enumerate(terms) if term), default=0)
    model, count = next(item for item in _MODELS.items() if item[1] >= used)
    intrinsics = reals((camera.fx, camera.fy, camera.cx, camera.cy, *terms[:count]))
    return (
        f"# rigsim stereo rig, {side} camera; metres; integer pixel = pixel centre\n{{\n"
        f"    'lensmodel':  '{_PREFIX}{model}',\n\n"
        f"    # fx, fy, cx, cy and the lens's terms\n    'intrinsics': [ {intrinsics}, ],\n\n"
        "    # rotation vector and translation that map the left camera's frame to this one's\n"
        f"    'extrinsics': [ {reals((*pose.rotvec_rad, *pose.t))}, ],\n\n"
        f"    'imagersize': [ {camera.width}, {camera.height}, ],\n}}\n"
    )


def _groups(files: Sequence[File]) -> list[tuple[File, ...]]:
    known = [file for file in files if _KNOWN.search(file.text)]
    if len(known) < 2:
        return []
    sides = [next((file for file in known if side in file.name.lower()), None) for side in ("left", "right")]
    if sides[0] is not None and sides[1] is not None and sides[0] is not sides[1]:
        return [(sides[0], sides[1])]
    return [tuple(known)]


def _lacks(file: File) -> str | None:
    if not _KNOWN.search(file.text):
        return None
    return "is mrcal's model of one camera: name both, as --rig left.cameramodel --rig right.cameramodel"


def _open(group: tuple[File, ...], asked: Asked) -> Found:
    left, right = _pair(group, asked)
    (camera, left_from_ref), (other, right_from_ref) = (_camera(file) for file in (left, right))
    return Found(StereoRig(camera, other, right_from_ref @ left_from_ref.inverse), unit=None)


def _pair(group: tuple[File, ...], asked: Asked) -> tuple[File, File]:
    if asked.cameras is None:
        if len(group) != 2:
            raise InvalidRig(f"{len(group)} cameras: choose two, as --rig-cameras 0,1")
        return group[0], group[1]
    have = ", ".join(file.name for file in group)
    chosen = []
    for name in asked.cameras:
        by_name = [file for file in group if name in (file.name, file.path.stem)]
        by_place = [group[int(name)]] if name.isdigit() and int(name) < len(group) else []
        if not by_name and not by_place:
            raise InvalidRig(f"camera {shown(name)}: must be one of {clipped(have)}, or its place from 0 on")
        chosen.append((by_name or by_place)[0])
    return chosen[0], chosen[1]


def _camera(file: File) -> tuple[Intrinsics, Pose]:
    """The camera, and the pose that maps the common frame to its own."""
    table = _table(file)
    of = file.name
    model = table.get("lensmodel", table.get("lens_model", table.get("distortion_model")))
    kind = str(model).removeprefix(_PREFIX).removeprefix("DISTORTION_")
    kind = "PINHOLE" if kind == "NONE" else kind
    if kind not in _MODELS:
        raise InvalidRig(
            f"lensmodel of {of} {shown(model)}: must be {', '.join(_MODELS)}; convert it with"
            " mrcal-convert-lensmodel LENSMODEL_OPENCV8"
        )
    fx, fy, cx, cy, *terms = numbers(
        member(table, "intrinsics", of), f"intrinsics of {of}", 4 + _MODELS[kind]
    )
    width, height = (
        pixels(float(side), f"imagersize of {of}")
        for side in numbers(member(table, "imagersize", of), f"imagersize of {of}", 2)
    )
    lens = opencv_lens(numbers([float(term) for term in terms], f"intrinsics of {of}"), f"intrinsics of {of}")
    key = "rt_cam_ref" if "rt_cam_ref" in table else "extrinsics"
    rt = numbers(member(table, key, of), f"{key} of {of}", 6)
    return Intrinsics(width, height, float(fx), float(fy), float(cx), float(cy), lens), Pose.from_rotvec(
        rt[:3], rt[3:]
    )


def _table(file: File) -> Mapping[str, object]:
    text = _BYTES.sub("b''", file.text)
    if len(text) > _MOST_CHARACTERS:
        raise InvalidRig(
            f"{file.name} has {len(text)} characters, must have <= {_MOST_CHARACTERS}: is no camera model"
        )
    try:
        found = ast.literal_eval(text.strip())
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError) as error:
        raise InvalidRig(f"{file.name} is no table of values: {clipped(str(error))}") from None
    if not isinstance(found, dict):
        raise InvalidRig(f"{file.name} is no camera model: must be a table of names and values")
    return {str(key): value for key, value in found.items()}


FORMAT = Format(
    "mrcal",
    "mrcal's camera models, one file a camera",
    (".cameramodel",),
    FILE_NAMES[0],
    groups=_groups,
    open=_open,
    lacks=_lacks,
    write=mrcal_files,
)
