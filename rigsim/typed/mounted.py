"""Whose lens a rig has that is mounted on a camera of its scene."""

from __future__ import annotations

from dataclasses import replace

from rigsim.rig.remark import Remark
from rigsim.typed import quantity
from rigsim.typed.rigs import RigOptions


def mounted(options: RigOptions, scene: str, mount: str | None) -> tuple[RigOptions, tuple[Remark, ...]]:
    """The options with the lens of the camera that ``--mount camera:NAME`` names, unless another was typed.

    Returns:
        The options, and a remark that says which lens it is.

    Raises:
        InvalidScene, InvalidRig: as `rigsim.study.scene.mounted.with_lens_of_mount`.
    """
    if mount is None or not mount.startswith("camera:"):
        return options, ()
    typed = next(
        (word for word in ("rig", "preset", "focal", "hfov") if getattr(options, word) is not None), None
    )
    if typed is not None:
        text = f"the lens is that of --{typed}, not that of the scene's camera {mount.partition(':')[2]}"
        return options, (Remark("lens", text),)
    if options.read is not None:
        return options, ()
    from rigsim.study.scene.mounted import with_lens_of_mount

    sizes = () if options.resolution is None else quantity.resolutions(options.resolution)
    size = sizes[0] if len(sizes) == 1 else None
    rig = with_lens_of_mount(options.base(scene), scene, mount, size)
    if rig is None:
        return options, ()
    lens = rig.left
    text = (
        f"both lenses are those of the scene's camera {mount.partition(':')[2]}: {lens.hfov_deg:.4g} deg"
        f" across {lens.width}x{lens.height} px; give another by --focal, --hfov, --preset or --rig"
    )
    return replace(options, read=rig), (Remark("lens", text),)
