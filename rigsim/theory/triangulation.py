"""Pixels of two cameras to points in space.

Every method takes ``(rig, uv_left, uv_right)`` with pixels (N, 2) as they stand in the images, lens
distortion included, and returns (N, 3) metres in the left camera's frame. A point with a NaN
or infinite pixel, or that would lie behind a camera or at infinity, is NaN.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from rigsim.errors import TriangulatorError
from rigsim.rig import given
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig
from rigsim.theory.custom import CheckedTriangulator, NamedMethod, TriangulatorFunction, load
from rigsim.theory.methods.lindstrom import triangulate_lindstrom
from rigsim.theory.methods.linear import triangulate_dlt, triangulate_midpoint
from rigsim.theory.methods.rectified import triangulate_rectified
from rigsim.theory.methods.refine import refine


def triangulate(
    rig: StereoRig,
    uv_left: npt.ArrayLike,
    uv_right: npt.ArrayLike,
    method: str | Callable[..., Any] = "optimal",
) -> Array:
    """Triangulate pixels (N, 2) of both images to points (N, 3) m in the left camera's frame.

    `method` is a name of `METHODS`, ``package.module:function``, or a callable
    ``(rig, uv_left, uv_right) -> (N, 3)``. Points that cannot be triangulated are NaN.

    Raises:
        TriangulatorError: pixels that are no (N, 2) numbers, an unknown method, a method that does not
            fit the rig, or a callable that raises or returns the wrong thing.

    Example:
        >>> import rigsim
        >>> rig = rigsim.preset("bin").rig
        >>> uv_left, uv_right = rig.project([[0.1, -0.2, 2.0]])
        >>> rigsim.triangulate(rig, uv_left, uv_right, "dlt").round(9).tolist()
        [[0.1, -0.2, 2.0]]
    """
    given.a(StereoRig, rig, "a StereoRig: the rig", TriangulatorError)
    left, right = _pixels(uv_left, uv_right)
    return resolve(method)(rig, left, right)


def rectified(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    """Closed form ``Z = fx b / (disparity + doffs)``, v the mean of both images; maximum likelihood.

    Raises:
        TriangulatorError: the rig is not rectified.
    """
    if not rig.is_rectified:
        raise TriangulatorError(
            "triangulator 'rectified': the rig is not rectified (parallel axes, equal fx, fy and cy, "
            "no distortion): use 'optimal'",
            "misused",
        )
    return triangulate_rectified(rig, uv_left, uv_right)


def optimal(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    """Maximum likelihood for equal noise in every pixel coordinate, whatever the rig.

    The closed form when the rig is rectified, else Lindstrom (CVPR 2010); with lens distortion
    followed by Gauss-Newton on the pixels as they were seen, which for lenses that look past 90 degrees
    starts from the middle between the rays.
    """
    if rig.is_rectified:
        return triangulate_rectified(rig, uv_left, uv_right)
    if rig.left.lens is None and rig.right.lens is None:
        return triangulate_lindstrom(rig, uv_left, uv_right)
    if rig.left.is_wide or rig.right.is_wide:
        return refine(rig, triangulate_midpoint(rig, uv_left, uv_right), uv_left, uv_right)
    pinhole = replace(rig, left=replace(rig.left, lens=None), right=replace(rig.right, lens=None))
    start = triangulate_lindstrom(pinhole, _undistorted(rig.left, uv_left), _undistorted(rig.right, uv_right))
    return refine(rig, start, uv_left, uv_right)


REGISTERED: tuple[NamedMethod, ...] = (
    NamedMethod("optimal", "maximum likelihood for equal noise in every pixel coordinate, any rig", optimal),
    NamedMethod("rectified", "closed form of the disparity; for rectified rigs alone", rectified),
    NamedMethod("dlt", "linear least squares on the projection equations", triangulate_dlt, falls_short=True),
    NamedMethod(
        "midpoint", "middle of the shortest line between both rays", triangulate_midpoint, falls_short=True
    ),
)
"""The built-in triangulators; a new one is a line here. `rigsim.study.triangulators` adds those of others."""

METHODS: Mapping[str, TriangulatorFunction] = MappingProxyType(
    {method.name: method.function for method in REGISTERED}
)
"""The built-in triangulators by name."""


def resolve(method: str | Callable[..., Any]) -> TriangulatorFunction:
    """The triangulator that `method` names; a user's own comes back wrapped in its checks.

    Raises:
        TriangulatorError: unknown name (the message lists the known), or it cannot be imported.
    """
    if isinstance(method, str):
        if method in METHODS:
            return METHODS[method]
        if ":" in method:
            return load(method)
        raise TriangulatorError(
            f"unknown triangulator {method!r}: choose one of {', '.join(METHODS)}, "
            "or package.module:function",
            "unknown",
        )
    if not callable(method):
        raise TriangulatorError(f"triangulator {method!r}: must be a name or a function", "unknown")
    if isinstance(method, CheckedTriangulator) or method in METHODS.values():
        return method
    return CheckedTriangulator(method, getattr(method, "__qualname__", type(method).__name__))


def _pixels(uv_left: npt.ArrayLike, uv_right: npt.ArrayLike) -> tuple[Array, Array]:
    checked = []
    for side, uv in (("left", uv_left), ("right", uv_right)):
        try:
            array = np.asarray(uv, dtype=np.float64)
        except (TypeError, ValueError):
            raise TriangulatorError(f"{side} pixels: must be numbers, shape (N, 2)", "misused") from None
        if array.ndim != 2 or array.shape[1] != 2:
            raise TriangulatorError(
                f"{side} pixels of shape {array.shape}: must be (N, 2), a row a point", "misused"
            )
        checked.append(array)
    left, right = checked
    if len(left) != len(right):
        raise TriangulatorError(f"{len(left)} left and {len(right)} right pixels: must be as many", "misused")
    return left, right


def _undistorted(camera: Intrinsics, uv: Array) -> Array:
    """Pixels (N, 2) where the same lens without distortion would see them."""
    with np.errstate(all="ignore"):
        return camera.normalize(uv) * (camera.fx, camera.fy) + (camera.cx, camera.cy)
