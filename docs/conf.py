"""How Sphinx builds the site: `./run docs`. Nothing is fetched, and a warning is an error (tools/docs.py)."""

from __future__ import annotations

import os
import sys
import warnings
from pathlib import Path

from rigsim import __version__

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_ext"))
os.environ["COLUMNS"] = "100"
warnings.filterwarnings("ignore", message="FigureCanvasAgg is non-interactive")

project = "rigsim"
author = "rigsim's authors"
project_copyright = "rigsim's authors, Apache-2.0"
version = release = __version__

extensions = [
    "generated",
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = [
    "sg_execution_times.rst",
    "_build",
    "gallery",
    "schema",
    "examples",
    "**/GALLERY_HEADER.rst",
]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}

myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 4
# in pages for GitHub as well as for the site: text blocks hold terminal output
highlight_language = "none"
pygments_style = "friendly"
smartquotes = False
copybutton_prompt_text = r"\$ "
copybutton_prompt_is_regexp = True

autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
python_maximum_signature_line_length = 88
napoleon_numpy_docstring = False

sphinx_gallery_conf = {
    "examples_dirs": ["gallery"],
    "gallery_dirs": ["auto_gallery"],
    "filename_pattern": r"\.py$",
    "within_subsection_order": "FileNameSortKey",
    "write_computation_times": False,
    "download_all_examples": False,
    "remove_config_comments": True,
    "show_signature": False,
    "show_memory": False,
    "min_reported_time": 1e9,
    "image_scrapers": ("matplotlib", "figures"),
    "matplotlib_animations": False,
    "thumbnail_size": (360, 252),
    "capture_repr": ("_repr_html_",),
}

html_theme = "furo"
html_title = "rigsim"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
html_theme_options = {"source_directory": "docs/"}
