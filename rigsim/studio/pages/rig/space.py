"""The scene in space: both cameras with what they see, and points with their error ellipsoids."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from html import escape
from typing import Any

import numpy as np
from nicegui import events, ui

from rigsim.present.live.colors import legend_html
from rigsim.present.live.space import REACH, CameraShape, depth_marks
from rigsim.rig.arrays import Array
from rigsim.studio.kit.latest import Latest
from rigsim.studio.kit.session import Session
from rigsim.studio.logic.numbers import RigNumbers
from rigsim.studio.logic.space import Space, cameras_of, space_of, told

_GROUND, _FLOOR = "#1b1f24", "#4a525c"
_LOOKS = ("#56b4e9", "#f28e4b")
_IDLE_FPS, _LIVELY_FPS = 4, 24
"""Pictures a second while nobody turns it, and while somebody does: without a graphics card each is work."""
_DOT, _WIDEST = 0.07, 6.0
_EXAGGERATED = 10
"""Times that ellipsoids are drawn larger at first: true ones are mostly too small to be seen."""
_HELP = "Drag to turn, scroll to come nearer; click a point for its numbers."
_SPARE = """
id => {
  const view = getElement(id);
  let seen = true;
  const look = entries => { seen = entries[entries.length - 1].isIntersecting; };
  new IntersectionObserver(look).observe(view.$el);
  for (const renderer of [view.renderer, view.text_renderer, view.text3d_renderer]) {
    const render = renderer.render.bind(renderer);
    renderer.render = (scene, camera) => { if (seen) render(scene, camera); };
  }
}
""".strip()
"""Draws nothing while the scene is scrolled out of sight."""


class SpaceView:
    """The objects of one scene; what has not changed is not sent again."""

    def __init__(self, picked: Callable[[int], None]) -> None:
        """Place an empty scene; `picked` is told the index of a point that is clicked."""
        self._picked = picked
        self._scene = ui.scene(
            grid=False,
            background_color=_GROUND,
            on_click=self._clicked,
            camera=ui.scene.perspective_camera(fov=50),
        )
        self._scene.props["fps"] = _IDLE_FPS
        for event, fps in (
            ("mouseenter", _LIVELY_FPS),
            ("touchstart", _LIVELY_FPS),
            ("mouseleave", _IDLE_FPS),
        ):
            self._scene.on(event, partial(self._hurry, fps), args=[])
        self._scene.on("init", js_handler=f"() => ({_SPARE})({self._scene.id})")
        self._scene.classes("rig-space").props('data-testid=space role=img aria-label="The scene in space"')
        self._scene.move_camera(7.0, -6.2, 5.6, 0.9, 5.2, 0.1, duration=0)
        self._cameras: list[tuple[Any, CameraShape] | None] = [None, None]
        self._dots: list[Any] = []
        self._balls: list[Any] = []
        self._floor: list[Any] = []
        self._floor_of = 0.0
        self._space: Space | None = None

    def _hurry(self, fps: int) -> None:
        self._scene.props["fps"] = fps

    def place_cameras(self, far_m: float, cameras: tuple[CameraShape, CameraShape]) -> None:
        """Put the cameras where they stand."""
        with self._scene:
            for place, shape in enumerate(cameras):
                held = self._cameras[place]
                if held is None or held[1].corners != shape.corners:
                    if held is not None:
                        held[0].delete()
                    held = (self._camera(shape, _LOOKS[place]), shape)
                    self._cameras[place] = held
                held[0].move(*shape.at)
                held[0].rotate_R([list(row) for row in shape.turn])
            if far_m != self._floor_of:
                self._lay_floor(far_m)

    def place_points(self, space: Space, exaggerated: float) -> None:
        """Put points and ellipsoids where they lie."""
        self._space = space
        shapes = space.shapes
        with self._scene:
            while len(self._dots) < len(shapes.at):
                name = f"point-{len(self._dots)}"
                self._balls.append(self._scene.sphere(1.0, 14, 8).with_name(name))
                self._dots.append(self._scene.sphere(_DOT, 8, 6).with_name(name))
        for place, (dot, ball) in enumerate(zip(self._dots, self._balls, strict=True)):
            there = place < len(shapes.at)
            dot.visible(there)
            ball.visible(there)
            if there:
                at, color = [round(float(value), 4) for value in shapes.at[place]], shapes.colors[place]
                dot.move(*at).material(color)
                ball.move(*at).material(color, 0.42)
                ball.rotate_R(np.round(shapes.turns[place], 5).tolist())
        self.exaggerate(exaggerated)

    def exaggerate(self, times: float) -> None:
        """Draw the ellipsoids so many times larger."""
        if self._space is None:
            return
        for ball, half_axes in zip(self._balls, self._space.shapes.half_axes, strict=False):
            ball.scale(*(round(float(np.clip(times * axis, 1e-3, _WIDEST)), 5) for axis in half_axes))

    def mark(self, index: int | None) -> None:
        """Show which point was picked."""
        for place, dot in enumerate(self._dots):
            dot.scale(2.2 if place == index else 1.0)

    def _clicked(self, event: events.SceneClickEventArguments) -> None:
        names = (hit.object_name for hit in event.hits)
        for name in names:
            if name and name.startswith("point-"):
                self._picked(int(name.removeprefix("point-")))
                return

    def _camera(self, shape: CameraShape, color: str) -> Any:
        with self._scene.group() as whole:
            self._scene.box(0.16, 0.12, 0.22).material(color)
            ends = [list(corner) for corner in shape.corners]
            for corner, after in zip(ends, ends[1:] + ends[:1], strict=True):
                self._scene.line([0.0, 0.0, 0.0], corner).material(color, 0.85)
                self._scene.line(corner, after).material(color, 0.85)
        return whole

    def _lay_floor(self, far_m: float) -> None:
        for thing in self._floor:
            thing.delete()
        self._floor_of = far_m
        half = 0.45 * REACH
        style = "color:#aab3bf;font-size:11px"
        self._floor = [self._scene.line([0, 0, 0], [0, REACH, 0]).material(_FLOOR)]
        for ahead, words in depth_marks(far_m):
            self._floor.append(self._scene.line([-half, ahead, 0], [half, ahead, 0]).material(_FLOOR, 0.7))
            self._floor.append(self._scene.text(words, style).move(half + 0.4, ahead, 0))


def space(session: Session, numbers: Latest[RigNumbers]) -> Callable[[Array | None], None]:
    """Place the scene; the function takes the points that were seen in the pictures."""
    with ui.element("section").classes("rig-panel w-full").props('aria-label="In space"'):
        with ui.element("div").classes("rig-titled"):
            ui.html("<h2>In space</h2>", sanitize=False)
            legend = ui.html("", sanitize=False)
        view = SpaceView(lambda index: pick(index))
        with ui.element("div").classes("rig-exaggerate"):
            said = ui.label(_says(_EXAGGERATED))
            slider = ui.slider(min=0, max=2, step=0.05, value=np.log10(_EXAGGERATED)).props("dense")
            slider.props('aria-label="Error ellipsoids, times as large"')
        ui.label(_HELP).classes("rig-soft")
        picked = (
            ui.html("", sanitize=False).props('data-testid=picked aria-live="polite"').classes("rig-scroll")
        )
    held: dict[str, Any] = {"points": None, "space": None}

    def times() -> float:
        return float(10 ** float(slider.value or 0.0))

    def enlarge() -> None:
        said.set_text(_says(times()))
        view.exaggerate(times())

    def pick(index: int) -> None:
        seen: Space | None = held["space"]
        if seen is not None and index < len(seen.cloud.points_left):
            view.mark(index)
            picked.set_content(_told(seen, index))

    def turn() -> None:
        cameras = cameras_of(numbers())
        if cameras is not None:
            view.place_cameras(*cameras)

    def rest() -> None:
        seen = space_of(numbers(), held["points"])
        held["space"] = seen
        picked.set_content("")
        view.mark(None)
        if seen is not None:
            view.place_points(seen, times())
            legend.set_content(legend_html(seen.shapes.scale, "std of the depth", "mm"))

    def take(points_left: Array | None) -> None:
        held["points"] = points_left
        rest()

    slider.on_value_change(enlarge)
    session.watch(turn)
    session.when_resting(rest)
    rest()
    return take


def _says(times: float) -> str:
    return f"Error ellipsoids (1 std), {times:.2g} ×"


def _told(seen: Space, index: int) -> str:
    cells = "".join(
        f"<div class='rig-number small'><span class=name>{escape(name)}</span>"
        f"<span class=value>{escape(value)}<span class=unit>{escape(unit)}</span></span></div>"
        for name, (value, unit) in told(seen.cloud, index).items()
    )
    return f"<div class='rig-numbers rig-picked'>{cells}</div>"
