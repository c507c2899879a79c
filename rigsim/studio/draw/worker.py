"""The process that draws: one request after the other, with the last scenes kept open."""

from __future__ import annotations

import time
import traceback
from collections import OrderedDict
from dataclasses import replace
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING

from rigsim.errors import RigsimError
from rigsim.studio.draw.child import begin, receive, send
from rigsim.studio.draw.request import Failed, Legend, Pair, PairRequest

if TYPE_CHECKING:
    from rigsim.sim.simulator import Simulator
    from rigsim.study.glance import Glance

STOP = "stop"
"""Says that nobody waits for the picture being drawn any more; no answer is `None`."""

_SCENES = 2


class _Unwanted(Exception):
    """Nobody waits for this picture any more."""


def main(connection: Connection) -> None:
    """Answer requests until the other end closes."""
    begin()
    painter = Painter(connection)
    while True:
        try:
            message = receive(connection)
            if isinstance(message, PairRequest):
                send(connection, painter.answer(message))
        except (EOFError, OSError):
            return


class Painter:
    """Draws pairs, and keeps the scenes it drew last."""

    def __init__(self, connection: Connection | None = None) -> None:
        """Begin without a scene.

        Args:
            connection: where a message means that nobody waits for the picture being drawn.
        """
        self._open: OrderedDict[str, Simulator] = OrderedDict()
        self._last: dict[bool, tuple[PairRequest, Glance]] = {}  # the last coarse and the last full one
        self._connection = connection

    @property
    def scenes(self) -> tuple[str, ...]:
        """The scenes that are open, the last one drawn last."""
        return tuple(self._open)

    def answer(self, request: PairRequest) -> Pair | Failed | None:
        """The pair, or why there is none; None where it was stopped."""
        try:
            return self._pair(request)
        except _Unwanted:
            return None
        except RigsimError as error:
            return Failed(" ".join(str(error).split()))
        except Exception as error:  # the page goes on, and the terminal says what is wrong
            traceback.print_exc()
            return Failed(f"this picture cannot be drawn: {type(error).__name__}: {error}")

    def close(self) -> None:
        """Close all scenes."""
        while self._open:
            self._open.popitem()[1].close()

    def _pair(self, request: PairRequest) -> Pair:
        from rigsim.present.kit.pictures import encode

        begun = time.perf_counter()
        seen = self._seen(request)
        image, legend = _overlay(request, seen)
        height, width = seen.depth_m.shape
        return Pair(
            left=encode(seen.left, "jpeg"),
            right=encode(seen.right, "jpeg"),
            width=width,
            height=height,
            coarse=request.coarse,
            overlay_image=image,
            legend=legend,
            depth_m=seen.depth_m,
            disparity_px=seen.disparity_px,
            depth_std_m=seen.depth_std_m,
            seconds=time.perf_counter() - begun,
            remarks=(*_smaller(request, width, height), *(remark.text for remark in seen.remarks)),
        )

    def _seen(self, request: PairRequest) -> Glance:
        """What the pair shows; another overlay on the last one costs no new pictures."""
        from rigsim.study.glance import Glimpse, glance

        plain = replace(request, overlay="none")
        last = self._last.get(request.coarse)
        if last is None or last[0] != plain:
            simulator = self._simulator(request.scene)
            asked = Glimpse(request.rig, request.size, request.coarse, request.noise_px, request.built)
            last = self._last[request.coarse] = (plain, glance(simulator, asked, self._may_stop))
        return last[1]

    def _simulator(self, scene: str) -> Simulator:
        from rigsim.sim.simulator import Simulator

        if scene not in self._open:
            opened = Simulator(scene)
            while len(self._open) >= _SCENES:
                self._open.popitem(last=False)[1].close()
            self._open[scene] = opened
        self._open.move_to_end(scene)
        return self._open[scene]

    def _may_stop(self) -> None:
        if self._connection is not None and self._connection.poll():
            raise _Unwanted


def _smaller(request: PairRequest, width: int, height: int) -> tuple[str, ...]:
    """That the picture is smaller than the rig's own, where nobody asked for that."""
    own = (request.rig.left.width, request.rig.left.height)
    if request.size is not None or request.coarse or (width, height) == own:
        return ()
    return (f"drawn at {width}x{height} of the rig's {own[0]}x{own[1]} px, to be quick",)


def _overlay(request: PairRequest, seen: Glance) -> tuple[bytes | None, Legend | None]:
    """The picture that is laid over the left one, and what its colours mean."""
    from rigsim.present.kit import pictures

    if request.overlay == "anaglyph":
        return pictures.encode(pictures.anaglyph(seen.left, seen.right), "jpeg"), None
    if request.overlay == "disparity":
        limits = pictures.picture_limits(seen.disparity_px)
        picture = pictures.disparity_picture(seen.disparity_px, limits)
        return pictures.encode(picture), Legend(*limits, "px", "disparity")
    if request.overlay == "error":
        std_mm = seen.depth_std_m * 1e3
        limits = pictures.picture_limits(std_mm)
        picture = pictures.error_picture(std_mm, limits)
        return pictures.encode(picture), Legend(*limits, "mm", "expected standard deviation of the depth")
    return None, None
