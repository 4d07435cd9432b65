"""Declared fields of a dataclass, with their unit, accepted values and meaning."""

from __future__ import annotations

import inspect
from collections.abc import Hashable, Mapping
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from enum import Flag, StrEnum, auto
from functools import cache, cached_property
from types import MappingProxyType
from typing import Any, TypeVar, cast

from annotated_types import Interval

from bounds.bound import Bound, Choice
from bounds.text import SiNote

Thing = TypeVar("Thing")


class Kind(StrEnum):
    """The kind of quantity of a field."""

    AMOUNT = auto()
    """A small depth without a sign."""
    DEVIATION = "slope"
    """A small length with a sign: a slope, a position error, an interference. Forms know it as a slope."""
    LENGTH = auto()
    """An extent; ``x_length`` is the extent of the amount ``x``, which does not act without it."""
    START = auto()
    """The place at which a modification begins."""
    EDGE = auto()
    """The size of a tip edge, where a flank ends."""
    ANGLE = auto()
    SHAPE = auto()
    """A law by its name."""
    CHOICE = auto()
    """One of several, by its name."""
    SURFACE = auto()
    """A surface given by a table."""
    PART = auto()
    """A part of declared fields."""
    PARTS = auto()
    """A list of parts, each a dataclass."""
    STIFFNESS = auto()
    """A force, traction or stress per displacement or strain."""
    DAMPING = auto()
    """A force or moment per rate."""
    FORCE = auto()
    INERTIA = auto()
    """A mass, a density, a moment of inertia."""
    LOAD = auto()
    """A force or a moment."""
    SPEED = auto()
    TEMPERATURE = auto()
    TIME = auto()
    FREQUENCY = auto()
    COUNT = auto()
    """An integer."""
    SWITCH = auto()
    """True or false."""
    RATIO = auto()


DEPTHS = (Kind.AMOUNT, Kind.DEVIATION)


class Direction(Flag):
    """Directions of a flank along which a modification varies."""

    NONE = 0
    PROFILE = auto()
    FACE = auto()


@dataclass(frozen=True)
class Declared:
    """The declaration of a field of a dataclass."""

    kind: Kind
    unit: str
    """Symbol of the SI unit; empty for none."""
    bound: Interval | Choice | None
    """Range of accepted values in SI, whatever the other fields are; None: the value checks itself."""
    description: str
    """Meaning of the field. A writer of the description puts the unit in place of {unit}, else before the
    first semicolon.
    """
    example: Any = None
    """A usual value, in SI."""
    along: Direction = Direction.NONE
    """Directions of a flank along which the field acts."""
    written: str = ""
    """Symbol of the unit in which the field is usually written, where that is not the usual one of its SI
    unit.
    """
    part: type | None = None
    """Dataclass of a part. The field's value is None, or the dataclass's default, where the part is left out.
    """
    omit_default: bool = False
    """Whether the field was added after results had been stored. At its default it is not written out, so
    that an input without the field keeps the address of its result.
    """
    maximum: int = 100
    """Largest number of parts of a list."""
    with_unit: bool = False
    """Whether a message has the unit behind the ends of the range."""

    @cached_property
    def limits(self) -> Bound | Choice | None:
        """Range of accepted values, as a message states it."""
        if not isinstance(self.bound, Interval):
            return self.bound
        unit = self.unit if self.with_unit else ""
        return Bound.of(self.bound, integer=self.kind is Kind.COUNT, unit=unit)

    @cached_property
    def remedy(self) -> SiNote:
        """Remedy for a refused value, with an example in its unit."""
        return SiNote(f"In {self.unit}, for example {self.example}.")


def declared(default: Any, declaration: Declared) -> Any:
    """Return the field of a dataclass with its default and its declaration.

    A default of None means that the field may be left out.
    """
    return field(default=default, metadata={Declared: declaration})


def required(declaration: Declared) -> Any:
    """Return the field of a dataclass without a default, with its declaration."""
    return declared(MISSING, declaration)


def written(thing: Any) -> Any:
    """Return a dataclass and its parts as dictionaries, without the fields left out at their defaults."""
    if not is_dataclass(thing):
        return type(thing)(map(written, thing)) if isinstance(thing, list | tuple) else thing
    by_name = declarations(type(thing))
    values = ((entry, getattr(thing, entry.name)) for entry in fields(thing))
    return {
        entry.name: written(value)
        for entry, value in values
        if not (value == entry.default and entry.name in by_name and by_name[entry.name].omit_default)
    }


def described(kind: type[Thing]) -> type[Thing]:
    """Append the descriptions of the declared fields of a dataclass to its docstring; a decorator."""
    entries = []
    for name, fact in declarations(kind).items():
        # where numpy's style has the type of an attribute: its part, else its unit
        unit = fact.unit or ("name" if isinstance(fact.bound, Choice) else "1")
        type_text = fact.part.__name__ if fact.part else unit
        entries.append(f"{name} : {type_text}\n    {fact.description.replace('{unit}', fact.unit)}")
    text = inspect.cleandoc(kind.__doc__ or "")
    kind.__doc__ = "\n".join((text, "", "Attributes", "----------", *entries, ""))
    return kind


def declarations(kind: type[Any]) -> Mapping[str, Declared]:
    """Return the declared fields of a dataclass by name, in its order."""
    return _declarations(cast("Hashable", kind))  # mypy does not take a type for hashable, as a cache needs


@cache
def _declarations(kind: Any) -> Mapping[str, Declared]:
    """Return the declared fields by name; the cache keeps those of each dataclass."""
    entries = {entry.name: entry.metadata[Declared] for entry in fields(kind) if Declared in entry.metadata}
    return MappingProxyType(entries)
