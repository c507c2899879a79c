"""The scenes that come with rigsim, and how a scene is found."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from rigsim.errors import InvalidScene

_PACKAGE = Path(__file__).resolve().parents[2]


def models_dir() -> Path:
    """Folder of the bundled scenes: in the package when installed, beside it in a checkout."""
    installed = _PACKAGE / "models"
    return installed if installed.is_dir() else _PACKAGE.parent / "models"


def names() -> list[str]:
    """Names of the bundled scenes."""
    return sorted(path.parent.name for path in models_dir().glob("*/scene.xml"))


def find(scene: str) -> Path:
    """Path of a bundled scene's file, or of the MJCF file `scene` names.

    Raises:
        InvalidScene: there is neither.
    """
    if scene in names():
        return models_dir() / scene / "scene.xml"
    path = Path(scene)
    try:
        if path.is_dir() and (path / "scene.xml").is_file():
            return path / "scene.xml"
        if path.is_file():
            return path
        if path.exists():
            kind = "a folder without a scene.xml" if path.is_dir() else "no regular file"
            raise InvalidScene(f"{path}: is {kind}: name an MJCF file or a bundled scene")
    except OSError as error:  # a name that no system takes, a folder that may not be looked into
        raise InvalidScene(f"scene {_short(scene)!r}: cannot be read ({error.strerror})") from None
    raise InvalidScene(
        f"unknown scene {_short(scene)!r}: no such file, and the bundled scenes are {', '.join(names())}"
    )


def _short(text: str) -> str:
    return text if len(text) <= 100 else f"{text[:97]}..."


def about(name: str) -> str:
    """What a bundled scene shows, one line: the text called `about` in its file."""
    root = ElementTree.parse(models_dir() / name / "scene.xml").getroot()
    text = root.find("./custom/text[@name='about']")
    return "" if text is None else str(text.get("data", ""))
