"""The renderer's process: only the newest request survives, and a crash is said."""

from __future__ import annotations

import asyncio
import io
import itertools
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from PIL import Image

from rigsim import BrownConrady, Intrinsics, RigsimError, StereoRig
from rigsim.studio.draw.process import RenderProcess
from rigsim.studio.draw.request import Failed, Pair, PairRequest
from rigsim.studio.draw.worker import Painter
from tests.helpers.processes import is_alive, wait_for_end
from tests.helpers.scenes import SLANTED, write

NUMBERS = itertools.count()
RIG = StereoRig.rectified(Intrinsics.from_focal(640, 360, 450.0), 0.12)


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> str:
    return write(tmp_path_factory.mktemp("scene"), SLANTED)


@pytest.fixture(scope="module")
def renderer() -> Iterator[RenderProcess]:
    shared = RenderProcess()
    yield shared
    shared.close()


@pytest.fixture
def painter() -> Iterator[Painter]:
    opened = Painter()
    yield opened
    opened.close()


def size_of(picture: bytes) -> tuple[int, int]:
    with Image.open(io.BytesIO(picture)) as image:
        image.load()
        return image.size


def colours(picture: bytes) -> np.ndarray:
    with Image.open(io.BytesIO(picture)) as image:
        return np.asarray(image.convert("RGB"), dtype=np.float64)


async def until(holds: Callable[[], bool]) -> None:
    while not holds():
        await asyncio.sleep(0.01)


def coarse(scene: str, **more: Any) -> PairRequest:
    return PairRequest(RIG, scene, coarse=True, **more)


def slow(scene: str) -> PairRequest:
    """One that takes a second, and is never the last one drawn."""
    return PairRequest(RIG, scene, size=(1280, 720), noise_px=0.1 + next(NUMBERS) / 1000)


def full(scene: str) -> PairRequest:
    return PairRequest(RIG, scene)


def test_a_pair_comes_with_what_is_known_of_its_pixels(renderer: RenderProcess, scene: str) -> None:
    async def main() -> None:
        quick = await renderer.draw("tab", coarse(scene))
        whole = await renderer.draw("tab", full(scene))
        assert isinstance(quick, Pair)
        assert isinstance(whole, Pair)
        assert (quick.width, quick.height, quick.coarse) == (320, 180, True)
        assert (whole.width, whole.height, whole.coarse) == (640, 360, False)
        for pair in (quick, whole):
            assert size_of(pair.left) == size_of(pair.right) == (pair.width, pair.height)
            for array in (pair.depth_m, pair.disparity_px, pair.depth_std_m):
                assert (array.shape, array.dtype) == ((pair.height, pair.width), np.float32)
            seen = np.isfinite(pair.disparity_px)
            np.testing.assert_allclose(pair.disparity_px[seen], 450 * 0.12 / pair.depth_m[seen], rtol=1e-4)
            assert pair.seconds > 0
            assert (pair.overlay_image, pair.legend) == (None, None)

    asyncio.run(main())


def test_left_and_right_are_not_swapped(painter: Painter, scene: str) -> None:
    pair = painter.answer(coarse(scene))
    assert isinstance(pair, Pair)
    near = pair.depth_m < 2.2  # the post, which is blue
    assert pair.disparity_px[near].min() > 1.3 * np.nanmedian(pair.disparity_px[pair.depth_m > 3])
    columns = []
    for picture in (pair.left, pair.right):
        red, _, blue = np.moveaxis(colours(picture), -1, 0)
        columns.append(np.nonzero(blue > 1.5 * red)[1].mean())
    drawn_px = np.nanmedian(pair.disparity_px[near]) * pair.width / 640
    assert columns[0] - columns[1] == pytest.approx(drawn_px, abs=1.0)


def test_only_the_newest_request_of_a_key_survives(renderer: RenderProcess, scene: str) -> None:
    async def main() -> None:
        busy = asyncio.ensure_future(renderer.draw("z", slow(scene)))
        await until(lambda: renderer.drawing == "z")
        asked = [coarse(scene, noise_px=0.1 * i) for i in range(1, 8)]
        answers = await asyncio.gather(*(renderer.draw("tab", request) for request in asked))
        assert isinstance(await busy, Pair)
        assert answers[:-1] == [None] * 6
        newest = answers[-1]
        assert isinstance(newest, Pair)
        seen = np.isfinite(newest.depth_std_m)
        # Z^2 / (f B) times sqrt(2) times the newest noise
        expected = newest.depth_m[seen] ** 2 / (450 * 0.12) * 0.7 * np.sqrt(2)
        np.testing.assert_allclose(newest.depth_std_m[seen], expected, rtol=1e-4)

    asyncio.run(main())


def test_keys_take_turns_and_coarse_goes_before_full(renderer: RenderProcess, scene: str) -> None:
    async def main() -> None:
        order: list[str] = []

        async def draw(name: str, key: str, request: PairRequest) -> None:
            if await renderer.draw(key, request) is not None:
                order.append(name)

        for key in ("a", "b", "c", "a"):
            await draw("", key, coarse(scene))
        order.clear()
        busy = asyncio.ensure_future(draw("z", "z", slow(scene)))
        await until(lambda: renderer.drawing == "z")
        asked = (("d", full(scene)), ("a", coarse(scene)), ("c", coarse(scene)), ("b", coarse(scene)))
        await asyncio.gather(busy, *(draw(key, key, request) for key, request in asked))
        assert order == ["z", "b", "c", "a", "d"]

    asyncio.run(main())


def test_a_full_picture_that_nobody_wants_any_more_gives_way(renderer: RenderProcess, scene: str) -> None:
    async def main() -> None:
        large = asyncio.ensure_future(renderer.draw("tab", slow(scene)))
        await until(lambda: renderer.drawing == "tab")
        quick = await renderer.draw("tab", coarse(scene))
        assert isinstance(quick, Pair)
        assert quick.coarse
        assert large.done()
        assert await large is None

    asyncio.run(main())


def test_a_killed_renderer_is_said_and_the_next_picture_comes(renderer: RenderProcess, scene: str) -> None:
    async def main() -> None:
        assert isinstance(await renderer.draw("a", coarse(scene)), Pair)
        killed = renderer.pid
        assert killed is not None
        one = asyncio.ensure_future(renderer.draw("a", slow(scene)))
        await until(lambda: renderer.drawing == "a")
        other = asyncio.ensure_future(renderer.draw("b", coarse(scene)))
        await until(lambda: renderer.waiting == ("b",))
        os.kill(killed, signal.SIGKILL)
        for failed in await asyncio.gather(one, other):
            assert isinstance(failed, Failed)
            assert failed.text == (
                "The renderer stopped (killed by signal 9); it has been started again: "
                "move a control to draw anew."
            )
        assert isinstance(await renderer.draw("a", coarse(scene)), Pair)
        assert renderer.pid not in (None, killed)
        wait_for_end(killed)

    asyncio.run(main())


def test_a_renderer_that_takes_too_long_is_given_up(scene: str) -> None:
    async def main() -> None:
        hasty = RenderProcess(longest_s=0.05)
        try:
            failed = await hasty.draw("tab", coarse(scene))
        finally:
            hasty.close()
        assert isinstance(failed, Failed)
        assert "gave no picture within 0.05 s" in failed.text

    asyncio.run(main())


def test_released_keys_free_the_process(scene: str) -> None:
    async def main() -> None:
        renderer = RenderProcess(freed_after_s=0.3)
        try:
            assert renderer.pid is None
            for key in ("a", "b"):
                assert isinstance(await renderer.draw(key, coarse(scene)), Pair)
            pid = renderer.pid
            assert pid is not None
            renderer.release("a")
            await asyncio.sleep(0.5)
            assert renderer.pid == pid  # b holds it
            renderer.release("b")
            await until(lambda: renderer.pid is None)
            wait_for_end(pid)
        finally:
            renderer.close()
        assert renderer.pid is None
        assert await renderer.draw("b", coarse(scene)) is None

    asyncio.run(main())


def test_release_and_close_let_calls_return(renderer: RenderProcess, scene: str) -> None:
    async def main() -> None:
        busy = asyncio.ensure_future(renderer.draw("a", slow(scene)))
        await until(lambda: renderer.drawing == "a")
        waiting = asyncio.ensure_future(renderer.draw("b", coarse(scene)))
        await until(lambda: renderer.waiting == ("b",))
        renderer.release("b")
        assert await waiting is None
        assert isinstance(await busy, Pair)

        other = RenderProcess()
        begun = asyncio.ensure_future(other.draw("a", coarse(scene)))
        await until(lambda: other.pid is not None)
        pid = other.pid
        assert pid is not None
        other.close()
        assert await begun is None
        wait_for_end(pid)

    asyncio.run(main())


PARENT = """
import asyncio, sys
from rigsim import Intrinsics, StereoRig
from rigsim.studio.draw.process import RenderProcess
from rigsim.studio.draw.request import PairRequest


async def main():
    renderer = RenderProcess()
    rig = StereoRig.rectified(Intrinsics.from_focal(64, 36, 45.0), 0.12)
    await renderer.draw("tab", PairRequest(rig, sys.argv[1], coarse=True))
    print(renderer.pid, flush=True)
    try:
        await asyncio.sleep(600)
    finally:
        renderer.close()


if __name__ == "__main__":
    try:
        asyncio.run(main())
    except KeyboardInterrupt:
        print("interrupted")
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_the_process_ends_with_its_parent_and_says_nothing(tmp_path: Any, scene: str, number: int) -> None:
    script = tmp_path / "parent.py"
    script.write_text(PARENT)
    with subprocess.Popen(
        [sys.executable, str(script), scene],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
        text=True,
    ) as parent:
        assert parent.stdout is not None
        assert parent.stderr is not None
        pid = int(parent.stdout.readline())
        assert is_alive(pid)
        if number == signal.SIGINT:
            os.killpg(parent.pid, number)  # as Ctrl-C does
        else:
            parent.kill()
        said, complained = parent.communicate()
    assert complained == ""
    assert said == ("interrupted\n" if number == signal.SIGINT else "")
    wait_for_end(pid)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"scene": "nowhere"}, "unknown scene 'nowhere': no such file, and the bundled scenes are"),
        ({"noise_px": -1.0}, "-1"),
        ({"size": (0, 100)}, "resolution 0x100: both sides must be >= 1 px"),
        ({"size": (20_000, 100)}, "20000x100"),
    ],
)
def test_what_cannot_be_drawn_is_one_line(
    painter: Painter, scene: str, change: dict[str, Any], words: str
) -> None:
    failed = painter.answer(replace(coarse(scene), **change))
    assert isinstance(failed, Failed)
    assert words in failed.text
    assert "\n" not in failed.text
    assert isinstance(painter.answer(coarse(scene)), Pair)


def test_a_fault_of_ours_is_one_line_for_the_page_and_whole_in_the_terminal(
    painter: Painter, scene: str, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def broken(*_: Any) -> None:
        raise ZeroDivisionError("no such thing")

    monkeypatch.setattr("rigsim.study.glance.glance", broken)
    assert painter.answer(coarse(scene)) == Failed(
        "this picture cannot be drawn: ZeroDivisionError: no such thing"
    )
    assert "Traceback" in capfd.readouterr().err


def test_a_bent_rig_is_drawn(painter: Painter, scene: str) -> None:
    lens = replace(RIG.left, lens=BrownConrady(-0.2, 0.05))
    bent = StereoRig.rectified(lens, 0.12)
    for request in (PairRequest(bent, scene, coarse=True), PairRequest(bent, scene)):
        pair = painter.answer(request)
        straight = painter.answer(replace(request, rig=RIG))
        assert isinstance(pair, Pair)
        assert isinstance(straight, Pair)
        # a barrel shows more at its edges, and the same in the middle
        apart = np.abs(pair.depth_m / straight.depth_m - 1)
        row, column = pair.height // 2, pair.width // 2
        assert apart[row, :5].min() > 20 * apart[row, column - 2 : column + 2].max()
        assert np.isfinite(pair.disparity_px).mean() > 0.7


@pytest.mark.parametrize(("overlay", "unit"), [("anaglyph", None), ("disparity", "px"), ("error", "mm")])
def test_overlays_have_the_pictures_size_and_say_their_scale(
    painter: Painter, scene: str, overlay: Any, unit: str | None
) -> None:
    pair = painter.answer(coarse(scene, overlay=overlay))
    assert isinstance(pair, Pair)
    assert pair.overlay_image is not None
    assert size_of(pair.overlay_image) == (pair.width, pair.height)
    picture = colours(pair.overlay_image)
    if unit is None:
        assert pair.legend is None
        left, right = (colours(part) @ (0.299, 0.587, 0.114) for part in (pair.left, pair.right))
        assert np.abs(picture[..., 0] - left).mean() < 0.5 * np.abs(picture[..., 0] - right).mean()
        for channel in (1, 2):
            assert (
                np.abs(picture[..., channel] - right).mean()
                < 0.5 * np.abs(picture[..., channel] - left).mean()
            )
        return
    assert pair.legend is not None
    assert pair.legend.unit == unit
    assert pair.legend.low < pair.legend.high
    values = pair.disparity_px if unit == "px" else 1e3 * pair.depth_std_m
    inside = np.isfinite(values)
    low, high = np.nanquantile(values, [0.0, 1.0])
    assert low <= pair.legend.low < pair.legend.high <= high
    # larger is brighter, and what is unknown is grey
    bright = picture.sum(axis=-1)
    assert np.corrcoef(bright[inside], values[inside])[0, 1] > 0.9
    assert (picture[~inside] == 60).all()


def test_a_smaller_picture_than_the_rigs_is_said(painter: Painter, scene: str) -> None:
    large = StereoRig.rectified(Intrinsics.from_focal(4056, 400, 3000.0), 0.1)
    pair = painter.answer(PairRequest(large, scene))
    assert isinstance(pair, Pair)
    said = f"drawn at {pair.width}x{pair.height} of the rig's 4056x400 px, to be quick"
    assert pair.width < 4056
    assert pair.remarks == (said,)
    for quiet in (PairRequest(large, scene, coarse=True), PairRequest(large, scene, size=(64, 36))):
        small = painter.answer(quiet)
        assert isinstance(small, Pair)
        assert small.remarks == ()


def test_another_overlay_costs_no_new_pictures(
    painter: Painter, scene: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    plain = painter.answer(coarse(scene))
    assert isinstance(plain, Pair)

    def drawn(*_: Any) -> None:
        raise RigsimError("drawn")

    monkeypatch.setattr("rigsim.study.glance.glance", drawn)
    overlaid = painter.answer(coarse(scene, overlay="disparity"))
    assert isinstance(overlaid, Pair)
    assert overlaid.overlay_image is not None
    assert overlaid.left == plain.left
    for other in (coarse(scene, noise_px=0.5), full(scene), coarse(scene, built=RIG)):
        assert painter.answer(other) == Failed("drawn")


def test_the_last_two_scenes_stay_open(painter: Painter, scene: str, tmp_path: Any) -> None:
    other = write(tmp_path, SLANTED, "other.xml")
    third = write(tmp_path, SLANTED, "third.xml")
    for path in (scene, other, scene, third):
        assert isinstance(painter.answer(coarse(path)), Pair)
    assert painter.scenes == (scene, third)


def test_a_cancelled_call_leaves_the_queue(renderer: RenderProcess, scene: str) -> None:
    async def main() -> None:
        busy = asyncio.ensure_future(renderer.draw("a", slow(scene)))
        await until(lambda: renderer.drawing == "a")
        left = asyncio.ensure_future(renderer.draw("b", full(scene)))
        await until(lambda: renderer.waiting == ("b",))
        left.cancel()
        with pytest.raises(asyncio.CancelledError):
            await left
        assert "b" not in renderer.waiting
        assert isinstance(await busy, Pair)

    asyncio.run(main())
