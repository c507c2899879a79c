"""The root of a function that grows: Newton's method, and halving where that goes astray."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rigsim.rig.arrays import Array

MET = 1e-14
QUICK_STEPS = 4
SAFE_STEPS = 120
_STILL = 4e-16


def growing_root(
    function: Callable[[Array], tuple[Array, Array]], target: Array, start: Array, end: float
) -> Array:
    """Where a function that grows from 0 on [0, end] is `target` (N,), to rounding.

    Args:
        function: Its values and derivatives at (N,).
        target: Within its values.
        start: A first guess (N,), within [0, end].
        end: May be infinite.
    """
    root, missed = newton(function, target, start, QUICK_STEPS)
    slow = ~((np.abs(missed) <= MET * target) & (root >= 0) & (root <= end))
    if slow.any():
        root[slow] = bracketed(function, target[slow], end)
    return root


def newton(
    function: Callable[[Array], tuple[Array, Array]], target: Array, start: Array, steps: int
) -> tuple[Array, Array]:
    """So many of Newton's steps; the roots, and by how much they miss `target` (N,)."""
    root = start
    for left in range(steps, -1, -1):
        value, slope = function(root)
        missed = value - target
        if left:
            root = root - missed / slope
    return root, missed


def bracketed(function: Callable[[Array], tuple[Array, Array]], target: Array, end: float) -> Array:
    """As `growing_root`, in as many steps as it takes."""
    low, high = np.zeros_like(target), np.maximum(target, 1.0)
    if np.isfinite(end):
        high = np.full_like(target, end)
    else:
        for _ in range(1100):
            short = function(high)[0] < target
            if not short.any():
                break
            high = np.where(short, 2 * high, high)
    root, last = np.clip(target, low, high), high
    for _ in range(SAFE_STEPS):
        value, slope = function(root)
        value = value - target
        low, high = np.where(value < 0, root, low), np.where(value < 0, high, root)
        step = root - value / slope
        # a step that is not half the last one may be part of a cycle
        good = (step >= low) & (step <= high) & (2 * np.abs(step - root) <= last)
        moved = np.where(good, step, (low + high) / 2)
        last = np.abs(moved - root)
        if (last <= _STILL * root).all():
            break
        root = moved
    return root
