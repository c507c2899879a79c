"""What lists names is made from the registries, and is up to date."""

from __future__ import annotations

from pathlib import Path

import pytest
from cogapp import Cog

from rigsim.interop import formats, layouts
from rigsim.interop.formats import registry as calibrations
from rigsim.interop.layouts import registry as layout_registry
from rigsim.study.scene import axes
from rigsim.study.scene.axes import registry as axis_registry

ROOT = Path(__file__).resolve().parents[2]
MADE = ("rigsim/cli/kit/lists.py", "docs/reference/columns.md", "docs/reference/sensors.md")


@pytest.mark.parametrize("name", MADE)
def test_made_lists_are_up_to_date(name: str) -> None:
    cog = Cog()
    assert cog.main(["cog", "--check", "-I", str(ROOT / "tools"), str(ROOT / name)]) == 0, (
        f"run: .venv/bin/cog -r -I tools {name}"
    )


def test_every_format_and_every_axis_stands_in_its_registry() -> None:
    for room, entry, entered in (
        (formats, "FORMAT = ", len(calibrations.ALL)),
        (axes, "AXIS = ", len(axis_registry.ALL)),
        (layouts, "LAYOUT = ", len(layout_registry.ALL)),
    ):
        texts = [path.read_text(encoding="utf-8") for path in Path(room.__path__[0]).rglob("*.py")]
        assert sum(f"\n{entry}" in text for text in texts) == entered
