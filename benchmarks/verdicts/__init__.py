"""What each conclusion of rigsim is worth: false alarms, power, and answers against brute force.

One module a claim, each with ``run() -> None``; all of them, or those named:
``./run bench verdicts``, ``./run bench verdicts.frusta``.
"""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules


def run() -> None:
    """Run every claim's module in turn."""
    for module in iter_modules(__path__):
        print(f"\n## {module.name}")
        import_module(f"{__name__}.{module.name}").run()
