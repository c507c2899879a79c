"""Point clouds as PLY (Turk, "The PLY polygon file format", 1994), metres, OpenCV axes."""

from __future__ import annotations

import numpy as np

from rigsim.rig.arrays import Array, Image


def ply_bytes(
    points: Array,
    *,
    depth_std_m: Array | None = None,
    colors: Image | None = None,
    binary: bool = True,
) -> bytes:
    """A PLY file of the `points` that are known.

    Args:
        points: (N, 3), m; rows with NaN are left out.
        depth_std_m: standard deviation of each point's depth, (N,), m, written as ``depth_std``; NaN if
            unknown.
        colors: red, green and blue of each point, (N, 3), 0 to 255.
        binary: little endian; False writes text.

    Raises:
        ValueError: the shapes do not belong together.
    """
    points = np.asarray(points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"points of shape {points.shape}: must be (N, 3)")
    known = np.isfinite(points).all(axis=1)
    fields = [("float", axis, "<f4", points[:, i]) for i, axis in enumerate("xyz")]
    if colors is not None:
        if colors.shape != points.shape:
            raise ValueError(f"colours of shape {colors.shape}: must be {points.shape}")
        names = ("red", "green", "blue")
        fields += [("uchar", name, "u1", colors[:, i].astype(np.float64)) for i, name in enumerate(names)]
    if depth_std_m is not None:
        if depth_std_m.shape != points.shape[:1]:
            raise ValueError(f"depth std of shape {depth_std_m.shape}: must be {points.shape[:1]}")
        fields.append(("float", "depth_std", "<f4", depth_std_m))

    header = [
        "ply",
        f"format {'binary_little_endian' if binary else 'ascii'} 1.0",
        "comment metres; x right, y down, z forward of the left camera",
        f"element vertex {int(known.sum())}",
        *(f"property {kind} {name}" for kind, name, _, _ in fields),
        "end_header",
    ]
    table = np.empty(int(known.sum()), dtype=[(name, kind) for _, name, kind, _ in fields])
    for _, name, _, values in fields:
        table[name] = values[known]
    if binary:
        body = bytes(table.tobytes())
    else:
        body = "".join(
            " ".join(f"{value:.9g}" if isinstance(value, float) else str(value) for value in row) + "\n"
            for row in table.tolist()
        ).encode("ascii")
    return "\n".join(header).encode("ascii") + b"\n" + body
