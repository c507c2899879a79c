"""A rig from above and from its side, any two lenses."""

from __future__ import annotations

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from rigsim.present.kit import style
from rigsim.present.kit.footprint import CameraView, Footprint
from rigsim.present.kit.format import length
from rigsim.present.kit.plan import BOTH, draw_cameras
from rigsim.rig.arrays import Array, Mask
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.study.rig.sight import meeting_depth_m

_SIDE_IN, _LEFT_IN, _GAP_IN, _BOTTOM_IN = 2.75, 0.72, 0.85, 0.95
_CELLS = 420
_LEAST_REACH, _BEYOND = 6.0, 2.5
_WIDE_DEG = 175.0
_BODY = 0.045
_UPRIGHT = 1e-3
_ABOVE = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
_SIDE = np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]])


def views_figure(rig: StereoRig) -> Figure:
    """Draw a rig from above and from its right side, a metre as long on both.

    Filled is what each camera sees in the plane of its optical axis, and what both do in one of the two
    planes or halfway between.
    """
    low, high = _span(rig)
    poses = (rig.rig_from_left, rig.rig_from_left @ rig.right_from_left.inverse)
    views = (
        (f"From above; baseline {length(rig.baseline_m)}", "to the right, m", "forward, m", _ABOVE),
        ("From its right side", "forward, m", "up, m", _SIDE),
    )
    with style.styled():
        figure = style.new_figure(style.PAGE_WIDTH_IN, _BOTTOM_IN + _SIDE_IN + 0.4)
        left = _LEFT_IN
        for title, across, up, paper in views:
            axes = style.place(figure, left, _BOTTOM_IN, _SIDE_IN, _SIDE_IN)
            _draw(axes, rig, poses, (low, high), paper)
            axes.set_title(title, pad=6)
            axes.set_xlabel(across, labelpad=2)
            axes.set_ylabel(up, labelpad=2)
            left += _SIDE_IN + _GAP_IN
        style.legend(figure, _entries(), _LEFT_IN, 0.4, columns=4)
    return figure


def _span(rig: StereoRig) -> tuple[float, float]:
    """From how far behind the rig to how far in front is drawn, m."""
    reach = max(
        _LEAST_REACH * rig.baseline_m, _BEYOND * min(meeting_depth_m(rig) or 0.0, rig.baseline_m * 100)
    )
    wide = max(camera.hfov_deg for camera in (rig.left, rig.right)) > _WIDE_DEG
    return -(reach / 2 if wide else 0.12 * reach), reach


def _draw(
    axes: Axes, rig: StereoRig, poses: tuple[Pose, Pose], span: tuple[float, float], paper: Array
) -> None:
    """One view; `paper` (3, 3) has its axes across, up and towards the eye as rows, in the rig's frame."""
    low, high = span
    half = (high - low) / 2
    ends = [(low, high) if abs(direction[2]) > 0 else (-half, half) for direction in paper[:2]]
    across, up = np.meshgrid(*(np.linspace(*end, _CELLS) for end in ends))
    axes.imshow(
        _colors(rig, poses, np.stack([across, up], axis=-1), paper),
        origin="lower",
        extent=(*ends[0], *ends[1]),
        aspect="equal",
        interpolation="nearest",
    )
    views = [_view(pose, paper) for pose in poses]
    size = _BODY * (high - low)
    draw_cameras(axes, Footprint(views[0], views[1], None), size, 0.0)
    for pose, view, color in zip(poses, views, (style.LEFT, style.RIGHT), strict=True):
        _draw_pin(axes, paper[:2] @ -pose.R[:, 1], view, size, color)
    axes.set_xlim(*ends[0])
    axes.set_ylim(*ends[1])
    axes.grid(False)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))


def _colors(rig: StereoRig, poses: tuple[Pose, Pose], at: Array, paper: Array) -> Array:
    """Colours (N, N, 4) of places (N, N, 2) m on the paper, by who sees them."""
    depths = [_depth(pose, at, paper) for pose in poses]
    own = [_sees(rig, poses, at, depth, paper) for depth in depths]
    between = _sees(rig, poses, at, (depths[0] + depths[1]) / 2, paper)
    left, right = own[0][0], own[1][1]
    both = np.logical_or.reduce([one & other for one, other in (*own, between)])
    colors = np.zeros((*at.shape[:2], 4))
    colors[left] = to_rgba(style.LEFT, 0.2)
    colors[right] = to_rgba(style.RIGHT, 0.2)
    colors[left & right] = (*np.mean([to_rgba(style.LEFT)[:3], to_rgba(style.RIGHT)[:3]], axis=0), 0.3)
    colors[both] = to_rgba(BOTH, 0.75)
    return colors


def _depth(pose: Pose, at: Array, paper: Array) -> Array:
    """How far towards the eye (N, N), m, the plane of a camera's optical axis lies."""
    center, axis = paper @ pose.t, paper @ pose.R[:, 2]
    flat2 = float(axis[:2] @ axis[:2])
    slope = axis[2] / flat2 if flat2 > _UPRIGHT else 0.0
    return np.asarray(center[2] + slope * ((at - center[:2]) @ axis[:2]))


def _sees(
    rig: StereoRig, poses: tuple[Pose, Pose], at: Array, depth: Array, paper: Array
) -> tuple[Mask, Mask]:
    """Which places each camera shows, at those depths (N, N) m."""
    points = np.concatenate([at, depth[..., None]], axis=-1).reshape(-1, 3) @ paper
    left, right = (
        camera.contains(camera.project(pose.inverse.apply(points))).reshape(depth.shape)
        for camera, pose in zip((rig.left, rig.right), poses, strict=True)
    )
    return left, right


def _view(pose: Pose, paper: Array) -> CameraView:
    axis = paper[:2] @ pose.R[:, 2]
    long = float(np.linalg.norm(axis))
    axis = axis / long if long > 1e-6 else np.array([0.0, 1.0])
    return CameraView(paper[:2] @ pose.t, axis, axis, axis)


def _draw_pin(axes: Axes, up: Array, view: CameraView, size: float, color: str) -> None:
    """A pin out of the body towards the top of the picture."""
    if np.linalg.norm(up) > 0.3:
        foot = view.center - 0.65 * size * view.axis
        axes.plot(*np.stack([foot, foot + 1.6 * size * up]).T, color=color, linewidth=1.4, zorder=5)


def _entries() -> list[tuple[Artist, str]]:
    return [
        (Patch(facecolor=style.LEFT, alpha=0.3), "left camera sees"),
        (Patch(facecolor=style.RIGHT, alpha=0.3), "right camera sees"),
        (Patch(facecolor=BOTH, alpha=0.75), "both see"),
        (Line2D([], [], color=style.INK, linewidth=1.4), "pin: top of the picture"),
    ]
