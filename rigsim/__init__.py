"""rigsim: a simulation-verified stereo rig designer."""

from rigsim._version import __version__

__all__ = ["__version__"]
