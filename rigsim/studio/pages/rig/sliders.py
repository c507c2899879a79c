"""Sliders that stand at the rig's own value until something is typed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from nicegui import ui

from rigsim.errors import RigsimError
from rigsim.rig.quantity import QuantityKind
from rigsim.studio.kit.controls import Span
from rigsim.studio.kit.session import Session
from rigsim.typed import quantity

_STEPS = 400
_THROTTLE_S = 0.04
Standing = Callable[[], Mapping[str, str]]
"""Where controls stand that nothing was typed in, by word."""


@dataclass(frozen=True, slots=True)
class Knob:
    """A word with a box and a slider."""

    word: str
    """The word's name."""
    label: str
    """What a screen reader says."""
    kind: QuantityKind
    """Names, units and bounds."""
    span: Span
    """What the slider covers."""
    clears: tuple[str, ...] = ()
    """Words that say the same thing, and go once this is typed."""
    hint: str = ""
    """A line under it."""

    def number(self, text: str) -> float | None:
        """What was typed, in the unit of the slider; None where it cannot be read."""
        try:
            return quantity.value(text, self.kind) / float(
                self.kind.factors[self.span.unit or self.kind.plain]
            )
        except RigsimError:
            return None


def knob(session: Session, what: Knob, standing: Standing) -> ui.element:
    """Place a box with a slider below; the box shows in grey where the rig stands of itself."""

    def fault(text: str) -> str | None:
        if text.strip():
            try:
                quantity.value(text, what.kind)
            except RigsimError as error:
                return str(error)
        return None

    def typed(text: str) -> None:
        session.type(**{what.word: text}, **(dict.fromkeys(what.clears, "") if text.strip() else {}))

    def current() -> float:
        number = what.number(session.state[what.word] or standing()[what.word])
        return what.span.low if number is None else number

    with ui.column().classes("rig-slider") as whole:
        box = ui.input(label=what.label, value=session.state[what.word], validation=fault)
        box.on_value_change(lambda event: typed(event.value or ""))
        box.props("dense outlined autocomplete=off stack-label")
        slider = ui.slider(min=0, max=_STEPS, step=1, value=what.span.step(current()))
        slider.props(f'aria-label="{what.label}, slider" dense')
    if what.hint:
        box.props(f'hint="{what.hint}"')

    def dragged(step: float) -> None:
        if step != what.span.step(current()):
            box.set_value(f"{what.span.value(step):g}{what.span.unit}")

    def follow() -> None:
        text = session.state[what.word]
        if box.value != text:
            box.set_value(text)
        placeholder = standing()[what.word]
        if box.props.get("placeholder") != placeholder:
            box.props(f'placeholder="{placeholder}"')
        step = what.span.step(current())
        if slider.value != step:
            slider.set_value(step)

    slider.on("update:model-value", lambda event: dragged(float(event.args)), throttle=_THROTTLE_S)
    session.watch(follow)
    return whole


def range_knob(session: Session, label: str, span: Span, standing: Standing) -> None:
    """Place a box ``near:far`` with a slider for each end below."""
    word, kind = "range", quantity.DEPTH

    def fault(text: str) -> str | None:
        from rigsim.typed.design import working_range

        try:
            working_range(text)
        except RigsimError as error:
            return str(error)
        return None

    def current() -> tuple[float, float]:
        factor = float(kind.factors[span.unit])
        for text in (session.state[word], standing()[word]):
            try:
                near, far = quantity.span(text, kind)
                return near / factor, far / factor
            except RigsimError:
                continue
        return span.low, span.high

    def dragged(end: int, step: float) -> None:
        ends = [*current()]
        if step == span.step(ends[end]):
            return
        ends[end] = span.value(step)
        if ends[0] < ends[1]:
            box.set_value(f"{ends[0]:g}:{ends[1]:g}{span.unit}")
        else:
            follow()

    def follow() -> None:
        if box.value != session.state[word]:
            box.set_value(session.state[word])
        for slider, value in zip(sliders, current(), strict=True):
            if slider.value != span.step(value):
                slider.set_value(span.step(value))

    with ui.column().classes("rig-slider"):
        box = ui.input(label=label, value=session.state[word], validation=fault)
        box.on_value_change(lambda event: session.type(**{word: event.value or ""}))
        box.props('dense outlined autocomplete=off stack-label hint="near:far, with the unit"')
        sliders = []
        for end, name in enumerate(("near end", "far end")):
            slider = ui.slider(min=0, max=_STEPS, step=1, value=span.step(current()[end]))
            slider.props(f'aria-label="{label}, {name}, slider" dense')
            slider.on(
                "update:model-value",
                lambda event, end=end: dragged(end, float(event.args)),
                throttle=_THROTTLE_S,
            )
            sliders.append(slider)
    session.watch(follow)
