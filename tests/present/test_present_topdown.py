from __future__ import annotations

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure

from rigsim.present.kit import style
from rigsim.present.kit.topdown import topdown_figure
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.noise import PixelNoise
from rigsim.rig.pose import Pose
from rigsim.rig.presets import preset
from rigsim.rig.stereo import StereoRig
from tests.helpers.synthetic_sweeps import depth_std, make_points

LENS = Intrinsics.from_focal(1280, 720, 900.0)
NOISE = PixelNoise(0.25)


def points_of(axes: Axes, gid: str) -> PathCollection:
    (found,) = [artist for artist in axes.collections if artist.get_gid() == gid]
    assert isinstance(found, PathCollection)
    return found


def labels(axes: Axes) -> list[str]:
    return [text.get_text() for text in axes.texts]


def test_points_stand_in_the_rigs_frame_and_wear_their_error() -> None:
    rig = StereoRig.rectified(LENS, 0.2)
    points, visible = make_points(rig, 400)
    error = depth_std(rig, points, NOISE)
    axes = topdown_figure(rig, points, visible=visible, depth_error_m=error, noise=NOISE).axes[0]
    colored = points_of(axes, "points")
    np.testing.assert_allclose(np.asarray(colored.get_array()), error[visible] * 1e3, rtol=1e-12)
    # the left camera stands at x = -0.1: its points move by half a baseline
    expected = points[visible][:, [0, 2]] - (0.1, 0.0)
    np.testing.assert_allclose(np.asarray(colored.get_offsets()), expected, atol=1e-12)
    hollow = points_of(axes, "seen-by-one")
    np.testing.assert_allclose(
        np.asarray(hollow.get_offsets()), points[~visible][:, [0, 2]] - (0.1, 0.0), atol=1e-12
    )
    assert len(hollow.get_facecolor()) == 0


def test_points_without_an_error_are_crosses() -> None:
    rig = StereoRig.rectified(LENS, 0.2)
    points, visible = make_points(rig, 50)
    error = depth_std(rig, points, NOISE)
    lost = int(np.flatnonzero(visible)[0])
    error[lost] = np.nan
    axes = topdown_figure(rig, points, visible=visible, depth_error_m=error, noise=NOISE).axes[0]
    np.testing.assert_allclose(
        np.asarray(points_of(axes, "not-found").get_offsets()), [points[lost, [0, 2]] - (0.1, 0)], atol=1e-12
    )


def test_lines_of_equal_error_lie_where_the_depth_law_says() -> None:
    rig = StereoRig.rectified(LENS, 0.2)
    points, visible = make_points(rig, 100)
    axes = topdown_figure(rig, points, visible=visible, noise=NOISE).axes[0]
    lines = {text.get_text(): text for text in axes.texts}
    depth = np.sqrt(0.010 * 900 * 0.2 / (0.25 * np.sqrt(2)))  # sigma_Z = Z^2 sigma_d / (f B) = 10 mm
    assert lines["10 mm"].xy[1] == pytest.approx(depth, rel=1e-3)
    # its end is the right edge of the left camera, which bounds the overlap
    assert lines["10 mm"].xy[0] == pytest.approx(-0.1 + 640 / 900 * depth, abs=0.1)


def test_the_default_prediction_is_that_of_theory() -> None:
    rig = StereoRig.verged(LENS, 0.2, 6.0)
    points, _ = make_points(rig, 30)
    axes = topdown_figure(rig, points, noise=NOISE).axes[0]
    colors = np.asarray(points_of(axes, "points").get_array())
    np.testing.assert_allclose(colors, depth_std(rig, points, NOISE) * 1e3, rtol=1e-6)


def test_a_metre_is_as_long_across_as_along() -> None:
    for rig in (StereoRig.rectified(LENS, 0.1), StereoRig.rectified(Intrinsics.from_hfov(640, 480, 20), 0.5)):
        points, visible = make_points(rig, 60)
        figure = topdown_figure(rig, points, visible=visible, noise=NOISE)
        for axes in (figure.axes[0], figure.axes[-1]):
            box = axes.get_position()
            width, height = figure.get_size_inches()
            across = np.ptp(axes.get_xlim()) / (box.width * width)
            along = np.ptp(axes.get_ylim()) / (box.height * height)
            assert across == pytest.approx(along, rel=1e-9)


def test_every_point_lies_on_the_paper() -> None:
    rig = StereoRig.verged(LENS, 0.3, 10.0)
    points, visible = make_points(rig, 500)
    axes = topdown_figure(rig, points, visible=visible, noise=NOISE).axes[0]
    x, z = np.asarray(points_of(axes, "points").get_offsets()).T
    assert x.min() > axes.get_xlim()[0]
    assert x.max() < axes.get_xlim()[1]
    assert z.min() > axes.get_ylim()[0]
    assert z.max() < axes.get_ylim()[1]


def test_axes_and_colour_bar_say_what_they_measure() -> None:
    rig = StereoRig.rectified(LENS, 0.2)
    points, visible = make_points(rig, 100)
    figure = topdown_figure(rig, points, visible=visible, noise=NOISE)
    main, bar, near = figure.axes
    assert main.get_xlabel() == "to the right, m"
    assert main.get_ylabel() == "forward, m"
    assert bar.get_xlabel().endswith(", mm")
    assert near.get_xlabel() == "mm"
    assert "200 mm" in labels(near)


def test_a_single_point_is_drawn_with_its_rays() -> None:
    rig = preset("branch").rig
    figure = topdown_figure(rig, [[0.3, 0.0, 2.5]], noise=NOISE, rays=True)
    axes = figure.axes[0]
    point = [0.3 - 0.075, 2.5]
    ends = [line.get_xydata()[-1] for line in axes.lines]
    assert sum(bool(np.allclose(end, point)) for end in ends) == 2
    std = 2.5**2 / (1200 * 0.15) * 0.25 * np.sqrt(2) * 1e3
    assert f"depth 2.50 m\n± {std:.1f} mm" in labels(axes)


@pytest.mark.parametrize(
    ("rig", "points"),
    [
        (StereoRig.rectified(LENS, 0.12), np.empty((0, 3))),
        (StereoRig.rectified(LENS, 0.12), np.full((1, 3), np.nan)),
        (StereoRig.verged(LENS, 0.3, -120.0), np.empty((0, 3))),
        (StereoRig(LENS, LENS, Pose(t=np.array([0.0, 0.0, -0.3]))), np.array([[0.1, 0.0, 2.0]])),
        (StereoRig(LENS, LENS, Pose(t=np.array([0.0, -0.2, 0.0]))), np.array([[0.1, 0.0, 2.0]])),
        (StereoRig.verged(LENS, 0.3, 4.0), np.array([[0.0, 0.0, 31.0]])),  # on the right camera's own plane
        (StereoRig.rectified(LENS, 5.0), np.array([[0.0, 0.0, 200.0], [9.0, 0.0, 30.0]])),
        (StereoRig.rectified(LENS, 0.01), np.array([[0.0, 0.0, 0.02], [0.01, 0.0, 0.05]])),
    ],
)
def test_odd_rigs_and_points_are_drawn_all_the_same(rig: StereoRig, points: Array) -> None:
    png = style.to_png(topdown_figure(rig, points, noise=NOISE, rays=True), dpi=50)
    assert png.startswith(b"\x89PNG")


def test_cameras_that_share_nothing_are_said_to() -> None:
    figure = topdown_figure(StereoRig.verged(LENS, 0.3, -120.0), np.empty((0, 3)), noise=NOISE)
    assert "the cameras share no view" in labels(figure.axes[0])


def test_no_noise_leaves_nothing_to_colour() -> None:
    rig = StereoRig.rectified(LENS, 0.2)
    points, visible = make_points(rig, 40)
    figure = topdown_figure(
        rig, points, visible=visible, depth_error_m=np.full(40, 1e-15), noise=PixelNoise(0.0)
    )
    assert len(figure.axes) == 2
    assert len(points_of(figure.axes[0], "exact").get_offsets()) == visible.sum()


def test_labels_of_the_plan_do_not_overlap() -> None:
    for baseline, vergence in ((0.5, 0.0), (0.06, 0.0), (0.12, 8.0)):
        rig = StereoRig.verged(LENS, baseline, vergence)
        points, visible = make_points(rig, 200)
        figure = topdown_figure(rig, points, visible=visible, noise=NOISE)
        assert_apart(figure, figure.axes[0])


def assert_apart(figure: Figure, axes: Axes) -> None:
    style.to_png(figure, dpi=72)
    boxes = [text.get_window_extent().shrunk(0.98, 0.9) for text in axes.texts if text.get_text()]
    assert len(boxes) >= 3
    for i, box in enumerate(boxes):
        assert box.count_overlaps(boxes[i + 1 :]) == 0
