"""Random rigs and points, the rigs every method must master, and one tolerance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
from hypothesis import strategies as st

from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

PLAIN = Intrinsics.from_focal(1280, 960, 800.0)
ODD = Intrinsics(1600, 1200, 1000.0, 1100.0, 810.0, 590.0)
LENS = BrownConrady(k1=-0.12, k2=0.03, p1=0.001, p2=-0.0015, k3=-0.004)

RIGS: dict[str, StereoRig] = {
    "rectified": StereoRig.rectified(
        Intrinsics(1280, 960, 800.0, 760.0, 700.0, 400.0),
        0.12,
        right=Intrinsics(1280, 960, 800.0, 760.0, 655.0, 400.0),
    ),
    "verged": StereoRig.verged(PLAIN, 0.12, 20.0),
    "forward": StereoRig(PLAIN, PLAIN, Pose.from_rotvec((0.01, 0.02, 0.03), (0.02, 0.01, -0.3))),
    "rolled": StereoRig(PLAIN, PLAIN, Pose.from_rotvec((0.0, -0.02, 0.3), (-0.12, 0.0, 0.0))),
    "unequal": StereoRig(PLAIN, ODD, Pose.from_rotvec((0.02, -0.05, 0.03), (-0.12, 0.01, 0.02))),
    "distorted": StereoRig(
        replace(PLAIN, lens=LENS),
        replace(ODD, lens=replace(LENS, k1=-0.08)),
        Pose.from_rotvec((0.02, -0.05, 0.03), (-0.12, 0.01, 0.02)),
    ),
}
"""One rig of every kind; the rectified one has doffs, fx != fy and an off-centre principal point."""


def close(actual: npt.ArrayLike, expected: npt.ArrayLike, rtol: float = 1e-9, atol: float = 0.0) -> None:
    """Fail unless shapes agree and ``|actual - expected| <= atol + rtol |expected|``; NaN equals NaN."""
    actual, expected = np.asarray(actual, dtype=np.float64), np.asarray(expected, dtype=np.float64)
    assert actual.shape == expected.shape
    np.testing.assert_allclose(actual, expected, rtol=rtol, atol=atol)


def points_in_view(rig: StereoRig, count: int, near_m: float, far_m: float, seed: int = 0) -> Array:
    """Points (count, 3) m of the left camera's frame that both images show, evenly spread over depth."""
    rng = np.random.default_rng(seed)
    found: list[Array] = []
    while sum(map(len, found)) < count:
        uv = rng.uniform((0, 0), (rig.left.width - 1, rig.left.height - 1), (4 * count, 2))
        z = rng.uniform(near_m, far_m, (4 * count, 1))
        points = np.hstack([rig.left.normalize(uv) * z, z])
        points = points[np.isfinite(points).all(axis=1)]
        found.append(points[rig.right.contains(rig.project(points)[1])])
    return np.concatenate(found)[:count]


def noisy(rig: StereoRig, points_left: Array, sigma_px: float, seed: int = 1) -> tuple[Array, Array]:
    """Projections with Gaussian noise, uncorrelated."""
    rng = np.random.default_rng(seed)
    uv_left, uv_right = rig.project(points_left)
    shape = uv_left.shape
    return uv_left + sigma_px * rng.standard_normal(shape), uv_right + sigma_px * rng.standard_normal(shape)


def vectors(limit: float) -> st.SearchStrategy[Array]:
    """Vectors (3,) with coordinates up to `limit`."""
    number = st.floats(-limit, limit, allow_subnormal=False)
    return st.tuples(number, number, number).map(np.array)


def poses(angle_rad: float = 2.0, shift_m: float = 3.0) -> st.SearchStrategy[Pose]:
    """Any rotation up to about `angle_rad` with any translation."""
    return st.builds(Pose.from_rotvec, vectors(angle_rad / 2), vectors(shift_m))


def lenses() -> st.SearchStrategy[BrownConrady]:
    """Distortions that a lens with a field of view of 80 degrees can be inverted for."""
    radial, tangential = st.floats(-0.1, 0.1), st.floats(-0.003, 0.003)
    return st.builds(
        BrownConrady, radial, st.floats(-0.02, 0.02), tangential, tangential, st.floats(-0.003, 0.003)
    )


def cameras(distorted: bool = False) -> st.SearchStrategy[Intrinsics]:
    """Cameras with unequal fx and fy and a principal point off the middle."""
    return st.builds(
        Intrinsics,
        st.just(1280),
        st.just(960),
        st.floats(700, 1500),
        st.floats(700, 1500),
        st.floats(540, 740),
        st.floats(400, 560),
        lenses() if distorted else st.none(),
    )


@st.composite
def rectified_rigs(draw: st.DrawFn) -> StereoRig:
    """Rectified rigs with doffs."""
    left = draw(cameras())
    right = replace(left, cx=left.cx + draw(st.floats(-40, 40)))
    return StereoRig.rectified(left, draw(st.floats(0.03, 0.5)), right=right)


@st.composite
def rigs(draw: st.DrawFn, distorted: bool = False) -> StereoRig:
    """Two unequal cameras side by side, each turned by up to 10 degrees about any axis."""
    baseline = np.array(
        [-draw(st.floats(0.05, 0.5)), draw(st.floats(-0.03, 0.03)), draw(st.floats(-0.05, 0.05))]
    )
    turn = draw(vectors(0.17))
    return StereoRig(draw(cameras(distorted)), draw(cameras(distorted)), Pose.from_rotvec(turn, baseline))
