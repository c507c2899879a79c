"""rigsim: a simulation-verified stereo rig designer.

Everything in `__all__` can be imported from here; a name's module is loaded when the name is first used.
`__init__.pyi` says which module that is.
"""

import lazy_loader

from rigsim._version import __version__ as __version__

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
