"""One scene, one renderer: what a rig would see there."""

from __future__ import annotations

from types import TracebackType
from typing import TYPE_CHECKING, Protocol

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.sim import backend
from rigsim.sim.frame import StereoFrame, View

if TYPE_CHECKING:
    from rigsim.sim.scene import Scene
    from rigsim.sim.truth import GroundTruth


class Renderer(Protocol):
    """What draws pictures of the placed rig."""

    name: str

    def render(self, side: int) -> View:
        """The left (0) or right (1) camera's picture."""

    def close(self) -> None:
        """Give back what is held."""


class Simulator:
    """A scene with a mounted rig and something to draw it; use it as a context manager.

    MuJoCo is imported when the first one is made, with the GL library that was found to work.
    """

    def __init__(self, scene: str, mount: str | None = None, renderer: str = "auto") -> None:
        """Open a scene.

        Args:
            scene: name of a bundled scene or path of an MJCF file.
            mount: where the rig sits, see `rigsim.sim.scene.load_scene`.
            renderer: auto, egl, osmesa or rays.

        Raises:
            InvalidScene: scene or mount cannot be used.
            RenderUnavailable: the renderer asked for does not work here.
        """
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

    def place(self, rig: StereoRig) -> None:
        """Move the rig; no picture is drawn yet."""
        self.scene.place(rig)

    def render(self) -> StereoFrame:
        """Both pictures of the placed rig, with the drawn depth checked against rays.

        Raises:
            RenderMismatch: the renderer disagrees with the rig or with rays.
            RenderUnavailable: the pictures are too large.
        """
        from rigsim.sim.render import check_depth

        renderer = self._ready()
        frame = StereoFrame(renderer.render(0), renderer.render(1))
        if self.backend != "rays":
            for side, view in enumerate((frame.left, frame.right)):
                check_depth(self.scene, side, view)
        return frame

    def truth(
        self, n_points: int, rng: np.random.Generator, range_m: tuple[float, float] | None = None
    ) -> GroundTruth:
        """Ground-truth points for the placed rig; see `rigsim.sim.truth.sample_truth`."""
        from rigsim.sim.truth import sample_truth

        return sample_truth(self.scene, n_points, rng, range_m)

    def true_disparity(self, frame: StereoFrame) -> Array:
        """Disparity of each pixel of the left picture; see `rigsim.sim.disparity.true_disparity`."""
        from rigsim.sim.disparity import true_disparity

        return true_disparity(self.scene, frame.left)

    @property
    def gl_renderer(self) -> str:
        """Name of what draws: rays, or what the GL library calls itself."""
        if self.backend == "rays":
            return "rays"
        self._ready()
        from OpenGL import GL

        return f"{self.backend}: {GL.glGetString(GL.GL_RENDERER).decode()}"

    def close(self) -> None:
        """Give the renderer back."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    def _ready(self) -> Renderer:
        """The renderer, made anew when the placed rig's pictures are larger than before."""
        rig = self.scene.rig
        if rig is None:
            raise InvalidRig("no rig was placed in the scene")
        if rig.left.distortion or rig.right.distortion:
            raise InvalidRig("lens distortion cannot be rendered: leave it out of the rig")
        need = (max(rig.left.width, rig.right.width), max(rig.left.height, rig.right.height))
        if self._renderer is not None and (need[0] > self._size[0] or need[1] > self._size[1]):
            self.close()
        if self._renderer is None:
            from rigsim.sim.rays import RayRenderer
            from rigsim.sim.render import GlRenderer, check_size

            check_size(*need)
            if self.backend == "rays":
                self._renderer = RayRenderer(self.scene)
            else:
                self._size = (max(need[0], self._size[0]), max(need[1], self._size[1]))
                self._renderer = GlRenderer(self.scene, self.backend, *self._size)
        return self._renderer
