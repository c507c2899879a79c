"""Figures that others have published, each with its source."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.presets import preset
from rigsim.rig.stereo import StereoRig
from rigsim.theory.limits import (
    blind_zone_m,
    dead_band_px,
    depth_range_for_disparities,
    depth_step_m,
    world_per_pixel_m,
)
from rigsim.theory.triangulation import METHODS, triangulate
from rigsim.theory.uncertainty import depth_bounds, parallax_px
from tests.helpers.sampling import close


def from_corner(focal_px: float, baseline_m: float) -> StereoRig:
    """The calculators' rig: the principal point is pixel (0, 0)."""
    return StereoRig.rectified(Intrinsics.from_focal(2000, 2000, focal_px, cx=0.0, cy=0.0), baseline_m)


def test_w1_drone_before_a_branch() -> None:
    # Multiview Calculator, first example; its page prints X 2098.6, its own formula gives 2100.0
    for method in METHODS:
        points = triangulate(from_corner(1200.0, 0.150), [[980, 500]], [[910, 500]], method)
        close(points * 1e3, [[2100.0, 1071.43, 2571.43]], rtol=0, atol=5e-3)
    rig = preset("branch").rig
    close(parallax_px(rig, [[0.0, 0.0, 2.57143]]), [70.0], rtol=1e-5)


def test_w2_desktop_scan() -> None:
    # Multiview Calculator, second example
    for method in METHODS:
        points = triangulate(from_corner(2000.0, 0.080), [[1400, 1050]], [[1250, 1050]], method)
        close(points * 1e3, [[746.67, 560.0, 1066.67]], rtol=0, atol=5e-3)
    rig = preset("artifact").rig
    close(parallax_px(rig, [[0.0, 0.0, 1.06667]]), [150.0], rtol=1e-5)


def test_w3_focal_length_of_a_field_of_view() -> None:
    # Luxonis, "Depth perception"
    close(Intrinsics.from_hfov(640, 400, 71.9).fx, 441.25, rtol=0, atol=5e-3)
    close(Intrinsics.from_hfov(1280, 800, 71.9).fx, 882.5, rtol=0, atol=5e-3)


def test_w4_depth_of_a_disparity() -> None:
    # Luxonis, "Depth perception": f 441.25 px, B 75 mm, 50 px
    rig = from_corner(441.25, 0.075)
    close(triangulate(rig, [[50, 0]], [[0, 0]])[0, 2] * 1e3, 661.9, rtol=0, atol=0.05)


def test_w5_nearest_depth_of_a_search() -> None:
    # Luxonis, "Depth perception": 95 disparities at 800P and 400P
    nearest = [depth_range_for_disparities(from_corner(f, 0.075), 95.0)[0] * 1e3 for f in (882.5, 441.0)]
    close(nearest, [697.0, 348.0], rtol=0, atol=0.5)


def test_w6_dead_band_and_blind_zone() -> None:
    # Luxonis, "Depth perception": HFOV 72 degrees, B 75 mm, 640 px
    rig = StereoRig.rectified(Intrinsics.from_hfov(640, 400, 72.0), 0.075)
    close(dead_band_px(rig, 1.0), 33.03, rtol=0, atol=5e-3)
    close(blind_zone_m(rig) * 1e3, 51.6, rtol=0, atol=0.05)


def test_w7_depth_error_of_a_quarter_pixel() -> None:
    # changh95, visual-slam-roadmap: f 500 px, B 0.1 m
    close(depth_step_m(from_corner(500.0, 0.1), [2.0, 10.0, 20.0], 0.25), [0.02, 0.5, 2.0])


def test_w8_asymmetric_bounds() -> None:
    # g-rousseau, pinhole-stereo-error: HFOV 90 degrees, 1280 px, B 0.1 m, 1.5 px, 10 m
    rig = StereoRig.rectified(Intrinsics.from_hfov(1280, 720, 90.0), 0.1)
    near, far = depth_bounds(rig, [[0.0, 0.0, 10.0]], 1.5)
    close([near[0], far[0]], [8.10, 13.06], rtol=0, atol=5e-3)


def test_w9_disparity_of_a_depth() -> None:
    # OpenCV forum: 1920 px, HFOV 70 degrees, B 63.5 mm, 1 m
    rig = StereoRig.rectified(Intrinsics.from_hfov(1920, 1080, 70.0), 0.0635)
    close(rig.left.fx, 1371.02, rtol=0, atol=5e-3)
    uv_left, uv_right = rig.project([[0.0, 0.0, 1.0]])
    close((uv_left - uv_right)[0, 0], 87.06, rtol=0, atol=5e-3)
    close(world_per_pixel_m(rig, 1.0) * 87.06, 0.0635, rtol=1e-4)


def test_w10_field_of_view_of_a_lens() -> None:
    # I3DR, SimStereoCam: 2448 px of 3.45 um behind 8 mm
    camera = Intrinsics.from_lens(2448, 2048, 8.0, 2448 * 3.45e-3)
    close(camera.hfov_deg, 55.65, rtol=0, atol=5e-3)


def test_w11_sensor_in_millimetres() -> None:
    # strands robots on MuJoCo >= 3.6: sensor 6.4 x 4.8 mm, focal 6 mm, principal (1.5, 0.8) mm, 320 x 240;
    # its c = (85, 80) counts from the corner of the first pixel, ours from that pixel's centre
    lens = Intrinsics.from_lens(320, 240, 6.0, 6.4)
    close([lens.fx, lens.fy], [300.0, 300.0])
    camera = replace(lens, cx=85 - 0.5, cy=80 - 0.5)
    # the sensor's corner lies 3.2 - 1.5 mm left of and 2.4 - 0.8 mm above the axis
    close(camera.normalize([[-0.5, -0.5]]), [[-1.7 / 6, -1.6 / 6]])
    close(np.subtract([lens.cx, lens.cy], [camera.cx, camera.cy]), [1.5 / 6.4 * 320, 0.8 / 4.8 * 240])
