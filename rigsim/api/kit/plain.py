"""Functions with many plain keyword arguments, each of which is one field of frozen options."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import ParamSpec, TypeVar

_P = ParamSpec("_P")
_O = TypeVar("_O")
_R = TypeVar("_R")


def takes(options: Callable[_P, _O]) -> Callable[[Callable[[_O], _R]], Callable[_P, _R]]:
    """Let a function of one `options` be called with the options' fields as its own arguments."""

    def decorate(function: Callable[[_O], _R]) -> Callable[_P, _R]:
        @functools.wraps(function)
        def call(*args: _P.args, **kwargs: _P.kwargs) -> _R:
            return function(options(*args, **kwargs))

        fields = inspect.signature(options)
        returned = inspect.signature(function).return_annotation
        vars(call)["__signature__"] = fields.replace(return_annotation=returned)
        del vars(call)["__wrapped__"]  # its signature is another
        return call

    return decorate
