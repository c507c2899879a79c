"""Functions of other people by name: ``package.module:function``, looked for beside the user first.

Modules beside the user are found last by everything else: a ``json.py`` there is not Python's ``json``.
"""

from __future__ import annotations

import importlib
import os
import sys
from functools import reduce
from importlib.machinery import PathFinder
from importlib.util import module_from_spec
from typing import Any


def find(name: str) -> Any:
    """What ``package.module:function`` names.

    Raises:
        ImportError: there is no such module, or it has the name of one of Python's own that is in use.
        AttributeError: the module has no such attribute.
        Exception: whatever importing the module raises.
    """
    module_name, _, attribute = name.partition(":")
    here = os.getcwd()
    if here not in sys.path:
        sys.path.append(here)
    _load_beside_user(module_name.partition(".")[0], here)
    return reduce(getattr, attribute.split("."), importlib.import_module(module_name))


def _load_beside_user(top: str, here: str) -> None:
    """Import the user's own module of that name, where there is one, whatever else has it."""
    spec = PathFinder.find_spec(top, [here])
    if spec is None or spec.loader is None or spec.origin is None:
        return
    loaded = sys.modules.get(top)
    if loaded is not None:
        if getattr(loaded, "__file__", None) != spec.origin and top in sys.stdlib_module_names:
            raise ImportError(f"{top} is the name of one of Python's own modules: rename {spec.origin}")
        return
    module = module_from_spec(spec)
    sys.modules[top] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        sys.modules.pop(top, None)
        raise
