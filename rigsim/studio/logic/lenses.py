"""The words of a rig where it comes from: a name, a file, or one's own hand."""

from __future__ import annotations

from collections.abc import Mapping

from rigsim.present.kit.format import plain
from rigsim.rig.presets import PRESETS
from rigsim.studio.logic.rig import Shown, taken_in
from rigsim.studio.state import State
from rigsim.studio.words import OF_RIG

OWN = ""
"""In place of a preset's name: a rig that is typed."""
_SHAPE = ("baseline", "hfov", "resolution", "vergence")
SIZES = (
    "640x480",
    "848x480",
    "1280x720",
    "1280x800",
    "1280x960",
    "1456x1088",
    "1600x1200",
    "1920x1080",
    "1920x1200",
    "2448x2048",
    "3840x2160",
    "4056x3040",
)
"""Image sizes that one meets."""
UNSHOWN: Mapping[str, str] = {
    "baseline": "120mm",
    "hfov": "70deg",
    "focal": "900",
    "resolution": "1280x720",
    "vergence": "0deg",
    "noise": "0.25",
    "range": "0.5:5m",
}
"""Where controls stand while no rig can be read."""


def standing(shown: Shown | None) -> Mapping[str, str]:
    """Where controls stand that nothing was typed in, as it would be typed."""
    if shown is None:
        return UNSHOWN
    rig = shown.rig
    vergence = plain(rig.vergence_deg, 4).replace("−", "-")
    return {
        **UNSHOWN,
        "baseline": f"{rig.baseline_m * 1e3:.5g}mm",
        "hfov": f"{rig.left.hfov_deg:.4g}deg",
        "focal": f"{rig.left.fx:.5g}",
        "resolution": f"{rig.left.width}x{rig.left.height}",
        "vergence": f"{'0' if vergence == '-0' else vergence}deg",
    }


def without_rig(state: State) -> State:
    """The words without those of the rig."""
    return State({name: text for name, text in state.words.items() if name not in OF_RIG})


def with_preset(state: State, name: str, shown: Shown | None) -> State:
    """The words for a preset as it is; for `OWN` those that type the rig that is shown."""
    kept = without_rig(state)
    if name in PRESETS:
        return kept.with_words(preset=name)
    now = standing(shown)
    return kept.with_words(**{word: state[word] or now[word] for word in _SHAPE})


def with_file(state: State, name: str, content: bytes) -> State:
    """The words for a calibration that was loaded.

    Raises:
        RigsimError: it holds no rig.
    """
    return without_rig(state).with_words(rig=taken_in(name, content))


def is_from_file(state: State) -> bool:
    """Whether the rig is one that the address carries."""
    return bool(state["rig"])
