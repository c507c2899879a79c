"""What is off where witnesses differ, in words: parts of sentences, without a full stop."""

from __future__ import annotations

from collections.abc import Sequence

from rigsim.present.kit.mistakes.of_amounts import AMOUNTS
from rigsim.present.kit.mistakes.said import MISTAKES
from rigsim.present.kit.sayings import Sentences, spoken
from rigsim.study.agreement.fault import Fault


def fault(found: Fault) -> str:
    """What is off."""
    return spoken(found.said, FAULTS)


def _as_verify(mistake: str) -> str:
    """A sentence of `verify` as part of another; its case is the sweep's, which goes without saying."""
    text = mistake.strip().rstrip(".").replace(" ('sweep')", "").replace(" in 'sweep'", "")
    return text[:1].lower() + text[1:] if text[1:2].islower() else text


def _constant(axes: Sequence[str], zero: bool) -> str:
    comes, what = "comes" if len(axes) == 1 else "come", "0" if zero else "the same number"
    return f"{' and '.join(axes)} {comes} back as {what} in every row"


def _points(of: str, span: str) -> str:
    return f"points with {of} {span} {'m' if of == 'Z' else 'px in the left image'}"


def _lost(share: float, when: str) -> str:
    percent = f"{share * 100:.0f}" if share >= 0.1 else f"{share * 100:.2g}"
    return f"{percent} % of the points come back as NaN{when}"


_Y = "Y scatters {times:#.3g} times as wide as the noise makes it"

FAULTS: Sentences = {
    **MISTAKES,
    **AMOUNTS,
    "as-verify": _as_verify,
    "none-known": "no single known mistake explains it",
    "none-known: nearest": lambda nearest, share: (
        f"no single known mistake explains it; the nearest, {nearest}, explains {share * 100:.0f} % of the "
        "mean square error"
    ),
    "same-here": lambda mistakes: "; the same here as: ".join(mistakes),
    "same-here: amounts": lambda first, others: f"{first}; the same here as {'; or '.join(others)}",
    "several": lambda differences: f"the true rig is not the assumed one: {'; '.join(differences)}",
    "in-a-part": "only {place} are off; there: {there}",
    "points: below": lambda of, low, high: _points(of, f"below {high:.4g}"),
    "points: above": lambda of, low, high: _points(of, f"above {low:.4g}"),
    "points: between": lambda of, low, high: _points(of, f"from {low:.4g} to {high:.4g}"),
    "lost-points": lambda share: _lost(share, " even without noise"),
    "lost-points: which": lambda share, which: _lost(share, f" even without noise: {which}"),
    "lost-points: each time": lambda share: _lost(share, ", other ones each time"),
    "lost-points: with noise": lambda share: _lost(share, " once there is noise"),
    "constant-coordinates": _constant,
    "depth-by-rows": "u and v are exchanged: depth follows the rows instead of the columns",
    "no-disparity": "disparities come out as 0, whatever the pixels: is one image used twice?",
    "scatter-of-Y": _Y,
    "scatter-of-Y: one image": f"{_Y}: one image's rows are not used",
    "scatter-of-Y: a part": f"{_Y}: part of what the rows say is wasted",
    "too-little-scatter": "errors scatter only {times:#.3g} times as wide as noise of {noise_px:g} px makes "
    "them: answers are averaged or drawn to a prior, or the truth leaks in",
    "too-much-scatter": "errors scatter {times:#.3g} times as wide as noise of {noise_px:g} px makes them, "
    "as noise of {as_px:.3g} px would: noise is added, or part of what the pixels say is wasted",
}
"""What is off, and all that may stand in it."""
