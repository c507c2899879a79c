"""For other people's tests: test a triangulator of theirs on cases with known answers.

::

    from rigsim.testing import assert_triangulates

    def test_my_triangulation():
        assert_triangulates(my_triangulate)

The function is called as ``my_triangulate(rig, uv_left, uv_right)`` and returns (N, 3) metres in the left
camera's frame; `rigsim.StereoRig` says what a rig is. With pytest the fixtures ``stereo_case``,
``stereo_cases`` and ``rendered_stereo`` are there as well; see docs/howto/testing.md.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypedDict, Unpack

if TYPE_CHECKING:
    import numpy.typing as npt

    from rigsim.rig.arrays import Array
    from rigsim.rig.stereo import StereoRig
    from rigsim.study.verify.case import Case

__all__ = ["RenderedStereo", "assert_matches_golden", "assert_triangulates", "render_stereo", "stereo_cases"]

UPDATE_GOLDEN = "RIGSIM_UPDATE_GOLDEN"
"""Environment variable: when it is set and not 0, `assert_matches_golden` writes instead of comparing."""


class CaseChoice(TypedDict, total=False):
    """Which cases a function is held to; see `stereo_cases`."""

    suite: str
    only: Sequence[str]
    rig: StereoRig | None
    scenes: Sequence[str]
    seed: int


def assert_triangulates(
    function: str | Callable[..., Any],
    cases: Sequence[Case] | Case | None = None,
    *,
    strict: bool = False,
    **choice: Unpack[CaseChoice],
) -> None:
    """Fail with a table of what is wrong unless `function` triangulates every case.

    Args:
        function: ``(rig, uv_left (N, 2) px, uv_right (N, 2) px) -> points_left (N, 3) m``, or the name of
            a known one, as ``optimal``.
        cases: cases to hold it to; None for those that `choice` chooses.
        strict: whether errors larger than least squares leaves are failures too.
        choice: `suite`, `only`, `rig`, `scenes` and `seed`, as `stereo_cases` takes them.

    Raises:
        AssertionError: a case failed.
        RigsimError: an argument cannot be: unknown suite, scene or name.
    """
    __tracebackhide__ = True  # pytest then shows the caller's line, not this one
    from rigsim.present.verify.failure import failure_text
    from rigsim.study.triangulators.registry import named
    from rigsim.study.verify.case import Case
    from rigsim.study.verify.runner import verify

    if cases is None:
        cases = stereo_cases(**choice)
    chosen = [cases] if isinstance(cases, Case) else list(cases)
    if not chosen:
        raise ValueError("no cases: give at least one")
    label = function if isinstance(function, str) else getattr(function, "__qualname__", repr(function))
    (result,) = verify(chosen, {label: named(function)})
    if not result.passed(strict):
        raise AssertionError(failure_text(result, strict))


def assert_matches_golden(
    result: object,
    path: str | os.PathLike[str],
    *,
    keys: str | Sequence[str] = (),
    tolerance: float = 0.0,
    update: bool | None = None,
) -> None:
    """Fail with what moved and by how much unless an answer is what it was when its golden file was written.

    Args:
        result: what `rigsim.sweep`, `rigsim.design` or `rigsim.tolerance` returned; the document of a
            command, as ``json.loads`` reads what ``rigsim calc depth --json`` prints; or a table, pandas or a
            list of mappings, with units in its columns' names, and standard errors, where it has any, in
            ``NAME_se``.
        path: the golden file, ``NAME.csv``, or a folder that holds one for each command.
        keys: of a table, the columns that say what a row is about; rows are compared by place without any.
        tolerance: what every number may differ by in any case, relative to its golden value.
        update: whether the file is written anew instead; by default where the environment variable
            ``RIGSIM_UPDATE_GOLDEN`` is set.

    Raises:
        AssertionError: a number moved beyond its noise, or is gone.
        RigsimError: there is no golden file, it cannot be read, or it is another command's.
    """
    __tracebackhide__ = True
    from rigsim.api.kit.golden import hold, record_from
    from rigsim.errors import InvalidRange, OutputError
    from rigsim.present.verify.golden import golden_text

    if update is None:
        update = os.environ.get(UPDATE_GOLDEN, "0") not in ("", "0")
    try:
        report = hold(record_from(result, keys), path, update, tolerance)
    except (InvalidRange, OutputError) as error:
        raise type(error)(str(error)) from None  # the message alone, not the way to it
    if not report.passed:
        raise AssertionError(golden_text(report))


def stereo_cases(
    *,
    suite: str = "quick",
    only: Sequence[str] = (),
    rig: StereoRig | None = None,
    scenes: Sequence[str] = (),
    seed: int = 0,
) -> list[Case]:
    """The cases of a suite.

    Args:
        suite: quick or full.
        only: names of cases or groups, with ``*``: ``["rectified", "doffs"]`` for a function that is made
            for rectified rigs alone.
        rig: a rig to try beside the built-in ones.
        scenes: names of bundled scenes or MJCF files to take cases from; these are rendered.
        seed: seed of the points and the noise.

    Raises:
        RigsimError: unknown suite or scene, or a name that no case has.
    """
    from rigsim.study.verify.session import Selection, gather

    return list(gather(Selection(suite, seed, tuple(only), tuple(scenes), rig)).cases)


@dataclass(frozen=True, slots=True, eq=False)
class RenderedStereo:
    """A pair of pictures and all that is true of it."""

    rig: StereoRig
    """The rig that took them."""
    left: npt.NDArray[Any]
    """Left picture, grey, (H, W)."""
    right: npt.NDArray[Any]
    """Right picture, grey, (H, W)."""
    depth_left: Array
    """True depth of each left pixel, (H, W), m; NaN for nothing."""
    disparity: Array
    """True ``u_left - u_right`` of each left pixel, (H, W), px; NaN where the right camera sees it not."""
    points_left: Array
    """True points that both cameras see, (N, 3), m."""
    uv_left: Array
    """Their exact pixels in the left picture, (N, 2)."""
    uv_right: Array
    """Their exact pixels in the right picture, (N, 2)."""


def render_stereo(
    scene: str = "boards",
    rig: StereoRig | None = None,
    *,
    blur_px: float = 0.7,
    grey_noise: float = 0.0,
    points: int = 500,
    seed: int = 0,
) -> RenderedStereo:
    """Draw a scene with a rig and say what is true of the pictures.

    Args:
        scene: name of a bundled scene or path of an MJCF file.
        rig: the rig; None for the one that the scene is made for.
        blur_px: standard deviation of the lens's blur, px.
        grey_noise: standard deviation of the noise, grey levels.
        points: how many truth points to draw; those that a camera does not see are left out.
        seed: seed of the points and the noise.

    Raises:
        InvalidScene: no such scene.
        RenderUnavailable: nothing here can draw pictures.
    """
    from rigsim.rig.sensor import Sensor
    from rigsim.sim.simulator import SUPERSAMPLE, Simulator
    from rigsim.study.scene.pictures import expose_pair
    from rigsim.study.verify.rendered import scene_rig
    from rigsim.study.verify.suite import stream

    sensor = Sensor(blur_px=blur_px, grey_noise=grey_noise)
    with Simulator(scene) as simulator:
        own = rig or scene_rig(simulator.scene.name)
        simulator.place(own)
        exposure = expose_pair(simulator, own, sensor, SUPERSAMPLE)
        pictures = exposure.pictures(sensor, stream(seed, "picture"))
        truth = simulator.truth(points, stream(seed, "truth"))
        points_left = truth.points_left[truth.visible]
        uv_left, uv_right = own.project(points_left)
        return RenderedStereo(
            rig=own,
            left=pictures.left,
            right=pictures.right,
            depth_left=exposure.frame.left.depth,
            disparity=simulator.true_disparity(exposure.frame),
            points_left=points_left,
            uv_left=uv_left,
            uv_right=uv_right,
        )
