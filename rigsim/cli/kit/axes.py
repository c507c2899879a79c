"""The options of the axes that a sweep can vary, made from their registry."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Annotated, Any, Concatenate, ParamSpec, TypeVar, cast

import typer

from rigsim.errors import InvalidRange
from rigsim.study.scene.axes import registry
from rigsim.study.scene.axes.axis import Axis

_P = ParamSpec("_P")
_R = TypeVar("_R")

CONTEXT = inspect.Parameter("context", inspect.Parameter.KEYWORD_ONLY, annotation=typer.Context)
"""How a command asks typer for what it knows of the words that were typed."""

TYPED: tuple[Axis, ...] = tuple(axis for axis in registry.ALL if axis.of_rig or axis.of_noise)
"""Those with an option of their own making; triangulators and sensors have theirs in the commands."""

DISPARITY_NOISE = "disparity_noise"
"""An option that says the noise in other words, and is no axis: tables keep to the noise of a coordinate."""
_DISPARITY_NOISE_HELP = (
    "Noise per disparity, px standard deviation, instead of --noise: sqrt(2) times as much."
)
_NONE: Mapping[str, str] = MappingProxyType({})


def takes_axes(command: Callable[Concatenate[Mapping[str, str], _P], _R]) -> Callable[..., _R]:
    """Give `command` an option for each axis and `DISPARITY_NOISE`, and hand it those that were typed, by
    name, as its first argument."""

    @functools.wraps(command)
    def run(context: typer.Context, **words: Any) -> _R:
        typed = meant(TYPED, words, context, {DISPARITY_NOISE: "noise"})
        return cast(Callable[..., _R], command)(typed, **words)

    options = [
        inspect.Parameter(
            name,
            inspect.Parameter.KEYWORD_ONLY,
            default=default,
            annotation=Annotated[str | None, typer.Option(help=says)],
        )
        for name, default, says in (
            *((axis.name, axis.default, axis.help) for axis in TYPED),
            (DISPARITY_NOISE, None, _DISPARITY_NOISE_HELP),
        )
    ]
    own = list(inspect.signature(command, eval_str=True).parameters.values())[1:]
    parameters = [CONTEXT, *options, *(item.replace(kind=inspect.Parameter.KEYWORD_ONLY) for item in own)]
    # where typer looks for a function's parameters
    run.__annotations__ = {item.name: item.annotation for item in parameters}
    vars(run)["__signature__"] = inspect.Signature(parameters)
    return run


def meant(
    axes: Sequence[Axis],
    words: dict[str, Any],
    context: typer.Context,
    other_words: Mapping[str, str] = _NONE,
) -> dict[str, str]:
    """What was typed of `axes`, taken out of `words`, and what is meant where nothing was.

    Args:
        axes: what can be typed.
        words: what typer found, by name.
        context: what it knows of them.
        other_words: further options, each with the axis that it says in other words.

    Raises:
        InvalidRange: two that say the same were typed, be it with the value that is meant anyway.
    """
    about = {**{axis.name: axis.instead_of or axis.name for axis in axes}, **other_words}
    texts = {name: words.pop(name) for name in about}
    said = {name: text for name, text in texts.items() if text is not None and _is_typed(context, name)}
    first: dict[str, str] = {}
    for name in sorted(said, key=lambda name: name != about[name]):
        other = first.setdefault(about[name], name)
        if other != name:
            both = f"--{other} and --{name}".replace("_", "-")
            raise InvalidRange(f"{both} both given: they say the same thing, give one")
    unsaid = {
        axis.name: axis.default for axis in axes if axis.default is not None and about[axis.name] not in first
    }
    return said | unsaid


def _is_typed(context: typer.Context, name: str) -> bool:
    source = context.get_parameter_source(name)
    return source is not None and source.name not in ("DEFAULT", "DEFAULT_MAP")
