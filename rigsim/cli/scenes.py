"""`rigsim scenes`: the bundled scenes and the rigs made for them."""

from __future__ import annotations


def scenes() -> None:
    """List the bundled scenes and the preset rigs."""
    from rigsim.present.console import print_table
    from rigsim.rig.presets import PRESETS
    from rigsim.sim import library

    print_table(
        "Scenes (--scene)",
        ("scene", "what it shows"),
        [(name, library.about(name)) for name in library.names()],
    )
    rows = [
        (
            preset.name,
            f"{preset.rig.baseline_m * 1e3:g}",
            f"{preset.rig.left.fx:g}",
            f"{preset.rig.left.width}x{preset.rig.left.height}",
            f"{preset.rig.left.hfov_deg:.1f}",
            preset.about,
        )
        for preset in PRESETS.values()
    ]
    print_table(
        "Rigs (--preset)",
        ("preset", "baseline mm", "focal px", "image px", "HFOV deg", "what it is for"),
        rows,
    )
