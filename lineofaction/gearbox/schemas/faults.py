"""Conversion of pydantic's errors to faults: field, value, bound, suggestion.

A bound is the rule that the value breaks, in words that follow "must be". The `loc` of an error is the path
to its value: names of fields, and indices of lists.
"""

from __future__ import annotations

import difflib
import types
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import islice, takewhile
from typing import Annotated, Any, NamedTuple, Union, get_args, get_origin

import annotated_types
from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from lineofaction.gearbox.problems import Fault
from lineofaction.gearbox.schemas.model import MAX_FAULTS

Loc = Sequence[int | str]

_LONGEST_NAME = 200
"""Characters of a field's name that a fault repeats: a request may have names of any length."""
_LONGEST_GUESS = 64
"""Characters of an unknown name that are compared with the known names."""
_MOST_NAMES = 12
"""Most fields of a table that a fault lists."""
_MOST_TABLES = 3
"""Most tables that a fault names as those of a field; where more have it, none of them is meant."""
_ALTERNATIVES = ("[key]", "[one]", "[many]")
"""Parts of a `loc` that name a key of a table or an alternative of a union; the user did not write them."""

_KINDS = {
    "int_type": "an integer",
    "int_from_float": "an integer",
    "int_parsing_size": "an integer",
    "float_type": "a number",
    "finite_number": "a finite number",
    "bool_type": "true or false",
    "string_type": "a text in quotes",
    "tuple_type": "a list in brackets",
    "list_type": "a list in brackets",
    "dict_type": "a table of fields",
    "model_type": "a table of fields",
    "model_attributes_type": "a table of fields",
    "json_invalid": "valid JSON",
}

_LISTS = ("tuple_type", "list_type")
_LIMITS: dict[str, type] = {
    "gt": annotated_types.Gt,
    "ge": annotated_types.Ge,
    "lt": annotated_types.Lt,
    "le": annotated_types.Le,
}


def faults_of(error: ValidationError, model: type[BaseModel]) -> tuple[Fault, ...]:
    """Return the faults of a validation of `model`."""
    items = innermost(error.errors(include_url=False))
    return tuple(fault_of(item, model, item["loc"]) for item in items)


def innermost(items: Sequence[Any]) -> list[Any]:
    """Return at most `MAX_FAULTS` errors, without those of a list or table of which a part has an error."""
    locations = [tuple(item["loc"]) for item in items]
    outer = {location[:depth] for location in locations for depth in range(len(location))}
    inner = (item for item, location in zip(items, locations, strict=True) if location not in outer)
    return list(islice(inner, MAX_FAULTS))


def fault_of(item: Mapping[str, Any], model: type[BaseModel] | None, loc: Loc) -> Fault:
    """Return one pydantic error as a fault; `loc` is its place relative to `model`."""
    context = item.get("ctx", {})
    if item["type"] == "refused":
        field = _dotted([*loc, *str(context["field"]).split(".")])
        return Fault(field, context["value"], context["bound"], context["suggestion"])
    parent, info = _field_at(model, loc)
    value = None if item["type"] == "missing" else item.get("input")
    if item["type"] == "extra_forbidden" and parent is not None and model is not None:
        suggestion = _advice_on_unknown(str(loc[-1]), loc[:-1], model, parent)
    else:
        suggestion = _described(info)
    return Fault(_dotted(loc), value, _bound(item, info), suggestion)


def _dotted(loc: Loc) -> str:
    """Return the path to a value as the user writes it: pair.pinion.teeth, load.torque_n_m[2]."""
    text = ""
    for part in loc:
        if part in _ALTERNATIVES:
            continue
        name = _printable(str(part)[:_LONGEST_NAME])
        if isinstance(part, int):
            text += f"[{name}]"
        else:
            text += f".{name}" if text else name
    return text or "input"


def _printable(name: str) -> str:
    """Return a name with escapes as in Python if it could start a line or command a terminal."""
    return name if name.isprintable() else name.encode("unicode_escape").decode()


def _field_at(model: type[BaseModel] | None, loc: Loc) -> tuple[type[BaseModel] | None, FieldInfo | None]:
    """Return the model that holds the last named field of `loc`, and that field; None: not known."""
    current, info = model, None
    for index, part in enumerate(loc):
        if isinstance(part, int):
            continue
        if current is None:
            return None, None
        info = current.model_fields.get(part)
        if index == len(loc) - 1 or info is None:
            return current, info
        inner = model_in(info.annotation)
        if inner is None:
            return current, info
        current = inner
    return current, info


def model_in(annotation: object) -> type[BaseModel] | None:
    """Return the model inside an annotation such as `Model | None` or `tuple[Model, ...]`."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    if get_origin(annotation) in (Union, types.UnionType, tuple, list, dict, Annotated):
        models = (model_in(argument) for argument in get_args(annotation))
        return next((inner for inner in models if inner is not None), None)
    return None


def _constraints(info: FieldInfo | None) -> dict[str, float]:
    """Return the limits of a field, or of the elements of its list, by the names in `_LIMITS`."""
    limits: dict[str, float] = {}
    for item in _metadata(info.metadata if info else (), info.annotation if info else None):
        for name, kind in _LIMITS.items():
            if isinstance(item, kind):
                limits[name] = getattr(item, name)
    return limits


def _metadata(constraints: Iterable[object], annotation: object) -> Iterable[object]:
    """Yield the metadata of a field and of the annotations inside its own, down to the elements of a list."""
    for item in constraints:
        yield from getattr(item, "metadata", None) or [item]
    for argument in get_args(annotation):
        yield from _metadata(getattr(argument, "__metadata__", ()), argument)


def _range(limits: Mapping[str, float]) -> str:
    if "ge" in limits and "le" in limits:
        return f"from {limits['ge']:g} to {limits['le']:g}"
    comparisons = {"gt": "above", "ge": "at least", "lt": "below", "le": "at most"}
    return " and ".join(f"{comparisons[name]} {limits[name]:g}" for name in comparisons if name in limits)


def _bound(item: Mapping[str, Any], info: FieldInfo | None) -> str:
    kind, context = item["type"], item.get("ctx", {})
    span = _range(_constraints(info))
    if kind in _KINDS:
        return f"{_KINDS[kind]}, each {span}" if kind in _LISTS and span else f"{_KINDS[kind]} {span}".strip()
    if kind in ("greater_than", "greater_than_equal", "less_than", "less_than_equal"):
        return span or _range({name: context[name] for name in _LIMITS if name in context})
    texts: dict[str, Callable[[], str]] = {
        "missing": lambda: "given",
        "extra_forbidden": lambda: "left out: there is no such field here",
        "literal_error": lambda: f"one of {context['expected']}",
        "too_short": lambda: f"a list of at least {context['min_length']}",
        "too_long": lambda: f"a list of at most {context['max_length']}",
        "string_too_short": lambda: f"a text of at least {context['min_length']} characters",
        "string_too_long": lambda: f"a text of at most {context['max_length']} characters",
        "string_pattern_mismatch": lambda: f"a text of the form {context['pattern']}",
    }
    return texts[kind]() if kind in texts else f"valid ({item.get('msg', '')})"


def _advice_on_unknown(name: str, location: Loc, model: type[BaseModel], table: type[BaseModel]) -> str:
    """Return a suggestion for a name of which the `table` at a place of `model` has no field.

    It names other tables that have such a field, or else the nearest names in this table.
    """
    path = [part for part in location if isinstance(part, str) and part not in _ALTERNATIVES]
    if tables := _nearest_tables(_tables_by_field(model).get(name, ()), path):
        return f"{name} is a field of {' and '.join(tables)}."
    close = difflib.get_close_matches(name[:_LONGEST_GUESS], table.model_fields, n=1)
    manual = getattr(table, "MANUAL", "")
    return f"Did you mean {close[0]}?" if close else known_names(name, list(table.model_fields), manual)


def known_names(name: str, known: Sequence[str], manual: str) -> str:
    """Return a sentence with the known names, or of many the nearest ones and the `manual` that has all."""
    if len(known) <= _MOST_NAMES:
        return f"Known here: {', '.join(known)}."
    nearest = difflib.get_close_matches(name[:_LONGEST_GUESS], known, n=_MOST_NAMES, cutoff=0.0)
    return f"Nearest of {len(known)} here: {', '.join(nearest)}. All are in {manual}."


class _Table(NamedTuple):
    """A table of a file: the names of the tables down to it, and whether it is one of a list."""

    path: tuple[str, ...]
    in_list: bool

    def __str__(self) -> str:
        """Return the table as its header in TOML."""
        if not self.path:
            return "the top level, outside of all tables"
        name = ".".join(self.path)
        return f"[[{name}]]" if self.in_list else f"[{name}]"


def _nearest_tables(tables: Sequence[_Table], path: Sequence[str]) -> list[str]:
    """Return the tables that share the longest beginning with a path, if they are few."""
    shared = [_shared(table.path, path) for table in tables]
    nearest = [str(table) for table, count in zip(tables, shared, strict=True) if count == max(shared)]
    return nearest if len(nearest) <= _MOST_TABLES else []


def _shared(first: Sequence[str], second: Sequence[str]) -> int:
    """Return how many names two paths share from the beginning on."""
    pairs = zip(first, second, strict=False)
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], pairs))


@lru_cache(maxsize=32)
def _tables_by_field(model: type[BaseModel]) -> Mapping[str, Sequence[_Table]]:
    """Return the tables below `model` that have a field of each name."""
    tables: dict[str, list[_Table]] = defaultdict(list)
    for table, inner in _tables(model, _Table((), in_list=False)):
        for name in inner.model_fields:
            tables[name].append(table)
    return tables


def _tables(model: type[BaseModel], table: _Table) -> Iterator[tuple[_Table, type[BaseModel]]]:
    """Yield a table and those below it, each with its model."""
    yield table, model
    for name, info in model.model_fields.items():
        inner = model_in(info.annotation)
        if inner is not None:
            yield from _tables(inner, _Table((*table.path, name), _is_list(info.annotation)))


def _is_list(annotation: object) -> bool:
    """Whether an annotation such as `tuple[Model, ...] | None` has a list."""
    return get_origin(annotation) in (tuple, list) or any(map(_is_list, get_args(annotation)))


def field_remedy(model: type[BaseModel], field: str) -> str:
    """Return the model's description of a field, e.g. ``"pair.pinion.bore_diameter_mm"``; empty if none."""
    loc = [part for part in field.replace("[", ".").replace("]", "").split(".") if not part.isdigit()]
    return _described(_field_at(model, loc)[1])


def _described(info: FieldInfo | None) -> str:
    if info is None:
        return ""
    example = f"For example {info.examples[0]!r}" if info.examples else ""
    return "".join(f"{part}. " for part in (info.description, example) if part).rstrip()
