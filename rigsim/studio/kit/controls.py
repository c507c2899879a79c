"""Controls: boxes for quantities with units, and sliders beside them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from nicegui import ui

from rigsim.errors import RigsimError
from rigsim.rig.quantity import QuantityKind
from rigsim.studio.kit.session import Session
from rigsim.typed import quantity

_STEPS = 400


@dataclass(frozen=True, slots=True)
class Span:
    """What a slider covers, in the unit of a number without one."""

    low: float
    high: float
    log: bool = True
    """Whether equal ways are equal ratios."""
    unit: str = ""
    """What is written behind the number, as ``mm``."""

    def value(self, step: float) -> float:
        """The number at a slider's step."""
        share = step / _STEPS
        if self.log:
            return _round(self.low * (self.high / self.low) ** share)
        return _round(self.low + (self.high - self.low) * share)

    def step(self, value: float) -> float:
        """The step of a number, within the slider."""
        value = min(max(value, self.low), self.high)
        if self.log:
            return round(_STEPS * math.log(value / self.low) / math.log(self.high / self.low))
        return round(_STEPS * (value - self.low) / (self.high - self.low))


@dataclass(frozen=True, slots=True)
class SignedSpan(Span):
    """What a slider covers about 0, finest near it: equal ways are not equal steps."""

    def value(self, step: float) -> float:
        """The number at a slider's step."""
        share = 2 * step / _STEPS - 1
        return _round(self.high * share * abs(share))

    def step(self, value: float) -> float:
        """The step of a number, within the slider."""
        share = min(max(value / self.high, -1.0), 1.0)
        return round((1 + math.copysign(math.sqrt(abs(share)), share)) / 2 * _STEPS)


def _round(value: float) -> float:
    """Three digits: what a hand on a slider can mean."""
    return float(f"{value:.3g}")


def text_box(
    session: Session,
    word: str,
    label: str,
    *,
    hint: str = "",
    kind: QuantityKind | None = None,
    placeholder: str = "",
) -> ui.input:
    """A box whose text is a word of the state.

    Args:
        session: the tab's session.
        word: the word's name.
        label: what a screen reader says.
        hint: a line under it.
        kind: what it must be, if it is one quantity.
        placeholder: what is meant where nothing is typed.
    """

    def fault(text: str) -> str | None:
        if kind is None or not text.strip():
            return None
        try:
            quantity.value(text, kind)
        except RigsimError as error:
            return str(error)
        return None

    box = ui.input(
        label=label,
        value=session.state[word],
        validation=fault,
        on_change=lambda event: session.type(**{word: event.value or ""}),
    ).props(f"dense outlined autocomplete=off{' stack-label' if placeholder else ''}")
    if placeholder:
        box.props(f'placeholder="{placeholder}"')
    if hint:
        box.props(f'hint="{hint}"')

    def fill() -> None:
        box.set_value(session.state[word])

    session.when_restored(fill)
    return box


def quantity_slider(
    session: Session,
    word: str,
    label: str,
    kind: QuantityKind,
    span: Span,
    unset: float,
    placeholder: str = "",
) -> None:
    """A box with a slider below, both of one quantity.

    Args:
        session: the tab's session.
        word: the word's name.
        label: what a screen reader says.
        kind: names, units and bounds.
        span: what the slider covers.
        unset: where the slider stands while nothing is typed, or what is typed cannot be read.
        placeholder: what is meant where nothing is typed.
    """

    def current() -> float:
        try:
            factor = float(kind.factors[span.unit or kind.plain])
            return quantity.value(session.state[word], kind) / factor
        except RigsimError:
            return unset

    def dragged(step: float) -> None:
        if step != span.step(current()):
            text = f"{span.value(step):g}{span.unit}"
            session.type(**{word: text})
            box.set_value(text)

    with ui.column().classes("rig-slider"):
        box = text_box(session, word, label, kind=kind, placeholder=placeholder)
        slider = ui.slider(min=0, max=_STEPS, step=1, value=span.step(current()))
        slider.props(f'aria-label="{label}, slider" dense')
        slider.on("update:model-value", lambda event: dragged(float(event.args)), throttle=0.04)

    def follow() -> None:
        step = span.step(current())
        if slider.value != step:
            slider.set_value(step)

    session.watch(follow, now=False)


def choice(session: Session, word: str, label: str, options: Mapping[str, str]) -> ui.select:
    """A list whose choice is a word of the state.

    Args:
        session: the tab's session.
        word: the word's name.
        label: what a screen reader says.
        options: what is shown, by the word's value; the empty one stands for none.
    """

    def current() -> str:
        return session.state[word] if session.state[word] in box.options else ""

    box = ui.select(
        dict(options), label=label, value=session.state[word] if session.state[word] in options else ""
    ).props("dense outlined options-dense")
    box.on_value_change(lambda event: session.type(**{word: event.value or ""}))

    def fill() -> None:
        box.set_value(current())

    session.when_restored(fill)
    return box


def action(words: str, do: Callable[[], object], *, icon: str = "", flat: bool = True) -> ui.button:
    """A button."""
    button = ui.button(words, icon=icon or None, on_click=do, color=None)
    button.classes("rig-action" if flat else "rig-action rig-first")
    return button.props(f"no-caps {'outline' if flat else 'unelevated'}")
