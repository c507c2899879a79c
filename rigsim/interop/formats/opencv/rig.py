"""From what OpenCV's functions return to a rig.

``R`` and ``T`` map the left camera's frame to the right one's, ``x_right = R x_left + T``, ``T`` in whatever
unit the board's squares were given in. ``P1, P2, Q`` are of the rectified pair: ``P2[0,3] = fx Tx``,
``Q[2,3] = f, Q[3,2] = -1/Tx, Q[3,3] = (cx - cx')/Tx`` (docs.opencv.org, `stereoRectify`).
"""

from __future__ import annotations

import re

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, Found
from rigsim.interop.formats.opencv.lenses import flat, lens_of
from rigsim.interop.formats.opencv.names import Facts, check_twice
from rigsim.interop.formats.opencv.unit import unit_of
from rigsim.interop.formats.values import (
    lens,
    matrix,
    number,
    numbers,
    pixels,
    rotation,
    shown,
    size_or_guess,
)
from rigsim.rig.arrays import Array
from rigsim.rig.pose import Pose
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig

_SIDES = ("left", "right")
_NUMBERS = {"left": "1", "right": "2"}
_SIZE = re.compile(r"\s*\(?\s*(\d+)\s*[xX,; ]\s*(\d+)\s*\)?\s*")


def rig_of(facts: Facts, asked: Asked) -> Found:
    """The rig that the facts describe, lengths as they stand there.

    Raises:
        InvalidRig: something is missing, or cannot be.
    """
    check_twice(facts)
    if facts.has_camera("left") or facts.has_camera("right"):
        K_left, K_right = (_camera_matrix(facts, side) for side in _SIDES)
        pose, distorts = _pose(facts), True
    else:
        (K_left, K_right), pose = _rectified(facts)
        distorts = False
    K = {"left": K_left, "right": K_right}
    if not pose.t.any():
        raise InvalidRig("T 0, 0, 0: must be the way from one camera to the other")
    sizes, remark = _sizes(facts, asked, [(float(K[side][0, 2]), float(K[side][1, 2])) for side in _SIDES])
    left, right = (
        lens(*sizes[side], K[side], lens_of(facts, side) if distorts else None, _called(facts, side))
        for side in _SIDES
    )
    unit, remarks = unit_of(facts, pose.t)
    return Found(StereoRig(left, right, pose), unit, remarks if remark is None else (remark, *remarks))


def camera_matrix(facts: Facts, side: str) -> Array | None:
    """A camera's matrix (3, 3), or None where there is none that can be read."""
    if not facts.has_camera(side):
        return None
    try:
        return _camera_matrix(facts, side)
    except InvalidRig:
        return None


def _called(facts: Facts, side: str) -> str:
    return facts.key("K", side) if facts.has("K", side) else f"camera matrix of the {side} camera"


def _camera_matrix(facts: Facts, side: str) -> Array:
    if facts.has("K", side):
        return matrix(facts.value("K", side), facts.key("K", side), 3, 3)
    if not facts.has_camera(side):
        raise InvalidRig(f"K{_NUMBERS[side]} is missing: the {side} camera's matrix")
    fx, fy, cx, cy = (
        number(facts.value(term, side), facts.key(term, side)) for term in ("fx", "fy", "cx", "cy")
    )
    return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])


def _pose(facts: Facts) -> Pose:
    if facts.has("T"):
        return Pose(_turn(facts, ""), _vector(facts, "T", ""))
    if facts.has("T", "right") and facts.has("R", "right"):
        right = Pose(_turn(facts, "right"), _vector(facts, "T", "right"))
        if not facts.has("T", "left"):
            return right
        return right @ Pose(_turn(facts, "left"), _vector(facts, "T", "left")).inverse
    if facts.has_pose:
        turns = [_rotation(facts, "rect" if facts.has("rect", side) else "R", side) for side in _SIDES]
        (_, _), rectified = _rectified(facts)
        # x_left and x_right turned are parallel, a baseline apart
        return Pose(turns[1].T @ turns[0], turns[1].T @ rectified.t)
    raise InvalidRig("T is missing: R and T map the left camera's frame to the right one's")


def _turn(facts: Facts, side: str) -> Array:
    if facts.has("R", side):
        return _rotation(facts, "R", side)
    if facts.has("rvec", side):
        return Pose.from_rotvec(_vector(facts, "rvec", side).tolist()).R
    raise InvalidRig("R is missing: R and T map the left camera's frame to the right one's")


def _rotation(facts: Facts, role: str, side: str) -> Array:
    value, key = flat(facts.value(role, side)), facts.key(role, side)
    if isinstance(value, list) and len(value) == 3:
        return Pose.from_rotvec(numbers(value, key, 3).tolist()).R
    return rotation(matrix(facts.value(role, side), key, 3, 3), key)


def _vector(facts: Facts, role: str, side: str) -> Array:
    return numbers(flat(facts.value(role, side)), facts.key(role, side), 3)


def _rectified(facts: Facts) -> tuple[tuple[Array, Array], Pose]:
    """Camera matrices (3, 3) and pose of the rectified pair, from P1 and P2 or from Q."""
    if facts.has_projections:
        P = [matrix(facts.value("P", side), facts.key("P", side), 3, 4) for side in _SIDES]
        for one, side in zip(P, _SIDES, strict=True):
            if not (one[0, 0] > 0 and one[1, 1] > 0 and one[2, :3].tolist() == [0, 0, 1]):
                raise InvalidRig(
                    f"{facts.key('P', side)}: must be [fx 0 cx a; 0 fy cy b; 0 0 1 c], fx and fy > 0"
                )
        left, right = (np.linalg.solve(one[:, :3], one[:, 3]) for one in P)
        return (P[0][:, :3], P[1][:, :3]), Pose(np.eye(3), right - left)
    if not facts.has("Q"):
        raise InvalidRig(
            "K1 and K2 are missing: the camera matrices; or P1 and P2, or Q, of a rectified pair"
        )
    key = facts.key("Q")
    Q = matrix(facts.value("Q"), key, 4, 4)
    if not (Q[2, 3] > 0 and Q[3, 2] != 0):
        raise InvalidRig(f"{key}[2,3] {Q[2, 3]:g} and [3,2] {Q[3, 2]:g}: must be f > 0 and -1/Tx, not 0")
    f, Tx, cx, cy = Q[2, 3], -1 / Q[3, 2], -Q[0, 3], -Q[1, 3]
    K = np.array([[f, 0.0, cx], [0.0, f, cy], [0.0, 0.0, 1.0]])
    K_right = K.copy()
    K_right[0, 2] = cx - Q[3, 3] * Tx
    return (K, K_right), Pose(np.eye(3), np.array([Tx, 0.0, 0.0]))


def _sizes(
    facts: Facts, asked: Asked, principals: list[tuple[float, float]]
) -> tuple[dict[str, tuple[int, int]], Remark | None]:
    """Each camera's width and height, px, and what is to be said where the file has none."""
    found = {side: _size(facts, side) or _size(facts, "") for side in _SIDES}
    left, right = found["left"] or found["right"], found["right"] or found["left"]
    if left is not None and right is not None:
        return {"left": left, "right": right}, None
    corners = [(1.0, 1.0)]
    for side in (*_SIDES, ""):
        if facts.has("roi", side):
            x, y, width, height = numbers(flat(facts.value("roi", side)), facts.key("roi", side), 4)
            corners.append((float(x + width), float(y + height)))
    largest = (max(x for x, _ in corners), max(y for _, y in corners))
    width_px, height_px, remark = size_or_guess(asked, principals, largest)
    return dict.fromkeys(_SIDES, (width_px, height_px)), remark


def _size(facts: Facts, side: str) -> tuple[int, int] | None:
    if facts.has("width", side) or facts.has("height", side):
        both = []
        for role in ("width", "height"):
            if not facts.has(role, side):
                raise InvalidRig(f"image_{role} is missing: the file has the other of the two")
            both.append(pixels(facts.value(role, side), facts.key(role, side)))
        return both[0], both[1]
    for role, order in (("size", (0, 1)), ("shape", (1, 0))):
        if not facts.has(role, side):
            continue
        value, key = flat(facts.value(role, side)), facts.key(role, side)
        if isinstance(value, str):
            words = _SIZE.fullmatch(value)
            if words is None:
                raise InvalidRig(f"{key} {shown(value)}: must be a width and a height, as [1280, 720]")
            value = [int(words[1]), int(words[2])]
        sides = numbers(value, key)
        if len(sides) < 2:
            raise InvalidRig(f"{key} {shown(value)}: must be a width and a height, as [1280, 720]")
        return pixels(float(sides[order[0]]), key), pixels(float(sides[order[1]]), key)
    return None
