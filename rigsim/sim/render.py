"""Pictures by MuJoCo's GL renderer, with the projection read back and the depth checked against rays."""

from __future__ import annotations

import contextlib
import weakref
from dataclasses import replace
from typing import Any, ClassVar

import mujoco
import numpy as np

from rigsim.errors import RenderMismatch, RenderUnavailable
from rigsim.rig.arrays import Array, Ids, Light
from rigsim.rig.intrinsics import Intrinsics
from rigsim.sim.backend import make_gl_context
from rigsim.sim.scenes.scene import Scene
from rigsim.sim.supersampling import box_average
from rigsim.sim.truth import rays
from rigsim.sim.truth.facets import CURVED, FINEST, Facets, radii_px, slices

MAX_SIDE_PX = 16384
"""Largest off-screen width or height the software renderers take."""

_FRUSTUM_TOLERANCE_PX = 1e-3
_CHECKED_PIXELS = 400
_FLAT_TOLERANCE_M = 2e-5  # at 1 m and nearer; grows with depth
_CURVED_TOLERANCE = 1.28  # of the geom's bounding radius over its slices: chords seen at a grazing angle
_EXACT = (mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_MESH)
_SPARE_GEOMS = 1000
_BAND_PX = 1 << 22  # drawn at once: four samples a pixel take 32 bytes each


class GlRenderer:
    """One GL context and one model; use it in the thread that made it, and close it.

    Several may be open at once: whatever one draws or frees, it does in its own context.
    """

    _current: ClassVar[weakref.ref[GlRenderer] | None] = None
    """The one whose context is current: what GL is told goes there, whosever it is."""

    def __init__(self, scene: Scene, backend: str, width: int, height: int, *, draft: bool = False) -> None:
        """Make a renderer for pictures up to `width` x `height` px; with `backs` it draws sheets' backs too.

        Args:
            scene: what is drawn.
            backend: egl or osmesa.
            width: of the widest picture, px.
            height: of the highest picture, px.
            draft: draw without shadows and with one sample a pixel: several times as fast.

        Raises:
            RenderUnavailable: GL does not start.
        """
        self.name = backend
        self._scene = scene
        self._size = (width, height)
        scene.model.vis.global_.offwidth = width
        scene.model.vis.global_.offheight = height
        self._context: Any = None
        self._gl: Any = make_gl_context(backend, width, height)
        GlRenderer._current = weakref.ref(self)
        self._scn = mujoco.MjvScene(scene.model, maxgeom=3 * scene.model.ngeom + _SPARE_GEOMS)
        self._camera = mujoco.MjvCamera()
        self._camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
        self._options = scene.options
        self._scn.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = not draft
        self._context = _make_context(scene.model, draft)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._context)
        self._context.readDepthMap = mujoco.mjtDepthMap.mjDEPTH_ZEROFAR
        self._facets = Facets(self._context, scene.model.vis.quality.numquads)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._context)
        self.backs = False
        self.bends = False

    def light(
        self, side: int, lens: Intrinsics, supersample: int, camera_from_face: Array | None = None
    ) -> Light:
        """Linear light (H, W, 3) that falls on the left (0) or right (1) camera through `lens`, 0 to 1.

        Drawn `supersample` times as fine along each side and averaged, so that an edge lands
        where the projection says; in bands, so that memory does not grow with the picture.

        Args:
            side: the left (0) or right (1) camera.
            lens: the pinhole to draw through.
            supersample: samples along each side of a pixel.
            camera_from_face: how the pinhole is turned against the camera, (3, 3); the headlight is not.

        Raises:
            RenderMismatch: the frustum is not the lens's.
            RenderUnavailable: the picture is larger than this renderer was made for.
        """
        light = np.empty((lens.height, lens.width, 3), dtype=np.float32)
        rows = max(1, _BAND_PX // (lens.width * supersample**2))
        for top in range(0, lens.height, rows):
            # a band is a picture of its own, whose principal point lies further up
            band = replace(lens, height=min(rows, lens.height - top), cy=lens.cy - top)
            rect = self._aim(side, band.supersampled(supersample), camera_from_face)
            image = np.empty((rect.height, rect.width, 3), dtype=np.uint8)
            mujoco.mjr_render(rect, self._scn, self._context)
            mujoco.mjr_readPixels(image, None, rect, self._context)
            light[top : top + band.height] = box_average(image[::-1], supersample)
        light /= 255
        return light

    def depth_and_segmentation(self, side: int, lens: Intrinsics | None = None) -> tuple[Array, Ids]:
        """Depth (H, W) m and geom id (H, W) at the pixel centres of the placed rig's camera.

        Both in one pass: with ids for colours, anti-aliasing is off.

        Args:
            side: the left (0) or right (1) camera.
            lens: the pinhole to draw through, when it is not the rig's own.

        Raises:
            RenderMismatch: the frustum is not the lens's.
            RenderUnavailable: the picture is larger than this renderer was made for.
        """
        rect = self._aim(side, lens or self._scene.lens(side))
        flags = self._scn.flags
        flags[mujoco.mjtRndFlag.mjRND_SEGMENT] = 1
        flags[mujoco.mjtRndFlag.mjRND_IDCOLOR] = 1
        raw = np.empty((rect.height, rect.width), dtype=np.float32)
        color = np.empty((rect.height, rect.width, 3), dtype=np.uint8)
        mujoco.mjr_render(rect, self._scn, self._context)
        mujoco.mjr_readPixels(color, raw, rect, self._context)
        flags[mujoco.mjtRndFlag.mjRND_SEGMENT] = 0
        flags[mujoco.mjtRndFlag.mjRND_IDCOLOR] = 0
        segment = color[::-1].astype(np.int32) @ np.array([1, 256, 65536], dtype=np.int32)
        segmentation = self._geom_ids()[segment]
        depth = self._metric_depth(raw[::-1])
        depth[segmentation < 0] = np.nan
        return depth, segmentation

    def close(self) -> None:
        """Give the GL context back; another renderer that was drawing draws on."""
        if self._context is None:
            return
        drawing = GlRenderer._current() if GlRenderer._current is not None else None
        self._make_current()
        context, self._context = self._context, None
        self._facets.free()
        context.free()
        self._gl.free()
        GlRenderer._current = None
        if drawing is not None and drawing is not self and drawing._context is not None:
            drawing._make_current()

    def __del__(self) -> None:
        # freed in whatever context is current, its names would take another renderer's textures and lists
        with contextlib.suppress(Exception):
            self.close()

    def _make_current(self) -> None:
        if GlRenderer._current is None or GlRenderer._current() is not self:
            self._gl.make_current()
            GlRenderer._current = weakref.ref(self)

    def _aim(self, side: int, lens: Intrinsics, camera_from_face: Array | None = None) -> Any:
        """Make ready to draw one camera through `lens`; returns the rectangle to draw into."""
        if lens.width > self._size[0] or lens.height > self._size[1]:
            raise RenderUnavailable(
                f"picture {lens.width}x{lens.height} px: this renderer was made for "
                f"{self._size[0]}x{self._size[1]}"
            )
        self._make_current()
        self._scene.set_lens(side, lens)
        self._camera.fixedcamid = self._scene.camera_ids[side]
        with self._scene.turned(side, camera_from_face):
            self._lay_out()
        if camera_from_face is not None:
            self._hold_headlight(side)
        self._facets.apply(self._scn, geom_slices(self._scene))
        self._scn.flags[mujoco.mjtRndFlag.mjRND_FOG] = 0
        self._scn.flags[mujoco.mjtRndFlag.mjRND_CULL_FACE] = not self.backs
        check_frustum(lens, read_frustum(self._scn.camera[0], lens.width, lens.height))
        return mujoco.MjrRect(0, 0, lens.width, lens.height)

    def _lay_out(self) -> None:
        """Infinite planes and the headlight about the camera that the MjvScene holds: this one."""
        model, data, every = self._scene.model, self._scene.data, mujoco.mjtCatBit.mjCAT_ALL.value
        mujoco.mjv_updateCamera(model, data, self._camera, self._scn)
        mujoco.mjv_updateScene(model, data, self._options, None, self._camera, every, self._scn)

    def _hold_headlight(self, side: int) -> None:
        """Let the headlight shine along the camera's own axis, whichever way its pinhole is turned."""
        for light in self._scn.lights[: self._scn.nlight]:
            if light.headlight:
                light.dir[:] = self._scene.world_from_camera(side).R[:, 2]

    def _metric_depth(self, raw: Any) -> Array:
        """Undo the reversed-Z projection, whose matrix GL holds in single precision."""
        visual_map, extent = self._scene.model.vis.map, self._scene.model.stat.extent
        near, far = np.float32(visual_map.znear * extent), np.float32(visual_map.zfar * extent)
        scale = np.float32(0.5) * (far + near) / (far - near) - np.float32(0.5)
        shift = far * near / (far - near)
        with np.errstate(divide="ignore"):
            return np.asarray(np.float64(shift) / (raw.astype(np.float64) + np.float64(scale)))

    def _geom_ids(self) -> Ids:
        """Geom id for each segment colour; -1 for background and for what is no geom."""
        table = np.full(self._scn.ngeom + 1, -1, dtype=np.int32)
        for geom in self._scn.geoms[: self._scn.ngeom]:
            if geom.segid >= 0 and geom.objtype == mujoco.mjtObj.mjOBJ_GEOM:
                table[geom.segid + 1] = geom.objid
        return table


def _make_context(model: Any, draft: bool) -> Any:
    """Buffers, textures and shapes in the GL context that is current."""
    samples, shadow_px = model.vis.quality.offsamples, model.vis.quality.shadowsize
    if draft:
        model.vis.quality.offsamples = model.vis.quality.shadowsize = 0
    try:
        return mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
    finally:
        model.vis.quality.offsamples, model.vis.quality.shadowsize = samples, shadow_px


def geom_slices(scene: Scene) -> Ids:
    """With how many slices each curved geom is drawn for the placed rig, (ngeom,): alike in both pictures."""
    radius_px = [
        radii_px(scene.model, scene.data, scene.world_from_camera(side), scene.lens(side)) for side in (0, 1)
    ]
    return np.asarray(slices(np.maximum(*radius_px)), dtype=np.int32)


def buffer_size(lens: Intrinsics, supersample: int) -> tuple[int, int]:
    """Width and height of the buffer that pictures through `lens` need, px: a band, and the plain depth."""
    rows = max(1, _BAND_PX // (lens.width * supersample**2))
    return lens.width * supersample, max(min(rows, lens.height) * supersample, lens.height)


def check_size(lens: Intrinsics, supersample: int) -> None:
    """Refuse a picture that the software renderers cannot draw.

    Raises:
        RenderUnavailable: it is too large.
    """
    if max(lens.width, lens.height) * supersample > MAX_SIDE_PX:
        finer = f", drawn {supersample} times as fine," if supersample > 1 else ""
        raise RenderUnavailable(
            f"picture {lens.width}x{lens.height} px{finer} is beyond the renderer's limit of "
            f"{MAX_SIDE_PX} px a side: give a --resolution of at most {MAX_SIDE_PX // supersample} px a side"
        )


def read_frustum(gl_camera: Any, width: int, height: int) -> tuple[float, float, float, float]:
    """(fx, fy, cx, cy) px that the renderer will draw with, from its frustum."""
    near = float(gl_camera.frustum_near)
    tall = float(gl_camera.frustum_top) - float(gl_camera.frustum_bottom)
    half_wide = float(gl_camera.frustum_width) or width / height * tall / 2
    fx = near * width / (2 * half_wide)
    fy = near * height / tall
    cx = width / 2 - float(gl_camera.frustum_center) / near * fx - 0.5
    cy = float(gl_camera.frustum_top) / near * fy - 0.5
    return fx, fy, cx, cy


def check_frustum(lens: Intrinsics, drawn: tuple[float, float, float, float]) -> None:
    """Compare what is drawn with what was asked for, at the image's corners.

    Raises:
        RenderMismatch: they differ by more than 1e-3 px.
    """
    fx, fy, cx, cy = drawn
    u, v = np.array([-0.5, lens.width - 0.5]), np.array([-0.5, lens.height - 0.5])
    shift_u = (u - lens.cx) / lens.fx * fx + cx - u
    shift_v = (v - lens.cy) / lens.fy * fy + cy - v
    worst = float(max(np.abs(shift_u).max(), np.abs(shift_v).max()))
    if not worst <= _FRUSTUM_TOLERANCE_PX:
        raise RenderMismatch(
            f"the renderer draws f ({fx:.4f}, {fy:.4f}) c ({cx:.4f}, {cy:.4f}) px instead of "
            f"f ({lens.fx:.4f}, {lens.fy:.4f}) c ({lens.cx:.4f}, {lens.cy:.4f}): {worst:.2g} px apart, "
            f"must be <= {_FRUSTUM_TOLERANCE_PX:g}; use mujoco >= 3.6, or --renderer rays"
        )


def check_depth(
    scene: Scene, side: int, depth: Array, segmentation: Ids, lens: Intrinsics | None = None
) -> float:
    """Compare the rendered depth with rays at some pixels away from edges; returns the worst error, m.

    Boxes, planes and meshes are exact in both; curved primitives are drawn with facets, so they
    are only held to a share of their size.

    Args:
        scene: what was drawn.
        side: the left (0) or right (1) camera.
        depth: (H, W), m.
        segmentation: geom ids, (H, W).
        lens: what it was drawn through, when it is not the placed rig's own.

    Raises:
        RenderMismatch: they differ by more than that.
    """
    inner = segmentation[1:-1, 1:-1]
    calm = inner >= 0
    for dv, du in ((0, 1), (2, 1), (1, 0), (1, 2)):
        calm &= segmentation[dv : dv + inner.shape[0], du : du + inner.shape[1]] == inner
    v, u = np.nonzero(calm)
    if len(v) == 0:
        return 0.0
    # evenly spread and the same in every run
    chosen = np.linspace(0, len(v) - 1, min(_CHECKED_PIXELS, len(v))).astype(np.int64)
    v, u = v[chosen] + 1, u[chosen] + 1
    exact, geom = rays.depth_at(scene, side, np.column_stack([u, v]).astype(np.float64), lens)
    drawn, drawn_geom = depth[v, u], segmentation[v, u]
    # which of two geoms in the same place is seen is a matter of rounding: only the depth must agree
    error = np.abs(drawn - exact)
    allowed = np.maximum(_allowed(scene, geom, exact), _allowed(scene, drawn_geom, exact))
    wrong = ~(error <= allowed)
    if wrong.mean() > 0.02:
        excess = np.where(np.isnan(error), np.inf, error / allowed)
        worst = int(np.argmax(np.where(wrong, excess, 0)))
        raise RenderMismatch(
            f"rendered depth {drawn[worst]:.6g} m, rays say {exact[worst]:.6g} m at pixel "
            f"({u[worst]}, {v[worst]}) of the {('left', 'right')[side]} picture "
            f"({scene.object_name(int(drawn_geom[worst]))}); {wrong.mean():.0%} of {len(v)} pixels differ: "
            "use --renderer rays, or report the scene"
        )
    flat = np.isin(scene.model.geom_type[drawn_geom], _EXACT) & (geom == drawn_geom)
    return float(error[flat].max(initial=0.0))


def _allowed(scene: Scene, geom: Ids, exact: Array) -> Array:
    """How far drawn depth may lie off at points of geoms (N,), m."""
    kind = scene.model.geom_type[geom]
    facets = np.where(np.isin(kind, CURVED), geom_slices(scene)[geom], FINEST)
    flat = _FLAT_TOLERANCE_M * np.maximum(exact, 1.0)
    chord = _CURVED_TOLERANCE / facets * scene.model.geom_rbound[geom]
    return np.where(np.isin(kind, _EXACT), flat, np.maximum(chord, flat))
