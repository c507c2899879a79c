"""What the page begins with, from the words of the command line."""

from __future__ import annotations

from pathlib import Path

from rigsim.errors import InvalidScene
from rigsim.studio.state import State, pack


def state_of(rig: Path | None, preset: str | None, scene: str | None) -> State:
    """The state that the command line asks for.

    Args:
        rig: a calibration's path.
        preset: a preset's name.
        scene: a bundled scene's name, or the path of an MJCF file.

    Raises:
        RigsimError: one of them cannot be used.
    """
    words: dict[str, str] = {}
    if rig is not None:
        from rigsim.interop.formats.calibration import read_calibration
        from rigsim.interop.formats.rig_toml import write_rig

        words["rig"] = pack(write_rig(read_calibration(rig), f"from {rig.name}"))
    if preset is not None:
        from rigsim.rig.presets import preset as named

        words["preset"] = named(preset).name
    if scene is not None:
        words["scene"] = _known(scene)
    return State(words)


def _known(scene: str) -> str:
    """The scene's name, or its path where there is one.

    Raises:
        InvalidScene: there is no such scene.
    """
    from rigsim.sim.scenes.library import names

    if scene in names():
        return scene
    path = Path(scene)
    if not path.is_file():
        raise InvalidScene(f"scene {scene}: no such file, and the bundled scenes are {', '.join(names())}")
    return str(path.resolve())
