"""How far long work has come."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

Stage: TypeAlias = Callable[[str, int, int], None]
"""Told of what things, how many are done, of how many."""
