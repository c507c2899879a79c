"""Textures from words: a scene says `bark size=512 seed=3` and gets the picture, equal bits every time.

A scene declares each texture with a plain builtin, so that any viewer opens it, and names the real one in
``<custom><text name="texture:NAME" data="GENERATOR key=value ..."/></custom>``. Keys are `seed`, the size
in texels (`size`, or `width` and `height`) and the generator's own.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import mujoco
import numpy as np

from rigsim.errors import InvalidScene
from rigsim.rig.arrays import Image
from rigsim.sim.noise import Plane
from rigsim.sim.scenes import prints
from rigsim.sim.truth import surfaces

PREFIX = "texture:"
"""What the name of a custom text starts with when it describes a texture."""

GENERATORS: dict[str, Callable[..., Plane]] = {
    pattern.__name__: pattern
    for pattern in (
        prints.amphora,
        surfaces.bark,
        surfaces.bricks,
        surfaces.carbon,
        surfaces.cardboard,
        prints.checker,
        surfaces.clouds,
        surfaces.cork,
        prints.dial,
        surfaces.leaves,
        surfaces.metal,
        surfaces.paint,
        prints.parcel,
        surfaces.plaster,
        prints.poster,
        prints.ruler,
        surfaces.speckle,
        surfaces.terrazzo,
        surfaces.tiles,
        surfaces.wood,
    )
}
"""Every generator by its name."""

_COLOR = re.compile(r"#[0-9a-fA-F]{6}")
_DEFAULT_SIZE = 512
_POWERS_OF_TWO = {"size": (64, 2048), "width": (64, 2048), "height": (64, 2048), "ridges": (1, 64)}
_MAX_SHARE = 4.0
_MAX_COUNT = 4096
_MAX_TEXELS = 4096 * 4096


@lru_cache(maxsize=64)
def generate(description: str) -> Image:
    """The texture `description` stands for, (H, W, 3) uint8, read-only; row 0 is the top.

    Raises:
        InvalidScene: the generator or a parameter is unknown, or a value is out of bounds.
    """
    name, *items = description.split() or [""]
    if name not in GENERATORS:
        raise InvalidScene(f"unknown texture {name!r}: choose one of {', '.join(GENERATORS)}")
    generator = GENERATORS[name]
    signature = inspect.signature(generator).parameters
    random = "on" in signature
    defaults: dict[str, Any] = {
        key: parameter.default
        for key, parameter in signature.items()
        if parameter.kind is inspect.Parameter.KEYWORD_ONLY
    }
    if random:
        defaults |= {"seed": 0, "size": _DEFAULT_SIZE, "width": 0, "height": 0}
    given = _parse(name, items, defaults)
    if random:
        seed, size = given.pop("seed", 0), given.pop("size", _DEFAULT_SIZE)
        shape = (given.pop("height", size), given.pop("width", size))
        color = generator(surfaces.Canvas(np.random.default_rng(seed), shape), **given)
    else:
        _check_texels(name, defaults | given)
        color = generator(**given)
    image: Image = np.rint(np.clip(color, 0, 1) * np.float32(255)).astype(np.uint8)
    image.flags.writeable = False
    return image


def apply_textures(spec: Any) -> None:
    """Put the generated pictures into a mujoco.MjSpec, before it is compiled.

    Raises:
        InvalidScene: a text names a texture that the file does not declare, or cannot be generated.
    """
    declared = {texture.name: texture for texture in spec.textures}
    for text in spec.texts:
        if not text.name.startswith(PREFIX):
            continue
        name = text.name.removeprefix(PREFIX)
        if name not in declared:
            raise InvalidScene(
                f"texture {name!r}: described but not declared; add <texture name={name!r} .../> to <asset>"
            )
        texture, image = declared[name], generate(text.data)
        if texture.type != mujoco.mjtTexture.mjTEXTURE_2D and image.shape[0] != image.shape[1]:
            raise InvalidScene(
                f"texture {name!r}: {image.shape[1]}x{image.shape[0]} texels on a cube, must be square"
            )
        texture.builtin = mujoco.mjtBuiltin.mjBUILTIN_NONE
        texture.colorspace = mujoco.mjtColorSpace.mjCOLORSPACE_LINEAR
        texture.height, texture.width, texture.nchannel = image.shape
        texture.data = image.tobytes()


def _parse(name: str, items: list[str], defaults: dict[str, Any]) -> dict[str, Any]:
    given: dict[str, Any] = {}
    for item in items:
        key, _, word = item.partition("=")
        if key not in defaults:
            raise InvalidScene(f"texture {name}: unknown parameter {key!r}, known are {', '.join(defaults)}")
        if key in given:
            raise InvalidScene(f"texture {name}: {key} is given twice")
        given[key] = _value(name, key, word, defaults[key])
    return given


def _value(name: str, key: str, word: str, default: Any) -> Any:
    where = f"texture {name}: {key}={word}"
    if isinstance(default, str):
        if not _COLOR.fullmatch(word):
            raise InvalidScene(f"{where}: must be a colour like #a08060")
        return word.lower()
    try:
        value = int(word) if isinstance(default, int) else float(word)
    except ValueError:
        kind = "a whole number" if isinstance(default, int) else "a number"
        raise InvalidScene(f"{where}: must be {kind}") from None
    if key in _POWERS_OF_TWO:
        least, most = _POWERS_OF_TWO[key]
        if not least <= value <= most or int(value).bit_count() != 1:
            raise InvalidScene(f"{where}: must be a power of two from {least} to {most}")
    elif key in {"seed", "margin"}:
        if value < 0:
            raise InvalidScene(f"{where}: must be >= 0")
    elif isinstance(default, float):
        if not 0 <= value <= _MAX_SHARE:
            raise InvalidScene(f"{where}: must be from 0 to {_MAX_SHARE:g}")
    elif not 1 <= value <= _MAX_COUNT:
        raise InvalidScene(f"{where}: must be from 1 to {_MAX_COUNT}")
    return value


def _check_texels(name: str, values: dict[str, Any]) -> None:
    square, margin = values["square"], values["margin"]
    height, width = ((values[key] + 1) * square + 2 * margin for key in ("rows", "cols"))
    if height * width > _MAX_TEXELS:
        raise InvalidScene(f"texture {name}: {width}x{height} texels, must be at most {_MAX_TEXELS} in all")
