"""The rig that a page's words describe."""

from __future__ import annotations

from dataclasses import dataclass

from rigsim.errors import InvalidRig
from rigsim.rig.noise import PixelNoise
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.studio.state import State, pack, unpack
from rigsim.typed.noise import pixel_noise
from rigsim.typed.rigs import RigOptions, single_rig


@dataclass(frozen=True, slots=True)
class Shown:
    """A rig as words describe it, and what is known of its images."""

    rig: StereoRig
    """The rig."""
    noise: PixelNoise
    """Noise of every pixel coordinate."""
    sized: bool
    """Whether the images have an edge that is known."""
    from_axis: bool
    """Whether pixels count from the optical axis."""
    remarks: tuple[Remark, ...]
    """What is odd about the mode of a camera one can buy."""


def options_of(state: State) -> RigOptions:
    """The words of a rig, as the command line's options.

    Raises:
        InvalidRig: the rig that the address carries cannot be read.
    """
    words = {name: text for name, text in state.words.items() if name != "rig"}
    packed = state["rig"]
    if not packed:
        return RigOptions.of(words)
    from rigsim.interop.formats.calibration import parse_calibration

    text = unpack(packed)
    if not text:
        raise InvalidRig("rig: the address holds no rig that can be read; load its file again")
    return RigOptions.of({**words, "preset": None}, read=parse_calibration(text))


def shown_rig(state: State, *, size_for: str = "") -> Shown:
    """The one rig that the words describe.

    Args:
        state: the words.
        size_for: what needs the image size; it may be left out when empty.

    Raises:
        RigsimError: something is missing, or cannot be read.
    """
    options = options_of(state)
    principal = state["principal"] or None
    rig = single_rig(options, principal, size_for=size_for)
    noise = pixel_noise(state["noise"] or None, None)
    from_axis = not (options.has_size or principal)
    return Shown(rig, noise, options.has_size, from_axis, tuple(options.mode_remarks(rig)))


def taken_in(name: str, content: bytes) -> str:
    """The word of an uploaded calibration: its rig, whatever format it came in.

    Args:
        name: of the file, for messages.
        content: its bytes, which are parsed as data.

    Raises:
        RigsimError: it holds no rig.
    """
    from rigsim.interop.formats.calibration import parse
    from rigsim.interop.formats.rig_toml import write_rig

    return pack(write_rig(parse(content, name=name[:60]).rig, f"from {name[:60]}"))
