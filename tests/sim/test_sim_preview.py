"""A preview shows the same geometry as a full picture, sooner."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rigsim import BrownConrady, Intrinsics, Pose, Simulator, StereoRig
from rigsim.errors import InvalidRig, NothingSeen, RenderMismatch
from rigsim.sim.disparity import drawn_disparity, drawn_points
from rigsim.sim.lens import distort_image, wider_intrinsics
from rigsim.sim.render import GlRenderer
from tests.helpers.scenes import SLANTED, write

LENS = Intrinsics(320, 180, 225.0, 230.0, 150.3, 91.8)
RIG = StereoRig.verged(LENS, 0.2, 3.0, right=replace(LENS, cx=161.0))
BENT = replace(LENS, lens=BrownConrady(-0.2, 0.05, 0.001, -0.002))
BENT_RIG = StereoRig.rectified(BENT, 0.2)
SHEET = """
<mujoco>
  <asset>
    <mesh name="sheet" inertia="shell" vertex="0 -2 -2 0 2 -2 0 0 3 1 0 -2" face="0 1 2 0 1 3"/>
  </asset>
  <worldbody>
    <site name="rig" pos="0 0 1"/>
    <geom name="wall" type="box" pos="4 0 1" size=".05 6 4"/>
    <geom name="sheet" type="mesh" mesh="sheet" pos="2 0 1" euler="0 0 {turn}"/>
  </worldbody>
</mujoco>
"""


@pytest.fixture(scope="module")
def slanted(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Simulator]:
    with Simulator(write(tmp_path_factory.mktemp("scene"), SLANTED)) as simulator:
        yield simulator


def test_a_draft_has_the_depth_and_nearly_the_light_of_the_full_picture(slanted: Simulator) -> None:
    slanted.place(RIG)
    draft, full = slanted.preview(), slanted.render(1)
    for quick, slow in ((draft.left, full.left), (draft.right, full.right)):
        np.testing.assert_array_equal(quick.depth, slow.depth)
        np.testing.assert_array_equal(quick.segmentation, slow.segmentation)
        far = np.abs(quick.light - slow.light)
        assert far.mean() < 0.03
        # the sides are not swapped: the other picture is further off
        other = full.right if slow is full.left else full.left
        assert np.abs(quick.light - other.light).mean() > 1.5 * far.mean()


def test_what_is_no_draft_is_the_full_picture(slanted: Simulator) -> None:
    slanted.place(RIG)
    preview, full = slanted.preview(draft=False), slanted.render(1)
    for one, other in ((preview.left, full.left), (preview.right, full.right)):
        np.testing.assert_array_equal(one.light, other.light)
        np.testing.assert_array_equal(one.depth, other.depth)


def test_a_bent_lens_is_looked_up_where_rays_go(slanted: Simulator) -> None:
    slanted.place(BENT_RIG)
    draft = slanted.preview()
    wide = wider_intrinsics(BENT, 2)
    full = slanted.render(1, (wide, wide))  # its depth is by rays through the lens
    for side, (quick, slow) in enumerate(((draft.left, full.left), (draft.right, full.right))):
        same = quick.segmentation == slow.segmentation
        assert same.mean() > 0.995
        far = np.abs(quick.depth - slow.depth)[same & np.isfinite(slow.depth)]
        assert np.quantile(far, 0.99) < 2e-5  # but along edges
        assert far.max() < 0.1
        light = distort_image(slow.light, wide, BENT)
        assert np.abs(quick.light - light).mean() < 0.03, side
    straight = Simulator(str(slanted.scene.path))
    with straight:
        straight.place(StereoRig.rectified(LENS, 0.2))
        unlike = straight.preview().left.depth
    assert np.nanmedian(np.abs(unlike - draft.left.depth)) > 1e-3  # the lens does something


def test_rays_preview_too(slanted: Simulator) -> None:
    with Simulator(str(slanted.scene.path), None, "rays") as rays:
        rays.place(BENT_RIG)
        slanted.place(BENT_RIG)
        by_rays, drawn = rays.preview(), slanted.preview()
    same = by_rays.right.segmentation == drawn.right.segmentation
    assert np.nanquantile(np.abs(by_rays.right.depth - drawn.right.depth)[same], 0.99) < 2e-5
    assert by_rays.left.image.std() > 5


def test_disparity_by_drawn_depth_is_that_by_rays(slanted: Simulator) -> None:
    for rig in (RIG, BENT_RIG):
        slanted.place(rig)
        frame = slanted.preview()
        points = drawn_points(rig, frame.left.depth)
        found = drawn_disparity(rig, points, frame.right.depth)
        true = slanted.true_disparity(frame)
        both = np.isfinite(found) & np.isfinite(true)
        assert np.abs(found - true)[both].max() < 1e-9
        hidden = np.isfinite(frame.left.depth) & np.isnan(true)
        assert hidden.mean() > 0.02  # the post hides a part of the wall
        assert np.mean(np.isfinite(found) == np.isfinite(true)) > 0.99
        assert np.isnan(found)[hidden].mean() > 0.9


def test_a_small_and_a_large_size_keep_their_renderers(
    slanted: Simulator, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = []
    original = GlRenderer.__init__
    large = StereoRig.rectified(Intrinsics.from_focal(400, 240, 300.0), 0.1)
    small = StereoRig.rectified(Intrinsics.from_focal(160, 96, 120.0), 0.1)
    with Simulator(str(slanted.scene.path)) as simulator:
        monkeypatch.setattr(
            GlRenderer,
            "__init__",
            lambda self, *of, **more: made.append(of[2:]) or original(self, *of, **more),
        )
        for _ in range(2):
            simulator.place(large)
            full = simulator.preview(draft=False)
            simulator.place(small)
            assert simulator.preview().left.depth.shape == (96, 160)
    assert full.left.depth.shape == (240, 400)
    assert made == [(400, 240), (160, 96)]


@pytest.mark.parametrize("turn", [0, 180])
def test_a_draft_shows_the_backs_of_sheets_that_rays_hit(tmp_path: Path, turn: int) -> None:
    with Simulator(write(tmp_path, SHEET.format(turn=turn))) as simulator:
        simulator.place(RIG)
        sheet = simulator.scene.model.geom("sheet").id
        full = simulator.render(1)
        assert (full.left.segmentation == sheet).any()
        for _ in range(2):
            np.testing.assert_array_equal(simulator.preview().left.depth, full.left.depth)


def test_wrong_depth_is_found_in_the_first_draft(slanted: Simulator, monkeypatch: pytest.MonkeyPatch) -> None:
    original = GlRenderer.depth_and_segmentation

    def further(self: GlRenderer, *of):
        depth, ids = original(self, *of)
        return 1.01 * depth, ids

    monkeypatch.setattr(GlRenderer, "depth_and_segmentation", further)
    with Simulator(str(slanted.scene.path)) as simulator:
        for rig in (RIG, BENT_RIG):
            simulator.place(rig)
            with pytest.raises(RenderMismatch, match="rays say"):
                simulator.preview()


def test_what_cannot_be_drawn_is_refused(slanted: Simulator) -> None:
    folded = replace(LENS, lens=BrownConrady(-2.0))
    slanted.place(StereoRig.rectified(folded, 0.2))
    with pytest.raises(InvalidRig, match="folds"):
        slanted.preview()
    # a camera in the face of the post at X 1.95, and of Y up to 0.3: the full picture says so
    slanted.place(StereoRig.rectified(LENS, 0.4), Pose(np.eye(3), np.array([0.0, 0.0, 1.949])))
    with pytest.raises(NothingSeen, match="post"):
        slanted.preview(draft=False)
