"""A calibration as Nerfstudio's ``transforms.json`` (docs.nerf.studio, "Data conventions").

Each frame has its own intrinsics. ``transform_matrix`` maps the camera's frame to the world's, with OpenGL's
axes: x right, y up, z backward. Pixels are counted from the corner of the first one: ``cx`` is half a
pixel more.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File, Format, Found, alone
from rigsim.interop.formats.tables.json_text import json_table
from rigsim.interop.formats.tables.terms import opencv_lens
from rigsim.interop.formats.values import (
    clipped,
    matrix,
    member,
    number,
    pixels,
    rotation,
    shown,
)
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import brown_of
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.sim.axes import CV_FROM_GL

FILE_NAME = "transforms.json"

_HALF = 0.5
_STILL = 0.01  # of the baseline: more than what poses from pictures are off by
_TERMS = ("k1", "k2", "p1", "p2", "k3")
_MODELS = ("OPENCV", "PINHOLE", "SIMPLE_PINHOLE")
_FISHEYE = "OPENCV_FISHEYE"
_UNIT = "length_unit"  # none of Nerfstudio's words: how rigsim's own file says that it has a scale


def transforms_json(
    rig: StereoRig,
    left_from_world: Sequence[Pose] = (Pose(),),
    names: Sequence[tuple[str, str]] = (("left.png", "right.png"),),
) -> str:
    """The text of a transforms.json in which `rig` took one pair a pose, every digit kept.

    Args:
        rig: the two cameras.
        left_from_world: where the rig was in each frame.
        names: the left and the right picture's path of each frame.
    """
    frames = []
    for pose, (name_left, name_right) in zip(left_from_world, names, strict=True):
        frames.append(_frame(rig.left, pose, name_left))
        frames.append(_frame(rig.right, rig.right_from_left @ pose, name_right))
    fisheyes = [isinstance(camera.lens, KannalaBrandt) for camera in (rig.left, rig.right)]
    if fisheyes[0] != fisheyes[1]:
        raise InvalidRig(
            "one lens is a fisheye and the other one none: Nerfstudio has one model for all frames"
        )
    model = _FISHEYE if all(fisheyes) else "OPENCV"
    return json.dumps({"camera_model": model, _UNIT: "m", "frames": frames}, indent=1) + "\n"


def parse_transforms(text: str, cameras: tuple[str, str] | None = None) -> StereoRig:
    """The rig in the text of a transforms.json.

    The pair is the first frame whose path has ``left`` in it and the first with ``right``, or those with the
    two words of `cameras`. Frames without such names are poses of one camera that moves; sides that move
    against each other are no rig either.

    Raises:
        InvalidRig: no JSON, fewer than two frames, no rig, another camera model, or values cannot be.
    """
    document = json_table(text)
    frames = member(document, "frames")
    if not isinstance(frames, list) or len(frames) < 2:
        found = len(frames) if isinstance(frames, list) else shown(frames)
        raise InvalidRig(f"frames {found}: must be a list of two or more, left and right")
    words = cameras or ("left", "right")
    sides = [
        [i for i, frame in enumerate(frames) if side in str(member(frame, "file_path", f"frame {i}"))]
        for side in words
    ]
    if not (sides[0] and sides[1]):
        raise InvalidRig(
            f"{len(frames)} frames, none called {words[0]} and {words[1]}: poses of one camera that moves are"
            " no rig, and have no scale; put left and right into the file_path of the two cameras' frames, or"
            " choose words that are there, as --rig-cameras cam0,cam1"
        )
    left, right = (_camera(document, frames[side[0]], f"frame {side[0]}") for side in sides)
    pairs = [
        _world_from_camera(frames[j], j).inverse @ _world_from_camera(frames[i], i)
        for i, j in zip(*sides, strict=False)
    ]
    for pose in pairs[1:]:
        if not np.allclose(pose.t, pairs[0].t, atol=_STILL * float(np.linalg.norm(pairs[0].t))):
            raise InvalidRig(
                "the right camera moves against the left one (seen from it, the left one is at"
                f" {_place(pairs[0])} in the first pair, at {_place(pose)} in another): no rig"
            )
    return StereoRig(left, right, pairs[0])


def _place(pose: Pose) -> str:
    return "(" + ", ".join(f"{value:.3g}" for value in pose.t) + ")"


def _world_from_camera(frame: object, index: int) -> Pose:
    name = f"frame {index}"
    T = matrix(member(frame, "transform_matrix", name), f"transform_matrix of {name}", 4, 4)
    return Pose(rotation(T[:3, :3], f"transform_matrix of {name}") @ CV_FROM_GL, T[:3, 3])


def _frame(camera: Intrinsics, camera_from_world: Pose, name: str) -> dict[str, object]:
    world_from_camera = camera_from_world.inverse
    T: Array = np.eye(4)
    T[:3, :3], T[:3, 3] = world_from_camera.R @ CV_FROM_GL, world_from_camera.t
    return {
        "file_path": name,
        "w": camera.width,
        "h": camera.height,
        "fl_x": camera.fx,
        "fl_y": camera.fy,
        "cx": camera.cx + _HALF,
        "cy": camera.cy + _HALF,
        **_terms(camera),
        "transform_matrix": (T + 0.0).tolist(),  # -0.0 is 0
    }


def _terms(camera: Intrinsics) -> dict[str, float]:
    """A camera's lens; that of a frame names the model, as the two may have different ones.

    Raises:
        InvalidRig: Nerfstudio has no such lens.
    """
    if isinstance(camera.lens, KannalaBrandt):
        return {name: float(getattr(camera.lens, name)) for name in camera.lens.names()}
    brown = brown_of(camera.lens, "Nerfstudio, beside fisheyes,")
    return {name: float(getattr(brown, name)) for name in _TERMS}


def _camera(document: Mapping[str, object], frame: object, name: str) -> Intrinsics:
    """A frame's camera; what it does not say, the document says for all frames."""
    table = {**document, **frame} if isinstance(frame, Mapping) else frame

    def value(key: str, default: float | None = None) -> float:
        if default is not None and isinstance(table, Mapping) and key not in table:
            return default
        return number(member(table, key, name), f"{key} of {name}")

    return Intrinsics(
        pixels(member(table, "w", name), f"w of {name}"),
        pixels(member(table, "h", name), f"h of {name}"),
        value("fl_x"),
        value("fl_y"),
        value("cx") - _HALF,
        value("cy") - _HALF,
        _lens(table, {key: value(key, 0.0) for key in (*_TERMS, "k4")}, name),
    )


def _lens(table: object, terms: Mapping[str, float], name: str) -> Lens | None:
    model = str(table.get("camera_model", "OPENCV")) if isinstance(table, Mapping) else "OPENCV"
    if model == _FISHEYE or (isinstance(table, Mapping) and table.get("is_fisheye") is True):
        return KannalaBrandt(*(terms[f"k{i}"] for i in range(1, 5)))
    if model not in _MODELS:
        raise InvalidRig(f"camera_model {clipped(model)}: must be one of {', '.join((*_MODELS, _FISHEYE))}")
    if terms["k4"] != 0:
        raise InvalidRig(f"k4 of {name} {terms['k4']:g}: must be 0, OpenCV's lens has no such k4")
    return opencv_lens(np.array([terms[key] for key in _TERMS]), name)


def _open(group: tuple[File, ...], asked: Asked) -> Found:
    text = group[0].text
    ours = json_table(text).get(_UNIT) == "m"
    return Found(parse_transforms(text, asked.cameras), unit="m" if ours else None)


FORMAT = Format(
    "nerfstudio",
    "Nerfstudio's frames",
    (".json",),
    FILE_NAME,
    groups=alone(lambda text: text.lstrip().startswith("{") and '"transform_matrix"' in text),
    open=_open,
    write=lambda rig: {FILE_NAME: transforms_json(rig)},
)
