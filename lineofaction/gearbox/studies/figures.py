"""The document of a result's figures, which follows from their model: names, units, parts."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial, reduce
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin

import numpy as np
from pydantic.fields import FieldInfo

from bounds.types import Json
from lineofaction.gearbox.schemas.figures import REQUIRED, Figures, Part, Source
from lineofaction.gearbox.units import BY_SUFFIX

_DIVISORS = {name: unit.factor for name, unit in BY_SUFFIX.items()} | {"_mpa": 1e6, "_mm_per_s": 1e-3}
_IN_SI = ("_n_m", "_n", "_hz", "_w", "_m2", "_m", "_s", "_db_a", "_db")
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


def figures_of(model: type[Part], *sources: Any, **own: Any) -> Json:
    """Return a result as a model of figures has it.

    A figure ``speed_rpm`` is the member ``speed_rpm`` of the first source that has one, or its member
    ``speed``, which is in SI; or what its `Source` says. A part is made of its own source, or of several and
    a mapping of its own members as a tuple. A number that is not finite is None where None may stand; a
    figure that may be missing is left out where it is None.

    Parameters
    ----------
    model : type of Part
    *sources : object or mapping
        Results, and documents of them.
    **own
        Members before those of the sources.

    Raises
    ------
    AttributeError
        No source has a figure.
    """
    document = {}
    for name, (field, key, source) in _declared(model).items():
        value = _found(name, source, own, sources, required=field.is_required())
        figure = source.turned(value[0]) if source and source.document else _figure(field.annotation, *value)
        if field.is_required() or figure is not None:
            document[key] = figure
    return document


@cache
def _declared(model: type[Part]) -> dict[str, tuple[FieldInfo, str, Source | None]]:
    """Return field, name in the document and source of every figure of a model, but for those of its file."""
    of_file = Figures.model_fields if issubclass(model, Figures) else {}
    return {
        name: (field, field.alias or name, next((m for m in field.metadata if isinstance(m, Source)), None))
        for name, field in model.model_fields.items()
        if name not in of_file
    }


def _found(
    name: str, source: Source | None, own: Json, sources: tuple[Any, ...], *, required: bool
) -> tuple[Any, Any]:
    """Return the value of a figure, and what turns it into its unit."""
    bare, convert = _unit(name)
    if name in own:
        return own[name], _same
    if bare in own:
        return own[bare], convert
    for each in sources:
        if source is None and (value := _member(each, name)) is not _MISSING:
            return value, _same
        if (value := _read(each, source) if source else _member(each, bare)) is not _MISSING:
            return value, convert
    if source and source.missing is not REQUIRED:
        return source.missing, _same
    if required:
        raise AttributeError(name)
    return None, _same


def _read(result: Any, source: Source) -> Any:
    """Return what a source says of a result; nothing if it has no such member."""
    return source.of(result) if callable(source.of) else reduce(_member, source.of.split("."), result)


def _member(result: Any, name: str) -> Any:
    if isinstance(result, Mapping):
        return result.get(name, _MISSING)
    return getattr(result, name, _MISSING)


@cache
def _unit(name: str) -> tuple[str, Callable[[Any], Any]]:
    """Return the name of a figure without its unit, and what turns a value in SI into it."""
    if name.endswith("_deg"):
        return name.removesuffix("_deg"), np.degrees
    for suffix, divisor in _DIVISORS.items():
        if name.endswith(suffix):
            return name.removesuffix(suffix), partial(_divided, divisor)
    suffix = next((suffix for suffix in _IN_SI if name.endswith(suffix)), "")
    return name.removesuffix(suffix), _same


def _same(value: Any) -> Any:
    return value


def _divided(divisor: float, value: Any) -> Any:
    return value / divisor


def _figure(kind: Any, value: Any, convert: Callable[[Any], Any]) -> Any:
    """Return a value as a type of a model has it."""
    kind, nullable = _present(kind)
    value = value.item() if isinstance(value, np.generic) else value
    if value is None or (nullable and isinstance(value, float) and not math.isfinite(value)):
        return None
    parts = get_args(kind)
    if isinstance(kind, type) and issubclass(kind, Part):
        sources, own = _sources(value)
        return figures_of(kind, *sources, **own)
    if isinstance(value, np.ndarray) and not _holds_none(kind):
        return convert(value).tolist()
    if get_origin(kind) in (list, tuple):
        return [_figure(parts[0], entry, convert) for entry in value]
    if get_origin(kind) is dict:
        return {name: _figure(parts[1], entry, convert) for name, entry in value.items()}
    return value if isinstance(value, str | bool) or convert is _same else convert(value)


def _sources(value: Any) -> tuple[Sequence[Any], Json]:
    """Return the sources of a part, and its own members."""
    if not isinstance(value, tuple) or hasattr(value, "_fields"):
        return [value], {}
    *sources, own = value
    return sources, own


def _present(kind: Any) -> tuple[Any, bool]:
    """Return a type without None, and whether None may stand."""
    if get_origin(kind) not in (Union, UnionType):
        return kind, False
    parts = [part for part in get_args(kind) if part is not NoneType]
    return (parts[0] if len(parts) == 1 else Any), NoneType in get_args(kind)


@cache
def _holds_none(kind: Any) -> bool:
    """Whether None may stand in rows of a type."""
    return kind is NoneType or any(_holds_none(part) for part in get_args(kind))
