"""A whole verification: its cases gathered, its triangulators run, and what made it noted."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from rigsim.errors import InvalidRange, InvalidScene, RigsimError
from rigsim.rig.stereo import StereoRig
from rigsim.study.golden.compare import Record
from rigsim.study.scene.provenance import versions
from rigsim.study.verify.case import Case
from rigsim.study.verify.golden import rig_words, scene_record, triangulator_record
from rigsim.study.verify.rendered import scene_rig
from rigsim.study.verify.result import CaseResult, VerifyResult
from rigsim.study.verify.runner import verify
from rigsim.study.verify.suite import scene_cases, selected, synthetic_cases
from rigsim.theory.custom import TriangulatorFunction

_OF_A_SCENE = ("exact", "noisy", "corners", "patches")


@dataclass(frozen=True, slots=True)
class Selection:
    """Which cases are asked for."""

    suite: str = "quick"
    """quick or full."""
    seed: int = 0
    """Seed of every random stream."""
    patterns: tuple[str, ...] = ()
    """Names of cases or groups, with ``*`` and ``?``; all when empty."""
    scenes: tuple[str, ...] | None = None
    """Scenes by name or path; None for all bundled ones."""
    rig: StereoRig | None = None
    """A rig to add, and to take in every scene."""


@dataclass(frozen=True, slots=True)
class Gathered:
    """The cases, and what could not be made."""

    cases: tuple[Case, ...]
    """At least one."""
    left_out: tuple[str, ...]
    """A sentence each."""


def gather(selection: Selection, on_scene: Callable[[int], None] = lambda _: None) -> Gathered:
    """Make the cases that are asked for; only scenes with a case among them are opened.

    Args:
        selection: which cases.
        on_scene: is told how many scenes are done.

    Raises:
        InvalidRange: unknown suite, negative seed, or a pattern that matches no case.
        InvalidScene: no such scene.
    """
    from rigsim.sim.scenes import library

    patterns = selection.patterns
    scenes = library.names() if selection.scenes is None else selection.scenes
    names = {scene: _scene_name(library.find(scene)) for scene in scenes}
    of_scenes = [(f"{name} {what}", name) for name in names.values() for what in _OF_A_SCENE]
    synthetic = tuple(synthetic_cases(selection.suite, selection.seed, selection.rig))
    possible = [*((case.name, case.group) for case in synthetic), *of_scenes]
    for pattern in patterns:
        if not any(selected(*one, [pattern]) for one in possible):
            groups = ", ".join(dict.fromkeys(group for _, group in possible))
            raise InvalidRange(f"cases {pattern!r}: matches none; the groups are {groups}")
    cases = [case for case in synthetic if selected(case.name, case.group, patterns)]
    left_out: list[str] = []
    for done, (scene, name) in enumerate(names.items(), start=1):
        if any(selected(f"{name} {what}", name, patterns) for what in _OF_A_SCENE):
            cases += _of_scene(selection, scene, name, left_out)
        on_scene(done)
    left_out += [
        f"cases {pattern!r}: the scene has none of that kind in this suite"
        for pattern in patterns
        if not any(selected(case.name, case.group, [pattern]) for case in cases)
    ]
    if not cases:
        raise InvalidRange(f"no case could be made; {'; '.join(left_out)}")
    return Gathered(tuple(cases), tuple(left_out))


def run(
    gathered: Gathered,
    triangulators: Mapping[str, TriangulatorFunction],
    selection: Selection,
    on_result: Callable[[CaseResult], None] = lambda _: None,
    command: str = "",
) -> VerifyResult:
    """Hold every triangulator, by the name it has in tables, against every case."""
    return VerifyResult(
        selection.suite,
        selection.seed,
        verify(gathered.cases, triangulators, on_result),
        gathered.left_out,
        {"command": command, **versions()},
    )


def _of_scene(selection: Selection, scene: str, name: str, left_out: list[str]) -> list[Case]:
    """A scene's cases; one that cannot be made leaves the others be."""

    def wanted(case: str, group: str) -> bool:
        return selected(case, group, selection.patterns)

    made: list[Case] = []
    try:
        for case in scene_cases(
            selection.suite, selection.seed, [scene], left_out.append, selection.rig, wanted=wanted
        ):
            if wanted(case.name, case.group):
                made.append(case)  # noqa: PERF401  # what came before an error is kept
    except InvalidScene:
        raise
    except RigsimError as error:
        left_out.append(f"{name}: {error}")
    return made


def _scene_name(path: Path) -> str:
    return path.parent.name if path.name == "scene.xml" else path.stem


def golden_records(result: VerifyResult, scenes: Sequence[str]) -> list[Record]:
    """What a verification and the scenes give now, to be written as golden or held against it.

    Args:
        result: the verification.
        scenes: scenes by name or path, each with the rig that it is made for.

    Raises:
        InvalidScene: no such scene.
    """
    from rigsim.sim.simulator import Simulator

    made_by = {name: str(result.provenance[name]) for name in ("rigsim", "mujoco")}
    records = []
    for scene in scenes:
        with Simulator(scene) as simulator:
            rig = scene_rig(simulator.scene.name)
            about = {**made_by, "rig": rig_words(rig), "renderer": simulator.backend}
            records.append(scene_record(simulator, rig, about))
    about = {**made_by, "suite": result.suite, "seed": str(result.seed)}
    return [*records, *(triangulator_record(one, about) for one in result.triangulators)]
