"""The document of a result's figures, which follows from their model: names, units, parts."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, reduce
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin

import numpy as np
from pydantic.fields import FieldInfo

from bounds.types import Json
from lineofaction.gearbox.schemas.figures import REQUIRED, Figures, Part, Source
from lineofaction.gearbox.units import ending_of, factor

_MISSING = object()


@dataclass(frozen=True)
class Row:
    """The entry of an index of every array of a result, under their names."""

    result: Any
    index: int

    def __getattr__(self, name: str) -> Any:
        """Return the entry of an array."""
        return getattr(self.result, name)[self.index]


def rows(result: Any, names: tuple[str, ...]) -> dict[str, Row]:
    """Return the rows of a result by the names of its meshes, its bearings, its points."""
    return {name: Row(result, index) for index, name in enumerate(names)}


def figures_of(model: type[Part], *sources: Any, **members: Any) -> Json:
    """Return a result as a model of figures has it.

    A figure ``speed_rpm`` is the member ``speed_rpm`` of the first source that has one, or its member
    ``speed``, which is in SI; or what its `Source` says. A name without unit that several figures share
    stands for none of them. A part is made of its own source, or of a tuple: several sources, then a mapping
    of the part's members. A number that is not finite is None where None may stand; a figure that may be
    missing is left out where it is None. Raises `AttributeError`: no source has a figure; `TypeError`: one of
    `members` is none of the model's figures, or might be several.

    Parameters
    ----------
    *sources : object or mapping
        Results, and documents of them.
    **members
        Members before those of the sources.
    """
    if unknown := ", ".join(sorted(members.keys() - _names(model))):
        raise TypeError(f"not the name of one figure of {model.__name__}: {unknown}")
    document = {}
    for figure in _declared(model):
        value, convert = figure.lookup(members, sources)
        source, kind = figure.source, figure.field.annotation
        entry = source.turned(value) if source and source.document else _figure(kind, value, convert)
        if figure.field.is_required() or entry is not None:
            document[figure.key] = entry
    return document


@dataclass(frozen=True)
class _Declared:
    """A figure of a model: field, field without unit (empty: not unique), and key in the document."""

    name: str
    bare: str
    key: str
    field: FieldInfo
    source: Source | None

    def lookup(self, members: Json, sources: tuple[Any, ...]) -> tuple[Any, Callable[[Any], Any]]:
        """Return the value of the figure, and the conversion to its unit."""
        _, convert = _unit(self.name)
        if self.name in members:
            return members[self.name], _same
        if self.bare in members:
            return members[self.bare], convert
        for candidate in sources:
            if self.source:
                of = self.source.of
                value = of(candidate) if callable(of) else reduce(_member, of.split("."), candidate)
            else:
                value = _member(candidate, self.name)
                if value is not _MISSING:
                    return value, _same
                value = _member(candidate, self.bare)
            if value is not _MISSING:
                return value, convert
        if self.source and self.source.missing is not REQUIRED:
            return self.source.missing, _same
        if self.field.is_required():
            raise AttributeError(self.name)
        return None, _same


@cache
def _declared(model: type[Part]) -> tuple[_Declared, ...]:
    """Return the figures of a model, except figures of its file."""
    of_file = Figures.model_fields if issubclass(model, Figures) else {}
    fields = {name: field for name, field in model.model_fields.items() if name not in of_file}
    bare = {name: _unit(name)[0] for name in fields}
    shared = Counter(bare.values())
    return tuple(
        _Declared(
            name,
            bare[name] if shared[bare[name]] == 1 else "",
            field.alias or name,
            field,
            next((entry for entry in field.metadata if isinstance(entry, Source)), None),
        )
        for name, field in fields.items()
    )


@cache
def _names(model: type[Part]) -> frozenset[str]:
    """Return the names by which a model has its figures."""
    return frozenset(name for figure in _declared(model) for name in (figure.name, figure.bare) if name)


def metadata_of(result: Any) -> Mapping[str, Any]:
    """Return the plain metadata of the result of a scene; empty for the result of a pair."""
    metadata = getattr(result, "metadata", None)
    return metadata if isinstance(metadata, Mapping) else {}


def _member(result: Any, name: str) -> Any:
    if isinstance(result, Mapping):
        return result.get(name, _MISSING)
    return getattr(result, name, _MISSING)


@cache
def _unit(name: str) -> tuple[str, Callable[[Any], Any]]:
    """Return the name of a figure without its unit, and the conversion from SI to the unit."""
    ending = ending_of(name)
    bare, divisor = name.removesuffix(ending), factor(name)
    if ending == "_deg":
        return bare, np.degrees
    return bare, _same if divisor == 1.0 else lambda value: value / divisor


def _same(value: Any) -> Any:
    return value


def _figure(kind: Any, value: Any, convert: Callable[[Any], Any]) -> Any:
    """Return a value as a type of a model has it."""
    kind, nullable = _present(kind)
    value = value.item() if isinstance(value, np.generic) else value
    if value is None or (nullable and isinstance(value, float) and not math.isfinite(value)):
        return None
    parts = get_args(kind)
    if isinstance(kind, type) and issubclass(kind, Part):
        is_source = not isinstance(value, tuple) or hasattr(value, "_fields")  # such as a named tuple
        *sources, members = (value, {}) if is_source else value
        return figures_of(kind, *sources, **members)
    if isinstance(value, np.ndarray) and (not _holds_none(kind) or _is_finite(value)):
        return convert(value).tolist()
    if get_origin(kind) in (list, tuple):
        return [_figure(parts[0], entry, convert) for entry in value]
    if get_origin(kind) is dict:
        return {name: _figure(parts[1], entry, convert) for name, entry in value.items()}
    return value if isinstance(value, str | bool) or convert is _same else convert(value)


def _present(kind: Any) -> tuple[Any, bool]:
    """Return a type without None, and whether None may stand."""
    if get_origin(kind) not in (Union, UnionType):
        return kind, False
    parts = [part for part in get_args(kind) if part is not NoneType]
    return (parts[0] if len(parts) == 1 else Any), NoneType in get_args(kind)


def _is_finite(values: np.ndarray) -> bool:
    """Whether an array is of finite numbers, none of which is None in a document."""
    return values.dtype.kind in "fiu" and bool(np.all(np.isfinite(values)))


@cache
def _holds_none(kind: Any) -> bool:
    return kind is NoneType or any(_holds_none(part) for part in get_args(kind))
