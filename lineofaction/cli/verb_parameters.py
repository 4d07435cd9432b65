"""Parameters of verbs as the command line passes them: added, and grouped in dataclasses."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import MISSING, fields, is_dataclass
from functools import wraps
from typing import Any, TypeVar, get_type_hints

R = TypeVar("R")


def with_parameters(verb: Callable[..., R], parameters: Sequence[inspect.Parameter]) -> Callable[..., R]:
    """Give a verb the signature that the command line reads."""
    verb.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    verb.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    return verb


def parameters_of(verb: Callable[..., Any]) -> list[inspect.Parameter]:
    """Return the parameters of a verb, their annotations evaluated."""
    return list(inspect.signature(verb, eval_str=True).parameters.values())


def keyword(name: str, annotation: Any, default: Any = inspect.Parameter.empty) -> inspect.Parameter:
    """Return a parameter that the command line passes by its name."""
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)


def grouped(verb: Callable[..., R]) -> Callable[..., R]:
    """Spread parameters that are dataclasses: each of their fields is an option, annotated as one.

    The verb is called with the dataclasses.
    """
    declared = parameters_of(verb)
    kinds = {part.name: part.annotation for part in declared}
    groups = {name: kind for name, kind in kinds.items() if isinstance(kind, type) and is_dataclass(kind)}

    @wraps(verb)
    def run(**options: Any) -> R:
        for name, group in groups.items():
            options[name] = group(**{field.name: options.pop(field.name) for field in fields(group)})
        return verb(**options)

    parameters = [
        parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY)
        for part in declared
        for parameter in (_options(groups[part.name]) if part.name in groups else [part])
    ]
    return with_parameters(run, parameters)


def _options(group: Any) -> list[inspect.Parameter]:
    hints = get_type_hints(group, include_extras=True)
    defaults = {
        field.name: inspect.Parameter.empty if field.default is MISSING else field.default
        for field in fields(group)
    }
    return [keyword(name, hints[name], default) for name, default in defaults.items()]
