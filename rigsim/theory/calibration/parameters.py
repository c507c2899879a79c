"""What a stereo calibration estimates: two cameras, and where the one stands in the other's frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array, Mask, frozen
from rigsim.rig.board import Board
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.lens import Lens
from rigsim.rig.pose import Pose, rotation_from_rotvec
from rigsim.rig.stereo import StereoRig

CAMERA = ("fx", "fy", "cx", "cy")
POSE = ("rx_rad", "ry_rad", "rz_rad", "tx_m", "ty_m", "tz_m")
WARP = ("warp_x_m", "warp_y_m")


@dataclass(frozen=True, slots=True)
class RigParameters:
    """The numbers of a rig that a calibration finds, in their order, and which of them are free.

    All of them: ``left.fx``, ... its lens's coefficients, the right camera's, then how right_from_left
    differs: a turn ``exp([r]x) R``, rad, of the right camera's frame, and t + ``t``, m; then, if the board is
    not trusted to be flat, its two warps, m.

    Example:
        >>> from rigsim.rig.lens.distortion import BrownConrady
        >>> held = RigParameters.of((BrownConrady, BrownConrady), fix=("k3", "right.p1"))
        >>> len(held.names), held.free.sum()
        (24, np.int64(21))
    """

    lenses: tuple[type[Lens] | None, type[Lens] | None]
    """Lens models of the left and the right camera; None has no coefficients."""
    names: tuple[str, ...]
    """All parameters, whether they are free or held."""
    free: Mask
    """Which are free, (p,)."""
    square_pixels: tuple[bool, bool]
    """Whether fy follows fx, of each camera."""
    warped: bool
    """Whether the board's two warps are among them."""

    @classmethod
    def of(
        cls,
        lenses: tuple[type[Lens] | None, type[Lens] | None],
        *,
        fix: Sequence[str] = (),
        warped: bool = False,
    ) -> RigParameters:
        """Everything but what `fix` holds: a name of both cameras or of one (``k3``, ``right.k3``),
        ``aspect``, ``focal``, ``principal``, ``tangential``, ``lens``, ``pose``.

        Raises:
            InvalidRange: a name is none of these.
        """
        names = [
            f"{side}.{name}"
            for side, lens in zip(("left", "right"), lenses, strict=True)
            for name in (*CAMERA, *(() if lens is None else lens.names()))
        ]
        names += POSE
        names += WARP if warped else ()
        free = np.ones(len(names), dtype=bool)
        square = [False, False]
        for word in fix:
            sides, name = _sides(word)
            if name == "aspect":
                square = [was or side in sides for was, side in zip(square, ("left", "right"), strict=True)]
                continue
            held = _held(name, sides, names)
            if not held:
                raise InvalidRange(f"fix {word!r}: {_way_out(names)}")
            free[[names.index(each) for each in held]] = False
        return cls(lenses, tuple(names), free, (square[0], square[1]), warped)

    def columns(self, side: int) -> slice:
        """Where the parameters of the left (0) or right (1) camera are."""
        counts = [len(CAMERA) + (0 if lens is None else len(lens.names())) for lens in self.lenses]
        return slice(0, counts[0]) if side == 0 else slice(counts[0], sum(counts))

    @property
    def pose(self) -> slice:
        """Where the pose's six are."""
        end = self.columns(1).stop
        return slice(end, end + 6)

    @property
    def warp(self) -> slice:
        """Where the board's two are; empty if it is trusted."""
        return slice(self.pose.stop, len(self.names))

    def basis(self, rig: StereoRig) -> Array:
        """How all parameters (p) move with the free ones (q): (p, q)."""
        full = np.eye(len(self.names))
        free = self.free.copy()
        for side, camera in enumerate((rig.left, rig.right)):
            if self.square_pixels[side]:
                fx = self.columns(side).start
                full[fx + 1, fx] = camera.fy / camera.fx if free[fx] else 0.0
                free[fx + 1] = False
        return frozen(full[:, free])

    def free_names(self, rig: StereoRig) -> tuple[str, ...]:
        """Names of the columns of `basis`."""
        moved = self.basis(rig)
        return tuple(self.names[int(np.argmax(column != 0))] for column in moved.T)

    def lens(self, rig: StereoRig, side: int) -> Lens | None:
        """The lens of one camera in its model here, whether it bends anything or not.

        Raises:
            InvalidRange: the camera's lens is of another model.
        """
        camera, model = (rig.left, rig.right)[side], self.lenses[side]
        if model is None or isinstance(camera.lens, model):
            return camera.lens
        if camera.lens is not None:
            raise InvalidRange(f"lens {camera.lens.said}: is no {model.model}; fit one first")
        return model()

    def moved(self, rig: StereoRig, change: Array) -> StereoRig:
        """The rig whose parameters are off by `change` (p,).

        Raises:
            InvalidRig: no camera has such numbers, as a focal length of 0.
        """
        cameras = [self._camera(rig, side, change[self.columns(side)]) for side in (0, 1)]
        turn, shift = change[self.pose][:3], change[self.pose][3:]
        right_from_left = Pose(
            rotation_from_rotvec(turn) @ rig.right_from_left.R, rig.right_from_left.t + shift
        )
        return StereoRig(cameras[0], cameras[1], right_from_left)

    def warped_board(self, board: Board, change: Array) -> Board:
        """The board whose warps, if they are parameters, are off by `change` (p,)."""
        if not self.warped:
            return board
        by_x, by_y = change[self.warp]
        return replace(board, warp_m=(board.warp_m[0] + float(by_x), board.warp_m[1] + float(by_y)))

    def _camera(self, rig: StereoRig, side: int, change: Array) -> Intrinsics:
        camera, model, lens = (rig.left, rig.right)[side], self.lenses[side], self.lens(rig, side)
        pinhole = np.array([camera.fx, camera.fy, camera.cx, camera.cy]) + change[:4]
        fx, fy, cx, cy = (float(value) for value in pinhole)
        if model is not None and lens is not None:
            now = np.array([getattr(lens, name) for name in model.names()]) + change[4:]
            lens = model(*(float(value) for value in now))
        return Intrinsics(camera.width, camera.height, fx, fy, cx, cy, lens)

    def camera_slopes(self, rig: StereoRig, side: int, points_camera: Array) -> Array:
        """Derivative (..., 2, c) px of one camera's projection with respect to its own parameters."""
        camera, lens = (rig.left, rig.right)[side], self.lens(rig, side)
        z = points_camera[..., 2:]
        with np.errstate(divide="ignore", invalid="ignore"):
            straight = np.where(z > 0, points_camera[..., :2] / z, np.nan)
        image = straight if lens is None else lens.project(points_camera)
        count = len(CAMERA) + (0 if lens is None else len(lens.names()))
        J = np.zeros((*points_camera.shape[:-1], 2, count))
        J[..., 0, 0], J[..., 1, 1] = image[..., 0], image[..., 1]
        J[..., 0, 2] = J[..., 1, 3] = 1.0 + 0 * image[..., 0]
        if lens is not None:
            J[..., 4:] = lens.slopes(points_camera) * np.array([[camera.fx], [camera.fy]])
        return J


def _sides(word: str) -> tuple[tuple[str, ...], str]:
    side, dot, name = word.partition(".")
    return ((side,), name) if dot else (("left", "right"), word)


_GROUPS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"focal": ("fx", "fy"), "principal": ("cx", "cy"), "tangential": ("p1", "p2")}
)


def _held(name: str, sides: Sequence[str], names: Sequence[str]) -> list[str]:
    """The full names that a word holds."""
    if name == "pose":
        return list(POSE)
    if name in POSE:
        return [name]
    own = [full for full in names if full.partition(".")[0] in sides]
    if name == "lens":
        return [full for full in own if full.partition(".")[2] not in CAMERA]
    return [full for full in own if full.partition(".")[2] in _GROUPS.get(name, (name,))]


def _way_out(names: Sequence[str]) -> str:
    own = dict.fromkeys(full.partition(".")[2] for full in names if "." in full)
    words = ", ".join([*own, "aspect", *_GROUPS, "lens", "pose", *POSE])
    return f"must be one of {words}; or of one camera, as right.{next(iter(own))}"
