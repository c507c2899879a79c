"""Pictures of the gallery that rigsim drew: its figures are not of pyplot, which Sphinx-Gallery asks."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst


def _scrape(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Save every figure that an example holds by a name, and that pyplot does not manage."""
    paths = []
    for value in block_vars["example_globals"].values():
        if isinstance(value, Figure) and getattr(value.canvas, "manager", None) is None:
            path = next(block_vars["image_path_iterator"])
            value.savefig(path, dpi=100)
            paths.append(path)
    return figure_rst(paths, gallery_conf["src_dir"])


def _get_sg_image_scraper() -> Any:
    """What Sphinx-Gallery looks for in a module that it is given by name."""
    return _scrape
