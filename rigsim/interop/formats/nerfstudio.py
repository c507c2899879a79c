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
from rigsim.interop.formats.format import Format
from rigsim.interop.formats.opencv_yaml import coefficients
from rigsim.interop.formats.values import (
    clipped,
    matrix,
    member,
    number,
    opencv_distortion,
    pixels,
    rotation,
    shown,
)
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.sim.axes import CV_FROM_GL

FILE_NAME = "transforms.json"

_HALF = 0.5
_STILL = 0.01  # of the baseline: more than what poses from pictures are off by
_TERMS = ("k1", "k2", "p1", "p2", "k3")
_MODELS = ("OPENCV", "PINHOLE", "SIMPLE_PINHOLE")


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
    return json.dumps({"camera_model": "OPENCV", "frames": frames}, indent=1) + "\n"


def parse_transforms(text: str) -> StereoRig:
    """The rig in the text of a transforms.json.

    The pair is the first frame whose path has ``left`` in it and the first with ``right``. Frames without
    such names are poses of one camera that moves; sides that move against each other are no rig either.

    Raises:
        InvalidRig: no JSON, fewer than two frames, no rig, another camera model, or values cannot be.
    """
    try:
        document = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InvalidRig(f"is not JSON: {clipped(str(error))}") from None
    frames = member(document, "frames")
    if not isinstance(frames, list) or len(frames) < 2:
        found = len(frames) if isinstance(frames, list) else shown(frames)
        raise InvalidRig(f"frames {found}: must be a list of two or more, left and right")
    sides = [
        [i for i, frame in enumerate(frames) if side in str(member(frame, "file_path", f"frame {i}"))]
        for side in ("left", "right")
    ]
    if not (sides[0] and sides[1]):
        raise InvalidRig(
            f"{len(frames)} frames, none called left and right: poses of one camera that moves are no rig;"
            " put left and right into the file_path of the two cameras' frames"
        )
    cameras = [_camera(document, frames[side[0]], f"frame {side[0]}") for side in sides]
    pairs = [
        _world_from_camera(frames[right], right).inverse @ _world_from_camera(frames[left], left)
        for left, right in zip(*sides, strict=False)
    ]
    for pose in pairs[1:]:
        if not np.allclose(pose.t, pairs[0].t, atol=_STILL * float(np.linalg.norm(pairs[0].t))):
            raise InvalidRig(
                "the right camera moves against the left one (seen from it, the left one is at"
                f" {_place(pairs[0])} in the first pair, at {_place(pose)} in another): no rig"
            )
    return StereoRig(cameras[0], cameras[1], pairs[0])


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
        **dict(zip(_TERMS, coefficients(camera).tolist(), strict=True)),
        "transform_matrix": (T + 0.0).tolist(),  # -0.0 is 0
    }


def _camera(document: Mapping[str, object], frame: object, name: str) -> Intrinsics:
    """A frame's camera; what it does not say, the document says for all frames."""
    table = {**document, **frame} if isinstance(frame, Mapping) else frame
    model = "OPENCV"
    if isinstance(table, Mapping):
        model = str(table.get("camera_model", "OPENCV"))
        if table.get("k4", 0.0) != 0:
            raise InvalidRig(f"k4 of {name} {shown(table['k4'])}: must be 0, rigsim's lens has no k4")
    if model not in _MODELS:
        raise InvalidRig(f"camera_model {clipped(model)}: must be one of {', '.join(_MODELS)}")

    def value(key: str) -> float:
        return number(member(table, key, name), f"{key} of {name}")

    terms = [
        number(table[key], f"{key} of {name}") if isinstance(table, Mapping) and key in table else 0.0
        for key in _TERMS
    ]
    return Intrinsics(
        pixels(member(table, "w", name), f"w of {name}"),
        pixels(member(table, "h", name), f"h of {name}"),
        value("fl_x"),
        value("fl_y"),
        value("cx") - _HALF,
        value("cy") - _HALF,
        opencv_distortion(np.array(terms), name),
    )


FORMAT = Format(
    "nerfstudio",
    "Nerfstudio's frames",
    (".json",),
    FILE_NAME,
    knows=lambda text: text.lstrip().startswith("{"),
    parse=parse_transforms,
    write=lambda rig: {FILE_NAME: transforms_json(rig)},
)
