"""Every public name of ``rigsim``, sorted by what it is for."""

from __future__ import annotations

import inspect

import rigsim

GROUPS = (
    ("The use cases", ("rigsim.api", "rigsim.study")),
    ("Rigs", ("rigsim.rig", "rigsim.interop")),
    ("Closed forms", ("rigsim.theory",)),
    ("Scenes", ("rigsim.sim",)),
    ("Errors", ("rigsim.errors",)),
)
CONSTANTS = {
    "PRESETS": "Every rig known by name, a mapping from name to preset; see :func:`rigsim.preset`.",
    "__version__": "The version of rigsim, a string.",
}
"""What is neither a class nor a function cannot say what it is."""


def as_markdown() -> str:
    """A section a group, an entry a name of ``rigsim.__all__``."""
    parts = []
    for title, modules in GROUPS:
        names = [name for name in rigsim.__all__ if _module(name).startswith(modules)]
        if names:
            parts.append(f"## {title}\n")
            parts.extend(_entry(name) for name in sorted(names, key=_order))
    return "\n".join(parts)


def _module(name: str) -> str:
    value = getattr(rigsim, name)
    return "rigsim.rig" if name in CONSTANTS else value.__module__


def _order(name: str) -> tuple[bool, str]:
    return inspect.isclass(getattr(rigsim, name)), name.lower()


def _entry(name: str) -> str:
    value = getattr(rigsim, name)
    if inspect.isclass(value):
        lines = [f".. autoclass:: rigsim.{name}", "   :members:"]
    elif name in CONSTANTS:
        lines = [f".. py:data:: rigsim.{name}", "", f"   {CONSTANTS[name]}"]
    else:
        lines = [f".. autofunction:: rigsim.{name}"]
    return "\n".join(["```{eval-rst}", *lines, "```", ""])
