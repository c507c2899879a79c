"""One scene, one renderer: what a rig would see there."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Protocol

import numpy as np

from rigsim.errors import InvalidRig, RenderMismatch
from rigsim.rig import given
from rigsim.rig.arrays import Array, Ids, Light, Mask
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.sim import backend, faces
from rigsim.sim.frame import StereoFrame, View
from rigsim.sim.scenes.made import MadeScene

if TYPE_CHECKING:
    from rigsim.sim.scenes.boards import TrueCorners
    from rigsim.sim.scenes.scene import Scene
    from rigsim.sim.truth.points import GroundTruth


SUPERSAMPLE = 2
"""Samples along each side of a pixel, unless something else is asked for."""


class Renderer(Protocol):
    """What draws pictures of the placed rig."""

    name: str
    backs: bool
    """Whether surfaces are drawn from behind as well."""
    bends: bool
    """Whether it draws through lenses that distort."""

    def light(
        self, side: int, lens: Intrinsics, supersample: int, camera_from_face: Array | None = None
    ) -> Light:
        """Linear light (H, W, 3) on the left (0) or right (1) camera through `lens`, turned by (3, 3)."""

    def depth_and_segmentation(self, side: int, lens: Intrinsics | None = None) -> tuple[Array, Ids]:
        """Depth (H, W) m and geom id (H, W) at the pixel centres of the placed rig's camera, or of `lens`."""

    def close(self) -> None:
        """Give back what is held."""


class Simulator:
    """A scene with a mounted rig and something to draw it; use it as a context manager.

    MuJoCo is imported when the first one is made, with the GL library that was found to work.

    Example:
        >>> import rigsim
        >>> with rigsim.Simulator("bin", renderer="rays") as simulator:
        ...     simulator.scene.name, simulator.backend
        ('bin', 'rays')
    """

    def __init__(
        self, scene: str | Path | MadeScene, mount: str | None = None, renderer: str = "auto"
    ) -> None:
        """Open a scene.

        Args:
            scene: name of a bundled scene, path of an MJCF file, or a scene that was made.
            mount: where the rig sits, see `rigsim.sim.scenes.scene.load_scene`.
            renderer: auto, egl, osmesa or rays.

        Raises:
            InvalidScene: scene or mount cannot be used.
            RenderUnavailable: the renderer asked for does not work here.
        """
        named = scene if isinstance(scene, MadeScene) else str(given.path(scene, "scene"))
        self.backend = backend.choose(renderer)
        backend.load_mujoco(self.backend)
        from rigsim.sim.scenes.scene import load_scene

        self.scene: Scene = load_scene(named, mount)
        self._renderers: dict[bool, Renderer] = {}  # by whether it draws drafts
        self._sizes: dict[bool, tuple[int, int]] = {}
        self._trusted = False  # what drafts show of surfaces' backs was held to rays
        self._remarks: dict[str, Remark] = {}
        self._looked_at = 0

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
            lenses: the cameras to draw the light through, when they are not the rig's own: pinholes that
                cover what its lenses show, to be resampled, or finer ones.

        Raises:
            InvalidRig: the distortion folds the picture over.
            RenderMismatch: the renderer disagrees with the rig or with rays.
            RenderUnavailable: the pictures are too large.
        """
        from rigsim.sim.truth import rays

        rig = self._placed()
        distorted = any(lens.lens is not None for lens in (rig.left, rig.right))
        drawn = lenses or (rig.left, rig.right)
        renderer = self._renderer_of(drawn, supersample)
        if distorted or self.backend == "rays":
            truths = [rays.depth_picture(self.scene, side) for side in (0, 1)]
        else:
            truths = self._drawn_depth(renderer)
        views = []
        for side, (depth, segmentation) in enumerate(truths):
            views.append(View(faces.draw(renderer, side, drawn[side], supersample), depth, segmentation))
        return StereoFrame(*views)

    def light(self, side: int, lens: Intrinsics) -> Light:
        """Linear light (H, W, 3), 0 to 1, on the placed rig's left (0) or right (1) camera, and nothing else.

        Args:
            side: which camera's place and turn.
            lens: the camera to draw through, one sample a pixel: its own, or a part of its picture
                (`Intrinsics.cropped`), as a rule a finer one (`Intrinsics.supersampled`).

        Raises:
            InvalidRig: the distortion folds the picture over.
            RenderUnavailable: the picture is too large.
        """
        self._placed()
        return faces.draw(self._room_for((lens,)), side, lens, 1)

    def make_room(self, lenses: Iterable[Intrinsics]) -> None:
        """Get ready for `light` through several cameras: what draws is made once, for the largest picture.

        Raises:
            InvalidRig, RenderUnavailable: as `light`.
        """
        self._room_for(lenses)

    def _room_for(self, lenses: Iterable[Intrinsics]) -> Renderer:
        from rigsim.sim.render import buffer_size, check_size

        pinholes = [pinhole for lens in lenses for pinhole in faces.pinholes_of(lens, 1)]
        for pinhole, k in pinholes:
            check_size(pinhole, k)
        return self._ready([buffer_size(pinhole, k) for pinhole, k in pinholes])

    def preview(self, draft: bool = True) -> StereoFrame:
        """Both pictures of the placed rig as soon as they can be had, lens distortion included.

        Args:
            draft: one sample a pixel, no shadows, and the drawn depth held to rays for the first picture of a
                scene alone; else what ``render(1)`` gives.

        Raises:
            InvalidRig: the distortion folds the picture over, or needs more than three times its width.
            NothingSeen: a camera lies in a surface; not of a draft.
            RenderMismatch: the renderer disagrees with the rig or with rays.
            RenderUnavailable: the pictures are too large.
        """
        depths = self.preview_depth(draft)
        left, right = (View(self.preview_light(side, draft), *depths[side]) for side in (0, 1))
        return StereoFrame(left, right)

    def preview_light(self, side: int, draft: bool = True) -> Light:
        """The light of the left (0) or right (1) picture of `preview` alone: linear, (H, W, 3).

        Args:
            side: which.
            draft: as `preview`.

        Raises:
            InvalidRig, RenderMismatch, RenderUnavailable: as `preview`.
        """
        from rigsim.sim import preview

        return preview.light(self.scene, self._previewer(draft), side)

    def preview_depth(self, draft: bool = True) -> tuple[tuple[Array, Ids], tuple[Array, Ids]]:
        """The depth of `preview` alone: (H, W) m, NaN for nothing, and geom ids (H, W), left and right.

        Args:
            draft: as `preview`.

        Raises:
            InvalidRig, NothingSeen, RenderMismatch, RenderUnavailable: as `preview`.
        """
        from rigsim.sim.preview import pinhole_of, through
        from rigsim.sim.truth import rays

        rig, renderer = self._placed(), self._previewer(draft)
        if not draft:
            self._looked()
        cameras = (rig.left, rig.right)
        if renderer.bends or any(faces.needs_faces(camera) for camera in cameras):
            left, right = (rays.depth_picture(self.scene, side) for side in (0, 1))
            return left, right
        lenses = tuple(pinhole_of(camera) for camera in cameras)
        if draft and self._trusted:
            drawn = [renderer.depth_and_segmentation(side, lenses[side]) for side in (0, 1)]
        else:
            drawn = self._drawn_depth(renderer, lenses)
            self._trusted = self._trusted or draft
        left, right = (
            picture if lens == camera else through(camera, *picture)
            for picture, lens, camera in zip(drawn, lenses, cameras, strict=True)
        )
        return left, right

    def _previewer(self, draft: bool) -> Renderer:
        from rigsim.sim.preview import pinholes_of
        from rigsim.sim.render import buffer_size, check_size

        rig = self._placed()
        drawn = [*pinholes_of(rig.left), *pinholes_of(rig.right)]
        for lens in drawn:
            check_size(lens, 1)
        return self._ready([buffer_size(lens, 1) for lens in drawn], draft)

    def check(self, supersample: int = SUPERSAMPLE) -> None:
        """Hold the placed rig's drawn depth to rays, as `render` does, and draw no light.

        Args:
            supersample: of the pictures that may be drawn later.

        Raises:
            RenderMismatch: the renderer disagrees with the rig or with rays.
            RenderUnavailable: the pictures are too large.
        """
        rig = self._placed()
        renderer = self._renderer_of((rig.left, rig.right), supersample)
        if self.backend != "rays" and rig.left.lens is None and rig.right.lens is None:
            self._drawn_depth(renderer)

    def _renderer_of(self, drawn: tuple[Intrinsics, Intrinsics], supersample: int) -> Renderer:
        """What draws through these cameras, and through the placed rig's own, which was looked at."""
        from rigsim.sim.render import buffer_size, check_size

        rig = self._placed()
        pinholes = [pinhole for camera in drawn for pinhole in faces.pinholes_of(camera, supersample)]
        for lens, k in pinholes:
            check_size(lens, k)
        sizes = [
            buffer_size(lens, k) for lens, k in (*pinholes, (rig.left, supersample), (rig.right, supersample))
        ]
        renderer = self._ready(sizes)
        self._looked()
        return renderer

    def _drawn_depth(
        self, renderer: Renderer, lenses: tuple[Intrinsics | None, ...] = (None, None)
    ) -> list[tuple[Array, Ids]]:
        """Depth and geom ids of both pictures, drawn so that they are what rays hit.

        Through the placed rig's cameras, or through `lenses`.

        MuJoCo leaves out the backs of surfaces, which rays hit: they are drawn where a scene shows any.
        """
        from rigsim.sim.render import check_depth

        first: RenderMismatch | None = None
        for backs in (False, True):
            renderer.backs = backs
            pictures = [renderer.depth_and_segmentation(side, lenses[side]) for side in (0, 1)]
            try:
                for side, picture in enumerate(pictures):
                    check_depth(self.scene, side, *picture, lenses[side])
            except RenderMismatch as mismatch:
                first = first or mismatch
            else:
                return pictures
        assert first is not None
        raise first

    def _looked(self) -> None:
        """Look at what the placed rig has before it, once: note what is odd, refuse a camera in a wall."""
        from rigsim.sim.truth.outlook import look_around

        self._placed()
        if self._looked_at != self.scene.placements:
            for remark in look_around(self.scene):
                self._remarks.setdefault(remark.code, remark)
            self._looked_at = self.scene.placements

    def truth(
        self,
        n_points: int,
        rng: np.random.Generator,
        range_m: tuple[float, float] | None = None,
        far_limit_m: float = math.inf,
    ) -> GroundTruth:
        """Ground-truth points for the placed rig; see `rigsim.sim.truth.ground_truth.sample_truth`."""
        from rigsim.sim.truth.ground_truth import sample_truth

        self._looked()
        return sample_truth(self.scene, n_points, rng, range_m, far_limit_m)

    def true_corners(self) -> TrueCorners:
        """Corners of the scene's checker boards; see `rigsim.sim.scenes.boards`."""
        from rigsim.sim.scenes.boards import true_corners

        return true_corners(self.scene)

    def points_at(self, uv_left: Array) -> tuple[Array, Mask]:
        """What the left camera sees at pixels (N, 2), and whether the right camera sees it too.

        Returns:
            Points (N, 3) m in the left camera's frame, NaN where there is nothing; and (N,).
        """
        from rigsim.sim.truth.ground_truth import points_at

        return points_at(self.scene, uv_left)

    def true_disparity(self, frame: StereoFrame) -> Array:
        """Disparity of each pixel of the left picture; see `rigsim.sim.disparity.true_disparity`."""
        from rigsim.sim.disparity import true_disparity

        return true_disparity(self.scene, frame.left)

    def on_sky(self, points_left: Array) -> Mask:
        """Which of the points (N, 3) that `points_at` gave are of a textured skybox, (N,).

        It is at infinity: features can be found on it, but it has no depth to hold them to.
        """
        nothing = np.isnan(points_left[:, 2])
        return nothing if self.scene.sky else np.zeros_like(nothing)

    @property
    def remarks(self) -> tuple[Remark, ...]:
        """What a person should know of the scene and of the rigs that looked at it, each said once."""
        from rigsim.sim.scenes import elements, gate

        for remark in elements.warned(self.scene.name, gate.heard()):
            self._remarks.setdefault(remark.text, remark)
        return (*self.scene.remarks, *self._remarks.values())

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
        for renderer in self._renderers.values():
            renderer.close()
        self._renderers.clear()
        self._trusted = False

    def _placed(self) -> StereoRig:
        if self.scene.rig is None:
            raise InvalidRig("no rig was placed in the scene")
        return self.scene.rig

    def _ready(self, sizes: list[tuple[int, int]], draft: bool = False) -> Renderer:
        """The renderer, made anew when it is to draw larger pictures than before."""
        from rigsim.sim.render import GlRenderer
        from rigsim.sim.truth.rays import RayRenderer

        had = self._sizes.get(draft, (0, 0))
        need = (max(had[0], *(width for width, _ in sizes)), max(had[1], *(height for _, height in sizes)))
        if draft in self._renderers and need != had:
            self._renderers.pop(draft).close()
        if draft not in self._renderers:
            self._sizes[draft] = need
            self._trusted = self._trusted and not draft
            if self.backend == "rays":
                self._renderers[draft] = RayRenderer(self.scene)
            else:
                self._renderers[draft] = GlRenderer(self.scene, self.backend, *need, draft=draft)
        return self._renderers[draft]
