"""Tolerance: a rig that was built a little off, and what of a build matters most."""

from rigsim.studio.pages.tolerance.page import begin, build

__all__ = ["begin", "build"]
