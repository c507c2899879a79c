"""The files people look at, as bytes; writing them is the caller's business."""

from __future__ import annotations

from collections.abc import Callable

import numpy.typing as npt
from matplotlib.figure import Figure

from rigsim.present.kit import style
from rigsim.present.kit.page import Cover
from rigsim.present.kit.picture_figure import picture_figure
from rigsim.present.kit.pictures import anaglyph, disparity_picture, encode, picture_limits, with_scale
from rigsim.present.kit.topdown import topdown_figure
from rigsim.present.sweep import page as report
from rigsim.present.sweep.measured_words import was_measured
from rigsim.present.sweep.plots import curves
from rigsim.present.sweep.plots.witnesses import witnesses_figure
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.study.scene.snapshot import Snapshot
from rigsim.study.sweep.result import SweepResult


def sweep_files(result: SweepResult, cover: Cover | None = None) -> dict[str, bytes]:
    """Name to content: report.html, topdown.png, depth_error.png, left.png, right.png; witnesses.png too
    when something was measured. `cover` is the report's own head."""
    plan = report.showcase_figure(result)
    files = {
        "report.html": report.report_html(result, plan, cover).encode("utf-8"),
        "topdown.png": style.to_png(plan),
        "depth_error.png": style.to_png(curves.depth_error_figure(result), dpi=110),
        "left.png": encode(result.showcase.image_left),
        "right.png": encode(result.showcase.image_right),
    }
    if was_measured(result.rows):
        files["witnesses.png"] = style.to_png(witnesses_figure(result), dpi=130)
    return files


def figures(result: SweepResult) -> dict[str, Callable[[], Figure]]:
    """What draws each figure of a sweep, by name: depth_error, topdown, and witnesses where something was
    measured."""
    found: dict[str, Callable[[], Figure]] = {
        "depth_error": lambda: curves.depth_error_figure(result),
        "topdown": lambda: report.showcase_figure(result),
    }
    if was_measured(result.rows):
        found["witnesses"] = lambda: witnesses_figure(result)
    return found


def render_files(snapshot: Snapshot) -> dict[str, bytes]:
    """Name to content: left.png, right.png, disparity.png, and anaglyph.png for images of one size."""
    left, right = snapshot.frame.left.image, snapshot.frame.right.image
    limits = picture_limits(snapshot.disparity)
    disparity = with_scale(disparity_picture(snapshot.disparity, limits), limits, "disparity, px")
    files = {"left.png": encode(left), "right.png": encode(right), "disparity.png": encode(disparity)}
    if left.shape == right.shape:
        files["anaglyph.png"] = encode(anaglyph(left, right))
    return files


def plot_points(
    rig: StereoRig, points_left: npt.ArrayLike, noise: PixelNoise | None = None, title: str = ""
) -> bytes:
    """PNG of a few points (N, 3) m in the left camera's frame, from above, with lines of sight."""
    return style.to_png(topdown_figure(rig, points_left, noise=noise, rays=True, title=title))


def render_figures(snapshot: Snapshot) -> dict[str, Callable[[], Figure]]:
    """What draws each picture of a rendered pair, by name: left, right and disparity."""
    left, right = snapshot.frame.left.image, snapshot.frame.right.image

    def disparity() -> Figure:
        limits = picture_limits(snapshot.disparity)
        picture = with_scale(disparity_picture(snapshot.disparity, limits), limits, "disparity, px")
        return picture_figure(picture, "disparity, px")

    return {
        "left": lambda: picture_figure(left, "left picture"),
        "right": lambda: picture_figure(right, "right picture"),
        "disparity": disparity,
    }
