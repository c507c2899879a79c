"""One scene, one renderer: what a rig would see there."""

from __future__ import annotations

from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Protocol

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig import given
from rigsim.rig.arrays import Array, Ids, Light, Mask
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.sim import backend
from rigsim.sim.frame import StereoFrame, View

if TYPE_CHECKING:
    from rigsim.sim.boards import TrueCorners
    from rigsim.sim.points import GroundTruth
    from rigsim.sim.scene import Scene


SUPERSAMPLE = 2
"""Samples along each side of a pixel, unless something else is asked for."""


class Renderer(Protocol):
    """What draws pictures of the placed rig."""

    name: str

    def light(self, side: int, lens: Intrinsics, supersample: int) -> Light:
        """Linear light (H, W, 3) on the left (0) or right (1) camera through `lens`."""

    def depth_and_segmentation(self, side: int) -> tuple[Array, Ids]:
        """Depth (H, W) m and geom id (H, W) at the pixel centres of the placed rig's camera."""

    def close(self) -> None:
        """Give back what is held."""


class Simulator:
    """A scene with a mounted rig and something to draw it; use it as a context manager.

    MuJoCo is imported when the first one is made, with the GL library that was found to work.
    """

    def __init__(self, scene: str | Path, mount: str | None = None, renderer: str = "auto") -> None:
        """Open a scene.

        Args:
            scene: name of a bundled scene or path of an MJCF file.
            mount: where the rig sits, see `rigsim.sim.scene.load_scene`.
            renderer: auto, egl, osmesa or rays.

        Raises:
            InvalidScene: scene or mount cannot be used.
            RenderUnavailable: the renderer asked for does not work here.
        """
        scene = str(given.path(scene, "scene"))
        self.backend = backend.choose(renderer)
        backend.load_mujoco(self.backend)
        from rigsim.sim.scene import load_scene

        self.scene: Scene = load_scene(scene, mount)
        self._renderer: Renderer | None = None
        self._size = (0, 0)

    def __enter__(self) -> Simulator:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def place(self, rig: StereoRig, mount_from_rig: Pose | None = None) -> None:
        """Move the rig, onto its mount or off it by `mount_from_rig`; no picture is drawn yet."""
        self.scene.place(rig, mount_from_rig)

    @property
    def left_from_world(self) -> Pose:
        """Where the placed rig's left camera is, OpenCV axes."""
        return self.scene.world_from_camera(0).inverse

    def render(
        self, supersample: int = SUPERSAMPLE, lenses: tuple[Intrinsics, Intrinsics] | None = None
    ) -> StereoFrame:
        """Both pictures of the placed rig, with the drawn depth checked against rays.

        Args:
            supersample: samples along each side of a pixel, averaged: 1, 2 or 4.
            lenses: the pinholes to draw the light through, when they are not the rig's own: a lens with
                distortion cannot be drawn, but a wider one can, and be resampled.

        Raises:
            InvalidRig: the rig's lenses distort, and no pinholes were given.
            RenderMismatch: the renderer disagrees with the rig or with rays.
            RenderUnavailable: the pictures are too large.
        """
        from rigsim.sim import rays
        from rigsim.sim.render import buffer_size, check_depth, check_size

        rig = self._placed()
        own = (rig.left, rig.right)
        distorted = any(lens.distortion is not None for lens in own)
        if lenses is None and distorted:
            raise InvalidRig("lens distortion cannot be drawn: give the pinholes to draw with")
        drawn = lenses or own
        for lens in drawn:
            check_size(lens, supersample)
        renderer = self._ready([buffer_size(lens, supersample) for lens in (*drawn, *own)])
        views = []
        for side in (0, 1):
            light = renderer.light(side, drawn[side], supersample)
            if distorted or self.backend == "rays":
                views.append(View(light, *rays.depth_picture(self.scene, side)))
                continue
            depth, segmentation = renderer.depth_and_segmentation(side)
            check_depth(self.scene, side, depth, segmentation)
            views.append(View(light, depth, segmentation))
        return StereoFrame(*views)

    def truth(
        self, n_points: int, rng: np.random.Generator, range_m: tuple[float, float] | None = None
    ) -> GroundTruth:
        """Ground-truth points for the placed rig; see `rigsim.sim.truth.sample_truth`."""
        from rigsim.sim.truth import sample_truth

        return sample_truth(self.scene, n_points, rng, range_m)

    def true_corners(self) -> TrueCorners:
        """Corners of the scene's checker boards; see `rigsim.sim.boards`."""
        from rigsim.sim.boards import true_corners

        return true_corners(self.scene)

    def points_at(self, uv_left: Array) -> tuple[Array, Mask]:
        """What the left camera sees at pixels (N, 2), and whether the right camera sees it too.

        Returns:
            Points (N, 3) m in the left camera's frame, NaN where there is nothing; and (N,).
        """
        from rigsim.sim.truth import points_at

        return points_at(self.scene, uv_left)

    def true_disparity(self, frame: StereoFrame) -> Array:
        """Disparity of each pixel of the left picture; see `rigsim.sim.disparity.true_disparity`."""
        from rigsim.sim.disparity import true_disparity

        return true_disparity(self.scene, frame.left)

    @property
    def gl_renderer(self) -> str:
        """Name of what draws: rays, or what the GL library calls itself."""
        if self.backend == "rays":
            return "rays"
        left = self._placed().left
        self._ready([(left.width, left.height)])
        from OpenGL import GL

        return f"{self.backend}: {GL.glGetString(GL.GL_RENDERER).decode()}"

    def close(self) -> None:
        """Give the renderer back."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    def _placed(self) -> StereoRig:
        if self.scene.rig is None:
            raise InvalidRig("no rig was placed in the scene")
        return self.scene.rig

    def _ready(self, sizes: list[tuple[int, int]]) -> Renderer:
        """The renderer, made anew when it is to draw larger pictures than before."""
        from rigsim.sim.rays import RayRenderer
        from rigsim.sim.render import GlRenderer

        need = (max(width for width, _ in sizes), max(height for _, height in sizes))
        if self._renderer is not None and (need[0] > self._size[0] or need[1] > self._size[1]):
            self.close()
        if self._renderer is None:
            self._size = (max(need[0], self._size[0]), max(need[1], self._size[1]))
            if self.backend == "rays":
                self._renderer = RayRenderer(self.scene)
            else:
                self._renderer = GlRenderer(self.scene, self.backend, *self._size)
        return self._renderer
