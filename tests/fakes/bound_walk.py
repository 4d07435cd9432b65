"""A walk over the numeric fields of a schema: what each refuses, and what it says it would accept."""

import re
import types
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, Union, get_args, get_origin

from changed_scenes import changed
from drawn_cases import drawn_part
from pydantic import BaseModel

from lineofaction.gearbox.problems import Fault

Table = dict[str, Any]
Place = tuple[str | int, ...]
Refusal = Callable[[Table], Fault | None]

HUGE = 10**18
LONGEST_CHAIN = 8
NUMBER = r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
LOW = re.compile(rf"\b(from|at least|above) (?:[a-z' ]+ )?({NUMBER})")
HIGH = re.compile(rf"\b(to below|to|below|at most) (?:[a-z' ]+ )?({NUMBER})")


@dataclass(frozen=True)
class Trial:
    """One value of one field, and why it is refused; None if it is accepted."""

    place: Place
    value: float
    fault: Fault | None
    table: Table = field(repr=False)


def dotted(place: Place) -> str:
    text = ""
    for part in place:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def numeric_fields(model: type[BaseModel], table: Table, start: Place = ()) -> Iterator[tuple[Place, type]]:
    """Yield every number of `model` whose table is in `table`, whether it is given there or not."""
    for name, info in model.model_fields.items():
        yield from _numbers(info.annotation, table.get(name), (*start, name))


def _numbers(annotation: Any, value: Any, place: Place) -> Iterator[tuple[Place, type]]:
    """Yield the numbers of one field: itself, the first and last of its list, those of its tables."""
    kind = get_origin(annotation)
    if kind in (Union, types.UnionType) or hasattr(annotation, "__metadata__"):
        inner = get_args(annotation)[:1] if hasattr(annotation, "__metadata__") else get_args(annotation)
        for one in inner:
            yield from _numbers(one, value, place)
    elif annotation in (int, float):
        yield place, annotation
    elif kind in (tuple, list) and isinstance(value, list) and value:
        for index in sorted({0, len(value) - 1}):
            yield from _numbers(get_args(annotation)[0], value[index], (*place, index))
    elif isinstance(annotation, type) and issubclass(annotation, BaseModel) and isinstance(value, dict):
        yield from numeric_fields(annotation, value, place)


def is_field(model: type[BaseModel], name: str) -> bool:
    """Whether a file of `model` can have a field of this dotted name."""
    current: type[BaseModel] | None = model
    for part in name.split("."):
        info = current.model_fields.get(part.partition("[")[0]) if current else None
        if info is None:
            return False
        current = _model_in(info.annotation)
    return True


def _model_in(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next(filter(None, map(_model_in, get_args(annotation))), None)


def chains(
    model: type[BaseModel], table: Table, refusal: Refusal, leave_out: str = ""
) -> Iterator[list[Trial]]:
    """Yield the chains of the numbers of a table of `model`, but for those inside of fields `leave_out`.

    By day of a fifth of them, drawn by their places.
    """
    numbers = [(place, kind) for place, kind in numeric_fields(model, table) if leave_out not in place]
    for place, kind in drawn_part(numbers, lambda number: dotted(number[0])):
        for end, far in ((LOW, -HUGE), (HIGH, HUGE)):
            yield _chain(table, place, kind, refusal, end, far)


def _chain(
    table: Table, place: Place, kind: type, refusal: Refusal, end: re.Pattern[str], far: int
) -> list[Trial]:
    """Return what follows a value far off: the bound that is told, typed, and so on; at last just beyond it.

    A chain ends where a value is accepted, another field is at fault, or words are told instead of a number.
    """
    chain: list[Trial] = []
    value: float | None = kind(far) * (10**25 if kind is float else 1)
    while value is not None and len(chain) < LONGEST_CHAIN:
        chain.append(trial(table, place, value, refusal))
        fault = chain[-1].fault
        value = next_typed(fault, end, kind) if fault and fault.field == dotted(place) else None
    if chain[-1].fault is None:
        size = abs(chain[-1].value)
        step = 1 if kind is int else 1e-5 * (size if size > 1e-5 else 1.0)
        beyond = chain[-1].value - step if end is LOW else chain[-1].value + step
        chain.append(trial(table, place, beyond, refusal))
    return chain


def trial(table: Table, place: Place, value: float, refusal: Refusal) -> Trial:
    typed = changed(table, {dotted(place): value})
    return Trial(place, value, refusal(typed), typed)


def next_typed(fault: Fault, end: re.Pattern[str], kind: type) -> float | None:
    """Return the number at one end of a bound as it is typed: a digit inside where the end is refused."""
    found = end.search(fault.bound.partition(":")[0])
    if found is None:
        return None
    value, word = float(found.group(2)), found.group(1)
    if kind is int:
        return int(value) + {"above": 1, "below": -1}.get(word, 0)
    inside = {"above": 1.1e-6, "below": -1.1e-6, "to below": -1.1e-6}.get(word, 0.0)
    return value + inside * (abs(value) or 1.0)
