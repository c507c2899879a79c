"""What of an MJCF file is not in the pictures, or has no place in space, and is said by name."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import mujoco
import numpy as np

from rigsim.rig.remark import Remark

_NAMED = 3  # of a kind; the others are counted
_VISIBLE = mujoco.MjvOption().geomgroup
_TEXTURED_GREY = (
    8  # between neighbouring texels along a row: less is a gradient, which nothing can be matched on
)
_DEFAULTS = mujoco.MjModel.from_xml_string("<mujoco/>").vis


def warned(scene: str, warnings: Iterable[str]) -> tuple[Remark, ...]:
    """Remarks on what MuJoCo warns of when it reads a file."""
    texts = dict.fromkeys(" ".join(each.split()) for each in warnings)
    said = "; ".join(text.removeprefix("WARNING: ") for text in texts)
    return (Remark("mujoco_warning", f"scene {scene}: MuJoCo warns: {said}"),) if said else ()


def left_out(model: Any, scene: str) -> tuple[Remark, ...]:
    """Remarks on elements that MuJoCo would draw and rays cannot check, and on fog and lights."""
    remarks = []
    kinds = {
        "skin": [i for i in range(model.nskin) if _VISIBLE[model.skin_group[i]]],
        "flex": [i for i in range(model.nflex) if _VISIBLE[model.flex_group[i]]],
        "tendon": [i for i in range(model.ntendon) if _VISIBLE[model.tendon_group[i]] and _drawn(model, i)],
    }
    names = [_listed(model, kind, ids) for kind, ids in kinds.items() if ids]
    if names:
        remarks.append(
            Remark(
                "left_out",
                f"scene {scene}: {'; '.join(names)}: not drawn, as rays cannot check where they are; "
                "make them geoms if they are to be seen",
            )
        )
    fog = _changed(model)
    if fog:
        remarks.append(
            Remark("fog", f"scene {scene}: {' and '.join(fog)} left out: pictures are as in clear air")
        )
    return tuple(remarks)


def textured_sky(model: Any) -> str:
    """Name of the skybox that is drawn, when features could be found on it; empty when there is none."""
    for texture in range(model.ntex):
        if model.tex_type[texture] != mujoco.mjtTexture.mjTEXTURE_SKYBOX:
            continue
        channels, start = int(model.tex_nchannel[texture]), int(model.tex_adr[texture])
        width, height = int(model.tex_width[texture]), int(model.tex_height[texture])
        texels = model.tex_data[start : start + width * height * channels].reshape(height, width, channels)
        steps = np.abs(np.diff(texels.astype(np.int16), axis=1))
        name = str(model.texture(texture).name) or "skybox"
        return name if steps.max(initial=0) > _TEXTURED_GREY else ""  # only the first one is drawn
    return ""


def _drawn(model: Any, tendon: int) -> bool:
    """Whether MuJoCo draws it: a spatial tendon of some width, which runs over sites and geoms."""
    first = int(model.wrap_type[model.tendon_adr[tendon]])
    return first != mujoco.mjtWrap.mjWRAP_JOINT and float(model.tendon_width[tendon]) > 0


def _listed(model: Any, kind: str, ids: list[int]) -> str:
    names = [_name(model, kind, i) for i in ids[:_NAMED]]
    more = f" and {len(ids) - _NAMED} more" if len(ids) > _NAMED else ""
    plural = {"skin": "skins", "flex": "flexes", "tendon": "tendons"}[kind] if len(ids) > 1 else kind
    return f"{plural} {', '.join(names)}{more}"


def _name(model: Any, kind: str, index: int) -> str:
    which = {
        "skin": mujoco.mjtObj.mjOBJ_SKIN,
        "flex": mujoco.mjtObj.mjOBJ_FLEX,
        "tendon": mujoco.mjtObj.mjOBJ_TENDON,
    }[kind]
    return mujoco.mj_id2name(model, which, index) or f"number {index + 1}"


def _changed(model: Any) -> list[str]:
    """Fog and haze, where the file sets them."""
    names = []
    ours, usual = model.vis, _DEFAULTS
    for name, values in {"fog": ("fogstart", "fogend"), "haze": ("haze",)}.items():
        lengths = any(getattr(ours.map, value) != getattr(usual.map, value) for value in values)
        if lengths or not np.array_equal(getattr(ours.rgba, name), getattr(usual.rgba, name)):
            names.append(name)
    return names
