"""Calibrations of every form that is read, to be made wrong: sets of files, by name."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Mapping

import numpy as np

from benchmarks.subjects.fuzz_seeds import SEEDS
from benchmarks.subjects.robot_calibrations import robots
from rigsim.interop.formats.registry import RIG_FORMATS, rig_files
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

_LEFT, _RIGHT = (
    Intrinsics(1280, 720, 811.5, 812.25, 633.5, 357.25),
    Intrinsics(1280, 720, 820.0, 819.5, 645.0, 362.5),
)
_RIG = StereoRig(_LEFT, _RIGHT, Pose.from_rotvec([0.004, -0.02, 0.007], [-0.083, 0.0007, 0.002]))
_PLAIN = StereoRig.rectified(_LEFT, 0.083)

_NUMBER = re.compile(rb"-?\d+\.?\d*(?:[eE][-+]?\d+)?")
_ODD_NUMBERS = (
    *(b"nan", b".nan", b"inf", b"-inf", b"1e999", b"0", b"-1", b"1e-320", b"9" * 400),
    *(b"0x10", b"true", b"~", b"''"),
)  # fmt: skip
_ODD_WORDS = (
    *(b"", b"\x00", b"\xff\xfe", b"\xe9", b"\t", b"[", b"]", b"{", b"}", b"<", b">", b"&a", b"*a"),
    *(b"<<: *a", b"!!python/tuple []", b"%YAML:1.0\n---\n", b"K1: ", b"<!DOCTYPE a [<!ENTITY b 'c'>]>"),
    *(b"\r\n", b"---\n", b"...\n", b": ", b"- ", b"# ", b"'", b'"'),
)  # fmt: skip


def _matrix(name: str, M: np.ndarray) -> str:
    data = ", ".join(repr(float(value)) for value in M.ravel())
    size = f"rows: {M.shape[0]}\n   cols: {M.shape[1]}"
    return f"{name}: !!opencv-matrix\n   {size}\n   dt: d\n   data: [ {data} ]\n"


def _xml(**values: np.ndarray) -> str:
    parts = (
        f'<{name} type_id="opencv-matrix">\n<rows>{M.shape[0]}</rows><cols>{M.shape[1]}</cols>\n<dt>d</dt>'
        f"<data>{' '.join(repr(float(value)) for value in M.ravel())}</data></{name}>\n"
        for name, M in values.items()
    )
    return f'<?xml version="1.0"?>\n<opencv_storage>\n{"".join(parts)}</opencv_storage>\n'


def _opencv() -> dict[str, dict[str, str]]:
    """The forms that OpenCV's users keep."""
    head, K1, K2 = "%YAML:1.0\n---\n", _LEFT.K, _RIGHT.K
    R, T = _RIG.right_from_left.R, _RIG.right_from_left.t[:, None]
    D, wide, fisheye = np.full((1, 5), 0.01), np.full((1, 14), 1e-3), np.full((1, 4), 0.01)
    cameras = head + "".join(_matrix(*item) for item in (("M1", K1), ("D1", wide), ("M2", K2), ("D2", wide)))
    way = head + _matrix("R", R) + _matrix("T", T)
    P2 = np.hstack([K1, [[-0.1 * K1[0, 0]], [0.0], [0.0]]])
    projections = _matrix("P1", np.hstack([K1, np.zeros((3, 1))])) + _matrix("P2", P2)
    table = {
        "left": {"K": K1.tolist(), "D": D[0].tolist(), "imageSize": [1280, 720]},
        "right": {"fx": 800.0, "fy": 801.0, "cx": 640.0, "cy": 360.0, "k1": 0.1},
        "stereo": {"R": R.tolist(), "T": T[:, 0].tolist(), "unit": "m"},
    }
    lenses = "".join(_matrix(*item) for item in (("K1", K1), ("D1", fisheye), ("K2", K2), ("D2", fisheye)))
    return {
        "pair": {"intrinsics.yml": cameras, "extrinsics.yml": way + "ROI1: [ 10, 20, 900, 600 ]\n"},
        "three": {
            "left.xml": _xml(cameraMatrix=K1, distCoeffs=D),
            "right.xml": _xml(cameraMatrix=K2, distCoeffs=D),
            "stereo.xml": _xml(R=R, T=T, Q=np.eye(4)),
        },
        "one XML": {"stereo.xml": _xml(K1=K1, D1=D, K2=K2, D2=D, R=R, T=T)},
        "nested": {"stereo.json": json.dumps(table)},
        "rectified": {"rectified.yml": f"{head}image_width: 1280\nimage_height: 720\n{projections}"},
        "fisheye": {"fisheye.yml": way.replace(head, f"{head}model: fisheye\n") + lenses},
        "omni": {"omni.yml": way + lenses + "xi1: 1.2\nxi2: 1.3\n"},
    }


def calibrations() -> dict[str, Mapping[str, bytes]]:
    """Every form, each read as it is."""
    made: dict[str, Mapping[str, bytes]] = {}
    for name in RIG_FORMATS:
        made[name] = rig_files(_PLAIN if name in ("middlebury", "kitti") else _RIG, name)
    for name, texts in _opencv().items():
        made[f"opencv, {name}"] = {file: text.encode() for file, text in texts.items()}
    made |= robots(_RIG)
    made["rig.toml"] = {"rig.toml": SEEDS["rig.toml"]}
    return made


def mutated(
    files: Mapping[str, bytes], others: Mapping[str, bytes], chance: random.Random
) -> dict[str, bytes]:
    """The same files with one to three mistakes in one of them, some taken from `others`."""
    made = dict(files)
    name = chance.choice(sorted(made))
    if chance.random() < 0.05:
        del made[name]
        return made
    content = made[name]
    for _ in range(chance.randint(1, 3)):
        content = _one_mistake(content, chance.choice(list(others.values())), chance)
    made[name] = content
    return made


def _one_mistake(content: bytes, other: bytes, chance: random.Random) -> bytes:
    at = chance.randint(0, len(content))
    kind = chance.randrange(8)
    if kind == 0:  # cut off
        return content[:at]
    if kind == 1:  # a bit
        return (
            content[:at] + bytes([content[at] ^ 1 << chance.randrange(8)]) + content[at + 1 :]
            if at < len(content)
            else b""
        )
    if kind == 2:  # a word
        return content[:at] + chance.choice(_ODD_WORDS) + content[at:]
    if kind == 3:  # a number
        found = list(_NUMBER.finditer(content))
        if not found:
            return content
        number = chance.choice(found)
        return content[: number.start()] + chance.choice(_ODD_NUMBERS) + content[number.end() :]
    lines = content.split(b"\n")
    line = chance.randrange(len(lines))
    if kind == 4:
        del lines[line]
    elif kind == 5:
        lines.insert(line, chance.choice(lines))
    elif kind == 6:
        lines.insert(line, chance.choice(other.split(b"\n")))
    else:
        lines[line] = b" " * chance.randrange(9) + lines[line].strip()
    return b"\n".join(lines)
